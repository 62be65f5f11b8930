//! The numbers of the equations of motion that the vertical plane does not need.

use glidepolar_dynamics::Parameters;
use glidepolar_number::{Number, quantities};

quantities! {
    /// Lateral coefficients, inertias, rudder and roll mass. Coefficients are about the centre of buoyancy, on frontal
    /// area and length, in flow axes; rates are made dimensionless by length over speed ([`RateLaw::Speed`]).
    Lateral, N_LATERAL, LATERAL {
        // side force, roll and yaw on descents
        CY_beta_per_rad: "1/rad" = 0.0 in -1000.0 .. 1000.0, "Side force coefficient per sideslip on descents";
        Cl_beta_per_rad: "1/rad" = 0.0 in -1000.0 .. 1000.0, "Rolling moment coefficient per sideslip on descents";
        CN_beta_per_rad: "1/rad" = 0.0 in -1000.0 .. 1000.0, "Yawing moment coefficient per sideslip on descents, Munk couple included as a tank measures it";
        CY_r: "1" = 0.0 in -1e4 .. 1e4, "Side force coefficient per yaw rate on descents";
        CN_r: "1" = 0.0 in -1e4 .. 1e4, "Yawing moment coefficient per yaw rate on descents, negative when it damps";
        Cl_p: "1" = 0.0 in -1e4 .. 1e4, "Rolling moment coefficient per roll rate on descents, negative when it damps";
        Cl_r: "1" = 0.0 in -1e4 .. 1e4, "Rolling moment coefficient per yaw rate on descents";
        CN_p: "1" = 0.0 in -1e4 .. 1e4, "Yawing moment coefficient per roll rate on descents";
        // the same on ascents
        ascent_CY_beta_per_rad: "1/rad" = 0.0 in -1000.0 .. 1000.0, "Side force coefficient per sideslip on ascents";
        ascent_Cl_beta_per_rad: "1/rad" = 0.0 in -1000.0 .. 1000.0, "Rolling moment coefficient per sideslip on ascents";
        ascent_CN_beta_per_rad: "1/rad" = 0.0 in -1000.0 .. 1000.0, "Yawing moment coefficient per sideslip on ascents, Munk couple included";
        ascent_CY_r: "1" = 0.0 in -1e4 .. 1e4, "Side force coefficient per yaw rate on ascents";
        ascent_CN_r: "1" = 0.0 in -1e4 .. 1e4, "Yawing moment coefficient per yaw rate on ascents";
        ascent_Cl_p: "1" = 0.0 in -1e4 .. 1e4, "Rolling moment coefficient per roll rate on ascents";
        ascent_Cl_r: "1" = 0.0 in -1e4 .. 1e4, "Rolling moment coefficient per yaw rate on ascents";
        ascent_CN_p: "1" = 0.0 in -1e4 .. 1e4, "Yawing moment coefficient per roll rate on ascents";
        // inertia
        added_mass_2_kg: "kg" = 70.0 in 0.0 .. 1e6, "Added mass along axis 2";
        roll_inertia_kg_m2: "kg.m2" = 0.5 in 1e-9 .. 1e7, "Moment of inertia in roll of hull and added water about the centre of buoyancy, without the moving mass";
        yaw_inertia_kg_m2: "kg.m2" = 12.0 in 1e-6 .. 1e7, "Moment of inertia in yaw of hull and added water about the centre of buoyancy, without the moving mass";
        added_Y_rdot_kg_m: "kg.m" = 0.0 in -1e6 .. 1e6, "Added mass that couples sway and yaw: momentum along axis 2 per yaw rate";
        moving_inertia_1_kg_m2: "kg.m2" = 0.0 in 0.0 .. 1e6, "Moment of inertia of the moving mass about its own centre, axis 1";
        moving_inertia_2_kg_m2: "kg.m2" = 0.0 in 0.0 .. 1e6, "Moment of inertia of the moving mass about its own centre, axis 2 at roll mass angle zero; contained in the pitch inertia";
        moving_inertia_3_kg_m2: "kg.m2" = 0.0 in 0.0 .. 1e6, "Moment of inertia of the moving mass about its own centre, axis 3 at roll mass angle zero";
        starboard_moment_kg_m: "kg.m" = 0.0 in -1e4 .. 1e4, "First moment of all fixed masses to starboard, a static list";
        // rudder
        rudder_CY_per_rad: "1/rad" = 0.0 in -1000.0 .. 1000.0, "Side force coefficient per rudder angle";
        rudder_CN_per_rad: "1/rad" = 0.0 in -1000.0 .. 1000.0, "Yawing moment coefficient per rudder angle";
        rudder_Cl_per_rad: "1/rad" = 0.0 in -1000.0 .. 1000.0, "Rolling moment coefficient per rudder angle";
        rudder_min_rad: "rad" = 0.0 in -3.2 .. 3.2, "Largest rudder angle to port, negative";
        rudder_max_rad: "rad" = 0.0 in -3.2 .. 3.2, "Largest rudder angle to starboard";
        rudder_rate_rad_s: "rad/s" = 0.1 in 1e-9 .. 100.0, "Largest rate of the rudder";
        rudder_power_W: "W" = 0.0 in 0.0 .. 1e6, "Power of the rudder at its largest rate";
        rudder_offset_rad: "rad" = 0.0 in -3.2 .. 3.2, "True rudder angle less the one that is read";
        // roll mass
        roll_mass_kg: "kg" = 0.0 in 0.0 .. 1e6, "Mass that turns about the hull's axis, part of the moving mass";
        roll_mass_radius_m: "m" = 0.0 in 0.0 .. 100.0, "Distance of its centre from the hull's axis";
        roll_mass_min_rad: "rad" = 0.0 in -6.3 .. 6.3, "Largest angle of the roll mass to port, negative";
        roll_mass_max_rad: "rad" = 0.0 in -6.3 .. 6.3, "Largest angle of the roll mass to starboard";
        roll_mass_rate_rad_s: "rad/s" = 0.1 in 1e-9 .. 100.0, "Largest rate of the roll mass";
        roll_mass_power_W: "W" = 0.0 in 0.0 .. 1e6, "Power of the roll mass at its largest rate";
        roll_mass_offset_rad: "rad" = 0.0 in -3.2 .. 3.2, "True angle of the roll mass less the one that is read";
        // heading control
        heading_rudder_gain: "1" = 0.0 in -1e3 .. 1e3, "Rudder angle per error of the heading (steering 1)";
        heading_roll_gain_descent: "1" = 0.0 in -1e3 .. 1e3, "Roll mass angle per error of the heading on descents (steering 2)";
        heading_roll_gain_ascent: "1" = 0.0 in -1e3 .. 1e3, "Roll mass angle per error of the heading on ascents (steering 2)";
        heading_lead_s: "s" = 0.0 in 0.0 .. 1e4, "Time by which heading control looks ahead at the present turn rate (steering 1 and 2)";
        heading_dead_band_rad: "rad" = 0.0 in 0.0 .. 3.2, "Error of the heading up to which heading control rests (steering 1 and 2)";
    }
}

impl<T: Number> Lateral<T> {
    /// Whether there is a figure of what rudder or roll mass draw as they move.
    pub fn counts_steering(&self) -> bool {
        self.rudder_power_W.value() > 0.0 || self.roll_mass_power_W.value() > 0.0
    }
}

/// How moments and forces by a rate grow with speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RateLaw {
    /// With the speed: `q A l C (rate l / V)`.
    #[default]
    Speed,
    /// With its square: `q A l C rate`, `C` in seconds (Zhang et al. 2013).
    SpeedSquared,
}

/// All numbers of a glider in six degrees of freedom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body<T> {
    /// Those that the vertical plane has, too.
    pub plane: Parameters<T>,
    /// The others.
    pub lateral: Lateral<T>,
    /// How the lateral rates work.
    pub rate_law: RateLaw,
}

impl<T: Number> Body<T> {
    /// The same numbers of another kind.
    pub fn map<U: Number>(&self, f: impl Fn(T) -> U) -> Body<U> {
        Body { plane: self.plane.map(&f), lateral: self.lateral.map(&f), rate_law: self.rate_law }
    }
}
