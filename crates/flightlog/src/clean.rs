//! Mending a raw record: rows without time, doubled rows, clocks that ran back, spikes, channels sampled more rarely than
//! the rest. Whatever is changed is counted in [`Notes`].

use std::collections::BTreeMap;

use super::channels::{Channel, FlightLog};
use super::median;

/// What was found in a log and what was done about it: a sentence, and how often.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Notes {
    counts: BTreeMap<String, usize>,
}

impl Notes {
    /// Counts `n` more cases of what a sentence says.
    pub fn add(&mut self, sentence: &str, n: usize) {
        if n > 0 {
            *self.counts.entry(sentence.to_owned()).or_insert(0) += n;
        }
    }

    /// Takes over the notes of another piece.
    pub fn merge(&mut self, other: &Notes) {
        for (sentence, n) in &other.counts {
            self.add(sentence, *n);
        }
    }

    /// All notes as text, `3 rows without time, left out`; each begins with its noun, in the plural.
    pub fn sentences(&self) -> Vec<String> {
        let counted = |(sentence, n): (&String, &usize)| match sentence.split_once("s ").filter(|_| *n == 1) {
            Some((noun, rest)) if !noun.contains(' ') => format!("1 {noun} {rest}"),
            _ => format!("{n} {sentence}"),
        };
        self.counts.iter().map(counted).collect()
    }
}

/// Largest pitch that there is, with a margin for noise \[rad\].
const MOST_PITCH_RAD: f64 = 1.6;

/// Deeper than the sea: its deepest place, 10 935 m, has 11 300 dbar \[dbar\].
const MOST_PRESSURE_DBAR: f64 = 11_400.0;

/// Deeper than the sea \[m\].
const MOST_DEPTH_M: f64 = 11_000.0;

/// Faster than any glider \[m/s\].
const MOST_SPEED_M_S: f64 = 5.0;

/// A density less 1000 kg/m3, as it is often written, of any water \[kg/m3\].
const LESS_1000_KG_M3: std::ops::RangeInclusive<f64> = 0.5..=100.0;

/// A density in g/cm3 of any water, from fresh and warm to salt under pressure \[g/cm3\].
const G_CM3: std::ops::RangeInclusive<f64> = 0.95..=1.1;

/// Values that look like another unit than that of their column: such values are taken out, and what is left cannot show it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct OtherUnits {
    pitch: Share,
    density: Share,
    density_g_cm3: Share,
    depth: Share,
    speed: Share,
}

/// How many of the values read are of a kind.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Share {
    read: usize,
    of_the_kind: usize,
}

impl OtherUnits {
    /// Counts the values of one more piece.
    pub(super) fn count(&mut self, log: &FlightLog) {
        self.pitch.count(log.column(Channel::Pitch), |pitch| pitch.abs() > MOST_PITCH_RAD);
        let is_g_cm3 = |density: f64| G_CM3.contains(&density);
        let density = log.column(Channel::Density);
        self.density.count(density, |density| LESS_1000_KG_M3.contains(&density) && !is_g_cm3(density));
        self.density_g_cm3.count(density, is_g_cm3);
        self.depth.count(log.column(Channel::Pressure), |pressure| pressure > MOST_PRESSURE_DBAR);
        self.depth.count(log.column(Channel::Depth), |depth| depth > MOST_DEPTH_M);
        self.speed.count(log.column(Channel::Speed), |speed| speed > MOST_SPEED_M_S);
    }

    /// The share of the pressures and depths that no sea has.
    pub(super) fn depth_beyond(&self) -> f64 {
        self.depth.share()
    }

    /// The share of the measured speeds that no glider has.
    pub(super) fn speed_beyond(&self) -> f64 {
        self.speed.share()
    }

    /// The share of the pitch angles beyond 90 deg.
    pub(super) fn pitch_beyond(&self) -> f64 {
        self.pitch.share()
    }

    /// The share of the densities that are in g/cm3.
    pub(super) fn density_g_cm3(&self) -> f64 {
        self.density_g_cm3.share()
    }

    /// The share of the densities that are less 1000 kg/m3.
    pub(super) fn density_less_1000(&self) -> f64 {
        self.density.share()
    }
}

