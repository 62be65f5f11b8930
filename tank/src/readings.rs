//! One run, from its file to the few figures that the reduction needs: raw readings of the balance still, before zero,
//! interaction and tare. Every run is read once and forgotten.

use glidepolar_input::{InputError, Place};
use nalgebra::Vector3;

use crate::campaign::{Kind, Run};
use crate::clipping;
use crate::harmonics::{self, Harmonics};
use crate::history::History;
use crate::series::{Mean3, block_means};
use crate::spikes;
use crate::window::{self, Found, NoWindow, Window};

/// What one run came to.
#[derive(Debug, Clone)]
pub struct Readings {
    /// The part at rest before the run-up, or the whole of a zero run.
    pub rest: Option<Rest>,
    /// The useful part.
    pub useful: Useful,
    /// The run in some hundred points, to be drawn.
    pub trace: Trace,
    /// What the crew should know of this run.
    pub notices: Vec<String>,
    /// Columns that are not used.
    pub unused: Vec<String>,
}

/// Means over a part at rest.
#[derive(Debug, Clone, Copy)]
pub struct Rest {
    /// Mean readings.
    pub readings: Mean3,
    /// Middle of the part since the run's begin \[s\].
    pub middle_s: f64,
}

/// The useful part of a run.
#[derive(Debug, Clone)]
pub enum Useful {
    /// At rest.
    Rest,
    /// At constant speed.
    Steady(Box<Steady>),
    /// Oscillating at constant speed.
    Periodic(Box<Harmonics>),
}

/// Means over a steady part.
#[derive(Debug, Clone)]
pub struct Steady {
    /// Mean readings.
    pub readings: Mean3,
    /// Mean speed \[m/s\].
    pub speed_m_s: f64,
    /// Mean square of the speed \[m2/s2\].
    pub speed_squared: f64,
    /// Mean acceleration along the tank \[m/s2\].
    pub acceleration_m_s2: f64,
    /// Its variance by the noise of the recorded speed \[m2/s4\].
    pub acceleration_variance: f64,
    /// Mean yaw angle \[deg\].
    pub yaw_deg: f64,
    /// How the window was found.
    pub found: Found,
    /// Length of the window \[s\].
    pub duration_s: f64,
    /// Middle of the window since the run's begin \[s\].
    pub middle_s: f64,
}

/// A history thinned out for drawing, with the window.
#[derive(Debug, Clone, Default)]
pub struct Trace {
    /// Time \[s\].
    pub time_s: Vec<f32>,
    /// Speed \[m/s\].
    pub speed_m_s: Vec<f32>,
    /// Readings: AF, SF, YM.
    pub channels: [Vec<f32>; 3],
    /// Begin and end of the window \[s\].
    pub window_s: (f64, f64),
}

/// Points of a drawn history.
const TRACE_POINTS: usize = 160;
/// Two speeds, or two angles, this far apart are not the same \[per cent of the commanded speed; deg\].
const SPEED_DIFFERENCE: f64 = 0.05;
const YAW_DIFFERENCE_DEG: f64 = 0.5;
/// Slope of a reading over its window, in units of a standard error on five degrees of freedom, that one run in a million
/// shows by chance.
const DRIFT_T: f64 = 27.0;
/// Samples further apart are no record of a balance \[s\].
const SLOWEST_INTERVAL_S: f64 = 0.5;
/// Other units of speed, and how many of them are 1 m/s.
const SPEED_UNITS: [(&str, f64); 4] = [("km/h", 3.6), ("knots", 1.9438), ("feet per second", 3.2808), ("mm/s", 1000.0)];
/// Fewest samples at rest that have a mean.
const LEAST_AT_REST: usize = 16;
/// Over this long the speed is averaged at both ends of a window \[s\].
const END_S: f64 = 0.5;

/// Reads a run.
///
/// # Errors
/// Where its file cannot be used, a channel is clipped, or it has no useful part.
pub fn read(run: &Run, hull_length_m: f64, history: &mut History) -> Result<Readings, InputError> {
    history.read(&run.file)?;
    let wrong = |problem: String| InputError::new(Place::file(&run.file), problem);
    let no_window = |error: NoWindow| wrong(error.to_string());
    clipping::check(history, &run.file)?;
    clipping::check_alive(history, run)?;
    check_time(run, history)?;
    check_units(run, history)?;
    let mut notices = spikes::leave_out(history);
    let rest = window::at_rest(history);
    let (useful, window) = match run.kind {
        Kind::Zero => (Useful::Rest, rest.clone().map_err(no_window)?),
        Kind::Tare | Kind::Static | Kind::Arc => {
            let found = window::steady(history, hull_length_m).map_err(no_window)?;
            let steady = steady(history, found);
            check_speed_unit(run, steady.speed_m_s)?;
            check_command(run, &steady, &mut notices);
            (Useful::Steady(Box::new(steady)), found.window)
        }
        Kind::Sway | Kind::Yaw => {
            let plateau = window::plateau(history).map_err(no_window)?;
            let harmonics = harmonics::fit(run, history, plateau).map_err(|error| wrong(error.to_string()))?;
            notices.extend(harmonics.notices(run));
            let window = harmonics.window;
            (Useful::Periodic(Box::new(harmonics)), window)
        }
    };
    Ok(Readings {
        rest: rest.ok().filter(|window| window.len() >= LEAST_AT_REST).map(|window| at_rest(history, &window)),
        trace: trace(history, window),
        unused: history.unused.clone(),
        useful,
        notices,
    })
}

