//! The keys of a vehicle file, in one table: from it follow the structure in memory, the reader, the writer and what a
//! misspelt or missing key is reported.

/// How much a key is needed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Need {
    /// Nothing works without it; the text says what it is needed for.
    Always(&'static str),
    /// Time histories and the FMU need it; steady glides and fits do without.
    ForMotion(&'static str),
    /// Turns need it; the vertical plane does without.
    ForTurns(&'static str),
    /// Taken when absent.
    Default(f64),
    /// Left out without loss.
    Optional,
}

/// One key of a vehicle file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// Section and name with a dot between.
    pub path: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// How much it is needed.
    pub need: Need,
    /// What it is.
    pub meaning: &'static str,
    /// Smallest value with a meaning.
    pub min: f64,
}

macro_rules! sections {
    ($($(#[$doc:meta])* $section:ident $Section:ident = $prefix:literal {
        $($name:ident : $need:expr, $unit:literal, $min:expr, $meaning:literal;)*
    })*) => {
        $(
            $(#[$doc])*
            #[derive(Debug, Clone, Copy, PartialEq, Default)]
            pub struct $Section {
                $(#[doc = concat!($meaning, " \\[", $unit, "\\]")] pub $name: Option<f64>,)*
            }
        )*

        /// All sections of numbers. A key that the file leaves out is `None`, whatever its default.
        #[derive(Debug, Clone, Copy, PartialEq, Default)]
        pub struct Sections {
            $($(#[$doc])* pub $section: $Section,)*
        }

        /// Every key of the numeric sections.
        pub const KEYS: &[Key] = &[
            $($(Key { path: concat!($prefix, ".", stringify!($name)), unit: $unit, need: $need, meaning: $meaning, min: $min },)*)*
        ];

        impl Sections {
            /// The place of a key, by its dotted path.
            pub fn slot(&mut self, path: &str) -> Option<&mut Option<f64>> {
                $($(if path == concat!($prefix, ".", stringify!($name)) {
                    return Some(&mut self.$section.$name);
                })*)*
                None
            }
        }
    };
}

use Need::{Always, Default as Assume, ForMotion, ForTurns, Optional};

/// Anything, negative too.
const ANY: f64 = f64::NEG_INFINITY;
/// Above zero: the least number that is.
const POSITIVE: f64 = f64::MIN_POSITIVE;

sections! {
    /// Sizes.
    geometry Geometry = "geometry" {
        frontal_area_m2: Always("lift, drag and moment refer to it"), "m2", POSITIVE, "Frontal area, reference area of all coefficients";
        length_m: Always("the moment coefficient refers to it"), "m", POSITIVE, "Overall length of the hull";
        diameter_m: Optional, "m", POSITIVE, "Largest diameter of the hull";
        wing_span_m: Optional, "m", POSITIVE, "Wing span";
        cb_aft_of_nose_m: Optional, "m", POSITIVE, "Centre of buoyancy aft of the nose";
    }
    /// Masses and displacement.
    mass Mass = "mass" {
        mass_kg: Always("the net weight is its difference to the displaced water"), "kg", POSITIVE, "Mass of the whole vehicle in air, ballast volume zero";
        displaced_volume_m3: Always("the net weight is the mass less what it displaces"), "m3", POSITIVE, "Displaced volume at the surface and the reference temperature, ballast volume zero";
        reference_density_kg_m3: Assume(1027.0), "kg/m3", POSITIVE, "Water density to which figures in kg of ballast refer";
        gravity_m_s2: Assume(9.81), "m/s2", POSITIVE, "Acceleration of gravity";
        moving_mass_kg: ForMotion("it turns the glider in pitch"), "kg", POSITIVE, "Mass that slides along the hull";
        moving_mass_height_m: ForMotion("it is the pendulum that holds the pitch"), "m", ANY, "Offset of the moving mass below the centre of buoyancy";
        offset_mass_kg: Assume(0.0), "kg", 0.0, "Part of the fixed mass off the centre of buoyancy";
        offset_mass_forward_m: Assume(0.0), "m", ANY, "Its position forward of the centre of buoyancy";
        offset_mass_below_m: Assume(0.0), "m", ANY, "Its position below the centre of buoyancy";
        cg_below_cb_m: Optional, "m", ANY, "Centre of gravity of the whole vehicle below the centre of buoyancy; replaces the offset mass";
        cg_forward_m: Optional, "m", ANY, "Centre of gravity of the whole vehicle forward of the centre of buoyancy, moving mass at zero; replaces the offset mass";
        cg_starboard_m: Optional, "m", ANY, "Centre of gravity of the whole vehicle to starboard, a static list";
    }
    /// Side force, roll and yaw.
    lateral Lateral = "lateral" {
        CY_beta_per_rad: ForTurns("the side force of a glider that slips"), "1/rad", ANY, "Side force coefficient per sideslip, negative when it pushes back";
        Cl_beta_per_rad: Assume(0.0), "1/rad", ANY, "Rolling moment coefficient per sideslip about the centre of buoyancy";
        CN_beta_per_rad: ForTurns("the yawing moment of a glider that slips"), "1/rad", ANY, "Yawing moment coefficient per sideslip about the centre of buoyancy, Munk couple included as a tank measures it, positive when it turns into the flow";
        CY_r: Assume(0.0), "1", ANY, "Side force coefficient per yaw rate";
        CN_r: ForTurns("what damps the yaw"), "1", ANY, "Yawing moment coefficient per yaw rate, negative when it damps";
        Cl_p: Assume(0.0), "1", ANY, "Rolling moment coefficient per roll rate, negative when it damps";
        Cl_r: Assume(0.0), "1", ANY, "Rolling moment coefficient per yaw rate";
        CN_p: Assume(0.0), "1", ANY, "Yawing moment coefficient per roll rate";
        m2_kg: ForTurns("the inertia to the side contains it"), "kg", 0.0, "Added mass along axis 2";
        roll_inertia_kg_m2: ForTurns("the inertia in roll"), "kg.m2", POSITIVE, "Moment of inertia in roll, added inertia included, moving mass left out";
        yaw_inertia_kg_m2: ForTurns("the inertia in yaw"), "kg.m2", POSITIVE, "Moment of inertia in yaw, added inertia included, moving mass left out";
        Y_rdot_kg_m: Assume(0.0), "kg.m", ANY, "Added mass that couples sway and yaw: momentum along axis 2 per yaw rate";
        Z_qdot_kg_m: Assume(0.0), "kg.m", ANY, "Added mass that couples heave and pitch: momentum along axis 3 per pitch rate";
    }
    /// What was measured on descents; what it leaves out is that of `lateral`.
    lateral_descent LateralDescent = "lateral.descent" {
        CY_beta_per_rad: Optional, "1/rad", ANY, "Side force coefficient per sideslip on descents";
        Cl_beta_per_rad: Optional, "1/rad", ANY, "Rolling moment coefficient per sideslip on descents";
        CN_beta_per_rad: Optional, "1/rad", ANY, "Yawing moment coefficient per sideslip on descents";
        CY_r: Optional, "1", ANY, "Side force coefficient per yaw rate on descents";
        CN_r: Optional, "1", ANY, "Yawing moment coefficient per yaw rate on descents";
        Cl_p: Optional, "1", ANY, "Rolling moment coefficient per roll rate on descents";
        Cl_r: Optional, "1", ANY, "Rolling moment coefficient per yaw rate on descents";
        CN_p: Optional, "1", ANY, "Yawing moment coefficient per roll rate on descents";
    }
    /// What was measured on ascents; what it leaves out is that of `lateral`.
    lateral_ascent LateralAscent = "lateral.ascent" {
        CY_beta_per_rad: Optional, "1/rad", ANY, "Side force coefficient per sideslip on ascents";
        Cl_beta_per_rad: Optional, "1/rad", ANY, "Rolling moment coefficient per sideslip on ascents";
        CN_beta_per_rad: Optional, "1/rad", ANY, "Yawing moment coefficient per sideslip on ascents";
        CY_r: Optional, "1", ANY, "Side force coefficient per yaw rate on ascents";
        CN_r: Optional, "1", ANY, "Yawing moment coefficient per yaw rate on ascents";
        Cl_p: Optional, "1", ANY, "Rolling moment coefficient per roll rate on ascents";
        Cl_r: Optional, "1", ANY, "Rolling moment coefficient per yaw rate on ascents";
        CN_p: Optional, "1", ANY, "Yawing moment coefficient per roll rate on ascents";
    }
    /// The rudder.
    rudder Rudder = "rudder" {
        CY_delta_per_rad: Assume(0.0), "1/rad", ANY, "Side force coefficient per rudder angle, negative at the tail";
        CN_delta_per_rad: Assume(0.0), "1/rad", ANY, "Yawing moment coefficient per rudder angle, positive: the bow turns to starboard";
        Cl_delta_per_rad: Assume(0.0), "1/rad", ANY, "Rolling moment coefficient per rudder angle";
        min_rad: Optional, "rad", ANY, "Largest angle to port, negative";
        max_rad: Optional, "rad", ANY, "Largest angle to starboard";
        rate_rad_s: Assume(0.1), "rad/s", POSITIVE, "Largest rate";
        power_W: Assume(0.0), "W", 0.0, "Power at the largest rate";
        offset_rad: Assume(0.0), "rad", ANY, "True angle less the one that is read";
    }
    /// The part of the moving mass that turns about the hull's axis.
    roll_mass RollMass = "roll_mass" {
        mass_kg: Assume(0.0), "kg", 0.0, "Its mass, contained in the moving mass";
        radius_m: Assume(0.0), "m", 0.0, "Distance of its centre from the hull's axis";
        min_rad: Optional, "rad", ANY, "Largest angle to port, negative";
        max_rad: Optional, "rad", ANY, "Largest angle to starboard";
        rate_rad_s: Assume(0.1), "rad/s", POSITIVE, "Largest rate";
        power_W: Assume(0.0), "W", 0.0, "Power at the largest rate";
        offset_rad: Assume(0.0), "rad", ANY, "True angle less the one that is read";
    }
    /// Water that moves with the hull.
    added_mass AddedMass = "added_mass" {
        m1_kg: ForMotion("the inertia along the hull contains it"), "kg", 0.0, "Added mass along axis 1, the glider's own mass left out";
        m3_kg: ForMotion("the inertia across the hull contains it"), "kg", 0.0, "Added mass along axis 3, the glider's own mass left out";
        pitch_inertia_kg_m2: ForMotion("the inertia in pitch"), "kg.m2", POSITIVE, "Moment of inertia in pitch, added inertia included, moving mass left out";
    }
    /// The glide polar.
    hydro Hydro = "hydro" {
        a_per_rad: Always("the lift slope"), "1/rad", ANY, "CL = CL0 + a alpha";
        b: Always("the drag at zero angle of attack"), "1", 0.0, "CD = b + c alpha^2";
        c_per_rad2: Always("the growth of drag with angle of attack"), "1/rad2", ANY, "CD = b + c alpha^2";
        d_per_rad: ForMotion("the pitching moment of the water"), "1/rad", ANY, "CM = CM0 + d alpha about the centre of buoyancy, Munk moment included";
        CL0: Assume(0.0), "1", ANY, "Lift coefficient at zero angle of attack";
        CM0: Assume(0.0), "1", ANY, "Moment coefficient at zero angle of attack";
        pitch_damping: Assume(0.0), "N.m.s", ANY, "Moment per pitch rate, negative when it damps";
        pitch_damping_quadratic: Assume(0.0), "N.m.s2", ANY, "Moment per pitch rate times its magnitude, negative when it damps";
        pitch_damping_CMq: Assume(0.0), "1", ANY, "Moment coefficient per pitch rate times length over speed, negative when it damps";
        pitch_damping_V2: Assume(0.0), "kg.s", ANY, "Moment per pitch rate and square of the speed, negative when it damps";
    }
    /// The polar measured on descents; what it leaves out is that of `hydro`.
    descent LegPolar = "hydro.descent" {
        a_per_rad: Optional, "1/rad", ANY, "Lift slope on descents";
        b: Optional, "1", 0.0, "b on descents";
        c_per_rad2: Optional, "1/rad2", ANY, "c on descents";
        d_per_rad: Optional, "1/rad", ANY, "d on descents";
    }
    /// The polar measured on ascents; what it leaves out is that of `hydro`.
    ascent AscentPolar = "hydro.ascent" {
        a_per_rad: Optional, "1/rad", ANY, "Lift slope on ascents";
        b: Optional, "1", 0.0, "b on ascents";
        c_per_rad2: Optional, "1/rad2", ANY, "c on ascents";
        d_per_rad: Optional, "1/rad", ANY, "d on ascents";
    }
    /// How the hull yields.
    hull Hull = "hull" {
        compressibility_per_Pa: Assume(0.0), "1/Pa", ANY, "Relative loss of volume per gauge pressure";
        thermal_expansion_per_K: Assume(0.0), "1/K", ANY, "Relative gain of volume per temperature";
        reference_temperature_C: Assume(15.0), "degC", ANY, "Temperature at which the displaced volume is stated";
    }
    /// The buoyancy engine.
    ballast Ballast = "ballast" {
        min_cc: ForMotion("the ballast volume stops there"), "cm3", ANY, "Smallest ballast volume";
        max_cc: ForMotion("the ballast volume stops there"), "cm3", ANY, "Largest ballast volume";
        rate_cc_s: ForMotion("the ballast volume changes no faster"), "cm3/s", POSITIVE, "Largest rate of change";
        nominal_kg: Assume(0.0), "kg", 0.0, "Ballast mass on board at ballast volume zero, contained in mass_kg";
        forward_m: Assume(0.0), "m", ANY, "Position of the ballast forward of the centre of buoyancy";
        below_m: Assume(0.0), "m", ANY, "Position of the ballast below the centre of buoyancy";
    }
    /// Travel of the moving mass.
    moving_mass MovingMass = "moving_mass" {
        min_m: ForMotion("the moving mass stops there"), "m", ANY, "Aftmost position";
        max_m: ForMotion("the moving mass stops there"), "m", ANY, "Foremost position";
        rate_m_s: ForMotion("the moving mass is no faster"), "m/s", POSITIVE, "Largest speed along the hull";
    }
    /// Battery and consumers.
    energy Energy = "energy" {
        battery_Wh: Optional, "W.h", POSITIVE, "Energy of the battery";
        battery_V: Optional, "V", POSITIVE, "Nominal voltage of the battery";
        hotel_W: Assume(0.0), "W", 0.0, "Power of everything that runs all the time";
        pump_J_per_cc: Assume(0.0), "J/cm3", 0.0, "Energy to pump out a volume at the surface";
        pump_J_per_dbar_cc: Assume(0.0), "J/(dbar.cm3)", 0.0, "Energy to pump out a volume per pressure; 0.01 is the ideal pump";
        pitch_move_J: Assume(0.0), "J", 0.0, "Energy of one move of the moving mass";
        surfacing_J: Assume(0.0), "J", 0.0, "Energy of one surfacing beyond the hotel power: fix and call";
        rudder_W: Assume(0.0), "W", 0.0, "Mean power of steering";
    }
}

/// The key of a dotted path.
pub fn key(path: &str) -> Option<&'static Key> {
    KEYS.iter().find(|key| key.path == path)
}
