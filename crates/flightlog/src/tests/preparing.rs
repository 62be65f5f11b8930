//! From raw rows to observations, on saw-tooths whose every sample is known.

use rand::{RngExt, SeedableRng, rngs::StdRng};

use super::*;

pub(super) const SINK_DBAR_S: f64 = 0.2;

/// A saw-tooth of `yos` dives to 60 dbar at one sample a second, pitch and ballast turning with it.
pub(super) fn saw_tooth(yos: usize) -> FlightLog {
    let half = 300;
    let mut log = FlightLog::default();
    for i in 0..2 * half * yos {
        let phase = i % (2 * half);
        let (down, p) = if phase < half { (true, phase) } else { (false, 2 * half - phase) };
        log.push(&[
            (Channel::Time, i as f64),
            (Channel::Pressure, 1.0 + SINK_DBAR_S * p as f64),
            (Channel::Pitch, if down { -0.45 } else { 0.45 }),
            (Channel::Ballast, if down { -200.0 } else { 200.0 }),
            (Channel::Density, 1025.0),
        ]);
    }
    log
}

pub(super) fn prepared(log: FlightLog) -> (Vec<Observation>, Vec<String>) {
    let mut preparation = Preparation::new(PreparationSettings::default());
    let mut out = Vec::new();
    preparation.push(log, &mut out);
    preparation.finish(&mut out);
    (out, preparation.notes().sentences())
}

#[test]
fn legs_turn_where_the_pressure_turns_and_steady_samples_have_the_known_velocity() {
    let (found, notes) = prepared(saw_tooth(3));
    assert_eq!(found.iter().map(|o| o.leg).max(), Some(5));
    assert_eq!(found.iter().map(|o| o.dive).max(), Some(2));
    let steady: Vec<&Observation> = found.iter().filter(|o| o.steady).collect();
    // Of 300 s a leg, 90 s after the turn, 8 s before it and what lies above 5 dbar are no steady glide.
    assert!(steady.len() > 6 * 190 && steady.len() < 6 * 203, "{}", steady.len());
    let expected = SINK_DBAR_S * 1e4 / (1025.0 * 9.81);
    for o in steady {
        let sign = if o.pitch_rad < 0.0 { 1.0 } else { -1.0 };
        assert!((o.sink_m_s - sign * expected).abs() < 1e-9, "{o:?}");
    }
    // The filter has no velocity at the ends of what is worked on at once: all but the last leg, then that.
    assert_eq!(notes.len(), 1, "{notes:?}");
    assert!(notes[0].starts_with("4 rows on a leg without"), "{notes:?}");
}

#[test]
fn pieces_of_any_size_give_the_same_observations() {
    let whole = prepared(saw_tooth(4)).0;
    for rows in [50, 333, 1000] {
        let log = saw_tooth(4);
        let mut preparation = Preparation::new(PreparationSettings::default());
        let mut out = Vec::new();
        for first in (0..log.len()).step_by(rows) {
            preparation.push(log.part(first..log.len().min(first + rows)), &mut out);
        }
        preparation.finish(&mut out);
        // A cut leg loses the turning point to the next one, and with it a steady sample or two beside the turns.
        let steady = |all: &[Observation]| -> Vec<Observation> { all.iter().filter(|o| o.steady).copied().collect() };
        let (whole, pieces) = (steady(&whole), steady(&out));
        assert!(
            pieces.len().abs_diff(whole.len()) <= 16,
            "{} of {} in pieces of {rows} rows",
            pieces.len(),
            whole.len()
        );
        for b in &pieces {
            let Some(a) = whole.iter().find(|a| a.time_s == b.time_s) else { continue };
            assert_eq!((a.leg, a.dive, a.ballast_m3), (b.leg, b.dive, b.ballast_m3));
            assert!((a.sink_m_s - b.sink_m_s).abs() < 1e-12, "pieces of {rows} rows: {a:?} {b:?}");
        }
    }
}