impl Share {
    /// Counts the steps of a clock and how many of them go back.
    pub(super) fn count_backward_steps(&mut self, time_s: &[f64]) {
        let mut last_s = None;
        for &time_s in time_s.iter().filter(|time_s| time_s.is_finite()) {
            if let Some(last_s) = last_s.replace(time_s) {
                self.read += 1;
                self.of_the_kind += usize::from(time_s < last_s);
            }
        }
    }

    fn count(&mut self, values: &[f64], is_of_the_kind: impl Fn(f64) -> bool) {
        for &value in values.iter().filter(|value| value.is_finite()) {
            self.read += 1;
            self.of_the_kind += usize::from(is_of_the_kind(value));
        }
    }

    pub(super) fn share(&self) -> f64 {
        self.of_the_kind as f64 / self.read.max(1) as f64
    }
}

/// Largest conductivity of a sea \[S/m\]: 60 g/kg at 35 degC have 9.
pub(super) const MOST_S_M: f64 = 10.0;

/// A conductivity beyond what a sea has is in mS/cm, whatever the name of its column says.
pub(super) fn conductivity_in_s_m(log: &mut FlightLog, notes: &mut Notes) {
    let mut known: Vec<f64> =
        log.column(Channel::Conductivity).iter().copied().filter(|value| value.is_finite()).collect();
    if known.is_empty() || median(&mut known) <= MOST_S_M {
        return;
    }
    log.column_mut(Channel::Conductivity).iter_mut().for_each(|value| *value *= 0.1);
    notes.add("conductivities beyond 10 S/m, which no sea has: taken as mS/cm", known.len());
}

/// A clock that runs back for more rows than this was set, not disturbed.
const SET_CLOCK_ROWS: usize = 5;

/// Mends the order of time: rows without time and doubled rows go, a clock that was set back is carried on.
///
/// `last_time_s` is the time of the row before this piece, NaN where there is none.
pub(super) fn order(log: &mut FlightLog, last_time_s: f64, notes: &mut Notes) {
    let keep: Vec<bool> = log.column(Channel::Time).iter().map(|t| t.is_finite()).collect();
    notes.add("rows without time, left out", keep.iter().filter(|&&keep| !keep).count());
    log.retain(&keep);

    let time = log.column(Channel::Time).to_vec();
    let step = median_step(&time);
    let mut keep = vec![true; time.len()];
    let mut corrected = time.clone();
    let (mut last, mut shift) = (last_time_s, 0.0);
    let mut i = 0;
    while i < time.len() {
        let t = time[i] + shift;
        if last.is_nan() || t > last {
            (corrected[i], last) = (t, t);
            i += 1;
            continue;
        }
        if t == last {
            notes.add("rows with the time of the row before, left out", 1);
            keep[i] = false;
            i += 1;
            continue;
        }
        let back = time[i..].iter().take(SET_CLOCK_ROWS + 1).take_while(|&&later| later + shift <= last).count();
        if back > SET_CLOCK_ROWS {
            // The seconds that passed meanwhile are not known: one sampling interval is put between.
            // Steps of a damaged clock may be too small to be seen beside its time.
            last = (last + step).max(last.next_up());
            corrected[i] = last;
            shift = last - time[i];
            i += 1;
            notes.add("times at which the clock was set back, carried on from the row before", 1);
        } else {
            notes.add("rows with a clock that ran back, left out", back);
            keep[i..i + back].fill(false);
            i += back;
        }
    }
    log.set(Channel::Time, corrected);
    log.retain(&keep);
}

