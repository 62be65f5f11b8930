//! An oscillating run as harmonics: whole cycles at full amplitude are found, and motion and readings regressed on mean and
//! first three harmonics of the frequency, with the noise that the record shows beside them.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use crate::campaign::{Kind, Run};
use crate::history::History;
use crate::window::Window;

/// Harmonics that are regressed.
pub const HARMONICS: usize = 3;
/// Mean, and cosine and sine of each harmonic.
pub const TERMS: usize = 2 * HARMONICS + 1;
/// A mean with its harmonics: `[mean, cos1, sin1, cos2, sin2, cos3, sin3]`, the phase counted from the window's begin.
pub type Series = [f64; TERMS];
/// Frequency \[Hz\] and covariance of the readings' cosine (or sine) coefficient there.
pub type NoiseSpectrum = Vec<(f64, Matrix3<f64>)>;

/// Amplitudes within this of the full one count as full.
const AMPLITUDE_TOLERANCE: f64 = 0.01;
/// A measured frequency this far from the commanded one is used instead of it.
const FREQUENCY_TOLERANCE: f64 = 0.003;
/// Pairs of frequencies, one below and one above a harmonic, from which its noise is taken at most.
const NEIGHBOURS: usize = 2;
/// Share of the window at either end over which samples gain and lose their weight. The smooth end of a build-up that the
/// window may still hold hardly shows in the motion, but its acceleration would in the force.
const TAPER: f64 = 0.08;
/// A third harmonic of the motion below so many standard errors is noise of the position sensor: twice differentiated it
/// would pass for a force.
const SIGNIFICANT: f64 = 3.0;

/// What an oscillating run came to.
#[derive(Debug, Clone)]
pub struct Harmonics {
    /// Whole cycles at full amplitude.
    pub window: Window,
    /// How many.
    pub cycles: usize,
    /// Frequency used \[Hz\].
    pub frequency_hz: f64,
    /// Frequency that the motion shows, where two cycles or more tell it \[Hz\].
    pub measured_hz: Option<f64>,
    /// Mean speed of the carriage \[m/s\].
    pub speed_m_s: f64,
    /// Sway \[m\]; zero where it was not recorded.
    pub sway_m: Series,
    /// Yaw \[rad\].
    pub yaw_rad: Series,
    /// Readings: AF, SF, YM.
    pub readings: [Series; 3],
    /// Covariance of a cosine (or sine) coefficient of the readings, harmonic by harmonic.
    pub noise: [Matrix3<f64>; HARMONICS],
    /// The same covariance at every frequency \[Hz\] beside the harmonics from which it was taken.
    pub spectrum: NoiseSpectrum,
    /// Length of the window, weights counted \[s\]: the covariance of a coefficient goes with one over it.
    pub effective_s: f64,
    /// Middle of the window since the run's begin \[s\].
    pub middle_s: f64,
}

/// Why a run has no usable oscillation.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum NoOscillation {
    #[error("column sway_m is missing: a sway run needs the measured position")]
    NoSway,
    #[error("{what} does not oscillate at {frequency_hz} Hz")]
    NoMotion { what: &'static str, frequency_hz: f64 },
    #[error("{held_s:.1} s at full amplitude and constant speed hold no whole cycle of {frequency_hz} Hz")]
    NoWholeCycle { held_s: f64, frequency_hz: f64 },
}

/// Finds the whole cycles within the part at constant speed and regresses them.
///
/// # Errors
/// Where there is no motion, or no whole cycle at full amplitude.
pub fn fit(run: &Run, history: &History, plateau: Window) -> Result<Harmonics, NoOscillation> {
    let (what, motion) = match run.kind {
        Kind::Sway => ("sway_m", history.sway_m().ok_or(NoOscillation::NoSway)?),
        _ => ("yaw_deg", history.yaw_deg()),
    };
    let commanded = run.frequency_hz;
    let envelope = Envelope::fit(history, motion, plateau, commanded)
        .ok_or(NoOscillation::NoWholeCycle { held_s: 0.0, frequency_hz: commanded })?;
    let (flat, measured_hz) =
        envelope.flat(commanded).ok_or(NoOscillation::NoMotion { what, frequency_hz: commanded })?;
    let frequency_hz = match measured_hz {
        Some(measured) if (measured / commanded - 1.0).abs() > FREQUENCY_TOLERANCE => measured,
        _ => commanded,
    };
    let interval = history.interval_s();
    let held_s = flat.len() as f64 * interval;
    // A twentieth of a cycle that the smooth envelope hides is no reason to lose one.
    let cycles = (held_s * frequency_hz + 0.05) as usize;
    if cycles == 0 {
        return Err(NoOscillation::NoWholeCycle { held_s, frequency_hz });
    }
    let mut cycles = cycles;
    loop {
        let samples = ((cycles as f64 / frequency_hz / interval).round() as usize).min(flat.len());
        let from = flat.from + (flat.len() - samples) / 2;
        let window = Window { from, to: from + samples };
        let found = regress(history, window, frequency_hz, cycles, measured_hz);
        if cycles == 1 || !fades(&found, history.time_s(), motion, run.kind) {
            return Ok(found);
        }
        cycles -= 1;
    }
}

