//! The tables from which `plan` calibrates: strokes of the pump, and battery counters dive by dive.

use std::path::Path;

use super::table::for_each_row;
use crate::input::{InputError, Place};
use crate::plan::calibrate::{DiveCount, Stroke};

/// Gauge pressure per depth of sea water, 1030 kg/m3 on the mean \[dbar/m\]; within 1 % down to 2000 m.
const DBAR_PER_M: f64 = 1030.0 * 9.81 * 1e-4;

/// Strokes smaller than this drown in the count of the potentiometer \[cm3\].
const SMALLEST_STROKE_CC: f64 = 1.0;

/// Counters dive by dive.
pub(super) struct Dives {
    /// What each dive drew.
    pub dives: Vec<DiveCount>,
    /// Volume of one count of the ballast potentiometer \[cm3\].
    pub cc_per_count: f64,
    /// Rows that lack a value.
    pub incomplete: usize,
}

/// Charge of a dive is the difference of the running counts to the dive before it: the first dive of an unbroken series
/// gives none.
pub(super) fn read_dives(file: &Path) -> Result<Dives, InputError> {
    const COLUMNS: [&str; 7] =
        ["dive", "duration_s", "VBD_CNV_cc_per_count", "ah24_cum_Ah", "ah24_min_V", "ah10_cum_Ah", "ah10_min_V"];
    let mut dives: Vec<DiveCount> = Vec::new();
    let mut before: Option<[f64; 7]> = None;
    let (mut cc_per_count, mut incomplete) = (None, 0);
    for_each_row(file, COLUMNS, |_, row| {
        if row.iter().any(|value| value.is_nan()) {
            incomplete += 1;
            return;
        }
        let [dive, duration_s, count, ah24, v24, ah10, v10] = row;
        cc_per_count.get_or_insert(count.abs());
        if let Some([_, _, _, ah24_before, _, ah10_before, _]) = before.filter(|before| before[0] + 1.0 == dive) {
            let (high, low) = (ah24 - ah24_before, ah10 - ah10_before);
            dives.push(DiveCount {
                dive: dive as u32,
                duration_s,
                charge_Ah: high + low,
                energy_J: (high * v24 + low * v10) * 3600.0,
            });
        }
        before = Some(row);
    })?;
    let cc_per_count = cc_per_count.ok_or_else(|| InputError::new(Place::file(file), "the table has no rows"))?;
    Ok(Dives { dives, cc_per_count, incomplete })
}

/// Rows in which the pump ran outward (`vbd_secs` above zero), and how many lack a value.
pub(super) fn read_strokes(file: &Path, cc_per_count: f64) -> Result<(Vec<Stroke>, usize), InputError> {
    const COLUMNS: [&str; 7] = ["dive", "depth_m", "vbd_ad_start", "vbd_ad_end", "vbd_secs", "vbd_A", "vbd_V"];
    let (mut strokes, mut incomplete) = (Vec::new(), 0);
    for_each_row(file, COLUMNS, |_, row| {
        let [dive, depth_m, start, end, seconds, ampere, volt] = row;
        incomplete += usize::from(row.iter().any(|value| value.is_nan()));
        let volume_cc = (start - end) * cc_per_count;
        let energy_J = seconds * ampere * volt;
        if seconds > 0.0 && volume_cc >= SMALLEST_STROKE_CC && (energy_J + depth_m + dive).is_finite() {
            strokes.push(Stroke { dive: dive as u32, pressure_dbar: depth_m * DBAR_PER_M, volume_cc, energy_J });
        }
    })?;
    Ok((strokes, incomplete))
}
