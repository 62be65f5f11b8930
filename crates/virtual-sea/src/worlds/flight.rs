//! A glider as a point mass on its path through water that moves.
//!
//! With pitch `theta` as controlled, path `xi = alpha - theta` (down positive), net mass `m0` and pressed area `q A`:
//!
//! ```text
//! across:  q A a alpha = m0 g cos xi
//!          with heave:  (m + m3) dalpha/dt = (m + m1) dtheta/dt + (m0 g cos xi - q A a alpha) / V
//! along:   (m + m1) dV/dt = m0 g sin xi - q A (b + c alpha^2) - (m + m1) cos xi du/dt
//! depth:   dz/dt = V sin xi + w
//! ```
//!
//! With heave a path that turns needs lift (Kirchhoff: `(m + m3) dv3/dt = (m + m1) v1 dtheta/dt + F3`, with `v3 = V alpha`), so it
//! follows the pitch late by `(m + m1) / (rho V A a / 2)`; without, it follows at once.
//!
//! `u` is the water's horizontal velocity along the heading, met where the glider is: parallel flow does not accelerate
//! by itself, so all of `du/dt` is what the glider lags behind. `w` is the water's vertical velocity, which lasts much
//! longer than the glider takes to follow it.

use super::weight_n;
use crate::effects::{Flow, Hidden, Memory};
use crate::hidden::Instant;
use crate::ocean::{GRAVITY_M_S2, Water, density_eos80};
use crate::random::{Stream, between, chance, normal, sign};
use crate::vehicle::Vehicle;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Step of the integration, s.
pub const STEP_S: f64 = 0.5;

/// Vertical velocity from which the number of dives is drawn, m/s.
const VERTICAL_M_S: f64 = 0.17;
/// Angle over which the slope of the lift is taken, rad.
const SLOPE_OVER_RAD: f64 = 1e-4;
/// Length of the hull, m.
const LENGTH_M: f64 = 1.8;
/// Temperature at which the volume of the file holds, degrees Celsius.
const REFERENCE_C: f64 = 15.0;

/// How much of the motion is unsteady.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// Forces balance at every moment.
    QuasiSteady,
    /// Speed takes its time.
    Surge,
    /// Speed and angle of attack do.
    SurgeAndHeave,
}

/// The water.
#[derive(Debug, Clone)]
pub struct Sea {
    surface_c: f64,
    fall_k: f64,
    surface_psu: f64,
    rise_psu: f64,
    thermocline_m: f64,
    /// Half the thickness of the thermocline, m.
    pub thickness_m: f64,
    /// Standard deviation of the slow vertical velocity, m/s, and its correlation time, s.
    pub wander_m_s: f64,
    /// See `wander_m_s`.
    pub wander_s: f64,
    /// Rms vertical velocity of the internal waves, m/s.
    pub waves_m_s: f64,
    waves: Vec<(f64, f64, f64)>,
    depth_m: f64,
    /// Pressure at each metre of the column at rest, dbar.
    pressure_dbar: Vec<f64>,
    /// Shear of the horizontal current.
    pub shear: Option<Shear>,
}

/// A layer across which the current changes.
#[derive(Debug, Clone, Copy)]
pub struct Shear {
    /// Half of the change, m/s.
    pub half_jump_m_s: f64,
    /// Half the thickness of the layer, m.
    pub thickness_m: f64,
    at_m: f64,
    direction_rad: f64,
}

impl Shear {
    /// The velocity of the current at a depth, to the east and to the north \[m/s\].
    pub fn velocity_m_s(&self, depth_m: f64) -> [f64; 2] {
        let (east, north) = self.direction_rad.sin_cos();
        let along = self.half_jump_m_s * ((depth_m - self.at_m) / self.thickness_m).tanh();
        [along * east, along * north]
    }
}