/// Whether the motion at either end of the window departs from its harmonics by more than it does in between: the build-up
/// and the fading of an oscillation are smooth, and a cycle's amplitude hides them.
fn fades(found: &Harmonics, time: &[f64], motion: &[f64], kind: Kind) -> bool {
    let window = found.window;
    let series = match kind {
        Kind::Sway => found.sway_m,
        _ => found.yaw_rad.map(f64::to_degrees),
    };
    let omega = std::f64::consts::TAU * found.frequency_hz;
    let rms = |from: usize, to: usize| {
        let squares = (from..to).map(|i| {
            let basis = basis(omega * (time[i] - time[window.from]));
            (motion[i] - (0..TERMS).map(|k| series[k] * basis[k]).sum::<f64>()).powi(2)
        });
        (squares.sum::<f64>() / (to - from) as f64).sqrt()
    };
    let quarter = (window.len() / (4 * found.cycles)).max(1);
    let between = rms(window.from + quarter, window.to - quarter);
    let allowed = (1.5 * between).max(1e-4 * series[1].hypot(series[2]));
    rms(window.from, window.from + quarter) > allowed || rms(window.to - quarter, window.to) > allowed
}

fn regress(history: &History, window: Window, frequency_hz: f64, cycles: usize, measured_hz: Option<f64>) -> Harmonics {
    let time = window.slice(history.time_s());
    let omega = std::f64::consts::TAU * frequency_hz;
    let zeros = vec![0.0; window.len()];
    let sway = history.sway_m().map_or(zeros.as_slice(), |sway| window.slice(sway));
    let [af, sf, ym] = window.of3(history.channels());
    let columns = [sway, window.slice(history.yaw_deg()), af, sf, ym];
    let taper = taper(window.len());
    let mut normal = SMatrix::<f64, TERMS, TERMS>::zeros();
    let mut right = SMatrix::<f64, TERMS, 5>::zeros();
    for i in 0..window.len() {
        let basis = basis(omega * (time[i] - time[0]));
        normal.ger(taper[i], &basis, &basis, 1.0);
        let observed = SVector::<f64, 5>::from_fn(|j, _| columns[j][i]);
        right.ger(taper[i], &basis, &observed, 1.0);
    }
    // Whole cycles of three harmonics are as good as orthogonal: always invertible.
    let solved = normal.cholesky().map(|c| c.solve(&right)).unwrap_or_else(SMatrix::zeros);
    let series = |j: usize| -> Series { std::array::from_fn(|k| solved[(k, j)]) };
    let motion = |j: usize| without_noise(series(j), columns[j], time, omega);
    let readings = [series(2), series(3), series(4)];
    let speeds = window.slice(history.speed_m_s());
    let (noise, spectrum) = noise([af, sf, ym], &readings, time, omega, cycles, &taper);
    let [sum, squares] = [1, 2].map(|power| taper.iter().map(|w| w.powi(power)).sum::<f64>());
    Harmonics {
        noise,
        spectrum,
        effective_s: sum * sum / squares * history.interval_s(),
        window,
        cycles,
        frequency_hz,
        measured_hz,
        speed_m_s: speeds.iter().sum::<f64>() / speeds.len() as f64,
        sway_m: motion(0),
        yaw_rad: motion(1).map(f64::to_radians),
        readings,
        middle_s: 0.5 * (time[0] + time[time.len() - 1]),
    }
}

