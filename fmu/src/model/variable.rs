//! What a variable of a model is, and a table of them: causality, kind, value reference, unit, bounds, the place it stands for.
//! Knows no single variable; the rows stand in `table.rs` and `space/table.rs`.

use super::units::Unit;

/// What a variable is to its surroundings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Causality {
    /// Time.
    Independent,
    /// Set from outside while the simulation runs.
    Input,
    /// Published to other models.
    Output,
    /// Open to look at.
    Local,
    /// Set from outside before the simulation, or between its steps when tunable.
    Parameter,
}

/// When a variable may change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variability {
    /// Never.
    Constant,
    /// Not after initialisation.
    Fixed,
    /// Between steps and at events, by the hand of the user.
    Tunable,
    /// At events.
    Discrete,
    /// Any time.
    Continuous,
}

/// Where the value at the start comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Initial {
    /// It is the start value.
    Exact,
    /// It follows from other variables; the start value is what it is with theirs, for importers that must know one.
    Approx,
    /// It follows from other variables.
    Calculated,
}

/// The type of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A floating-point number.
    Real,
    /// An integer.
    Integer,
    /// One of the items of a list, each with its number.
    Choice(&'static Choice),
    /// True or false.
    Boolean,
    /// A text.
    Text,
}

/// A list of which a variable takes one item.
#[derive(Debug, PartialEq, Eq)]
pub struct Choice {
    /// What the list is called.
    pub name: &'static str,
    /// What it decides.
    pub description: &'static str,
    /// Its items, numbered from 0: name and meaning.
    pub items: &'static [(&'static str, &'static str)],
}

/// The place in the glider that a variable stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slot {
    /// Time.
    Time,
    /// An input, by its place in the table of inputs.
    Input(usize),
    /// A continuous state.
    State(usize),
    /// The time derivative of a continuous state.
    Derivative(usize),
    /// An output, by its place in the table of outputs.
    Output(usize),
    /// The power drawn, which is the derivative of the energy under its own name.
    Power,
    /// An event indicator.
    Indicator(usize),
    /// Something that changes at events only.
    Discrete(Discrete),
    /// A number of the library's table of parameters.
    Parameter(usize),
    /// Who moves the moving mass and the ballast.
    Actuation,
    /// Who gives rudder and roll mass their set-points.
    Steering,
    /// Where density and temperature of the water come from.
    WaterSource,
    /// Whether the start is the glide of the parameters that were set.
    StartInTrim,
    /// The name of the vehicle.
    VehicleName,
}

/// What changes at events only.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Discrete {
    /// Whether the hull breaks the surface.
    AtSurface,
    /// Whether the hull touches the seabed.
    OnSeabed,
    /// Which end of its range the ballast is pushed against.
    BallastStop,
    /// Which stop the moving mass is pushed against.
    MovingMassStop,
}

/// One variable. Owns nothing on the heap: the table must not outlive a library that is unloaded.
#[derive(Debug, Clone, Copy)]
pub struct Variable {
    /// Its value reference.
    pub reference: u32,
    /// Name, with its unit.
    pub name: &'static str,
    /// What it is, in a line.
    pub description: &'static str,
    /// Type of its value.
    pub kind: Kind,
    /// What it is to its surroundings.
    pub causality: Causality,
    /// When it may change.
    pub variability: Variability,
    /// Where its value at the start comes from; none for time.
    pub initial: Option<Initial>,
    /// Its unit, where it has one.
    pub unit: Option<&'static Unit>,
    /// Smallest and largest value.
    pub bounds: Option<(f64, f64)>,
    /// A usual size.
    pub nominal: Option<f64>,
    /// Whether an event may make it jump.
    pub jumps: bool,
    /// What it stands for.
    pub slot: Slot,
}

impl Variable {
    /// Whether a user may give it a start value.
    pub fn has_start(&self) -> bool {
        matches!(self.initial, Some(Initial::Exact | Initial::Approx))
    }

    /// Whether its value at the start follows from other variables.
    pub fn follows_at_start(&self) -> bool {
        matches!(self.initial, Some(Initial::Approx | Initial::Calculated))
    }
}

/// The variables of a model, in the order of their value references, and the name of this very table.
#[derive(Debug, Clone, Copy)]
pub struct Table {
    /// The variables.
    pub rows: &'static [Variable],
    /// A name for this table: it changes when a variable changes, and stays when only start values do. Written as a GUID,
    /// the form that FMI 2.0 importers expect.
    pub token: &'static str,
}

impl Table {
    /// The lists that its variables choose from.
    pub fn choices(self) -> impl Iterator<Item = &'static Choice> {
        self.rows.iter().filter_map(|variable| match variable.kind {
            Kind::Choice(choice) => Some(choice),
            _ => None,
        })
    }

    /// The variable of this value reference.
    pub fn variable(self, value_reference: u32) -> Option<&'static Variable> {
        self.rows.get((value_reference as usize).checked_sub(1)?)
    }

    /// The variable that stands for this place.
    pub fn variable_of(self, slot: Slot) -> &'static Variable {
        self.rows.iter().find(|variable| variable.slot == slot).expect("every slot has its row")
    }

    /// The value reference of what stands in this place.
    pub fn reference_of(self, slot: Slot) -> u32 {
        self.variable_of(slot).reference
    }

    /// The place of the variable of this name.
    pub fn slot_of(self, name: &str) -> Option<Slot> {
        self.rows.iter().find(|variable| variable.name == name).map(|variable| variable.slot)
    }
}

/// The rows by their value references, which are 1 to N.
pub(super) fn in_order<const N: usize>(mut rows: Vec<Variable>) -> [Variable; N] {
    rows.sort_by_key(|row| row.reference);
    for (row, expected) in rows.iter().zip(1..) {
        assert_eq!(row.reference, expected, "{}: a further row takes the next free value reference", row.name);
    }
    rows.try_into().unwrap_or_else(|rows: Vec<_>| panic!("{} rows, not {N}", rows.len()))
}

/// The bytes of a table's name.
pub(super) struct Token([u8; 38]);

impl Token {
    /// The name of these rows.
    pub fn of(rows: &[Variable]) -> Self {
        // FNV-1a: stable across compilers and machines, which the standard library's hash does not promise to be.
        let mut hash: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
        for byte in rows.iter().flat_map(|v| format!("{v:?}").into_bytes()) {
            hash = (hash ^ u128::from(byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b);
        }
        let digits = format!("{hash:032x}");
        let parts = [&digits[..8], &digits[8..12], &digits[12..16], &digits[16..20], &digits[20..]];
        let guid = format!("{{{}}}", parts.join("-"));
        Token(std::array::from_fn(|i| guid.as_bytes()[i]))
    }

    /// As text.
    pub fn text(&self) -> &str {
        std::str::from_utf8(&self.0).expect("digits, dashes and braces")
    }
}