impl Sea {
    /// Draws the water above `bottom_m`.
    pub fn draw(random: &mut Stream, bottom_m: f64) -> Sea {
        let mixed = chance(random, 0.15);
        let waves_m_s = if chance(random, 0.6) { between(random, 0.001, 0.006) } else { 0.0 };
        let waves = (0..5)
            .map(|_| {
                (600.0 * 30f64.powf(between(random, 0.0, 1.0)), between(random, 0.0, TAU), between(random, 0.5, 2.0))
            })
            .collect();
        let thermocline_m = bottom_m.min(200.0) * between(random, 0.15, 0.6);
        let shear = chance(random, 0.4).then(|| Shear {
            half_jump_m_s: 0.5 * between(random, 0.02, 0.25) * sign(random),
            thickness_m: (bottom_m.min(300.0) * between(random, 0.08, 0.3)).max(10.0),
            at_m: bottom_m.min(300.0) * between(random, 0.2, 0.7),
            direction_rad: between(random, 0.0, TAU),
        });
        let mut sea = Sea {
            surface_c: between(random, 8.0, 24.0),
            fall_k: if mixed { 0.0 } else { between(random, 1.0, 12.0) },
            surface_psu: between(random, 30.0, 36.0),
            rise_psu: if mixed { 0.0 } else { between(random, 0.0, 1.5) },
            thermocline_m,
            // From some metres to all of the upper column.
            thickness_m: 2.0 * (0.5 * thermocline_m).max(2.0).powf(between(random, 0.0, 1.0)),
            wander_m_s: between(random, 0.001, 0.007),
            wander_s: 120.0 * 20f64.powf(between(random, 0.0, 1.0)),
            waves_m_s,
            waves,
            depth_m: bottom_m,
            pressure_dbar: Vec::new(),
            shear,
        };
        // What a pressure sensor reads is the weight of the water above: with a mean density it would be off by half a per
        // cent, and the vertical velocity made of it by as much.
        let mut pressure_dbar = 0.0;
        for metre in 0..(bottom_m + 50.0) as usize {
            sea.pressure_dbar.push(pressure_dbar);
            let (c, psu) = sea.temperature_and_salinity(metre as f64 + 0.5);
            pressure_dbar += density_eos80(psu, c, pressure_dbar) * GRAVITY_M_S2 * 1e-4;
        }
        sea
    }

    fn temperature_and_salinity(&self, depth_m: f64) -> (f64, f64) {
        let deep = 0.5 * (1.0 + ((depth_m - self.thermocline_m) / self.thickness_m).tanh());
        (self.surface_c - self.fall_k * deep, self.surface_psu + self.rise_psu * deep)
    }

    /// The water at a depth, of water that was moved there from `heave_m` above.
    fn water(&self, depth_m: f64, heave_m: f64) -> Water {
        let (temperature_c, salinity_psu) = self.temperature_and_salinity(depth_m - heave_m);
        let density_kg_m3 = density_eos80(salinity_psu, temperature_c, self.pressure_dbar(depth_m));
        Water { temperature_c, salinity_psu, density_kg_m3 }
    }

    fn pressure_dbar(&self, depth_m: f64) -> f64 {
        let place = depth_m.clamp(0.0, (self.pressure_dbar.len() - 2) as f64);
        let above = self.pressure_dbar[place as usize];
        above + (self.pressure_dbar[place as usize + 1] - above) * place.fract()
    }

    /// Vertical velocity (down positive) and displacement of the internal waves.
    fn heave(&self, depth_m: f64, time_s: f64) -> (f64, f64) {
        let mut moved = (0.0, 0.0);
        for (period_s, phase, mode) in &self.waves {
            let size = self.waves_m_s * (2.0 / self.waves.len() as f64).sqrt();
            // Nothing at the surface; the first to the second mode over one and a half times the dive.
            let shape = 1.4 * (mode * std::f64::consts::PI * depth_m / (1.5 * self.depth_m)).sin();
            let angle = TAU * time_s / period_s + phase;
            moved.0 += size * shape * angle.cos();
            moved.1 += size * shape * period_s / TAU * angle.sin();
        }
        moved
    }

    /// Change with depth of the current along a heading, 1/s.
    fn shear_1_s(&self, depth_m: f64, heading_rad: f64) -> f64 {
        self.shear.map_or(0.0, |shear| {
            let cosh = ((depth_m - shear.at_m) / shear.thickness_m).cosh();
            shear.half_jump_m_s / (shear.thickness_m * cosh * cosh) * (heading_rad - shear.direction_rad).cos()
        })
    }
}

