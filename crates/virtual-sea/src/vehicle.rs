//! The glider: its true figures, drawn and trimmed for the ocean at hand, and the figures its owner believes in.
//!
//! Signs and reference areas are those of the tank: CL = a alpha, CD = b + c alpha^2, CM = d alpha (Munk's couple
//! included) on the frontal area, the moment also on the hull length and about the centre of buoyancy, nose up positive.

use crate::ocean::{GRAVITY_M_S2, Ocean, Water};
use crate::random::{Stream, between, sign};
use std::fmt::Write;

/// Density that the vehicle file states as its reference, kg/m3.
pub const REFERENCE_DENSITY_KG_M3: f64 = 1025.0;

/// Angle of attack up to which the coefficients' laws hold, rad: beyond every steady glide.
pub const ATTACHED_RAD: f64 = 0.35;

/// A kind of glider, each with its own sizes, engine and depth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hull {
    /// Coastal Slocum: 200 m, a fast piston of about 240 cc each way.
    Slocum200,
    /// Slocum with a slow oil pump of about 400 cc each way; dives as deep as the time of a dive allows, to 450 m.
    SlocumDeep,
    /// Seaglider-like: fat, slow pump, to 950 m; a log of 12 h holds only a few dives.
    Seaglider,
}

/// Everything that moves a glider in the vertical plane.
#[derive(Debug, Clone, PartialEq)]
pub struct Vehicle {
    /// Reference area of the coefficients, m2.
    pub frontal_area_m2: f64,
    /// Hull length, reference length of the pitching moment, m.
    pub length_m: f64,
    /// Whole vehicle in air, kg.
    pub mass_kg: f64,
    /// Displaced volume at the surface, reference temperature, ballast volume 0, m3.
    pub displaced_volume_m3: f64,
    /// The mass that slides along axis 1, kg; part of `mass_kg`.
    pub moving_mass_kg: f64,
    /// Its distance below the centre of buoyancy, m; all else is centred there.
    pub moving_mass_height_m: f64,
    /// Added mass along axis 1, kg.
    pub added_mass_1_kg: f64,
    /// Added mass along axis 3, kg.
    pub added_mass_3_kg: f64,
    /// Pitch inertia without the moving mass, added inertia included, kg m2.
    pub pitch_inertia_kg_m2: f64,
    /// Lift slope per rad.
    pub a_per_rad: f64,
    /// Drag coefficient at no angle of attack.
    pub b: f64,
    /// Growth of the drag coefficient with the squared angle of attack, per rad2.
    pub c_per_rad2: f64,
    /// Moment slope per rad, negative = stable.
    pub d_per_rad: f64,
    /// Pitching moment against the pitch rate, N m s.
    pub pitch_damping_n_m_s: f64,
    /// Relative loss of hull volume per pressure, 1/Pa.
    pub compressibility_per_pa: f64,
    /// Relative gain of hull volume per temperature, 1/K.
    pub thermal_expansion_per_k: f64,
    /// Temperature at which `displaced_volume_m3` holds, degrees Celsius.
    pub reference_temperature_c: f64,
    /// Smallest ballast volume, cc.
    pub ballast_min_cc: f64,
    /// Largest ballast volume, cc.
    pub ballast_max_cc: f64,
    /// Speed of the buoyancy engine drawing in, cc/s.
    pub ballast_in_cc_s: f64,
    /// Speed of the buoyancy engine pumping out, cc/s.
    pub ballast_out_cc_s: f64,
    /// Travel of the moving mass either side of the centre of buoyancy, m.
    pub moving_mass_travel_m: f64,
    /// Speed of the moving mass, m/s.
    pub moving_mass_rate_m_s: f64,
    /// Depth the vehicle may dive to, m.
    pub depth_limit_m: f64,
}

