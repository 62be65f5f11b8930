//! How the model moves through the tank, and what its own inertia adds to the readings.
//!
//! The balance reads the force of the water plus that of inertia on everything below it. With the mass `m`, its centre `xG`
//! ahead of the moment centre and its moment of inertia `Izz` about the moment centre, entrained water included,
//!
//! ```text
//! X_water = X_read + m (u' - v r - xG r^2)
//! Y_water = Y_read + m (v' + u r + xG r')
//! N_water = N_read + Izz r' + m xG (v' + u r)
//! ```

use nalgebra::Vector3;

use crate::harmonics::{Harmonics, Series, TERMS};
use crate::hull::Hull;

/// Motion of the moment centre, body axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Velocity forward \[m/s\].
    pub u: f64,
    /// Velocity to starboard \[m/s\].
    pub v: f64,
    /// Rate of turn, bow to starboard \[rad/s\].
    pub r: f64,
    /// Acceleration forward, `u' - v r` \[m/s2\].
    pub forward: f64,
    /// Acceleration to starboard, `v' + u r` \[m/s2\].
    pub sideways: f64,
    /// Angular acceleration \[rad/s2\].
    pub rdot: f64,
}

impl Motion {
    /// At a fixed angle to a straight path, gaining speed.
    pub fn straight(speed_m_s: f64, yaw_rad: f64, acceleration_m_s2: f64) -> Motion {
        let (sine, cosine) = yaw_rad.sin_cos();
        Motion {
            u: speed_m_s * cosine,
            v: -speed_m_s * sine,
            r: 0.0,
            forward: acceleration_m_s2 * cosine,
            sideways: -acceleration_m_s2 * sine,
            rdot: 0.0,
        }
    }

    /// Around a circle, positive radius to starboard, at a fixed angle to the path.
    pub fn turning(speed_m_s: f64, radius_m: f64, yaw_rad: f64, acceleration_m_s2: f64) -> Motion {
        let straight = Motion::straight(speed_m_s, yaw_rad, acceleration_m_s2);
        let r = speed_m_s / radius_m;
        Motion {
            r,
            forward: straight.forward - straight.v * r,
            sideways: straight.sideways + straight.u * r,
            ..straight
        }
    }

    /// At a phase of an oscillation at constant carriage speed.
    pub fn oscillating(run: &Harmonics, phase: f64) -> Motion {
        let omega = std::f64::consts::TAU * run.frequency_hz;
        let [_, across, across_rate] = derivatives(&run.sway_m, phase, omega);
        let [yaw, r, rdot] = derivatives(&run.yaw_rad, phase, omega);
        let (sine, cosine) = yaw.sin_cos();
        Motion {
            u: run.speed_m_s * cosine + across * sine,
            v: across * cosine - run.speed_m_s * sine,
            r,
            forward: across_rate * sine,
            sideways: across_rate * cosine,
            rdot,
        }
    }

    /// Speed through the water \[m/s\].
    pub fn speed(&self) -> f64 {
        self.u.hypot(self.v)
    }

    /// `v'`, the rate of the velocity to starboard \[m/s2\].
    pub fn vdot(&self) -> f64 {
        self.sideways - self.u * self.r
    }

    /// The same motion at the centre of buoyancy, which lies aft of the moment centre.
    pub fn at_cb(&self, cb_aft_of_mc_m: f64) -> Motion {
        Motion {
            v: self.v - cb_aft_of_mc_m * self.r,
            forward: self.forward + cb_aft_of_mc_m * self.r * self.r,
            sideways: self.sideways - cb_aft_of_mc_m * self.rdot,
            ..*self
        }
    }

    /// What inertia took from the balance's readings, to be added to them: AF, SF, YM about the moment centre.
    pub fn inertia(&self, hull: &Hull) -> Vector3<f64> {
        let Some(live) = hull.live else { return Vector3::zeros() };
        let ahead = hull.mc_m - live.xg_m;
        let forward = self.forward - ahead * self.r * self.r;
        let sideways = self.sideways + ahead * self.rdot;
        Vector3::new(
            -live.mass_kg * forward,
            live.mass_kg * sideways,
            live.izz_kg_m2 * self.rdot + live.mass_kg * ahead * self.sideways,
        )
    }
}