/// Lift slope, drag at no angle of attack, its growth with the squared angle; on the frontal area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polar {
    /// Lift slope, per rad.
    pub a: f64,
    /// Drag coefficient at no angle of attack.
    pub b: f64,
    /// Its growth with the squared angle of attack, per rad2.
    pub c: f64,
}

/// The glider.
#[derive(Debug, Clone)]
pub struct DrawnGlider {
    area_m2: f64,
    mass_kg: f64,
    volume_m3: f64,
    added_kg: [f64; 2],
    /// Polar of descents.
    pub descent: Polar,
    /// Polar of ascents.
    pub ascent: Polar,
    compressibility_per_pa: f64,
    expansion_per_k: f64,
    engine_cc: f64,
    rate_cc_s: f64,
}

impl DrawnGlider {
    /// Draws a glider and ballasts it for the water in the middle of the dive.
    pub fn draw(random: &mut Stream, sea: &Sea) -> DrawnGlider {
        let fat = chance(random, 0.4);
        let mut of = |thin: (f64, f64), fat_one: (f64, f64)| {
            let (low, high) = if fat { fat_one } else { thin };
            between(random, low, high)
        };
        let area_m2 = of((0.033, 0.040), (0.065, 0.075));
        let descent =
            Polar { a: of((5.0, 21.0), (7.0, 12.0)), b: of((0.2, 0.5), (0.15, 0.3)), c: of((3.0, 12.0), (2.0, 6.0)) };
        let engine_cc = of((220.0, 450.0), (300.0, 420.0));
        let rate_cc_s = of((5.0, 25.0), (2.0, 8.0));
        let mass_kg = between(random, 50.0, 65.0);
        let mut ratio = |share: f64| 1.0 + share * between(random, -1.0, 1.0);
        let apart = Polar { a: descent.a * ratio(0.2), b: descent.b * ratio(0.3), c: descent.c * ratio(0.2) };
        let ascent = if chance(random, 0.3) { apart } else { descent };
        let (compressibility_per_pa, expansion_per_k) = (between(random, 3e-10, 6e-10), between(random, 3e-5, 9e-5));
        let middle_m = 0.4 * sea.depth_m;
        let Water { temperature_c: c, density_kg_m3: density, .. } = sea.water(middle_m, 0.0);
        let stretched =
            1.0 - compressibility_per_pa * sea.pressure_dbar(middle_m) * 1e4 + expansion_per_k * (c - REFERENCE_C);
        let trim_kg = between(random, -0.02, 0.02);
        let added_kg = [mass_kg * between(random, 0.04, 0.1), mass_kg * between(random, 0.9, 1.2)];
        DrawnGlider {
            area_m2,
            mass_kg,
            volume_m3: (mass_kg + trim_kg) / density / stretched,
            added_kg,
            descent,
            ascent,
            compressibility_per_pa,
            expansion_per_k,
            engine_cc,
            rate_cc_s,
        }
    }

    /// The glider with the polar of one leg, as the effects see it. Its attitude is imposed: what only moves the pitch is 0.
    pub fn as_vehicle(&self, polar: &Polar) -> Vehicle {
        Vehicle {
            frontal_area_m2: self.area_m2,
            length_m: LENGTH_M,
            mass_kg: self.mass_kg,
            displaced_volume_m3: self.volume_m3,
            moving_mass_kg: 0.0,
            moving_mass_height_m: 0.0,
            added_mass_1_kg: self.added_kg[0],
            added_mass_3_kg: self.added_kg[1],
            pitch_inertia_kg_m2: 0.0,
            a_per_rad: polar.a,
            b: polar.b,
            c_per_rad2: polar.c,
            d_per_rad: 0.0,
            pitch_damping_n_m_s: 0.0,
            compressibility_per_pa: self.compressibility_per_pa,
            thermal_expansion_per_k: self.expansion_per_k,
            reference_temperature_c: REFERENCE_C,
            ballast_min_cc: -self.engine_cc,
            ballast_max_cc: self.engine_cc,
            ballast_in_cc_s: self.rate_cc_s,
            ballast_out_cc_s: self.rate_cc_s,
            moving_mass_travel_m: 0.0,
            moving_mass_rate_m_s: 0.0,
            depth_limit_m: f64::INFINITY,
        }
    }

