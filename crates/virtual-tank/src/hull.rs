//! The five hulls and the force of the water on them, in body axes: x forward, y to starboard, bow to starboard
//! positive. Forces are worked out at the centre of buoyancy and handed over about the moment centre. Knows the water
//! and the hull's own motion; must not know the balance, the carriage or how anybody reduces a run.

use serde::{Deserialize, Serialize};

use super::effects::Hidden;
use super::outline::{PHOENIX, Spheroid, Strip, TableRow, frontal_area, strips, volume};
use super::random::Stream;
use super::water::Water;

/// Speed at which the coefficient b is stated when drag depends on Reynolds number, m/s.
const REFERENCE_SPEED_M_S: f64 = 2.0;

/// CL = a alpha, CD = b + c alpha^2 on frontal area, CM = d alpha about the centre of buoyancy on frontal area times
/// overall length; alpha in radians.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StaticCoefficients {
    /// Lift slope, 1/rad.
    pub a: f64,
    /// Drag at zero angle (at 2 m/s where it depends on Reynolds number).
    pub b: f64,
    /// Growth of drag, 1/rad^2.
    pub c: f64,
    /// Moment slope, 1/rad.
    pub d: f64,
}

/// SNAME primes on overall length about the centre of buoyancy.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "PascalCase")]
#[allow(missing_docs, reason = "the field's own symbols")]
pub struct DynamicDerivatives {
    pub yv: f64,
    pub nv: f64,
    pub yr: f64,
    pub nr: f64,
    pub yvdot: f64,
    pub nvdot: f64,
    pub yrdot: f64,
    pub nrdot: f64,
}

/// What hangs below the balance when a model is fitted: model, strut and the water inside.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LiveMass {
    /// Mass, kg.
    pub live_mass_kg: f64,
    /// Its centre aft of the nose, m.
    pub xg_m: f64,
    /// Its moment of inertia about the moment centre, kg m2.
    pub izz_kg_m2: f64,
}

/// A hull in the water.
#[derive(Debug, Clone)]
pub(super) struct Hull {
    pub row: TableRow,
    pub coefficients: StaticCoefficients,
    pub derivatives: DynamicDerivatives,
    /// Surge added mass over rho L^3 / 2, negative.
    xudot: f64,
    pub live: LiveMass,
    strips: Vec<Strip>,
}

/// Motion at the moment centre through the water that surrounds it, body axes.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Flow {
    pub u: f64,
    pub v: f64,
    pub r: f64,
    pub udot: f64,
    pub vdot: f64,
    pub rdot: f64,
    /// Share of the steady forces that has built up since the start: 1 once the flow is developed.
    pub development: f64,
    /// Drag coefficient of something caught on the model.
    pub extra_cd: f64,
}

/// Force and moment about the moment centre: X forward, Y to starboard, N bow to starboard.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Loads {
    pub x: f64,
    pub y: f64,
    pub n: f64,
}

impl std::ops::Add for Loads {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, n: self.n + other.n }
    }
}