/// A series and its first two rates at a phase.
fn derivatives(series: &Series, phase: f64, omega: f64) -> [f64; 3] {
    let mut sum = [series[0], 0.0, 0.0];
    for k in 1..=(TERMS - 1) / 2 {
        let (sine, cosine) = (k as f64 * phase).sin_cos();
        let (a, b, w) = (series[2 * k - 1], series[2 * k], k as f64 * omega);
        sum[0] += a * cosine + b * sine;
        sum[1] += w * (b * cosine - a * sine);
        sum[2] -= w * w * (a * cosine + b * sine);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hull::LiveMass;
    use glidepolar_hull::hull_tests::HullGeometry;

    /// A free body turning about its own centre feels no force: what the balance would read is inertia alone, and taking
    /// it out leaves nothing. The centre's acceleration is worked out along the path, the formulas along body axes.
    #[test]
    fn inertia_is_mass_times_the_acceleration_of_its_centre() {
        let hull = Hull {
            id: "h".into(),
            ldr: 8.5,
            geometry: HullGeometry { diameter_m: 0.203, loa_m: 1.724, cb_m: 0.815, volume_m3: None },
            mc_m: 0.736,
            centre_uncertainties_m: [0.0; 2],
            live: Some(LiveMass { mass_kg: 50.0, xg_m: 0.9, izz_kg_m2: 12.0 }),
            wetted_area_m2: None,
            base_area_m2: 0.0,
        };
        let (mass, ahead) = (50.0, 0.736 - 0.9);
        // Position of the moment centre (X, Y) and heading as functions of time.
        let place = |t: f64| (2.0 * t, 0.3 * (1.3 * t).sin());
        let heading = |t: f64| 0.2 * (1.3 * t).cos();
        let centre = |t: f64| {
            let (x, y) = place(t);
            (x + ahead * heading(t).cos(), y + ahead * heading(t).sin())
        };
        let (t, h) = (0.7, 1e-4);
        let second = |f: &dyn Fn(f64) -> f64| (f(t + h) - 2.0 * f(t) + f(t - h)) / (h * h);
        let first = |f: &dyn Fn(f64) -> f64| (f(t + h) - f(t - h)) / (2.0 * h);
        let (sine, cosine) = heading(t).sin_cos();
        let body = |x: f64, y: f64| (x * cosine + y * sine, y * cosine - x * sine);
        let (u, v) = body(first(&|t| place(t).0), first(&|t| place(t).1));
        let (forward, sideways) = body(second(&|t| place(t).0), second(&|t| place(t).1));
        let motion = Motion { u, v, r: first(&heading), forward, sideways, rdot: second(&heading) };
        let (gx, gy) = body(second(&|t| centre(t).0), second(&|t| centre(t).1));
        let found = motion.inertia(&hull);
        assert!((found[0] + mass * gx).abs() < 1e-4, "{found} {gx}");
        assert!((found[1] - mass * gy).abs() < 1e-4);
        // About the moment centre: Izz r' plus the centre's lever times the moment centre's own acceleration.
        assert!((found[2] - 12.0 * motion.rdot - mass * ahead * sideways).abs() < 1e-9);
        assert!((motion.vdot() - (sideways - u * motion.r)).abs() < 1e-12);
    }

    #[test]
    fn a_turn_to_starboard_accelerates_to_starboard() {
        let motion = Motion::turning(2.0, 10.0, 0.0, 0.0);
        assert!((motion.r - 0.2).abs() < 1e-12 && (motion.sideways - 0.4).abs() < 1e-12 && motion.vdot().abs() < 1e-12);
        assert!((motion.at_cb(0.08).v + 0.016).abs() < 1e-12);
    }
}