    /// Shallowest pitch that is flown: an angle of attack of 0.6 of that of the best glide. Beyond that of the best glide a
    /// slower path is a steeper one, and no pilot goes there.
    fn shallowest_rad(&self) -> f64 {
        let of = |polar: &Polar| {
            let alpha = 0.6 * (polar.b / polar.c).sqrt();
            ((polar.b + polar.c * alpha * alpha) / (polar.a * alpha)).atan() - alpha
        };
        of(&self.descent).max(of(&self.ascent)).max(0.2)
    }

    /// The vehicle file: all as it is, but for the coefficients, which are off by one factor for both legs.
    pub fn file(&self, random: &mut Stream) -> String {
        let mut off = |share: f64| 1.0 + if chance(random, 0.6) { share * between(random, -1.0, 1.0) } else { 0.0 };
        let (a, b, c) = (off(0.2), off(0.2), off(0.2));
        let mut out = "name = \"a glider of its own world\"\nsource = \"virtual\"\n".to_owned();
        let mut table = |title: &str, rows: &[(&str, f64)]| {
            let _ = writeln!(out, "\n[{title}]");
            rows.iter().for_each(|(key, value)| {
                let _ = writeln!(out, "{key} = {value:?}");
            });
        };
        table("geometry", &[("frontal_area_m2", self.area_m2), ("length_m", LENGTH_M)]);
        table(
            "mass",
            &[
                ("mass_kg", self.mass_kg),
                ("displaced_volume_m3", self.volume_m3),
                ("reference_density_kg_m3", 1025.0),
                ("moving_mass_kg", 9.0),
                ("moving_mass_height_m", 0.05),
            ],
        );
        table("added_mass", &[("m1_kg", self.added_kg[0]), ("m3_kg", self.added_kg[1]), ("pitch_inertia_kg_m2", 12.0)]);
        let polar = |polar: Polar| {
            [("a_per_rad", polar.a * a), ("b", polar.b * b), ("c_per_rad2", polar.c * c), ("d_per_rad", -0.8)]
        };
        table("hydro", &polar(self.descent));
        if self.ascent != self.descent {
            table("hydro.ascent", &polar(self.ascent)[..3]);
        }
        table(
            "hull",
            &[
                ("compressibility_per_Pa", self.compressibility_per_pa),
                ("thermal_expansion_per_K", self.expansion_per_k),
                ("reference_temperature_C", REFERENCE_C),
            ],
        );
        table("ballast", &[("min_cc", -self.engine_cc), ("max_cc", self.engine_cc), ("rate_cc_s", self.rate_cc_s)]);
        table("moving_mass", &[("min_m", -0.08), ("max_m", 0.08), ("rate_m_s", 0.002)]);
        out
    }
}

/// How it is flown.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Depth of the dives, m.
    pub bottom_m: f64,
    /// Pitch and ballast of each leg, descents first.
    pub legs: Vec<(f64, f64)>,
    headings_rad: Vec<f64>,
    /// Amplitude of the pitch's hunting, rad, and its period, s.
    pub hunting_rad: f64,
    /// See `hunting_rad`.
    pub hunting_s: f64,
    wander_rad: f64,
    list_rad: f64,
}

impl Plan {
    /// How long it takes at a vertical velocity of 0.17 m/s, hours.
    pub fn hours(&self) -> f64 {
        self.legs.len() as f64 * self.bottom_m / VERTICAL_M_S / 3600.0
    }

