//! The outline of a hull: what theory needs beyond its length and diameter.
//!
//! Where nobody states an outline, bow and stern are those of SUBOFF (Groves, Huang and Chang 1989, DTRC/SHD-1298-01, the
//! equations in feet there) with as much parallel middle body as the length asks for: a streamlined hull like any glider's.
//! A report says which figures rest on that.

/// Radius along a hull of revolution.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// Distance aft of the nose \[m\], evenly spaced, first 0, last the overall length.
    pub x_m: Vec<f64>,
    /// Radius \[m\].
    pub radius_m: Vec<f64>,
}

/// What follows from an outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integrals {
    /// Volume \[m3\].
    pub volume_m3: f64,
    /// Wetted surface \[m2\].
    pub wetted_m2: f64,
    /// Area of the side view \[m2\].
    pub planform_m2: f64,
    /// Centroid of the side view aft of the nose \[m\].
    pub planform_centroid_m: f64,
    /// Centre of the volume aft of the nose \[m\].
    pub centroid_m: f64,
}

const STATIONS: usize = 2000;
/// Bow, afterbody to the cap, and cap of SUBOFF in diameters.
const BOW: f64 = 3.333333 / 1.666667;
const STERN: f64 = 3.333333 / 1.666667;
const CAP: f64 = 0.3125 / 1.666667;

impl Outline {
    /// SUBOFF's bow and stern about a parallel middle body.
    pub fn like_suboff(length_m: f64, diameter_m: f64) -> Outline {
        let slender = length_m / diameter_m;
        // A hull too short for both has them shortened alike.
        let squeeze = (slender / (BOW + STERN + CAP)).min(1.0);
        let x_m: Vec<f64> = (0..=STATIONS).map(|i| length_m * i as f64 / STATIONS as f64).collect();
        let radius = |x: f64| 0.5 * diameter_m * suboff_shape(x / diameter_m, slender, squeeze);
        Outline { radius_m: x_m.iter().map(|x| radius(*x)).collect(), x_m }
    }

    /// Sectional area \[m2\].
    pub fn area_m2(&self, station: usize) -> f64 {
        std::f64::consts::PI * self.radius_m[station].powi(2)
    }

    /// Integrals by the trapezoidal rule.
    pub fn integrals(&self) -> Integrals {
        let mut sums = [0.0; 5];
        for i in 0..self.x_m.len() - 1 {
            let (x0, x1) = (self.x_m[i], self.x_m[i + 1]);
            let (r0, r1) = (self.radius_m[i], self.radius_m[i + 1]);
            let (dx, x, r) = (x1 - x0, 0.5 * (x0 + x1), 0.5 * (r0 + r1));
            let area = std::f64::consts::PI * (r0 * r0 + r1 * r1) / 2.0;
            sums[0] += area * dx;
            sums[1] += std::f64::consts::TAU * r * dx.hypot(r1 - r0);
            sums[2] += 2.0 * r * dx;
            sums[3] += 2.0 * r * x * dx;
            sums[4] += area * x * dx;
        }
        Integrals {
            volume_m3: sums[0],
            wetted_m2: sums[1],
            planform_m2: sums[2],
            planform_centroid_m: sums[3] / sums[2],
            centroid_m: sums[4] / sums[0],
        }
    }
}

/// Radius over the largest one at a distance in diameters.
fn suboff_shape(x: f64, slender: f64, squeeze: f64) -> f64 {
    let (bow, stern, cap) = (BOW * squeeze, STERN * squeeze, CAP * squeeze);
    if x < bow {
        // Feet of the report: its bow is 3.333333 ft long.
        let t = x / bow * 3.333333;
        let q = 0.3 * t - 1.0;
        let inner = 1.126395101 * t * q.powi(4) + 0.442874707 * t * t * q.powi(3) + 1.0 - q.powi(4) * (1.2 * t + 1.0);
        inner.max(0.0).powf(1.0 / 2.1)
    } else if x < slender - cap - stern {
        1.0
    } else if x < slender - cap {
        let xi = (slender - cap - x) / stern;
        let (rh, k0, k1) = (0.1175, 10.0, 44.6244);
        let rh2 = rh * rh;
        let poly = [
            rh2,
            0.0,
            rh * k0,
            20.0 - 20.0 * rh2 - 4.0 * rh * k0 - k1 / 3.0,
            -45.0 + 45.0 * rh2 + 6.0 * rh * k0 + k1,
            36.0 - 36.0 * rh2 - 4.0 * rh * k0 - k1,
            -10.0 + 10.0 * rh2 + rh * k0 + k1 / 3.0,
        ];
        poly.iter().rev().fold(0.0, |sum, c| sum * xi + c).max(0.0).sqrt()
    } else {
        let t = ((x - (slender - cap)) / cap).clamp(0.0, 1.0);
        0.1175 * (1.0 - t * t).max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Groves et al. 1989 for the bare hull: volume 24.692 ft3, centre of buoyancy 6.59003 ft aft of the nose; the wetted
    /// surface of the same equations is 64.46 ft2.
    #[test]
    fn suboff_has_its_published_volume() {
        let foot = 0.3048;
        let outline = Outline::like_suboff(14.291667 * foot, 1.666667 * foot);
        let integrals = outline.integrals();
        assert!((integrals.volume_m3 / foot.powi(3) - 24.692).abs() < 0.005, "{}", integrals.volume_m3 / foot.powi(3));
        assert!((integrals.centroid_m / foot - 6.59003).abs() < 0.002);
        assert!((integrals.wetted_m2 / foot.powi(2) - 64.46).abs() < 0.1, "{}", integrals.wetted_m2 / foot.powi(2));
    }
}
