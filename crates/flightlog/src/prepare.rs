//! From raw pieces of a log to observations: corrected, with in-situ density, vertical velocity and legs.
//!
//! Pieces are cut at turning points: what follows the last one waits for the next piece, so that a log of any length
//! passes through a bounded memory.

use super::channels::{Channel, FlightLog};
use super::clean::{Notes, OtherUnits, Share, conductivity_in_s_m, despike, fill, fill_angle, median_step, order};
use super::density::{densities_kg_m3, practical_salinity};
use super::motors::motors;
use super::observation::{DBAR_PA, Observation};
use super::on_change::{hold, is_recorded_on_change};
use super::pressure::{Pressures, SEA_WATER_KG_M3};
use super::segment::{Leg, legs};
use super::settings::PreparationSettings;
use super::vertical_velocity::vertical_velocity;

/// So near to the usual pitch of the first minutes of its leg a glider has turned into it, and so far from its steepest of the last
/// moments it turns out of it \[rad\].
const PITCHED_WITHIN_RAD: f64 = 0.05;

/// These first minutes \[s\]: turning takes one or two of them.
const FIRST_MINUTES_S: f64 = 300.0;

/// More samples than this wait for a turning point at most; a stretch without any is cut there.
const LONGEST_WAIT: usize = 500_000;

/// The result for one piece.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Prepared {
    /// Samples, in the order of time.
    pub observations: Vec<Observation>,
}

/// A preparation under way.
#[derive(Debug, Clone)]
pub struct Preparation {
    settings: PreparationSettings,
    notes: Notes,
    waiting: FlightLog,
    first_time_s: f64,
    last_time_s: f64,
    noise_dbar: Vec<f64>,
    other_units: OtherUnits,
    backward_steps: Share,
    counters: Counters,
    turns_only: Vec<Observation>,
    holds_ballast: bool,
    last_ballast_cc: f64,
}

#[derive(Debug, Clone, Copy, Default)]
struct Counters {
    leg: u32,
    dive: u32,
    stretch: u32,
    dive_name: Option<i64>,
    last_descends: Option<bool>,
}

impl Preparation {
    /// Starts one.
    pub fn new(settings: PreparationSettings) -> Self {
        Preparation {
            settings,
            notes: Notes::default(),
            waiting: FlightLog::default(),
            first_time_s: f64::NAN,
            last_time_s: f64::NAN,
            noise_dbar: Vec::new(),
            other_units: OtherUnits::default(),
            backward_steps: Share::default(),
            counters: Counters::default(),
            turns_only: Vec::new(),
            holds_ballast: false,
            last_ballast_cc: f64::NAN,
        }
    }

    /// Takes another acceleration of gravity from now on \[m/s2\].
    pub fn set_gravity(&mut self, gravity_m_s2: f64) {
        self.settings.gravity_m_s2 = gravity_m_s2;
    }

    /// What was found in the log and done about it so far.
    pub fn notes(&self) -> &Notes {
        &self.notes
    }

    /// Noise of one sample of pressure, the median over the stretches \[dbar\].
    pub fn pressure_noise_dbar(&self) -> f64 {
        let mut noise = self.noise_dbar.clone();
        if noise.is_empty() { f64::NAN } else { super::median(&mut noise) }
    }

    /// Share of the pitch angles read so far that lie beyond 90 deg and were taken out: a few are damage, most of them are
    /// in another unit than radians.
    pub fn share_of_pitch_beyond(&self) -> f64 {
        self.other_units.pitch_beyond()
    }

    /// Share of the densities read so far that look like g/cm3 and were taken out.
    pub fn share_of_density_in_g_cm3(&self) -> f64 {
        self.other_units.density_g_cm3()
    }

    /// Share of the densities read so far that look like a density less 1000 kg/m3 and were taken out.
    pub fn share_of_density_less_1000(&self) -> f64 {
        self.other_units.density_less_1000()
    }

    /// Share of the pressures and depths read so far that no sea has and that were taken out.
    pub fn share_of_depth_beyond(&self) -> f64 {
        self.other_units.depth_beyond()
    }

    /// Share of the measured speeds read so far that no glider has and that were taken out.
    pub fn share_of_speed_beyond(&self) -> f64 {
        self.other_units.speed_beyond()
    }

    /// Returns the share of the rows read so far before which the time goes back. A few are a clock that was set; many are rows that are
    /// not sorted by time.
    pub fn share_of_backward_steps(&self) -> f64 {
        self.backward_steps.share()
    }

