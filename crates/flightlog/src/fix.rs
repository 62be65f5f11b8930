//! Positions at the surface that a glider wrote into its own log.

/// A position at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GpsFix {
    /// Unix time \[s\].
    pub time_s: f64,
    /// Latitude, north positive \[deg\].
    pub lat_deg: f64,
    /// Longitude, east positive \[deg\].
    pub lon_deg: f64,
}

impl GpsFix {
    /// A fix of numbers that a position can have; nothing of others, or where the receiver wrote zeros.
    pub fn new(time_s: f64, lat_deg: f64, lon_deg: f64) -> Option<Self> {
        let is_one = time_s.is_finite() && lat_deg.abs() <= 90.0 && lon_deg.abs() <= 360.0;
        (is_one && (lat_deg != 0.0 || lon_deg != 0.0)).then_some(GpsFix { time_s, lat_deg, lon_deg })
    }
}

/// Degrees from a receiver's `DDMM.mmm`, degrees and minutes in one number; NaN where the minutes are 60 or more.
pub(super) fn degrees(ddmm: f64) -> f64 {
    let whole = (ddmm / 100.0).trunc();
    let minutes = ddmm - 100.0 * whole;
    if minutes.abs() < 60.0 { whole + minutes / 60.0 } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_and_minutes_in_one_number_are_taken_apart() {
        assert!((degrees(5430.6) - 54.51).abs() < 1e-12);
        assert!((degrees(-12224.0) + 122.4).abs() < 1e-12);
        assert!(degrees(5475.0).is_nan());
        // A receiver without a fix writes 69696969.
        assert_eq!(GpsFix::new(0.0, degrees(69_696_969.0), 10.0), None);
        assert_eq!(GpsFix::new(0.0, 0.0, 0.0), None);
    }
}