    /// Draws a plan of some eight to sixteen hours.
    pub fn draw(random: &mut Stream, glider: &DrawnGlider, bottom_m: f64) -> Plan {
        let dives = ((between(random, 7.0, 14.0) * 3600.0 / (2.0 * bottom_m / VERTICAL_M_S)) as usize).clamp(4, 60);
        // Either one glide for all, or each leg its own.
        let varied = chance(random, 0.6);
        let mut glide = || (between(random, 12.0, 40.0).to_radians(), between(random, 0.5, 0.95) * glider.engine_cc);
        let same = [glide(), glide()];
        let least_rad = glider.shallowest_rad();
        let mut legs = Vec::new();
        for leg in 0..2 * dives {
            let drawn = glide();
            let (pitch_rad, ballast_cc) = if varied { drawn } else { same[leg % 2] };
            let up = if leg % 2 == 0 { -1.0 } else { 1.0 };
            legs.push((up * pitch_rad.max(least_rad), up * ballast_cc));
        }
        let mut heading_rad = between(random, 0.0, TAU);
        let turns = chance(random, 0.6);
        let headings_rad = (0..dives)
            .map(|_| {
                heading_rad += if turns && chance(random, 0.5) { between(random, 0.5, 3.0) } else { 0.0 };
                heading_rad.rem_euclid(TAU)
            })
            .collect();
        Plan {
            bottom_m,
            legs,
            headings_rad,
            hunting_rad: if chance(random, 0.6) { between(random, 0.1, 1.2).to_radians() } else { 0.0 },
            hunting_s: between(random, 120.0, 1500.0),
            wander_rad: between(random, 0.05, 0.4).to_radians(),
            list_rad: between(random, -0.04, 0.04),
        }
    }
}

/// All that a flight follows from.
#[derive(Debug, Clone, Copy)]
pub struct Voyage<'a> {
    /// The water.
    pub sea: &'a Sea,
    /// The glider as it is, effects apart.
    pub glider: &'a DrawnGlider,
    /// The effects.
    pub hidden: &'a Hidden,
    /// How much of its motion is unsteady.
    pub motion: Motion,
    /// How it is flown.
    pub plan: &'a Plan,
}