    /// The filter for the vertical velocity in a sentence.
    pub fn filter(&self) -> String {
        format!(
            "slope of the least-squares line through the pressure within +-{} s of each sample (one sample on each side at least), over the in-situ density and g = {:.4} m/s2",
            self.settings.half_window_s, self.settings.gravity_m_s2
        )
    }

    /// Takes the next piece; what is finished of it is added to `out`.
    pub fn push(&mut self, mut piece: FlightLog, out: &mut Vec<Observation>) {
        self.backward_steps.count_backward_steps(piece.column(Channel::Time));
        order(&mut piece, self.last_time_s, &mut self.notes);
        if piece.is_empty() {
            return;
        }
        self.other_units.count(&piece);
        conductivity_in_s_m(&mut piece, &mut self.notes);
        despike(&mut piece, &mut self.notes);
        let time = piece.column(Channel::Time);
        self.last_time_s = time[time.len() - 1];
        if self.first_time_s.is_nan() {
            self.first_time_s = time[0];
        }
        self.waiting.append(&piece);
        let cut = self.last_turn();
        self.process(cut, out);
    }

    /// The samples since the last call that have heading and pitch but not all that the forces need, density or ballast
    /// volume: they show how the glider turned and nothing else. Never steady; their sink speed is that of ordinary sea water.
    pub fn take_turns_only(&mut self) -> Vec<Observation> {
        std::mem::take(&mut self.turns_only)
    }

    /// Ends the log.
    pub fn finish(&mut self, out: &mut Vec<Observation>) {
        let rest = self.waiting.len();
        self.process(rest, out);
    }

    /// Up to where the waiting samples can be worked on: the last turning point but the very last leg.
    fn last_turn(&self) -> usize {
        let n = self.waiting.len();
        let breaks = self.breaks(&self.waiting);
        let start = breaks.last().copied().unwrap_or(0);
        let pressure = Pressures::new(&self.waiting, &self.settings).dbar;
        let (rows, known) = known(&pressure[start..]);
        match legs(&known, self.settings.least_leg_dbar).last() {
            Some(last) if last.first > 0 => start + rows[last.first],
            _ if start > 0 => start,
            _ if n > LONGEST_WAIT => n,
            _ => 0,
        }
    }

    /// Rows at which a new stretch begins, the first row not among them.
    fn breaks(&self, log: &FlightLog) -> Vec<usize> {
        let time = log.column(Channel::Time);
        let longest = self.settings.longest_gap_s.max(10.0 * median_step(time));
        (1..time.len()).filter(|&i| time[i] - time[i - 1] > longest).collect()
    }

    fn process(&mut self, rows: usize, out: &mut Vec<Observation>) {
        if rows == 0 {
            return;
        }
        let rest = self.waiting.part(rows..self.waiting.len());
        let mut log = std::mem::replace(&mut self.waiting, rest);
        log.truncate(rows);

        let breaks = self.breaks(&log);
        self.notes.add("gaps in the record, the legs cut there", breaks.len());
        let bounds: Vec<usize> = std::iter::once(0).chain(breaks).chain([log.len()]).collect();
        for pair in bounds.windows(2) {
            self.stretch(log.part(pair[0]..pair[1]), out);
        }
    }