fn at_rest(history: &History, window: &Window) -> Rest {
    Rest {
        readings: Mean3::new(window.of3(history.channels()), history.interval_s()),
        middle_s: middle_s(window.slice(history.time_s())),
    }
}

fn middle_s(time: &[f64]) -> f64 {
    0.5 * (time[0] + time[time.len() - 1])
}

fn steady(history: &History, found: Found) -> Steady {
    let window = found.window;
    let speeds = window.slice(history.speed_m_s());
    let time = window.slice(history.time_s());
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let n = speeds.len();
    let duration_s = time[n - 1] - time[0];
    let end = ((END_S / history.interval_s()) as usize).clamp(1, (n / 4).max(1));
    let gained = mean(&speeds[n - end..]) - mean(&speeds[..end]);
    let between_s = duration_s - end as f64 * history.interval_s();
    // Variance of one sample of the speed, by the differences of successive ones.
    let noise = 0.5 * speeds.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum::<f64>() / (n - 1).max(1) as f64;
    Steady {
        readings: Mean3::new(window.of3(history.channels()), history.interval_s()),
        speed_m_s: mean(speeds),
        speed_squared: speeds.iter().map(|u| u * u).sum::<f64>() / n as f64,
        acceleration_m_s2: gained / between_s,
        acceleration_variance: 2.0 * noise / end as f64 / between_s.powi(2),
        yaw_deg: mean(window.slice(history.yaw_deg())),
        found,
        duration_s,
        middle_s: middle_s(time),
    }
}

/// Milliseconds where seconds are expected: no balance is read once in half a second.
fn check_time(run: &Run, history: &History) -> Result<(), InputError> {
    let interval_s = history.interval_s();
    if interval_s <= SLOWEST_INTERVAL_S {
        return Ok(());
    }
    let problem = format!("samples come every {interval_s:.3} s, expected at most {SLOWEST_INTERVAL_S} s");
    Err(InputError::new(Place::file(&run.file), problem).help("is time_s in milliseconds? expected seconds"))
}

/// Speeds that are those of the table in another unit.
fn check_speed_unit(run: &Run, speed_m_s: f64) -> Result<(), InputError> {
    let ratio = speed_m_s / run.speed_m_s;
    let Some((unit, _)) = SPEED_UNITS.iter().find(|(_, per_m_s)| (ratio / per_m_s - 1.0).abs() < 0.02) else {
        return Ok(());
    };
    let problem = format!("speed_m_s is {speed_m_s:.3} where runs.csv has {} m/s: it looks like {unit}", run.speed_m_s);
    Err(InputError::new(Place::file(&run.file), problem).help("write speeds in m/s"))
}

/// Degrees where radians were written, in either file.
fn check_units(run: &Run, history: &History) -> Result<(), InputError> {
    if !matches!(run.kind, Kind::Static | Kind::Tare) {
        return Ok(());
    }
    let shown = crate::series::median(history.yaw_deg());
    let ratio = shown / run.yaw_deg;
    let of = |file: &str, other: &str| {
        let problem = format!(
            "yaw_deg is {shown:.4} in this file and {} in runs.csv: {file} looks like radians, expected degrees in both",
            run.yaw_deg
        );
        Err(InputError::new(Place::file(&run.file), problem)
            .help(format!("convert {file} to degrees; {other} is right")))
    };
    let degree = 1f64.to_radians();
    if run.yaw_deg.abs() > 0.5 && (ratio / degree - 1.0).abs() < 0.05 {
        return of("this file", "runs.csv");
    }
    if shown.abs() > 0.5 && (ratio * degree - 1.0).abs() < 0.05 {
        return of("runs.csv", "this file");
    }
    Ok(())
}

fn check_command(run: &Run, steady: &Steady, notices: &mut Vec<String>) {
    if (steady.speed_m_s / run.speed_m_s - 1.0).abs() > SPEED_DIFFERENCE {
        notices.push(format!(
            "speed {:.3} m/s where {} m/s was commanded; the measured one is used",
            steady.speed_m_s, run.speed_m_s
        ));
    }
    if run.kind != Kind::Arc && (steady.yaw_deg - run.yaw_deg).abs() > YAW_DIFFERENCE_DEG {
        notices.push(format!(
            "yaw {:.2} deg where {} deg was commanded; the measured one is used",
            steady.yaw_deg, run.yaw_deg
        ));
    }
    if steady.found.slope_t.abs() > DRIFT_T {
        notices.push(format!(
            "readings drift over the window (slope {:.0} times its standard error)",
            steady.found.slope_t.abs()
        ));
    }
}

fn trace(history: &History, window: Window) -> Trace {
    let size = history.len().div_ceil(TRACE_POINTS).max(1);
    let thin = |column: &[f64]| block_means(column, size).into_iter().map(|x| x as f32).collect();
    let time = history.time_s();
    Trace {
        time_s: thin(time),
        speed_m_s: thin(history.speed_m_s()),
        channels: history.channels().map(thin),
        window_s: (time[window.from], time[window.to - 1]),
    }
}

impl Steady {
    /// Standard errors of the mean readings.
    pub fn se(&self) -> Vector3<f64> {
        self.readings.covariance.diagonal().map(f64::sqrt)
    }
}