/// The five hulls with coefficients of this campaign: straight lines in length to diameter ratio, so that the trend is
/// exact as well.
pub(super) fn draw_hulls(stream: &mut Stream) -> Vec<Hull> {
    let mut line = |middle: f64, slope: f64| {
        let (middle, slope) = (middle * stream.between(0.9, 1.1), slope * stream.between(0.8, 1.2));
        move |ldr: f64| middle + slope * (ldr - 10.5)
    };
    // Sizes: friction line with form factor for b, Munk's moment times the efficiency found on SUBOFF for d, SUBOFF's
    // sweep for a and c.
    let (a, b, c, d) = (line(1.06, 0.08), line(0.138, 0.0115), line(1.6, 0.12), line(1.21, 0.035));
    let sway_efficiency = stream.between(0.78, 0.98);
    let yaw_efficiency = stream.between(0.75, 0.95);
    let offset = stream.sign() * stream.between(0.004, 0.015);
    let (yr, nr) = (stream.between(0.13, 0.19), stream.between(0.12, 0.16));
    PHOENIX
        .iter()
        .map(|row| {
            let (ldr, loa) = (row.ldr, row.loa_m);
            let coefficients = StaticCoefficients { a: a(ldr), b: b(ldr), c: c(ldr), d: d(ldr) };
            let strips = strips(row);
            let volume = volume(row);
            let area_ratio = frontal_area() / (loa * loa);
            let displaced = 2.0 * volume / loa.powi(3);
            let spheroid = Spheroid::new(ldr);
            let yvdot = -sway_efficiency * spheroid.sway * displaced;
            let inertia = displaced / 20.0 * (1.0 + 1.0 / (ldr * ldr));
            let derivatives = DynamicDerivatives {
                // Exact consequences of the static law: Y = q A (CL cos + CD sin), v = -V sin(alpha).
                yv: -(coefficients.a + coefficients.b) * area_ratio,
                nv: -coefficients.d * area_ratio,
                yr: yr * area_ratio,
                nr: -nr * area_ratio,
                yvdot,
                // The added-mass matrix of a body is symmetric; its centre lies a little off the centre of buoyancy.
                nvdot: offset * yvdot,
                yrdot: offset * yvdot,
                nrdot: -yaw_efficiency * spheroid.yaw * inertia,
            };
            let live_mass_kg = 1000.0 * volume * stream.between(0.97, 1.05) + 2.5;
            let xg_m = row.cb_m + stream.between(-0.012, 0.012);
            let izz_kg_m2 = live_mass_kg * ((0.24 * loa).powi(2) + (xg_m - row.mc_m).powi(2));
            let live = LiveMass {
                live_mass_kg: to_places(live_mass_kg, 3),
                xg_m: to_places(xg_m, 4),
                izz_kg_m2: to_places(izz_kg_m2, 4),
            };
            Hull { row: *row, coefficients, derivatives, xudot: -spheroid.surge * displaced, live, strips }
        })
        .collect()
}

impl Hull {
    /// The moment centre's distance ahead of the centre of buoyancy, m.
    fn mc_ahead_of_cb(&self) -> f64 {
        self.row.cb_m - self.row.mc_m
    }

    /// Force of the water on the hull about the moment centre.
    pub(super) fn force_of_water(&self, flow: &Flow, water: &Water, hidden: &Hidden) -> Loads {
        let (length, half_rho) = (self.row.loa_m, 0.5 * water.density_kg_m3);
        // The centre of buoyancy lies behind the moment centre and swings out when the hull turns.
        let lever = self.mc_ahead_of_cb();
        let (u, v, vdot) = (flow.u, flow.v - lever * flow.r, flow.vdot - lever * flow.rdot);
        let speed2 = u * u + v * v;
        let speed = speed2.sqrt();
        let (sine, cosine) = if speed > 0.0 { (-v / speed, u / speed) } else { (0.0, 1.0) };
        let alpha = sine.atan2(cosine);

        let (lift, drag, moment) = self.static_law(alpha, speed, flow.extra_cd, water, hidden);
        let pressure_area = half_rho * speed2 * self.blockage(sine, cosine, hidden) * frontal_area();
        let d = &self.derivatives;
        let l3 = half_rho * length.powi(3);
        let (l4, l5) = (l3 * length, l3 * length * length);

        let mut x = pressure_area * (lift * sine - drag * cosine);
        let mut y = pressure_area * (lift * cosine + drag * sine) + l3 * d.yr * speed * flow.r;
        let mut n = pressure_area * length * moment + l4 * d.nr * speed * flow.r;
        if hidden.crossflow_per_rad2 != 0.0 {
            let (dy, dn) = self.crossflow(v, flow.r);
            y += half_rho * hidden.crossflow_per_rad2 * dy;
            n += half_rho * hidden.crossflow_per_rad2 * dn;
        }
        if let Some(wall) = hidden.wall {
            let drawn = half_rho * speed2 * frontal_area() * wall.side_force;
            y += drawn;
            n += drawn * wall.arm_lengths * length;
        }
        x *= flow.development;
        y *= flow.development;
        n *= flow.development;

        // Inertia of the water, with the axial force that a turning hull feels from it.
        x += l3 * (self.xudot * flow.udot - d.yvdot * v * flow.r) - l4 * d.yrdot * flow.r * flow.r;
        y += l3 * d.yvdot * vdot + l4 * d.yrdot * flow.rdot;
        n += l4 * d.nvdot * vdot + l5 * d.nrdot * flow.rdot;
        // The strut's wake acts where the strut holds the model: no moment there.
        let wake = half_rho * frontal_area() * hidden.strut_interference_per_rad2 * flow.v * flow.v.abs();
        Loads { x, y: y - wake * flow.development, n: n - lever * y }
    }