    /// One unbroken stretch of samples.
    fn stretch(&mut self, mut log: FlightLog, out: &mut Vec<Observation>) {
        let s = self.settings.clone();
        let Pressures { dbar: pressure, by_depth_kg_m3 } = Pressures::new(&log, &s);
        let keep: Vec<bool> = pressure.iter().map(|p| p.is_finite()).collect();
        speeds_to_rows(&mut log, &keep);
        self.notes.add("rows without pressure, left out", keep.iter().filter(|&&keep| !keep).count());
        log.set(Channel::Pressure, pressure);
        // Before rows without pressure go: another computer's rows may be those with the pitch.
        self.fill_slow_channels(&mut log);
        log.retain(&keep);
        if log.len() < 5 {
            return;
        }
        let has_temperature = self.has_temperature(&mut log);
        let water = teos10(&log);
        let density = density_kg_m3(&log, &water, &s);
        if let Some(given) = s.density_kg_m3.filter(|given| density.iter().all(|density| density == given)) {
            let of_record = "parts of the record without a density, or temperature with salinity or conductivity";
            self.notes.add(&format!("{of_record}: {given} kg/m3 assumed at all depths, as given by --density"), 1);
        }
        let pressure = log.column(Channel::Pressure);
        let time = log.column(Channel::Time);
        let velocity = vertical_velocity(time, pressure, s.half_window_s);
        self.noise_dbar.push(velocity.noise_dbar);
        let met = water_met_m_s2(&log);
        let moving = motors(&log, &s);
        let legs = legs(pressure, s.least_leg_dbar);
        let stretch = self.counters.stretch;
        self.counters.stretch += 1;

        let (mut dropped, turns_before) = (0, self.turns_only.len());
        let mut without_temperature = 0;
        let on_legs: usize = legs.iter().map(|leg| leg.end - leg.first).sum();
        let with_motors =
            legs.iter().map(|leg| moving[leg.first..leg.end].iter().filter(|m| **m).count()).sum::<usize>();
        if 2 * with_motors > on_legs {
            self.notes.add(
                "rows left out because a motor moved or had just moved, more than half of their stretch",
                with_motors,
            );
        }
        for leg in &legs {
            self.counters.open_leg(leg.descends, &log, leg.first);
            let (start_s, end_s) = pitched_between_s(&log, leg, &s);
            let first = if leg.first == 0 { 0 } else { leg.first + 1 };
            for i in first..leg.end {
                // Without a density: for which way the glider goes, not for how fast.
                let here_kg_m3 = if density[i].is_finite() { density[i] } else { SEA_WATER_KG_M3 };
                let per_dbar = DBAR_PA / (by_depth_kg_m3.unwrap_or(here_kg_m3) * s.gravity_m_s2);
                let ballast_cc = log.at(Channel::Ballast, i);
                let pitch_rad = log.at(Channel::Pitch, i);
                let sink_m_s = velocity.rate_dbar_s[i] * per_dbar;
                let is_usable = [ballast_cc, pitch_rad, sink_m_s, density[i]].iter().all(|value| value.is_finite());
                if !is_usable {
                    dropped += 1;
                    if [pitch_rad, sink_m_s, log.at(Channel::Heading, i)].iter().any(|value| !value.is_finite()) {
                        continue;
                    }
                }
                let under_way = (pitch_rad < 0.0) == leg.descends && (sink_m_s > 0.0) == leg.descends;
                let is_clear = time[i] - start_s >= s.after_turn_s && end_s - time[i] >= s.before_turn_s;
                let temperature_C = log.at(Channel::Temperature, i);
                without_temperature += usize::from(is_usable && !has_temperature[i]);
                let battery = log.at(Channel::BatteryPosition, i);
                // A Seaglider counts its pitch mass positive nose up, that is aft.
                let battery_forward_m = if battery.is_finite() { battery } else { -log.at(Channel::PitchMass, i) };
                let observation = Observation {
                    time_s: time[i] - self.first_time_s,
                    pressure_dbar: pressure[i],
                    pressure_rate_dbar_s: velocity.rate_dbar_s[i],
                    temperature_C,
                    density_kg_m3: density[i],
                    teos10_density_kg_m3: water[i][0],
                    teos10_surface_density_kg_m3: water[i][1],
                    pitch_rad,
                    roll_rad: log.at(Channel::Roll, i),
                    rudder_rad: log.at(Channel::Rudder, i),
                    roll_mass_rad: log.at(Channel::RollMass, i),
                    heading_rad: log.at(Channel::Heading, i),
                    ballast_m3: ballast_cc * 1e-6,
                    battery_forward_m,
                    sink_m_s,
                    sink_se_m_s: velocity.se_dbar_s[i] * per_dbar,
                    sink_window_s: velocity.window_s[i].map(|seconds| seconds as f32),
                    sink_rate_m_s2: velocity.acceleration_dbar_s2[i] * per_dbar,
                    speed_m_s: log.at(Channel::Speed, i),
                    water_met_m_s2: met[i],
                    leg: self.counters.leg,
                    dive: self.counters.dive,
                    stretch,
                    motor_moving: log.at(Channel::MotorMoving, i) > 0.5,
                    since_move_s: log.at(Channel::SinceMove, i),
                    steady: is_usable
                        && has_temperature[i]
                        && under_way
                        && is_clear
                        && !moving[i]
                        && pressure[i] > s.surface_dbar,
                };
                if is_usable { &mut *out } else { &mut self.turns_only }.push(observation);
            }
            self.counters.leg += 1;
        }
        self.notes.add("rows on a leg without pitch, ballast volume, density or vertical velocity, left out", dropped);
        self.notes.add(
            "rows without temperature, of a hull that expands with it: not compared with a steady glide",
            without_temperature,
        );
        let turns = self.turns_only.len() - turns_before;
        self.notes.add("of these rows, with heading and pitch: used for turn rates alone", turns);
    }