#[test]
fn clocks_duplicates_and_rows_without_time_are_corrected_and_counted() {
    let mut log = saw_tooth(2);
    let time = log.column_mut(Channel::Time);
    time[100] = time[99];
    time[200] = f64::NAN;
    time[300] = 50.0;
    let rows = time.len();
    // Set back by an hour from row 700 on.
    time[700..].iter_mut().for_each(|t| *t -= 3600.0);
    let (found, notes) = prepared(log);
    assert!(found.windows(2).all(|pair| pair[1].time_s > pair[0].time_s));
    for expected in [
        "1 row with the time of the row before",
        "1 row without time",
        "1 row with a clock that ran back",
        "1 time at which the clock was set back",
    ] {
        assert!(notes.iter().any(|note| note.starts_with(expected)), "{expected}: {notes:?}");
    }
    assert!(found.len() > rows - 20);
}

#[test]
fn spikes_go_and_gaps_cut_a_leg() {
    let mut log = saw_tooth(2);
    log.column_mut(Channel::Pressure)[150] = 500.0;
    log.column_mut(Channel::Pitch)[151] = 1.2;
    let keep: Vec<bool> = (0..log.len()).map(|i| !(400..520).contains(&i)).collect();
    log.retain(&keep);
    let (found, notes) = prepared(log);
    assert!(found.iter().all(|o| o.pressure_dbar < 62.0 && o.pitch_rad.abs() < 0.5));
    assert!(notes.iter().any(|note| note == "1 spike of pressure, taken out"), "{notes:?}");
    assert!(notes.iter().any(|note| note == "1 spike of pitch, taken out"), "{notes:?}");
    assert!(notes.iter().any(|note| note.starts_with("1 gap in the record")), "{notes:?}");
    assert!(found.iter().map(|o| o.stretch).max() >= Some(1));
}

#[test]
fn values_in_another_unit_are_counted_before_they_are_taken_out() {
    let shares = |change: fn(usize, &mut FlightLog)| {
        let mut preparation = Preparation::new(PreparationSettings::default());
        for first in [0, 600] {
            let log = saw_tooth(2);
            let mut piece = log.part(first..log.len().min(first + 600));
            change(first, &mut piece);
            preparation.push(piece, &mut Vec::new());
        }
        (preparation.share_of_pitch_beyond(), preparation.share_of_density_less_1000())
    };
    assert_eq!(shares(|_, _| ()), (0.0, 0.0));
    assert_eq!(shares(|_, log| log.column_mut(Channel::Pitch).iter_mut().for_each(|v| *v = v.to_degrees())).0, 1.0);
    // A sensor that failed for half of the log counts over the whole of it, not piece by piece.
    let failed = shares(|first, log| {
        if first == 0 {
            log.column_mut(Channel::Pitch).fill(9.99);
        }
    });
    assert_eq!(failed.0, 0.5);
    assert_eq!(shares(|_, log| log.column_mut(Channel::Density).iter_mut().for_each(|v| *v -= 1000.0)).1, 1.0);
    // A density that was never measured and stands as 0 is no unit.
    assert_eq!(shares(|_, log| log.column_mut(Channel::Density).fill(0.0)).1, 0.0);
}

#[test]
fn a_conductivity_that_no_sea_has_is_in_another_unit() {
    let with = |factor: f64| {
        let mut log = saw_tooth(2);
        let rows = log.len();
        log.set(Channel::Density, vec![f64::NAN; rows]);
        log.set(Channel::Temperature, vec![10.0; rows]);
        log.set(Channel::Conductivity, vec![3.8 * factor; rows]);
        prepared(log)
    };
    let ((right, _), (other, notes)) = (with(1.0), with(10.0));
    assert!(right.len() > 30 && right.len() == other.len());
    let differs = |(a, b): (&Observation, &Observation)| (a.density_kg_m3 - b.density_kg_m3).abs() > 1e-6;
    assert!(!right.iter().zip(&other).any(differs) && right[0].density_kg_m3 > 1020.0);
    assert!(notes.iter().any(|note| note.contains("taken as mS/cm")), "{notes:?}");
}