    /// Dynamic pressure past the model over that far ahead of it: continuity in what the model leaves of the tank's section.
    /// Across the tank it takes up its side area, nine tenths of length times diameter.
    fn blockage(&self, sine: f64, cosine: f64, hidden: &Hidden) -> f64 {
        if hidden.blockage_section_ratio == 0.0 {
            return 1.0;
        }
        let side_over_front = 0.9 * self.row.loa_m * super::outline::DIAMETER_M / frontal_area();
        let taken = hidden.blockage_section_ratio * (cosine.abs() + side_over_front * sine.abs());
        1.0 / (1.0 - taken).powi(2)
    }

    /// CL, CD and CM about the centre of buoyancy in steady straight motion.
    fn static_law(&self, alpha: f64, speed: f64, extra_cd: f64, water: &Water, hidden: &Hidden) -> (f64, f64, f64) {
        let StaticCoefficients { a, b, c, d } = self.coefficients;
        let mut side = 1.0;
        if hidden.asymmetry_ratio != 1.0 {
            let excess = (hidden.asymmetry_ratio - 1.0) / (hidden.asymmetry_ratio + 1.0);
            side += excess * (alpha / 0.5f64.to_radians()).tanh();
        }
        let mut lift = a * side * alpha;
        let mut drag = b * self.friction_ratio(speed, water, hidden.drag_exponent) + c * alpha * alpha + extra_cd;
        if let Some(bubble) = hidden.bubble {
            let beyond = (bubble.side * alpha - bubble.onset_rad) / 0.25f64.to_radians();
            let burst = 0.5 * (1.0 + beyond.tanh());
            lift -= bubble.side * bubble.lift_loss * burst;
            drag += 0.2 * bubble.lift_loss * burst;
        }
        if hidden.wave_hump_cd != 0.0 {
            let froude = speed / (9.81 * self.row.loa_m).sqrt();
            let hump = |centre: f64, width: f64| (-((froude - centre) / width).powi(2)).exp();
            drag += hidden.wave_hump_cd * (hump(0.50, 0.09) + 0.35 * hump(0.34, 0.04));
        }
        if let Some(transition) = hidden.transition {
            drag -= 0.5 * transition.drag_saved * (1.0 - ((speed - transition.speed_m_s) / 0.1).tanh());
        }
        if let Some(lock_in) = hidden.lock_in {
            drag += lock_in.drag_saved * (-((speed - lock_in.speed_m_s) / 0.35).powi(2)).exp();
        }
        let mut moment = d * side * alpha;
        if let Some(stall) = hidden.stall {
            let beyond = 0.5 * (1.0 + ((alpha.abs() - stall.onset_rad) / 1.0f64.to_radians()).tanh());
            lift -= alpha.signum() * stall.lift_loss * beyond;
            moment -= alpha.signum() * stall.lift_loss / 3.0 * beyond;
        }
        (lift, drag, moment)
    }

    /// b at this speed over b at 2 m/s and 15 C: the ITTC-57 line Cf = 0.075/(log10 Re - 2)^2 raised to the power that
    /// gives the asked exponent of dynamic pressure there.
    fn friction_ratio(&self, speed: f64, water: &Water, exponent: f64) -> f64 {
        if exponent == 0.0 || speed < 0.05 {
            return 1.0;
        }
        let distance = |reynolds: f64| reynolds.log10() - 2.0;
        let at_reference = distance(REFERENCE_SPEED_M_S * self.row.loa_m / Water::fresh(15.0).kinematic_viscosity_m2_s);
        let here = distance(speed * self.row.loa_m / water.kinematic_viscosity_m2_s);
        // d ln Cf / d ln q of the line itself.
        let of_the_line = -1.0 / (std::f64::consts::LN_10 * at_reference);
        (at_reference / here).powf(2.0 * exponent / of_the_line)
    }

    /// Crossflow drag summed over the strips, per unit coefficient and rho/2: each strip sees its own cross velocity.
    fn crossflow(&self, v: f64, r: f64) -> (f64, f64) {
        let mut sum = (0.0, 0.0);
        for strip in &self.strips {
            let across = v + strip.ahead_m * r;
            let force = -strip.share * across * across.abs();
            sum.0 += force;
            sum.1 += force * strip.ahead_m;
        }
        sum
    }
}

/// What the manifest prints is what the simulation uses.
fn to_places(value: f64, places: i32) -> f64 {
    let scale = 10f64.powi(places);
    (value * scale).round() / scale
}

#[cfg(test)]
mod tests {
    use super::super::random::Purpose;
    use super::*;

