//! The units of the variables: what they are in SI base units, and how a person likes to see them.

/// A unit as the FMI defines one: `base value = factor * value + offset`, the base value in the SI base units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// How the unit is written.
    pub name: &'static str,
    /// Exponents of the SI base units and of rad.
    pub base: &'static [(&'static str, i32)],
    /// Factor to the base unit.
    pub factor: f64,
    /// Offset to the base unit.
    pub offset: f64,
    /// The unit for display, if another is handier, and its factor: `displayed = factor * value`.
    pub display: Option<(&'static str, f64)>,
}

const fn unit(name: &'static str, base: &'static [(&'static str, i32)]) -> Unit {
    Unit { name, base, factor: 1.0, offset: 0.0, display: None }
}

const fn scaled(name: &'static str, factor: f64, base: &'static [(&'static str, i32)]) -> Unit {
    Unit { factor, ..unit(name, base) }
}

const fn shown(name: &'static str, base: &'static [(&'static str, i32)], display: &'static str, factor: f64) -> Unit {
    Unit { display: Some((display, factor)), ..unit(name, base) }
}

const DEG_PER_RAD: f64 = 180.0 / std::f64::consts::PI;

/// Every unit that a variable may have.
pub const UNITS: &[Unit] = &[
    unit("1", &[]),
    unit("s", &[("s", 1)]),
    unit("1/s", &[("s", -1)]),
    unit("m", &[("m", 1)]),
    unit("m2", &[("m", 2)]),
    shown("m3", &[("m", 3)], "cm3", 1e6),
    scaled("cm3", 1e-6, &[("m", 3)]),
    scaled("cm3/h", 1e-6 / 3600.0, &[("m", 3), ("s", -1)]),
    shown("m3/s", &[("m", 3), ("s", -1)], "cm3/s", 1e6),
    unit("m/s", &[("m", 1), ("s", -1)]),
    unit("m/s2", &[("m", 1), ("s", -2)]),
    shown("rad", &[("rad", 1)], "deg", DEG_PER_RAD),
    shown("rad/s", &[("rad", 1), ("s", -1)], "deg/s", DEG_PER_RAD),
    shown("rad/s2", &[("rad", 1), ("s", -2)], "deg/s2", DEG_PER_RAD),
    unit("1/rad", &[("rad", -1)]),
    unit("1/rad2", &[("rad", -2)]),
    unit("kg", &[("kg", 1)]),
    shown("kg/s", &[("kg", 1), ("s", -1)], "g/s", 1e3),
    scaled("kg/h", 1.0 / 3600.0, &[("kg", 1), ("s", -1)]),
    unit("kg/m3", &[("kg", 1), ("m", -3)]),
    unit("kg.m", &[("kg", 1), ("m", 1)]),
    unit("kg.m2", &[("kg", 1), ("m", 2)]),
    unit("kg.m/s", &[("kg", 1), ("m", 1), ("s", -1)]),
    unit("N", &[("kg", 1), ("m", 1), ("s", -2)]),
    unit("N.m", &[("kg", 1), ("m", 2), ("s", -2)]),
    unit("N.m.s", &[("kg", 1), ("m", 2), ("s", -1)]),
    unit("N.m.s2", &[("kg", 1), ("m", 2)]),
    shown("J", &[("kg", 1), ("m", 2), ("s", -2)], "kJ", 1e-3),
    unit("W", &[("kg", 1), ("m", 2), ("s", -3)]),
    unit("J/m3", &[("kg", 1), ("m", -1), ("s", -2)]),
    unit("Pa", &[("kg", 1), ("m", -1), ("s", -2)]),
    unit("Pa/s", &[("kg", 1), ("m", -1), ("s", -3)]),
    unit("kg/m3/s", &[("kg", 1), ("m", -3), ("s", -1)]),
    unit("1/Pa", &[("kg", -1), ("m", 1), ("s", 2)]),
    scaled("dbar", 1e4, &[("kg", 1), ("m", -1), ("s", -2)]),
    unit("1/K", &[("K", -1)]),
    unit("K", &[("K", 1)]),
    unit("K/s", &[("K", 1), ("s", -1)]),
    Unit { name: "degC", base: &[("K", 1)], factor: 1.0, offset: 273.15, display: None },
    scaled("1/d", 1.0 / 86_400.0, &[("s", -1)]),
];

/// The unit of this name.
pub fn unit_named(name: &str) -> Option<&'static Unit> {
    UNITS.iter().find(|unit| unit.name == name)
}