#[test]
fn the_noise_of_a_reading_is_no_motor() {
    // Two tenths of a cubic centimetre and of a millimetre, at one row a second: steps of half a unit all the time.
    let mut random = StdRng::seed_from_u64(5);
    let mut log = saw_tooth(2);
    let noisy = |value: f64, sd: f64, random: &mut StdRng| value + sd * (random.random::<f64>() - 0.5) * 12f64.sqrt();
    let quiet = prepared(saw_tooth(2)).0.iter().filter(|o| o.steady).count();
    let ballast: Vec<f64> = log.column(Channel::Ballast).iter().map(|cc| noisy(*cc, 0.2, &mut random)).collect();
    let battery: Vec<f64> = (0..log.len()).map(|_| noisy(0.01, 2e-4, &mut random)).collect();
    log.set(Channel::Ballast, ballast);
    log.set(Channel::BatteryPosition, battery);
    let (found, notes) = prepared(log.clone());
    // Around the three turns, where the pump does run, the noise widens its move by the seconds of the means.
    let steady = found.iter().filter(|o| o.steady).count();
    assert!(steady <= quiet && steady >= quiet - 3 * 10, "{steady} of {quiet}: {notes:?}");
    // A pump that runs is one all the same: 30 cc in mid-leg.
    let n = log.len();
    let pumped: Vec<f64> = (0..n).map(|i| log.at(Channel::Ballast, i) + if i < 450 { 0.0 } else { 30.0 }).collect();
    log.set(Channel::Ballast, pumped);
    let (found, _) = prepared(log);
    let steady_at = |t: f64| found.iter().find(|o| o.time_s == t).is_some_and(|o| o.steady);
    assert!(steady_at(430.0) && !steady_at(447.0) && !steady_at(538.0) && steady_at(555.0));
}

#[test]
fn samples_while_a_motor_moves_are_not_steady() {
    let mut log = saw_tooth(1);
    let n = log.len();
    log.set(Channel::BatteryPosition, (0..n).map(|i| if i < 150 { 0.01 } else { 0.02 }).collect());
    log.column_mut(Channel::MotorMoving)[200] = 1.0;
    let (found, _) = prepared(log);
    let at = |t: f64| found.iter().find(|o| o.time_s == t).unwrap();
    assert!(at(140.0).steady && !at(147.0).steady && !at(152.0).steady && at(160.0).steady);
    assert!(at(199.0).steady && !at(200.0).steady && at(201.0).steady);
}

#[test]
fn a_glide_is_steady_after_it_has_pitched_into_its_leg() {
    let mut log = saw_tooth(1);
    let n = log.len();
    // The second leg's pitch takes 60 s to come up.
    let pitch = |i: usize| if i < 300 { -0.45 } else { (-0.45 + 0.015 * (i - 300) as f64).min(0.45) };
    log.set(Channel::Pitch, (0..n).map(pitch).collect());
    let (found, _) = prepared(log);
    let first = found.iter().find(|o| o.leg == 1 && o.steady).map(|o| o.time_s);
    // Within 0.05 rad of it after 57 s, then 90 s more.
    assert_eq!(first, Some(447.0));
}

/// The pitch of the first leg turns over a minute before its depth does, from what it was on all of the leg or for two minutes.
#[test]
fn a_glide_is_steady_until_it_pitches_out_of_its_leg() {
    for at_first in [-0.45, -0.65, -0.3] {
        let mut log = saw_tooth(1);
        let n = log.len();
        let held = |i: usize| if i < 120 { at_first } else { -0.45 };
        let pitch = |i: usize| if i < 240 { held(i) } else { (-0.45 + 0.015 * (i - 240) as f64).min(0.45) };
        log.set(Channel::Pitch, (0..n).map(pitch).collect());
        let (found, _) = prepared(log);
        let last = found.iter().rfind(|o| o.leg == 0 && o.steady).map(|o| o.time_s);
        // Within 0.05 rad of it for 3 s, less 8 s.
        assert_eq!(last, Some(235.0), "{at_first} rad at first");
    }
}

#[test]
fn a_pitch_that_drifts_along_its_leg_is_steady_all_the_same() {
    let steady = |log: FlightLog| prepared(log).0.iter().filter(|o| o.steady).count();
    // Legs of half an hour, and a pitch that changes by 0.3 rad on the way.
    let mut log = FlightLog::default();
    for i in 0..3600 {
        let (descends, p) = (i < 1800, if i < 1800 { i } else { 3600 - i });
        log.push(&[
            (Channel::Time, f64::from(i)),
            (Channel::Pressure, 1.0 + SINK_DBAR_S * f64::from(p)),
            (Channel::Pitch, if descends { -0.45 } else { 0.45 }),
            (Channel::Ballast, if descends { -200.0 } else { 200.0 }),
            (Channel::Density, 1025.0),
        ]);
    }
    let held = steady(log.clone());
    let drifting = log.column(Channel::Pitch).iter().enumerate();
    let drifting: Vec<f64> = drifting.map(|(i, p)| p * (0.7 + 0.6 * (i % 1800) as f64 / 1800.0)).collect();
    log.set(Channel::Pitch, drifting);
    assert_eq!(steady(log), held);
}

