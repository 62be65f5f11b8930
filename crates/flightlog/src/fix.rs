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

/// The positions of a vehicle's rows, one after the other. A vehicle writes its last position in every row until the receiver
/// has a new one, through a whole dive: a row has a fix where its position is another than that of the row before.
#[derive(Debug, Default)]
pub(super) struct Positions {
    /// That of the row before, in the same file.
    before: Option<(f64, f64)>,
    /// The last one that was received, in any file.
    received: Option<(f64, f64)>,
}

impl Positions {
    /// The rows that follow are those of another file. When the position in its first row was received is not known.
    pub(super) fn begin_file(&mut self) {
        self.before = None;
    }

    /// Takes the position of the next row, in any unit; whether the receiver had it new there. Under water the position may
    /// be a reckoned one, and at the surface the one from before the dive comes back.
    pub(super) fn is_received(&mut self, lat: f64, lon: f64, is_at_surface: bool) -> bool {
        let here = (lat, lon);
        let differs = self.before.is_some_and(|before| before != here) && self.received != Some(here);
        self.before = Some(here);
        if is_at_surface && (differs || self.received.is_none()) {
            self.received = Some(here);
        }
        is_at_surface && differs
    }
}

/// Degrees from a receiver's `DDMM.mmm`, degrees and minutes in one number; NaN where the minutes are 60 or more.
pub fn degrees(ddmm: f64) -> f64 {
    let whole = (ddmm / 100.0).trunc();
    let minutes = ddmm - 100.0 * whole;
    if minutes.abs() < 60.0 { whole + minutes / 60.0 } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_position_is_received_where_it_changes_and_at_no_other_row() {
        let mut positions = Positions::default();
        let mut received = |rows: &[(f64, bool)]| -> Vec<usize> {
            positions.begin_file();
            (0..rows.len()).filter(|&row| positions.is_received(rows[row].0, 10.0, rows[row].1)).collect()
        };
        // Climbing, at the surface with the position from before the dive, then with new ones, of which one is repeated.
        assert_eq!(received(&[(54.0, false), (54.0, true), (54.1, true), (54.1, true), (54.2, true)]), [2, 4]);
        // The next file: reckoned under water, and the last position again before there is a new one.
        assert_eq!(received(&[(54.3, false), (54.4, false), (54.2, true), (54.2, true), (54.5, true)]), [4]);
        // A file that begins at the surface: its first position may be of any time.
        assert_eq!(received(&[(54.6, true), (54.6, true), (54.7, true)]), [2]);
    }

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
