//! The pressure of each row of a stretch: as it was measured, or by the depth where the log has that alone. Knows nothing of
//! velocities or legs.
//!
//! A depth stands for `p = rho g z` with one density for all rows. With that of each row the pressure would jump between rows with and
//! without a density by 0.3 % of itself, which at 300 m and 4 s a row is 0.2 m/s. Where a stretch has pressures, a depth
//! between them is left out, as another sensor's: it stands in only where the pressure fails for longer than channels are filled,
//! by the ratio of the two and their offset at both ends.

use super::channels::{Channel, FlightLog};
use super::clean::{fill, median_step};
use super::observation::DBAR_PA;
use super::settings::PreparationSettings;

/// Sea water where the log has no density \[kg/m3\].
pub(super) const SEA_WATER_KG_M3: f64 = 1025.0;

/// Pressures of the rows of a stretch.
pub(super) struct Pressures {
    /// In each row, NaN where neither pressure nor depth is known \[dbar\].
    pub(super) dbar: Vec<f64>,
    /// The density with which depths were taken to pressures, where none was measured: with it the vertical velocity is that of the
    /// depth \[kg/m3\].
    pub(super) by_depth_kg_m3: Option<f64>,
}

impl Pressures {
    pub(super) fn new(log: &FlightLog, settings: &PreparationSettings) -> Pressures {
        let (pressure, depth) = (log.column(Channel::Pressure), log.column(Channel::Depth));
        let density_kg_m3 = settings.density_kg_m3.unwrap_or(SEA_WATER_KG_M3);
        let dbar_per_m = density_kg_m3 * settings.gravity_m_s2 / DBAR_PA;
        if pressure.iter().all(|pressure| !pressure.is_finite()) {
            let dbar = (0..log.len()).map(|i| log.at(Channel::Depth, i) * dbar_per_m).collect();
            return Pressures { dbar, by_depth_kg_m3: Some(density_kg_m3) };
        }
        let mut dbar = pressure.to_vec();
        if !depth.is_empty() {
            let time = log.column(Channel::Time);
            let depths = Depths::new(time, pressure, depth, dbar_per_m);
            let longest_s = settings.longest_fill_s.max(4.0 * median_step(time));
            for (before, after) in gaps(time, pressure, longest_s) {
                let first = before.map_or(0, |row| row + 1);
                for i in first..after.unwrap_or(log.len()) {
                    dbar[i] = depths.pressure_dbar(depth[i], [before, after], time[i]);
                }
            }
        }
        Pressures { dbar, by_depth_kg_m3: None }
    }
}

/// Stretches without a pressure that are longer than this: the rows with one before and after each.
fn gaps(time_s: &[f64], pressure: &[f64], longest_s: f64) -> Vec<(Option<usize>, Option<usize>)> {
    let known: Vec<usize> = (0..pressure.len()).filter(|&i| pressure[i].is_finite()).collect();
    let before = std::iter::once(None).chain(known.iter().copied().map(Some));
    let after = known.iter().copied().map(Some).chain([None]);
    let time_of = |row: Option<usize>, end: usize| time_s[row.unwrap_or(end)];
    let is_long = |(before, after): &(Option<usize>, Option<usize>)| {
        time_of(*after, time_s.len() - 1) - time_of(*before, 0) > longest_s
    };
    before.zip(after).filter(is_long).collect()
}

/// Pressures by the depth, along a stretch: the scale of the depths, and the offset between the two sensors where both are known.
struct Depths<'a> {
    time_s: &'a [f64],
    dbar_per_m: f64,
    /// Pressure less scaled depth in each row with a pressure, the depth being drawn straight between its own rows; NaN elsewhere \[dbar\].
    offset_dbar: Vec<f64>,
}

impl<'a> Depths<'a> {
    /// At this scale where no row has both.
    fn new(time_s: &'a [f64], pressure: &[f64], depth: &[f64], otherwise_dbar_per_m: f64) -> Self {
        let deepest = depth.iter().copied().fold(0.0, f64::max);
        let mut drawn = depth.to_vec();
        fill(time_s, &mut drawn, f64::INFINITY);
        // Near the surface a ratio is that of two zeros.
        let both = pressure.iter().zip(&drawn).filter(|(_, depth)| **depth > 0.5 * deepest);
        let mut ratios: Vec<f64> = both.map(|(p, z)| p / z).filter(|ratio| ratio.is_finite()).collect();
        let dbar_per_m = if ratios.is_empty() { otherwise_dbar_per_m } else { crate::median(&mut ratios) };
        let offset_dbar = pressure.iter().zip(&drawn).map(|(p, z)| p - z * dbar_per_m).collect();
        Depths { time_s, dbar_per_m, offset_dbar }
    }

    /// At a time between two rows: the offset goes straight from one to the other, so that the pressure has no step there.
    fn pressure_dbar(&self, depth: f64, [before, after]: [Option<usize>; 2], time_s: f64) -> f64 {
        let of = |row: usize| Some(self.offset_dbar[row]).filter(|offset| offset.is_finite());
        let offset = match (before.and_then(of).zip(before), after.and_then(of).zip(after)) {
            (Some((first, before)), Some((last, after))) => {
                let (from, to) = (self.time_s[before], self.time_s[after]);
                first + (last - first) * (time_s - from) / (to - from)
            }
            (Some((one, _)), None) | (None, Some((one, _))) => one,
            (None, None) => 0.0,
        };
        depth * self.dbar_per_m + offset
    }
}