    /// In which rows the temperature that a hull feels is known. In a stretch without any the vehicle's reference stands for it; in a
    /// single row the reference would be off by all of the difference. What lies between known ones is drawn straight, so that the speed
    /// can be followed through it.
    fn has_temperature(&self, log: &mut FlightLog) -> Vec<bool> {
        let is_known: Vec<bool> = log.column(Channel::Temperature).iter().map(|value| value.is_finite()).collect();
        if !self.settings.needs_temperature || !is_known.contains(&true) {
            return vec![true; log.len()];
        }
        let time = log.column(Channel::Time).to_vec();
        fill(&time, log.column_mut(Channel::Temperature), f64::INFINITY);
        is_known
    }

    fn fill_slow_channels(&mut self, log: &mut FlightLog) {
        let time = log.column(Channel::Time).to_vec();
        let longest = self.settings.longest_fill_s.max(4.0 * median_step(&time));
        // Once shown it holds for the whole log: a short stretch has too few values to show it again.
        self.holds_ballast |= is_recorded_on_change(&time, log.column(Channel::Ballast), longest);
        if self.holds_ballast {
            self.notes.add("stretches whose ballast volume was recorded when it changed: its last value stands", 1);
            hold(log.column_mut(Channel::Ballast), &mut self.last_ballast_cc);
        } else if let Some(last) = log.column(Channel::Ballast).iter().rfind(|value| value.is_finite()) {
            self.last_ballast_cc = *last;
        }
        for channel in [
            Channel::Pitch,
            Channel::Ballast,
            Channel::Density,
            Channel::Temperature,
            Channel::Salinity,
            Channel::Conductivity,
            Channel::Roll,
            Channel::RollMass,
            Channel::Rudder,
            Channel::BatteryPosition,
            Channel::PitchMass,
            Channel::CurrentEast,
            Channel::CurrentNorth,
        ] {
            if !log.column(channel).is_empty() {
                fill(&time, log.column_mut(channel), longest);
            }
        }
        if !log.column(Channel::Heading).is_empty() {
            fill_angle(&time, log.column_mut(Channel::Heading), longest);
        }
    }
}

impl Counters {
    /// A descent opens a dive, and so does an ascent that follows an ascent; where the log numbers its dives, it is
    /// believed.
    fn open_leg(&mut self, descends: bool, log: &FlightLog, row: usize) {
        let number = log.at(Channel::Dive, (row + 1).min(log.len() - 1));
        if number.is_finite() {
            let name = Some(number as i64);
            if self.dive_name.is_some() && self.dive_name != name {
                self.dive += 1;
            }
            self.dive_name = name;
        } else if self.last_descends.is_some_and(|last| descends || !last) {
            self.dive += 1;
        }
        self.last_descends = Some(descends);
    }
}

/// Half window over which the change of the current is taken \[s\]: profiles of currents come in layers of some metres, which
/// a glider takes half a minute to pass.
const CURRENT_HALF_WINDOW_S: f64 = 15.0;

/// How fast the water velocity along the heading changes along the path; NaN where the log has no current.
fn water_met_m_s2(log: &FlightLog) -> Vec<f64> {
    if !(log.has(Channel::CurrentEast) && log.has(Channel::CurrentNorth) && log.has(Channel::Heading)) {
        return vec![f64::NAN; log.len()];
    }
    let rate =
        |channel| vertical_velocity(log.column(Channel::Time), log.column(channel), CURRENT_HALF_WINDOW_S).rate_dbar_s;
    let (east, north) = (rate(Channel::CurrentEast), rate(Channel::CurrentNorth));
    let along = |i: usize| {
        let (sin, cos) = log.at(Channel::Heading, i).sin_cos();
        east[i] * sin + north[i] * cos
    };
    (0..log.len()).map(along).collect()
}

/// The rows with a pressure, and their pressures.
fn known(pressure: &[f64]) -> (Vec<usize>, Vec<f64>) {
    pressure.iter().enumerate().filter(|(_, p)| p.is_finite()).map(|(i, &p)| (i, p)).unzip()
}

