//! What an external sensor adds to a glider in drag and power.

use glidepolar_dynamics::Parameters;

/// What an external sensor costs the glider.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sensor {
    /// Its drag area, drag coefficient times the area that it refers to \[m2\].
    pub drag_area_m2: f64,
    /// Its power \[W\].
    pub power_W: f64,
}

impl Sensor {
    /// The glider with this sensor on it: `b` grows by the drag area over the frontal area on both legs.
    pub fn carried_by(&self, parameters: &Parameters<f64>) -> Parameters<f64> {
        let p = parameters;
        let more = self.drag_area_m2 / p.frontal_area_m2;
        let ascent_b = p.b * p.ascent_b_ratio;
        Parameters {
            b: p.b + more,
            ascent_b_ratio: if more == 0.0 { p.ascent_b_ratio } else { (ascent_b + more) / (p.b + more) },
            hotel_W: p.hotel_W + self.power_W,
            ..*p
        }
    }
}