impl Hull {
    /// Draws a vehicle of this kind and ballasts it for the ocean: neutral in mid-water but for a seventh of the
    /// engine's capacity, as ballasting comes out.
    pub fn draw(self, random: &mut Stream, ocean: &Ocean) -> Vehicle {
        let mass_kg = rounded(between(random, 51.0, 54.0), 3);
        let length_m = rounded(between(random, 1.5, 1.8), 3);
        let (area, a, b, c) = match self {
            Hull::Seaglider => ((0.069, 0.072), (8.0, 11.0), (0.18, 0.26), (2.0, 4.0)),
            _ => ((0.0356, 0.0380), (15.0, 21.0), (0.30, 0.50), (6.0, 10.0)),
        };
        let (engine_cc, in_cc_s, out_cc_s, depth_limit_m) = match self {
            Hull::Slocum200 => ((225.0, 260.0), (18.0, 30.0), (10.0, 18.0), 195.0),
            Hull::SlocumDeep => ((360.0, 430.0), (6.0, 10.0), (3.0, 5.0), 450.0),
            Hull::Seaglider => ((320.0, 400.0), (3.0, 5.0), (1.5, 2.5), 950.0),
        };
        let engine_cc = between(random, engine_cc.0, engine_cc.1).round();
        let mut vehicle = Vehicle {
            frontal_area_m2: rounded(between(random, area.0, area.1), 5),
            length_m,
            mass_kg,
            displaced_volume_m3: 0.0,
            moving_mass_kg: rounded(between(random, 8.5, 9.5), 3),
            moving_mass_height_m: rounded(between(random, 0.045, 0.060), 4),
            added_mass_1_kg: rounded(mass_kg * between(random, 0.04, 0.10), 2),
            added_mass_3_kg: rounded(mass_kg * between(random, 0.92, 1.15), 1),
            pitch_inertia_kg_m2: rounded(between(random, 15.0, 22.0), 1),
            a_per_rad: between(random, a.0, a.1),
            b: between(random, b.0, b.1),
            c_per_rad2: between(random, c.0, c.1),
            d_per_rad: between(random, -1.4, -0.6),
            pitch_damping_n_m_s: rounded(between(random, 35.0, 60.0), 1),
            compressibility_per_pa: rounded(between(random, 3.6e-10, 4.4e-10), 12),
            thermal_expansion_per_k: rounded(between(random, 5.0e-5, 8.0e-5), 7),
            reference_temperature_c: 15.0,
            ballast_min_cc: -engine_cc,
            ballast_max_cc: engine_cc,
            ballast_in_cc_s: rounded(between(random, in_cc_s.0, in_cc_s.1), 1),
            ballast_out_cc_s: rounded(between(random, out_cc_s.0, out_cc_s.1), 1),
            moving_mass_travel_m: 0.08,
            moving_mass_rate_m_s: rounded(between(random, 0.001, 0.003), 4),
            depth_limit_m,
        };
        let trim_error_kg = 1e-3 * engine_cc * between(random, -0.15, 0.15);
        vehicle.displaced_volume_m3 = rounded(vehicle.neutral_volume_m3(ocean, trim_error_kg), 8);
        vehicle
    }
}

impl Vehicle {
    /// What the owner's file says: masses, volume and geometry as they are, hydrodynamic coefficients off by 10 to 20 %.
    pub fn believed(&self, random: &mut Stream) -> Vehicle {
        let mut off = |true_value: f64| {
            let error = sign(random) * between(random, 0.10, 0.20);
            rounded(true_value * (1.0 + error), 3)
        };
        Vehicle {
            a_per_rad: off(self.a_per_rad),
            b: off(self.b),
            c_per_rad2: off(self.c_per_rad2),
            d_per_rad: off(self.d_per_rad),
            ..self.clone()
        }
    }

    /// Hull volume under gauge pressure and temperature, m3, ballast volume 0.
    pub fn hull_volume_m3(&self, pressure_pa: f64, temperature_c: f64) -> f64 {
        let pressed = self.compressibility_per_pa * pressure_pa;
        let warmed = self.thermal_expansion_per_k * (temperature_c - self.reference_temperature_c);
        self.displaced_volume_m3 * (1.0 - pressed + warmed)
    }

    /// Angle of attack (rad) and speed (m/s) of the steady glide at a pitch angle, with a net mass (+ = heavy); `None`
    /// where pitch and net mass do not belong together or the pitch is too flat to glide.
    pub fn steady_glide(&self, net_mass_kg: f64, pitch_rad: f64, density_kg_m3: f64) -> Option<(f64, f64)> {
        if net_mass_kg * pitch_rad >= 0.0 {
            return None;
        }
        let mut angle = 0.0_f64;
        for _ in 0..60 {
            let path = pitch_rad.abs() + angle;
            let drag = self.b + self.c_per_rad2 * angle * angle;
            angle = 0.5 * (angle + drag / (self.a_per_rad * path.tan()));
            if !angle.is_finite() || angle > 0.3 {
                return None;
            }
        }
        let drag = self.b + self.c_per_rad2 * angle * angle;
        let along = GRAVITY_M_S2 * net_mass_kg.abs() * (pitch_rad.abs() + angle).sin();
        let speed = (2.0 * along / (density_kg_m3 * self.frontal_area_m2 * drag)).sqrt();
        Some((net_mass_kg.signum() * angle, speed))
    }