/// Takes speeds on rows that are left out, as those of a sensor with a clock of its own, to the nearest row that is kept and
/// has none, within a sampling interval: the model's speed is no other there.
fn speeds_to_rows(log: &mut FlightLog, keep: &[bool]) {
    if log.column(Channel::Speed).is_empty() || keep.iter().all(|&keep| keep) {
        return;
    }
    let kept: Vec<usize> = (0..keep.len()).filter(|&i| keep[i]).collect();
    let time = log.column(Channel::Time).to_vec();
    let reach_s = median_step(&kept.iter().map(|&i| time[i]).collect::<Vec<_>>());
    let speeds = log.column_mut(Channel::Speed);
    for i in (0..keep.len()).filter(|&i| !keep[i]) {
        if !speeds[i].is_finite() {
            continue;
        }
        let after = kept.partition_point(|&row| row < i);
        let near = kept[after.saturating_sub(1)..(after + 1).min(kept.len())].iter().copied();
        let free = near.filter(|&row| speeds[row].is_nan() && (time[row] - time[i]).abs() <= reach_s);
        if let Some(row) = free.min_by(|&a, &b| (time[a] - time[i]).abs().total_cmp(&(time[b] - time[i]).abs())) {
            speeds[row] = speeds[i];
        }
    }
}

/// Density by TEOS-10 in each row, in situ and at p = 0; NaN where the water was not measured.
fn teos10(log: &FlightLog) -> Vec<[f64; 2]> {
    let mut position = (f64::NAN, f64::NAN);
    (0..log.len())
        .map(|i| {
            let (latitude, longitude) = (log.at(Channel::Latitude, i), log.at(Channel::Longitude, i));
            if latitude.is_finite() && longitude.is_finite() {
                position = (latitude, longitude);
            }
            let (temperature, pressure) = (log.at(Channel::Temperature, i), log.at(Channel::Pressure, i));
            let salinity = log.at(Channel::Salinity, i);
            let salinity = if salinity.is_finite() {
                salinity
            } else {
                practical_salinity(log.at(Channel::Conductivity, i), temperature, pressure)
            };
            densities_kg_m3(salinity, temperature, pressure, position.0, position.1)
        })
        .collect()
}

/// In-situ density: as recorded, or by TEOS-10, or as the user gave it.
fn density_kg_m3(log: &FlightLog, teos10: &[[f64; 2]], settings: &PreparationSettings) -> Vec<f64> {
    let recorded = |i| log.at(Channel::Density, i);
    let mut density: Vec<f64> =
        (0..log.len()).map(|i| if recorded(i).is_finite() { recorded(i) } else { teos10[i][0] }).collect();
    if let Some(given) = settings.density_kg_m3.filter(|_| density.iter().all(|value| !value.is_finite())) {
        density.fill(given);
    }
    fill(log.column(Channel::Time), &mut density, settings.longest_fill_s);
    density
}

/// Between when a glider is pitched as it is on a leg \[s\]: when it has turned into the leg, with the pitch of its first minutes,
/// and when it begins to turn out of it. It may do so before its ballast or its depth turns, and may have changed its pitch on the way.
fn pitched_between_s(log: &FlightLog, leg: &Leg, s: &PreparationSettings) -> (f64, f64) {
    let (time, pitch) = (log.column(Channel::Time), |i: usize| log.at(Channel::Pitch, i));
    // What lies at the surface is no part of a glide.
    let is_below = |i: &usize| log.at(Channel::Pressure, *i) > s.surface_dbar;
    let first = (leg.first..leg.end).find(is_below).unwrap_or(leg.first);
    // No more than the first minutes: a pitch that drifts along the leg is another at its end, and steady all the same.
    let end = first + time[first..leg.end].partition_point(|t| *t <= time[first] + FIRST_MINUTES_S);
    let mut known: Vec<f64> = (first..end).map(pitch).filter(|pitch| pitch.is_finite()).collect();
    let median_pitch = if known.is_empty() { f64::NAN } else { super::median(&mut known) };
    let turned = (leg.first..end).find(|&i| (pitch(i) - median_pitch).abs() <= PITCHED_WITHIN_RAD);

    // Back from where the pitch has turned over to the steepest of the time that a turn takes.
    let steepness = |i: usize| if leg.descends { -pitch(i) } else { pitch(i) };
    let last = (leg.first..leg.end).rfind(is_below).unwrap_or(leg.end - 1);
    let over = (leg.first..=last).rfind(|&i| steepness(i) > 0.0).unwrap_or(last);
    let begin = leg.first + time[leg.first..=over].partition_point(|t| *t < time[over] - s.after_turn_s);
    let steepest = (begin..=over).map(steepness).fold(f64::NAN, f64::max);
    let held = (begin..=over).rfind(|&i| steepness(i) >= steepest - PITCHED_WITHIN_RAD).unwrap_or(last);
    // A leg that ends before its glider turns is cut there, whatever lies behind it.
    (time[turned.unwrap_or(leg.first)], if held == last { time[leg.end - 1] } else { time[held] })
}