fn basis(phase: f64) -> SVector<f64, TERMS> {
    let (s1, c1) = phase.sin_cos();
    let (s2, c2) = (2.0 * s1 * c1, c1 * c1 - s1 * s1);
    let (s3, c3) = (s2 * c1 + c2 * s1, c2 * c1 - s2 * s1);
    SVector::from([1.0, c1, s1, c2, s2, c3, s3])
}

/// Weights of a window's samples: one, with cosine lobes at both ends.
fn taper(samples: usize) -> Vec<f64> {
    let lobe = TAPER * samples as f64;
    let weight = |i: usize| {
        let inside = (i as f64 + 0.5).min(samples as f64 - 0.5 - i as f64) / lobe;
        if inside < 1.0 { (0.5 * std::f64::consts::PI * inside).sin().powi(2) } else { 1.0 }
    };
    (0..samples).map(weight).collect()
}

/// A motion less those of its higher harmonics that the scatter of its own sensor explains.
fn without_noise(mut series: Series, column: &[f64], time: &[f64], omega: f64) -> Series {
    let left = column.iter().zip(time).map(|(x, t)| {
        let basis = basis(omega * (t - time[0]));
        (x - (0..TERMS).map(|k| series[k] * basis[k]).sum::<f64>()).powi(2)
    });
    let n = column.len() as f64;
    let variance = 2.0 * left.sum::<f64>() / (n * n);
    for k in [3, 5] {
        if series[k].powi(2) + series[k + 1].powi(2) < SIGNIFICANT.powi(2) * variance {
            (series[k], series[k + 1]) = (0.0, 0.0);
        }
    }
    series
}

/// The residuals' Fourier coefficients at frequencies beside each harmonic, as many below as above since noise falls with
/// frequency, stand for the noise at the harmonic itself.
fn noise(
    channels: [&[f64]; 3],
    fitted: &[Series; 3],
    time: &[f64],
    omega: f64,
    cycles: usize,
    taper: &[f64],
) -> ([Matrix3<f64>; HARMONICS], NoiseSpectrum) {
    let n = time.len();
    // Of the window's own frequencies (multiples of 1 over its length) those that are no harmonic; half multiples where
    // one cycle leaves none.
    let step = if cycles == 1 { 0.5 } else { 1.0 / cycles as f64 };
    let is_free = |share: f64| (share - share.round()).abs() > 1e-6;
    let shares: [Vec<f64>; HARMONICS] = std::array::from_fn(|k| {
        let centre = (k + 1) as f64;
        let apart = (1..).map(|j| j as f64 * step).take_while(|apart| *apart < centre - 0.5 * step);
        let pairs = apart.filter(|apart| is_free(centre - apart)).take(NEIGHBOURS);
        pairs.flat_map(|apart| [centre - apart, centre + apart]).collect()
    });
    let mut frequencies: Vec<f64> = shares.iter().flatten().copied().collect();
    frequencies.sort_by(f64::total_cmp);
    frequencies.dedup();
    let mut transforms = vec![(Vector3::zeros(), Vector3::zeros()); frequencies.len()];
    let turn: Vec<(f64, f64)> = {
        let interval = (time[n - 1] - time[0]) / (n - 1) as f64;
        frequencies.iter().map(|share| (share * omega * interval).sin_cos()).collect()
    };
    let mut phasors = vec![(0.0, 1.0); frequencies.len()];
    for i in 0..n {
        let basis = basis(omega * (time[i] - time[0]));
        let residual = Vector3::from_fn(|channel, _| {
            channels[channel][i] - (0..TERMS).map(|k| fitted[channel][k] * basis[k]).sum::<f64>()
        });
        for (j, (sine, cosine)) in phasors.iter_mut().enumerate() {
            transforms[j].0 += residual * (taper[i] * *cosine);
            transforms[j].1 += residual * (taper[i] * *sine);
            let (ds, dc) = turn[j];
            (*sine, *cosine) = (*sine * dc + *cosine * ds, *cosine * dc - *sine * ds);
        }
    }
    let scale = (2.0 / taper.iter().sum::<f64>()).powi(2);
    let spectrum: NoiseSpectrum = frequencies
        .iter()
        .zip(&transforms)
        .map(|(share, (a, b))| {
            let hz = share * omega / std::f64::consts::TAU;
            (hz, (a * a.transpose() + b * b.transpose()) * (0.5 * scale))
        })
        .collect();
    let mean = |near: Vec<f64>| {
        let found = near.iter().filter_map(|share| frequencies.iter().position(|f| f == share));
        found.map(|j| spectrum[j].1).sum::<Matrix3<f64>>() / near.len().max(1) as f64
    };
    (shares.map(mean), spectrum)
}

