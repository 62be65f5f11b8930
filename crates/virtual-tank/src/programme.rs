//! The test programme: which runs are made, in what order, on which day and hour, in water of what temperature.
//! Knows what a towing-tank crew decides and what goes wrong while they do; no physics of hulls or balances.

use super::effects::Hidden;
use super::faults;
use super::motion::{Command, Kind};
use super::planned_run::PlannedRun;
use super::random::Stream;
use super::world::{Order, World};

/// No block of runs is begun later than this, h after the begin of the day.
const LAST_BLOCK_BEGINS_H: f64 = 6.5;
/// Changing hulls, h.
const HULL_CHANGE_H: f64 = 1.0;

/// What a campaign is to hold.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wishes<'a> {
    /// The hulls, in the order in which they are towed.
    pub hulls: &'a [usize],
    /// How often each goes through its programme.
    pub passes: usize,
    /// Whether oscillations and turns are left out.
    pub statics_only: bool,
}

/// Plans a campaign: the strut alone first (unless it was never tared), then hull after hull.
pub(super) fn plan(wishes: Wishes<'_>, world: &World, hidden: &Hidden, stream: &mut Stream) -> Vec<PlannedRun> {
    let mut crew = Crew {
        world,
        stream,
        day: 0,
        hours: 0.0,
        speed_before_m_s: 0.0,
        loaded_before: None,
        temperature: (0.0, 0.0, 0.0),
        day_temperature: 0.0,
        runs: Vec::new(),
    };
    crew.temperature = (crew.stream.between(12.0, 18.0), crew.stream.between(0.5, 1.5), crew.stream.between(0.0, 6.0));
    crew.begin_day(0);
    if hidden.untared_strut_n.is_none() {
        let mut tares = tare_runs(world);
        if world.order == Order::Shuffled {
            crew.stream.shuffle(&mut tares);
        }
        if !tares.is_empty() {
            crew.session(None, tares);
        }
    }
    let Wishes { hulls, passes, statics_only } = wishes;
    for &hull in hulls {
        let mut work = Vec::new();
        for pass in 0..passes {
            let moving = if statics_only { vec![] } else { vec![oscillating_runs(), arc_runs()] };
            for mut group in std::iter::once(static_runs(world)).chain(moving) {
                if world.order == Order::Shuffled {
                    crew.stream.shuffle(&mut group);
                }
                if pass > 0 {
                    group.iter_mut().for_each(|(_, note)| *note = format!("pass {}", pass + 1));
                }
                work.append(&mut group);
            }
        }
        if !crew.runs.is_empty() {
            crew.change_hull();
        }
        crew.session(Some(hull), work);
    }
    let mut runs = crew.runs;
    write_wrong_temperature(&mut runs, hidden);
    catch_weed(&mut runs, hulls, hidden);
    faults::mislead(&mut runs, hulls, &hidden.rig);
    runs
}

/// A run to make and what to note beside it.
type Job = (Command, String);

fn towed(kind: Kind, speed_m_s: f64, yaw_deg: f64) -> Command {
    Command { kind, speed_m_s, yaw_deg, sway_amplitude_m: 0.0, frequency_hz: 0.0, radius_m: 0.0, hold_s: 0.0 }
}

fn tare_runs(world: &World) -> Vec<Job> {
    world.tare.iter().map(|(speed, yaw)| (towed(Kind::Tare, *speed, *yaw), String::new())).collect()
}

fn static_runs(world: &World) -> Vec<Job> {
    let run = |(speed, yaw): &(f64, f64), note: &str| (towed(Kind::Static, *speed, *yaw), note.to_owned());
    world
        .sweep
        .iter()
        .map(|point| run(point, ""))
        .chain(world.repeats.iter().map(|point| run(point, "repeat")))
        .collect()
}

fn oscillating_runs() -> Vec<Job> {
    let sway = [(0.10, 0.2), (0.20, 0.2), (0.30, 0.2), (0.20, 0.1), (0.40, 0.1), (0.10, 0.3), (0.15, 0.3)];
    let yaw = [(4.0, 0.2), (8.0, 0.2), (12.0, 0.2), (5.0, 0.1), (10.0, 0.1), (5.0, 0.3), (10.0, 0.3)];
    let sway = sway.map(|(amplitude, hz)| Command {
        sway_amplitude_m: amplitude,
        frequency_hz: hz,
        ..towed(Kind::Sway, 2.0, 0.0)
    });
    let yaw = yaw.map(|(degrees, hz): (f64, f64)| {
        let amplitude = 2.0 * degrees.to_radians().tan() / (std::f64::consts::TAU * hz);
        // Mechanisms are set to whole tenths of a millimetre.
        Command { sway_amplitude_m: (amplitude * 1e4).round() / 1e4, frequency_hz: hz, ..towed(Kind::Yaw, 2.0, 0.0) }
    });
    sway.into_iter().chain(yaw).map(|command| (command, String::new())).collect()
}