/// Flies the plan and shows every step to `observe`.
pub fn fly(voyage: &Voyage, random: &mut Stream, mut observe: impl FnMut(&Instant)) {
    let Voyage { sea, glider, hidden, motion, plan } = *voyage;
    let vehicles = [glider.as_vehicle(&glider.descent), glider.as_vehicle(&glider.ascent)];
    let (mut time_s, mut depth_m, mut speed, mut alpha) = (0.0, 1.0, 0.1, 0.0);
    let (mut ballast_cc, mut held_rad) = (plan.legs[0].1, plan.legs[0].0);
    let mut wander = sea.wander_m_s * normal(random);
    let mut pitch_wander = normal(random);
    let mut memory = Memory::afloat(&sea.water(0.0, 0.0));
    let mut pitch_before = None;
    for (leg, &(pitch_rad, wanted_cc)) in plan.legs.iter().enumerate() {
        let up = leg % 2 == 1;
        let heading_rad = plan.headings_rad[leg / 2];
        // A leg that gets nowhere is given up: the next one is flown from where it is.
        let gives_up_s = time_s + 4.0 * plan.bottom_m / 0.1;
        while time_s < gives_up_s && if up { depth_m > 3.0 } else { depth_m < plan.bottom_m } {
            let ease = 1.0 - (-STEP_S / 20.0f64).exp();
            held_rad += ease * (pitch_rad - held_rad);
            let pumped_cc = (wanted_cc - ballast_cc).clamp(-glider.rate_cc_s * STEP_S, glider.rate_cc_s * STEP_S);
            ballast_cc += pumped_cc;
            pitch_wander = keep(pitch_wander, 1.0, 400.0, random);
            wander = keep(wander, sea.wander_m_s, sea.wander_s, random);
            let pitch =
                held_rad + plan.hunting_rad * (TAU * time_s / plan.hunting_s).sin() + plan.wander_rad * pitch_wander;
            let (wave_m_s, heave_m) = sea.heave(depth_m, time_s);
            let water = sea.water(depth_m, heave_m + hidden.internal_tide(depth_m, time_s).1);
            let pressure_pa = sea.pressure_dbar(depth_m) * 1e4;
            memory.step(hidden, &water, pressure_pa, pumped_cc, STEP_S);
            let vehicle = &vehicles[usize::from(pitch > 0.0)];
            let mass_kg = hidden.mass_kg(glider.mass_kg, time_s, &memory, pressure_pa);
            let volume_m3 = hidden.volume_m3(vehicle, pressure_pa, water.temperature_c, ballast_cc, &memory);
            let net_mass_kg = mass_kg - water.density_kg_m3 * volume_m3;
            let net_n = weight_n(net_mass_kg);
            let half = 0.5 * water.density_kg_m3 * glider.area_m2;
            let [surge_kg, heave_kg] = glider.added_kg.map(|added| mass_kg + added);
            let flow = |angle_rad: f64, speed: f64| Flow {
                time_s,
                angle_rad,
                density_kg_m3: water.density_kg_m3,
                dynamic_pressure_pa: 0.5 * water.density_kg_m3 * speed * speed,
                rising: pitch > 0.0,
                roll_rad: plan.list_rad,
                rudder_rad: 0.0,
                depth_m,
            };
            // The angle of attack that carries the net weight at this speed, by Newton's method from the angle so far.
            let mut balanced: f64 = alpha;
            for _ in 0..8 {
                let wanted = net_n * (balanced - pitch).cos() / (half * speed * speed);
                let lift = |angle_rad: f64| hidden.lift_coefficient(vehicle, &flow(angle_rad, speed));
                let slope =
                    (lift(balanced + SLOPE_OVER_RAD) - lift(balanced - SLOPE_OVER_RAD)) / (2.0 * SLOPE_OVER_RAD);
                balanced = (balanced + (wanted - lift(balanced)) / slope).clamp(-0.4, 0.4);
            }
            alpha = match motion {
                Motion::SurgeAndHeave => {
                    let follow_s = heave_kg / (half * speed * vehicle.a_per_rad);
                    let pitch_rate = (pitch - pitch_before.unwrap_or(pitch)) / STEP_S;
                    let turned = (balanced + pitch_rate * follow_s * surge_kg / heave_kg).clamp(-0.4, 0.4);
                    alpha + (1.0 - (-STEP_S / follow_s).exp()) * (turned - alpha)
                }
                _ => 0.7 * alpha + 0.3 * balanced,
            };
            pitch_before = Some(pitch);
            let xi = alpha - pitch;
            let along_n = net_n * xi.sin();
            let drag = half * hidden.drag_coefficient(vehicle, &flow(alpha, speed));
            if motion == Motion::QuasiSteady {
                // Some relaxation towards the balance, which a second reaches.
                speed += 0.5 * ((along_n.max(1e-3) / drag).sqrt() - speed);
            } else {
                let water = sea.shear_1_s(depth_m, heading_rad) * speed * xi.sin() * xi.cos();
                speed += STEP_S * ((along_n - drag * speed * speed) / surge_kg - water);
            }
            speed = speed.max(0.03);
            let water_sinking_m_s = wave_m_s + wander + hidden.sinking_water_m_s(depth_m, time_s);
            let sinking_m_s = speed * xi.sin() + water_sinking_m_s;
            depth_m = (depth_m + STEP_S * sinking_m_s).max(0.0);
            observe(&Instant {
                time_s,
                dive: leg as u32 / 2 + 1,
                depth_m,
                sinking_m_s,
                water_sinking_m_s,
                speed_m_s: speed,
                angle_rad: alpha,
                pitch_rad: pitch,
                roll_rad: plan.list_rad,
                heading_rad,
                rudder_rad: 0.0,
                rudder_reading_rad: 0.0,
                roll_mass_rad: f64::NAN,
                engine_cc: ballast_cc,
                moving_mass_m: 0.0,
                pressure_pa,
                water,
                net_mass_kg,
                outside_kg: hidden.outside_kg(&memory.outside, pressure_pa, water.density_kg_m3),
            });
            time_s += STEP_S;
        }
    }
}

/// One step of a first-order autoregressive process.
fn keep(value: f64, sd: f64, time_s: f64, random: &mut Stream) -> f64 {
    let kept = (-STEP_S / time_s).exp();
    kept * value + (1.0 - kept * kept).sqrt() * sd * normal(random)
}
