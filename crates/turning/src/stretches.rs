//! Steady stretches of a log: between moves of the controls, each with one turn rate.

use glidepolar_flightlog::Observation;

/// What makes a stretch steady.
struct Limits {
    /// Time after a move from which a turn is steady \[s\]: some time constants of roll and sideslip, which are 5 to 10 s.
    settled_s: f64,
    /// Shortest stretch that gives one turn rate \[s\].
    shortest_s: f64,
    /// Longest stretch \[s\].
    longest_s: f64,
    /// Stretches above this mean pressure are left out \[dbar\]: waves turn the glider there.
    surface_dbar: f64,
}

/// Where the log has its moves: an interval between two of them is one stretch. The heading wanders, so that a piece of 20 s may be
/// off by as much as turn rates differ; only where nothing moves for very long is a leg cut.
const BETWEEN_MOVES: Limits = Limits { settled_s: 20.0, shortest_s: 40.0, longest_s: 600.0, surface_dbar: 10.0 };
/// Where moves are seen in the readings alone, and nothing may move for a whole leg: depth must be separated, also on shallow dives.
const WITHOUT_MOVES: Limits = Limits { settled_s: 25.0, shortest_s: 20.0, longest_s: 60.0, surface_dbar: 0.0 };
/// Times of samples are not exact \[s\].
const JITTER_S: f64 = 0.5;
/// Samples of the shortest stretch.
const LEAST_SAMPLES: usize = 3;
/// Longer gaps between two samples end a stretch \[s\].
const LONGEST_GAP_S: f64 = 60.0;
/// A step larger than this is a move: roll, rudder, roll mass \[rad\].
const MOVES_RAD: [f64; 3] = [0.12, 0.03, 0.05];
/// So far from the median pitch of its leg a glider is still pitching \[rad\].
const PITCHING_RAD: f64 = 0.15;

/// One steady stretch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stretch {
    pub(crate) dive: u32,
    pub(crate) descends: bool,
    pub(crate) pitch_rad: f64,
    /// By depth rate and pitch.
    pub(crate) speed_m_s: f64,
    pub(crate) pressure_dbar: f64,
    pub(crate) rate_rad_s: f64,
    pub(crate) roll_rad: f64,
    pub(crate) rudder_rad: f64,
    pub(crate) roll_mass_rad: f64,
    pub(crate) battery_forward_m: f64,
}

/// The steady stretches of a log with heading.
pub(crate) fn stretches(observations: &[Observation]) -> Vec<Stretch> {
    let mut found = Vec::new();
    // Where the log flags its motors, no move needs to be seen in the roll.
    let flagged = observations.iter().any(|o| o.motor_moving || o.since_move_s.is_finite());
    let limits = if flagged { BETWEEN_MOVES } else { WITHOUT_MOVES };
    for leg in observations.chunk_by(|a, b| a.leg == b.leg && a.stretch == b.stretch) {
        let mut pitches: Vec<f64> = leg.iter().map(|o| o.pitch_rad).filter(|p| p.is_finite()).collect();
        if pitches.is_empty() {
            continue;
        }
        let pitch = glidepolar_flightlog::median(&mut pitches);
        let usable = |o: &Observation| {
            o.heading_rad.is_finite()
                && (o.roll_rad.is_finite() || o.rudder_rad.is_finite())
                && (o.pitch_rad - pitch).abs() < PITCHING_RAD
                && (o.sink_m_s > 0.0) == (pitch < 0.0)
        };
        let mut moved_s = leg[0].time_s;
        let mut run: Vec<&Observation> = Vec::new();
        for (i, o) in leg.iter().enumerate() {
            if let Some(end_s) = move_before(leg, i, flagged) {
                close(&mut run, &limits, &mut found);
                moved_s = end_s;
            }
            let gap = run.last().is_some_and(|last| o.time_s - last.time_s > LONGEST_GAP_S);
            let full = run.first().is_some_and(|first| o.time_s - first.time_s > limits.longest_s);
            if gap || full {
                close(&mut run, &limits, &mut found);
            }
            if o.time_s - moved_s >= limits.settled_s && usable(o) {
                run.push(o);
            }
        }
        close(&mut run, &limits, &mut found);
    }
    found
}

/// When a move ended that this sample is the first to show, the sample itself where the log has no times of moves.
fn move_before(leg: &[Observation], i: usize, flagged: bool) -> Option<f64> {
    let o = &leg[i];
    if o.since_move_s.is_finite() {
        let step_s = i.checked_sub(1).map_or(0.0, |before| o.time_s - leg[before].time_s);
        return (o.since_move_s <= step_s).then_some(o.time_s - o.since_move_s);
    }
    let moved = o.motor_moving || if flagged { steps(leg, i) } else { is_move(leg, i) };
    moved.then_some(o.time_s)
}

/// Whether rudder or roll mass read otherwise than in the sample before: a move between two samples has no flag.
fn steps(leg: &[Observation], i: usize) -> bool {
    let Some(before) = i.checked_sub(1).map(|before| &leg[before]) else { return false };
    (leg[i].rudder_rad - before.rudder_rad).abs() > MOVES_RAD[1]
        || (leg[i].roll_mass_rad - before.roll_mass_rad).abs() > MOVES_RAD[2]
}

/// Whether a control moved from the sample before: by the means of three samples on either side, so that noise is none.
fn is_move(leg: &[Observation], i: usize) -> bool {
    let of: [fn(&Observation) -> f64; 3] = [|o| o.roll_rad, |o| o.rudder_rad, |o| o.roll_mass_rad];
    of.into_iter().zip(MOVES_RAD).any(|(of, moves)| {
        let mean = |part: &[Observation]| part.iter().map(of).sum::<f64>() / part.len() as f64;
        let (before, after) = (&leg[i.saturating_sub(3)..i], &leg[i..(i + 3).min(leg.len())]);
        !before.is_empty() && (mean(after) - mean(before)).abs() > moves
    })
}

/// The line through the headings of a run.
fn close(run: &mut Vec<&Observation>, limits: &Limits, found: &mut Vec<Stretch>) {
    let samples = std::mem::take(run);
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else { return };
    if samples.len() < LEAST_SAMPLES || last.time_s - first.time_s < limits.shortest_s - JITTER_S {
        return;
    }
    let n = samples.len() as f64;
    let mean = |of: fn(&Observation) -> f64| samples.iter().map(|o| of(o)).sum::<f64>() / n;
    let middle = mean(|o| o.time_s);
    let (mut heading, mut before) = (0.0, first.heading_rad);
    let (mut upper, mut lower) = (0.0, 0.0);
    for o in &samples {
        let turned = o.heading_rad - before;
        heading += turned - std::f64::consts::TAU * (turned / std::f64::consts::TAU).round();
        before = o.heading_rad;
        upper += (o.time_s - middle) * heading;
        lower += (o.time_s - middle) * (o.time_s - middle);
    }
    let pressure_dbar = mean(|o| o.pressure_dbar);
    if pressure_dbar < limits.surface_dbar {
        return;
    }
    found.push(Stretch {
        dive: first.dive,
        descends: mean(|o| o.pitch_rad) < 0.0,
        pitch_rad: mean(|o| o.pitch_rad),
        speed_m_s: (mean(|o| o.sink_m_s) / mean(|o| o.pitch_rad).sin()).abs(),
        pressure_dbar,
        rate_rad_s: upper / lower,
        roll_rad: mean(|o| o.roll_rad),
        rudder_rad: mean(|o| o.rudder_rad),
        roll_mass_rad: mean(|o| o.roll_mass_rad),
        battery_forward_m: mean(|o| o.battery_forward_m),
    });
}
