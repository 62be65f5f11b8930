//! From forces on a hull to coefficients, and between the forms in which hull tests are published.
//!
//! Axes: yaw angle `+psi` (bow to starboard) is the angle of attack of the glider's vertical plane. `AF` positive aft,
//! `SF` positive to starboard, `YM` positive bow to starboard, the force of the water on the model. Knows no files.

use glidepolar_number::Number;

/// Force of the water on a model as a three-component balance names it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BalanceForce<T> {
    /// Axial force, positive aft \[N\].
    pub axial_N: T,
    /// Side force, positive to starboard \[N\].
    pub side_N: T,
    /// Yaw moment, positive bow to starboard, about a point that goes with it \[N m\].
    pub yaw_N_m: T,
}

/// Lift, drag and moment: the same force in wind axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WindForce<T> {
    /// Lift, across the flow \[N\].
    pub lift_N: T,
    /// Drag, along the flow \[N\].
    pub drag_N: T,
    /// Moment about the same point \[N m\].
    pub moment_N_m: T,
}

/// Lift, drag and moment coefficient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HullCoefficients<T> {
    /// Lift coefficient on the frontal area.
    pub lift: T,
    /// Drag coefficient on the frontal area.
    pub drag: T,
    /// Moment coefficient on frontal area times length, about the centre of buoyancy.
    pub moment: T,
}

impl<T: Number> BalanceForce<T> {
    /// The same force about another point: `YM' = YM + (aft' - aft) SF`, both points measured aft of the nose \[m\].
    pub fn moved(self, from_aft_m: T, to_aft_m: T) -> Self {
        BalanceForce { yaw_N_m: self.yaw_N_m + (to_aft_m - from_aft_m) * self.side_N, ..self }
    }

    /// `L = SF cos psi - AF sin psi`, `D = AF cos psi + SF sin psi`.
    pub fn in_wind_axes(self, yaw_rad: T) -> WindForce<T> {
        let (sin, cos) = yaw_rad.sin_cos();
        WindForce {
            lift_N: self.side_N * cos - self.axial_N * sin,
            drag_N: self.axial_N * cos + self.side_N * sin,
            moment_N_m: self.yaw_N_m,
        }
    }
}

impl<T: Number> WindForce<T> {
    /// Coefficients by dynamic pressure, frontal area and length; the moment must already be about the centre of buoyancy.
    pub fn coefficients(self, dynamic_pressure_Pa: T, frontal_area_m2: T, length_m: T) -> HullCoefficients<T> {
        let force = dynamic_pressure_Pa * frontal_area_m2;
        HullCoefficients {
            lift: self.lift_N / force,
            drag: self.drag_N / force,
            moment: self.moment_N_m / (force * length_m),
        }
    }
}

/// Forces in SNAME primes: `X' = X/(rho/2 L^2 U^2)`, `N' = N/(rho/2 L^3 U^2)`, on a reference length of their own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrimeForce {
    /// Longitudinal force, positive forward.
    pub x: f64,
    /// Side force, positive to starboard.
    pub y: f64,
    /// Yaw moment, positive bow to starboard.
    pub n: f64,
}

impl PrimeForce {
    /// As a balance would read it at a dynamic pressure of 1 Pa, on the reference length \[m\].
    pub fn at_unit_pressure(self, reference_length_m: f64) -> BalanceForce<f64> {
        let area = reference_length_m * reference_length_m;
        BalanceForce { axial_N: -self.x * area, side_N: self.y * area, yaw_N_m: self.n * area * reference_length_m }
    }
}

/// Frontal area of a hull of this largest diameter \[m2\].
pub fn frontal_area_m2(diameter_m: f64) -> f64 {
    std::f64::consts::PI / 4.0 * diameter_m * diameter_m
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_suboff_table_converts_to_its_published_coefficients() {
        // Roddy 1990, point 159, 10.05 deg; CL, CD, CM about the centre of buoyancy computed apart from this code.
        let point = PrimeForce { x: -1.049e-3, y: 2.450e-3, n: 2.008e-3 };
        let (lpp, loa, diameter) = (4.2609, 4.356, 0.508);
        let c = point
            .at_unit_pressure(lpp)
            .moved(2.013, 6.59003 * 0.3048)
            .in_wind_axes(10.05f64.to_radians())
            .coefficients(1.0, frontal_area_m2(diameter), loa);
        assert!((c.lift - 0.1997).abs() < 1e-4, "{}", c.lift);
        assert!((c.drag - 0.1308).abs() < 1e-4, "{}", c.drag);
        assert!((c.moment - 0.1757).abs() < 1e-4, "{}", c.moment);
    }

    #[test]
    fn moving_the_moment_aft_adds_the_side_force_times_the_way() {
        let force = BalanceForce::<f64> { axial_N: 1.0, side_N: 10.0, yaw_N_m: 2.0 };
        assert!((force.moved(0.736, 0.815).yaw_N_m - 2.79).abs() < 1e-12);
        assert_eq!(force.moved(0.736, 0.815).axial_N, 1.0);
    }
}