fn arc_runs() -> Vec<Job> {
    let turns = [(1.0, 10.0), (1.0, -10.0), (2.0, 20.0), (2.0, -20.0)];
    let once = turns.map(|(speed, radius)| Command { radius_m: radius, ..towed(Kind::Arc, speed, 0.0) });
    once.into_iter().map(|c| (c, String::new())).chain(once.into_iter().map(|c| (c, "repeat".to_owned()))).collect()
}

/// The people at the tank and their clock.
struct Crew<'a> {
    world: &'a World,
    stream: &'a mut Stream,
    day: usize,
    hours: f64,
    speed_before_m_s: f64,
    loaded_before: Option<(Option<usize>, Command)>,
    /// Mean, swing and phase of the tank's temperature.
    temperature: (f64, f64, f64),
    day_temperature: f64,
    runs: Vec<PlannedRun>,
}

impl Crew<'_> {
    fn begin_day(&mut self, day: usize) {
        self.day = day;
        self.hours = 0.1;
        self.speed_before_m_s = 0.0;
        self.loaded_before = None;
        let (mean, swing, phase) = self.temperature;
        let slow = (day as f64 * std::f64::consts::TAU / 23.0 + phase).sin();
        self.day_temperature = mean + swing * slow + 0.1 * self.stream.normal();
    }

    /// Runs with one hull (or none): a zero, some runs, a zero, and so on; the last of a day is a zero.
    fn session(&mut self, hull: Option<usize>, work: Vec<Job>) {
        self.zero(hull, "before");
        let blocks = work.chunks(self.world.runs_between_zeros).count();
        for (i, block) in work.chunks(self.world.runs_between_zeros).enumerate() {
            if self.hours > LAST_BLOCK_BEGINS_H {
                self.begin_day(self.day + 1);
                self.zero(hull, "morning");
            }
            for (command, note) in block {
                self.run(hull, *command, note);
            }
            self.zero(hull, if i + 1 == blocks { "after" } else { "between" });
        }
    }

    fn change_hull(&mut self) {
        if self.hours + HULL_CHANGE_H > LAST_BLOCK_BEGINS_H {
            self.begin_day(self.day + 1);
        } else {
            self.hours += HULL_CHANGE_H;
            self.speed_before_m_s = 0.0;
            self.loaded_before = None;
        }
    }

    fn zero(&mut self, hull: Option<usize>, note: &str) {
        let hull = hull.filter(|_| self.world.zeros_name_hull);
        self.run(hull, towed(Kind::Zero, 0.0, 0.0), note);
    }

    fn run(&mut self, hull: Option<usize>, command: Command, note: &str) {
        let hold_s = if command.kind == Kind::Zero { self.world.zero_s } else { self.world.hold_s };
        let command = Command { hold_s, ..command };
        let wait_s = self.stream.between(self.world.wait_s.0, self.world.wait_s.1);
        self.hours += wait_s / 3600.0;
        let temperature_c = self.day_temperature + self.world.warming_K_per_hour * self.hours;
        let moving = command.kind != Kind::Zero;
        let (yaw_draw, speed_draw) = (self.stream.normal(), self.stream.normal());
        self.runs.push(PlannedRun {
            hull,
            command,
            day: self.day,
            hours: self.hours,
            temperature_c,
            recorded_temperature_c: (temperature_c * 100.0).round() / 100.0,
            wait_s,
            speed_before_m_s: self.speed_before_m_s,
            loaded_before: self.loaded_before,
            yaw_error_deg: if moving { self.world.levels.yaw_setting_deg * yaw_draw } else { 0.0 },
            speed_ratio: if moving { 1.0 + self.world.levels.speed_setting * speed_draw } else { 1.0 },
            extra_cd: 0.0,
            speed_slip: 0.0,
            note: note.to_owned(),
        });
        self.hours += command.times().end / 3600.0;
        if moving {
            self.loaded_before = Some((hull, command));
        }
        // A zero run lets the water settle further: the current left over is that of the run before it.
        self.speed_before_m_s =
            if moving { command.speed_m_s } else { self.speed_before_m_s * (-wait_s / 360.0).exp() };
    }
}

fn write_wrong_temperature(runs: &mut [PlannedRun], hidden: &Hidden) {
    let Some(wrong) = hidden.wrong_temperature else {
        return;
    };
    let mut days: Vec<usize> = runs.iter().filter(|run| run.hull.is_some()).map(|run| run.day).collect();
    days.dedup();
    let day = days[((days.len() as f64 * wrong.day_fraction) as usize).min(days.len() - 1)];
    for run in runs.iter_mut().filter(|run| run.day == day) {
        run.recorded_temperature_c = ((run.temperature_c + wrong.error_c) * 100.0).round() / 100.0;
    }
}

fn catch_weed(runs: &mut [PlannedRun], hulls: &[usize], hidden: &Hidden) {
    let Some(weed) = hidden.weed else { return };
    let hull = hulls[((hulls.len() as f64 * weed.hull_fraction) as usize).min(hulls.len() - 1)];
    let count = runs.iter().filter(|run| run.hull == Some(hull)).count();
    let clean = (count as f64 * weed.run_fraction) as usize;
    for run in runs.iter_mut().filter(|run| run.hull == Some(hull)).skip(clean) {
        run.extra_cd = weed.drag_coefficient;
    }
}