/// Takes out spikes: single values, or two in a row, that stand apart from the median of their neighbours by far more
/// than the neighbours do from each other.
pub(super) fn despike(log: &mut FlightLog, notes: &mut Notes) {
    for (channel, least, name) in [
        (Channel::Pressure, 2.0, "spikes of pressure, taken out"),
        (Channel::Depth, 2.0, "spikes of depth, taken out"),
        (Channel::Pitch, 0.15, "spikes of pitch, taken out"),
        (Channel::Ballast, 40.0, "spikes of ballast volume, taken out"),
        (Channel::Temperature, 1.0, "spikes of temperature, taken out"),
        (Channel::Salinity, 1.0, "spikes of salinity, taken out"),
        (Channel::Density, 1.0, "spikes of density, taken out"),
        (Channel::Speed, 0.3, "spikes of measured speed, taken out"),
    ] {
        if log.column(channel).is_empty() {
            continue;
        }
        notes.add(name, despike_column(log.column_mut(channel), least));
    }
    for (channel, low, high, name) in [
        (Channel::Pitch, -MOST_PITCH_RAD, MOST_PITCH_RAD, "values of pitch beyond 90 deg, taken out"),
        (Channel::Pressure, -20.0, MOST_PRESSURE_DBAR, "values of pressure that no sea has, taken out"),
        (Channel::Depth, -MOST_DEPTH_M, MOST_DEPTH_M, "values of depth that no sea has, taken out"),
        (Channel::Density, 900.0, 1300.0, "values of density that no sea has, taken out"),
        (Channel::Temperature, -5.0, 50.0, "values of temperature that no sea has, taken out"),
        (Channel::Salinity, 0.0, 50.0, "values of salinity that no sea has, taken out"),
        (Channel::Speed, 0.0, MOST_SPEED_M_S, "values of measured speed that no glider has, taken out"),
    ] {
        if log.column(channel).is_empty() {
            continue;
        }
        let mut n = 0;
        for value in log.column_mut(channel) {
            if value.is_finite() && !(low..=high).contains(value) {
                *value = f64::NAN;
                n += 1;
            }
        }
        notes.add(name, n);
    }
}

/// Sets spikes to NaN and says how many there were. The median is over seven values, the yardstick their median
/// distance from it, and never below `least`.
fn despike_column(values: &mut [f64], least: f64) -> usize {
    const HALF: usize = 3;
    const TIMES: f64 = 8.0;
    let original = values.to_vec();
    let mut window = [0.0; 2 * HALF + 1];
    let mut n = 0;
    for i in 0..original.len() {
        if !original[i].is_finite() {
            continue;
        }
        let around = &original[i.saturating_sub(HALF)..(i + HALF + 1).min(original.len())];
        let mut count = 0;
        for &value in around.iter().filter(|value| value.is_finite()) {
            window[count] = value;
            count += 1;
        }
        if count < 4 {
            continue;
        }
        let center = median(&mut window[..count]);
        let mut distances = [0.0; 2 * HALF + 1];
        for (distance, value) in distances.iter_mut().zip(&window[..count]) {
            *distance = (value - center).abs();
        }
        let scale = median(&mut distances[..count]);
        if (original[i] - center).abs() > (TIMES * scale).max(least) {
            values[i] = f64::NAN;
            n += 1;
        }
    }
    n
}

/// Fills what is missing in a column by straight lines in time, over gaps of at most `longest_s`.
pub(super) fn fill(time_s: &[f64], values: &mut [f64], longest_s: f64) {
    let mut last: Option<usize> = None;
    for i in 0..values.len() {
        if !values[i].is_finite() {
            continue;
        }
        if let Some(l) = last.filter(|&l| i > l + 1 && time_s[i] - time_s[l] <= longest_s) {
            let slope = (values[i] - values[l]) / (time_s[i] - time_s[l]);
            for j in l + 1..i {
                values[j] = values[l] + slope * (time_s[j] - time_s[l]);
            }
        }
        last = Some(i);
    }
}

/// As [`fill`], for angles that turn over.
pub(super) fn fill_angle(time_s: &[f64], values: &mut [f64], longest_s: f64) {
    let turn = std::f64::consts::TAU;
    let mut last = f64::NAN;
    for value in values.iter_mut().filter(|value| value.is_finite()) {
        if last.is_finite() {
            *value -= ((*value - last) / turn).round() * turn;
        }
        last = *value;
    }
    fill(time_s, values, longest_s);
    for value in values.iter_mut() {
        *value = value.rem_euclid(turn);
    }
}

/// The median time between two rows; 1 s where there are none.
pub(super) fn median_step(time_s: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).filter(|&dt| dt > 0.0).collect();
    if steps.is_empty() { 1.0 } else { median(&mut steps) }
}