/// Amplitude and phase of a motion over one cycle, from every start.
struct Envelope {
    /// First sample of each cycle.
    starts: Vec<usize>,
    amplitude: Vec<f64>,
    phase: Vec<f64>,
    period: usize,
    interval_s: f64,
}

impl Envelope {
    fn fit(history: &History, motion: &[f64], plateau: Window, frequency_hz: f64) -> Option<Envelope> {
        let time = history.time_s();
        let interval_s = history.interval_s();
        let period = (1.0 / frequency_hz / interval_s).round() as usize;
        if period < 8 || period > plateau.len() {
            return None;
        }
        let omega = std::f64::consts::TAU * frequency_hz;
        let mut sums = Vec::with_capacity(plateau.len() + 1);
        let mut sum = (0.0, 0.0);
        sums.push(sum);
        for i in plateau.from..plateau.to {
            let (sine, cosine) = (omega * time[i]).sin_cos();
            sum = (sum.0 + motion[i] * cosine, sum.1 + motion[i] * sine);
            sums.push(sum);
        }
        let step = (period / 24).max(1);
        let mut envelope = Envelope { starts: vec![], amplitude: vec![], phase: vec![], period, interval_s };
        for from in (0..=plateau.len() - period).step_by(step) {
            let (a, b) = (sums[from + period].0 - sums[from].0, sums[from + period].1 - sums[from].1);
            envelope.starts.push(plateau.from + from);
            envelope.amplitude.push(2.0 / period as f64 * a.hypot(b));
            envelope.phase.push((-b).atan2(a));
        }
        Some(envelope)
    }

    /// The stretch at full amplitude, and the frequency as its phase shows it.
    fn flat(&self, frequency_hz: f64) -> Option<(Window, Option<f64>)> {
        let mut sorted = self.amplitude.clone();
        sorted.sort_by(f64::total_cmp);
        let full = sorted[(0.9 * (sorted.len() - 1) as f64) as usize];
        if full <= 0.0 {
            return None;
        }
        let (mut best, mut start) = (0..0, 0);
        for end in 0..=self.starts.len() {
            if end == self.starts.len() || (self.amplitude[end] / full - 1.0).abs() > AMPLITUDE_TOLERANCE {
                if end - start > best.len() {
                    best = start..end;
                }
                start = end + 1;
            }
        }
        let (first, last) = (best.start, best.end.checked_sub(1)?);
        let window = Window { from: self.starts[first], to: self.starts[last] + self.period };
        let apart_s = (self.starts[last] - self.starts[first]) as f64 * self.interval_s;
        let measured = (apart_s * frequency_hz >= 0.9).then(|| {
            // The phase drifts by less than half a turn from one start to the next, so that it can be followed.
            let turned: f64 = (first..last)
                .map(|i| {
                    let step = self.phase[i + 1] - self.phase[i];
                    step - std::f64::consts::TAU * (step / std::f64::consts::TAU).round()
                })
                .sum();
            frequency_hz + turned / (std::f64::consts::TAU * apart_s)
        });
        Some((window, measured))
    }
}

impl Harmonics {
    /// What the crew should know.
    pub fn notices(&self, run: &Run) -> Vec<String> {
        let mut notices = Vec::new();
        if self.frequency_hz != run.frequency_hz {
            notices.push(format!(
                "oscillates at {:.4} Hz where {} Hz was commanded; the measured frequency is used",
                self.frequency_hz, run.frequency_hz
            ));
        }
        if self.cycles == 1 {
            notices.push("one whole cycle only".to_owned());
        }
        let check = |what: &str, unit: &str, found: f64, commanded: Option<f64>| {
            let commanded = commanded.filter(|c| (found / c - 1.0).abs() > 0.05)?;
            Some(format!(
                "{what} amplitude {found:.4} {unit} where {commanded} {unit} was commanded; the measured one is used"
            ))
        };
        let amplitude = |series: &Series| series[1].hypot(series[2]);
        if run.kind == Kind::Sway {
            notices.extend(check("sway", "m", amplitude(&self.sway_m), run.sway_amplitude_m));
        } else {
            let degrees = amplitude(&self.yaw_rad).to_degrees();
            notices.extend(check("yaw", "deg", degrees, run.yaw_amplitude_deg));
        }
        notices
    }
}