#[test]
fn a_log_of_nothing_but_missing_values_gives_nothing() {
    let mut log = saw_tooth(1);
    log.column_mut(Channel::Pressure).fill(f64::NAN);
    let (found, notes) = prepared(log);
    assert!(found.is_empty());
    assert!(notes.iter().any(|note| note.contains("rows without pressure")), "{notes:?}");
    assert!(prepared(FlightLog::default()).0.is_empty());
}

#[test]
fn turning_points_ignore_what_is_smaller_than_a_leg() {
    let pressure: Vec<f64> = [0.0, 5.0, 10.0, 9.0, 12.0, 20.0, 18.0, 19.0, 10.0, 3.0, 4.0, 2.0, 8.0, 15.0].to_vec();
    let found = legs(&pressure, 4.0);
    let bounds: Vec<(usize, usize, bool)> = found.iter().map(|leg| (leg.first, leg.end, leg.descends)).collect();
    assert_eq!(bounds, [(0, 6, true), (5, 12, false), (11, 14, true)]);
}

/// A CTD that is off for a leg takes that leg from the fits of forces, not from the turn rates.
#[test]
fn rows_without_density_show_turns_and_nothing_else() {
    let mut log = saw_tooth(3);
    let time = log.column(Channel::Time).to_vec();
    log.set(Channel::Heading, time.iter().map(|time| 0.01 * time).collect());
    let whole = prepared(log.clone()).0;
    let off = |i: usize| (600..900).contains(&i);
    let density = (0..log.len()).map(|i| if off(i) { f64::NAN } else { 1025.0 }).collect();
    log.set(Channel::Density, density);
    let mut preparation = Preparation::new(PreparationSettings::default());
    let mut out = Vec::new();
    preparation.push(log, &mut out);
    preparation.finish(&mut out);
    let turns = preparation.take_turns_only();
    assert!(out.iter().all(|o| o.density_kg_m3.is_finite()) && turns.len() > 280, "{} rows", turns.len());
    assert!(turns.iter().all(|o| !o.steady && o.density_kg_m3.is_nan() && o.heading_rad.is_finite()));
    // But where the slope of the pressure reaches over the turn.
    let towards = turns.iter().filter(|o| (o.sink_m_s > 0.0) == (o.pitch_rad < 0.0)).count();
    assert!(towards + 20 > turns.len(), "{towards} of {}", turns.len());
    assert_eq!(out.len() + turns.len(), whole.len(), "no row is lost");
    assert!(preparation.notes().sentences().iter().any(|note| note.contains("used for turn rates alone")));
    assert!(preparation.take_turns_only().is_empty());
}

/// A cell that is empty for longer than is drawn straight: a hull that expands would be weighed at its reference there, 47 g off in
/// water 12 K colder.
#[test]
fn a_hull_that_expands_is_not_compared_where_its_temperature_is_missing() {
    let mut log = saw_tooth(2);
    let temperature: Vec<f64> =
        (0..log.len()).map(|i| if (400..550).contains(&i) { f64::NAN } else { 3.0 + 1e-3 * i as f64 }).collect();
    log.set(Channel::Temperature, temperature);
    let prepared = |needs_temperature: bool, log: FlightLog| {
        let settings = PreparationSettings { needs_temperature, ..PreparationSettings::default() };
        let mut preparation = Preparation::new(settings);
        let mut out = Vec::new();
        preparation.push(log, &mut out);
        preparation.finish(&mut out);
        (out, preparation.notes().sentences())
    };
    let is_missing = |o: &&Observation| (400.0..550.0).contains(&o.time_s);
    let (found, notes) = prepared(true, log.clone());
    assert!(
        found.iter().filter(is_missing).all(|o| !o.steady && (o.temperature_C - 3.0 - 1e-3 * o.time_s).abs() < 1e-9)
    );
    assert!(notes.iter().any(|note| note.starts_with("150 rows without temperature")), "{notes:?}");
    // A hull that does not expand needs none.
    let (found, notes) = prepared(false, log);
    assert!(
        found.iter().filter(is_missing).any(|o| o.steady) && !notes.iter().any(|note| note.contains("temperature"))
    );
}