    fn hulls() -> Vec<Hull> {
        draw_hulls(&mut Stream::new(7, Purpose::Hulls))
    }

    /// The stated derivatives are the slopes of the force about the centre of buoyancy, by finite differences.
    #[test]
    fn stated_derivatives_are_slopes_of_the_force() {
        let water = Water::fresh(14.0);
        for hull in hulls() {
            let (u, h) = (2.0, 1e-4);
            let lever = hull.mc_ahead_of_cb();
            // Motion of the centre of buoyancy -> motion of the moment centre; force about MC -> about CB.
            let at_cb = |v: f64, r: f64, vdot: f64, rdot: f64| {
                let flow = Flow {
                    u,
                    v: v + lever * r,
                    r,
                    udot: 0.0,
                    vdot: vdot + lever * rdot,
                    rdot,
                    development: 1.0,
                    extra_cd: 0.0,
                };
                let loads = hull.force_of_water(&flow, &water, &Hidden::default());
                (loads.y, loads.n + lever * loads.y)
            };
            let slope =
                |plus: (f64, f64), minus: (f64, f64)| ((plus.0 - minus.0) / (2.0 * h), (plus.1 - minus.1) / (2.0 * h));
            let l = hull.row.loa_m;
            let force = 0.5 * water.density_kg_m3 * l * l;
            let d = hull.derivatives;
            let (yv, nv) = slope(at_cb(h, 0.0, 0.0, 0.0), at_cb(-h, 0.0, 0.0, 0.0));
            let (yr, nr) = slope(at_cb(0.0, h, 0.0, 0.0), at_cb(0.0, -h, 0.0, 0.0));
            let (yvdot, nvdot) = slope(at_cb(0.0, 0.0, h, 0.0), at_cb(0.0, 0.0, -h, 0.0));
            let (yrdot, nrdot) = slope(at_cb(0.0, 0.0, 0.0, h), at_cb(0.0, 0.0, 0.0, -h));
            let pairs = [
                (yv, d.yv * force * u),
                (nv, d.nv * force * u * l),
                (yr, d.yr * force * u * l),
                (nr, d.nr * force * u * l * l),
                (yvdot, d.yvdot * force * l),
                (nvdot, d.nvdot * force * l * l),
                (yrdot, d.yrdot * force * l * l),
                (nrdot, d.nrdot * force * l * l * l),
            ];
            for (i, (found, stated)) in pairs.into_iter().enumerate() {
                assert!(
                    (found / stated - 1.0).abs() < 1e-5,
                    "{} derivative {i}: {found} against {stated}",
                    hull.row.id
                );
            }
        }
    }

    /// Crossflow in steady drift: normal force K sin|sin| on frontal area, pushing aft of the centre of buoyancy.
    #[test]
    fn crossflow_has_its_stated_size() {
        let water = Water::fresh(14.0);
        let hidden = Hidden { crossflow_per_rad2: 5.0, ..Hidden::default() };
        for hull in hulls() {
            for degrees in [-20.0f64, 5.0, 12.0] {
                let (sine, cosine) = degrees.to_radians().sin_cos();
                let flow = Flow { u: 2.0 * cosine, v: -2.0 * sine, development: 1.0, ..Flow::default() };
                let with = hull.force_of_water(&flow, &water, &hidden);
                let without = hull.force_of_water(&flow, &water, &Hidden::default());
                let normal = 0.5 * water.density_kg_m3 * 4.0 * frontal_area() * 5.0 * sine * sine.abs();
                assert!(((with.y - without.y) / normal - 1.0).abs() < 1e-9);
                assert!((with.x - without.x).abs() < 1e-9);
                let lever_cb = hull.mc_ahead_of_cb() + (with.n - without.n) / (with.y - without.y);
                assert!((-0.15..-0.01).contains(&(lever_cb / hull.row.loa_m)), "{}", lever_cb / hull.row.loa_m);
            }
        }
    }

    #[test]
    fn friction_line_has_the_stated_exponent_at_two_metres_per_second() {
        let (hull, water) = (&hulls()[0], Water::fresh(15.0));
        let ratio = |speed: f64| hull.friction_ratio(speed, &water, -0.15).ln();
        let exponent = (ratio(2.01) - ratio(1.99)) / (2.0 * (2.01f64 / 1.99).ln());
        assert!((exponent + 0.15).abs() < 1e-4, "{exponent}");
        assert!(ratio(2.0).abs() < 1e-12);
    }
}