    /// Position of the moving mass that holds a steady glide, m: the moment balance about the centre of buoyancy.
    pub fn moving_mass_for(&self, pitch_rad: f64, angle_rad: f64, speed_m_s: f64, density_kg_m3: f64) -> f64 {
        let lever = 0.5 * density_kg_m3 * speed_m_s * speed_m_s * self.frontal_area_m2 * self.length_m;
        let moment = lever * self.d_per_rad * angle_rad;
        -self.moving_mass_height_m * pitch_rad.tan() + moment / (self.moving_mass_kg * GRAVITY_M_S2 * pitch_rad.cos())
    }

    /// Ballast volume that makes the vehicle neutral in mid-water, cc.
    pub fn neutral_ballast_cc(&self, ocean: &Ocean) -> f64 {
        let (water, pressure_pa) = self.mid_water(ocean);
        1e6 * (self.mass_kg / water.density_kg_m3 - self.hull_volume_m3(pressure_pa, water.temperature_c))
    }

    fn neutral_volume_m3(&self, ocean: &Ocean, heavy_kg: f64) -> f64 {
        let (water, pressure_pa) = self.mid_water(ocean);
        let unit = Vehicle { displaced_volume_m3: 1.0, ..self.clone() };
        let relative = unit.hull_volume_m3(pressure_pa, water.temperature_c);
        (self.mass_kg - heavy_kg) / (water.density_kg_m3 * relative)
    }

    /// Water and pressure in the middle of the usual range of dives: most of the thermocline above, little below.
    fn mid_water(&self, ocean: &Ocean) -> (Water, f64) {
        let depth_m = 0.5 * self.depth_limit_m.min(200.0);
        (ocean.water(depth_m, 0.0), ocean.pressure_pa(depth_m))
    }

    /// The vehicle file, as a glider's owner would have it.
    pub fn to_toml(&self, name: &str) -> String {
        let mut out = String::new();
        let mut table = |title: &str, rows: &[(&str, f64)]| {
            let _ = writeln!(out, "\n[{title}]");
            for (key, value) in rows {
                let _ = writeln!(out, "{key} = {value:?}");
            }
        };
        table("geometry", &[("frontal_area_m2", self.frontal_area_m2), ("length_m", self.length_m)]);
        table(
            "mass",
            &[
                ("mass_kg", self.mass_kg),
                ("displaced_volume_m3", self.displaced_volume_m3),
                ("reference_density_kg_m3", REFERENCE_DENSITY_KG_M3),
                ("moving_mass_kg", self.moving_mass_kg),
                ("moving_mass_height_m", self.moving_mass_height_m),
            ],
        );
        table(
            "added_mass",
            &[
                ("m1_kg", self.added_mass_1_kg),
                ("m3_kg", self.added_mass_3_kg),
                ("pitch_inertia_kg_m2", self.pitch_inertia_kg_m2),
            ],
        );
        table(
            "hydro",
            &[
                ("a_per_rad", self.a_per_rad),
                ("b", self.b),
                ("c_per_rad2", self.c_per_rad2),
                ("d_per_rad", self.d_per_rad),
                ("pitch_damping", -self.pitch_damping_n_m_s),
            ],
        );
        table(
            "hull",
            &[
                ("compressibility_per_Pa", self.compressibility_per_pa),
                ("thermal_expansion_per_K", self.thermal_expansion_per_k),
                ("reference_temperature_C", self.reference_temperature_c),
            ],
        );
        table(
            "ballast",
            &[("min_cc", self.ballast_min_cc), ("max_cc", self.ballast_max_cc), ("rate_cc_s", self.ballast_in_cc_s)],
        );
        table(
            "moving_mass",
            &[
                ("min_m", -self.moving_mass_travel_m),
                ("max_m", self.moving_mass_travel_m),
                ("rate_m_s", self.moving_mass_rate_m_s),
            ],
        );
        format!(
            "name = \"{name}\"\nsource = \"weighed and measured ashore; hydrodynamic coefficients estimated, 10 to 20 % uncertain\"\n{out}"
        )
    }
}

/// As many decimals as an owner would write down.
fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10.0_f64.powi(decimals);
    (value * scale).round() / scale
}

/// The angle that the moment goes by: the angle of attack itself while the flow is attached; beyond, its sine, so that
/// the tail turns the glider into the flow from wherever it comes.
pub fn attached_angle(angle_rad: f64) -> f64 {
    if angle_rad.abs() <= ATTACHED_RAD {
        return angle_rad;
    }
    ATTACHED_RAD * angle_rad.sin() / ATTACHED_RAD.sin()
}
