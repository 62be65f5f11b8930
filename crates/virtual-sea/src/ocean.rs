//! The water: stratification, in-situ density, internal waves, shear and turbulence. Knows nothing of gliders.
//!
//! Density is the international equation of state of 1980 (EOS-80), typed from Fofonoff and Millard, "Algorithms for
//! computation of fundamental properties of seawater", UNESCO Technical Papers in Marine Science 44 (1983); it differs
//! from TEOS-10 by about 0.01 kg/m3, which keeps the logs independent of any one library's choice.

use crate::random::{Stream, between, normal, sign};
use std::f64::consts::TAU;

/// Gravity used throughout, m/s2.
pub const GRAVITY_M_S2: f64 = 9.81;

const GRID_M: f64 = 1.0;
const VERTICAL_MODES: usize = 3;
const WAVES_PER_MODE: usize = 6;
const INERTIAL_PERIOD_S: f64 = 16.0 * 3600.0;

/// What a glider meets at one depth and moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Water {
    /// Temperature, degrees Celsius (ITS-90).
    pub temperature_c: f64,
    /// Practical salinity (PSS-78).
    pub salinity_psu: f64,
    /// In-situ density, kg/m3.
    pub density_kg_m3: f64,
}

/// How rough an ocean to draw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weather {
    /// Multiplies the drawn internal waves, shear and turbulence; 0 is a still ocean, 1 the usual one.
    pub roughness: f64,
    /// Temperature and salinity the same at all depths (density still grows with pressure).
    pub unstratified: bool,
    /// A shelf in summer: the thermocline, else 15 to 40 m thick, is one of 2 to 5 m, at 15 to 35 m.
    pub shelf: bool,
}

impl Default for Weather {
    fn default() -> Self {
        Self { roughness: 1.0, unstratified: false, shelf: false }
    }
}

/// One drawn ocean.
#[derive(Debug, Clone)]
pub struct Ocean {
    /// Root mean square vertical velocity of the internal waves where they are strongest in depth, m/s.
    pub wave_rms_m_s: f64,
    /// Standard deviation of the turbulent velocity, m/s; it decorrelates over [`Ocean::turbulence_time_s`].
    pub turbulence_m_s: f64,
    /// Decorrelation time of the turbulence along the glider's path, s.
    pub turbulence_time_s: f64,
    profile: Profile,
    temperature_c: Vec<f64>,
    salinity_psu: Vec<f64>,
    pressure_pa: Vec<f64>,
    shape: [Vec<f64>; VERTICAL_MODES],
    waves: [[Wave; WAVES_PER_MODE]; VERTICAL_MODES],
    shear: Shear,
}

#[derive(Debug, Clone, Copy)]
struct Profile {
    surface_c: f64,
    deep_c: f64,
    surface_psu: f64,
    deep_psu: f64,
    thermocline_m: f64,
    thickness_m: f64,
    seabed_m: f64,
}

#[derive(Debug, Clone, Copy)]
struct Wave {
    amplitude_m_s: f64,
    frequency_rad_s: f64,
    phase_rad: f64,
}

#[derive(Debug, Clone, Copy)]
struct Shear {
    half_jump_m_s: f64,
    direction_rad: f64,
}

/// The internal waves from one step of the integration to the next: their sines are turned by a step's angle. Eighteen of them
/// computed anew for each step were a fifth of a flight's time.
#[derive(Debug, Clone)]
pub struct WavesByStep<'a> {
    ocean: &'a Ocean,
    /// Sine and cosine of each wave's phase now, and of the angle by which it grows in a step.
    phases: [[[SinCos; 2]; WAVES_PER_MODE]; VERTICAL_MODES],
}

type SinCos = (f64, f64);

impl WavesByStep<'_> {
    /// The waves now.
    pub fn waves(&self) -> Waves {
        self.ocean.waves_with(|mode, place| self.phases[mode][place][0])
    }

    /// Goes on by one step. Rounding adds up: after half a day of steps of 0.25 s the heave is within 1e-9 m (a test).
    pub fn advance(&mut self) {
        for [(sin, cos), (step_sin, step_cos)] in self.phases.as_flattened_mut() {
            (*sin, *cos) = (*sin * *step_cos + *cos * *step_sin, *cos * *step_cos - *sin * *step_sin);
        }
    }
}

/// The internal waves at one moment: enough to give velocity and heave at any depth cheaply.
#[derive(Debug, Clone, Copy)]
pub struct Waves {
    velocity_m_s: [f64; VERTICAL_MODES],
    heave_m: [f64; VERTICAL_MODES],
}

impl Ocean {
    /// Draws an ocean.
    pub fn draw(random: &mut Stream, weather: Weather) -> Self {
        let surface_c = between(random, 13.0, 22.0);
        let surface_psu = between(random, 31.5, 34.0);
        let fall_c = between(random, 7.0, 12.0);
        let rise_psu = between(random, 0.5, 2.0);
        let mut thermocline_m = between(random, 35.0, 80.0);
        let mut thickness_m = between(random, 15.0, 40.0);
        if weather.shelf {
            thermocline_m = 15.0 + (thermocline_m - 35.0) * 20.0 / 45.0;
            thickness_m = 2.0 + (thickness_m - 15.0) * 3.0 / 25.0;
        }
        let stratified = if weather.unstratified { 0.0 } else { 1.0 };
        let profile = Profile {
            surface_c,
            deep_c: surface_c - stratified * fall_c,
            surface_psu,
            deep_psu: surface_psu + stratified * rise_psu,
            thermocline_m,
            thickness_m,
            seabed_m: between(random, 1100.0, 1500.0),
        };
        let wave_rms_m_s = weather.roughness * between(random, 0.003, 0.007);
        let turbulence_m_s = weather.roughness * between(random, 0.002, 0.005);
        let turbulence_time_s = between(random, 20.0, 60.0);
        let waves = draw_waves(random, wave_rms_m_s);
        let shear = Shear {
            half_jump_m_s: weather.roughness * between(random, 0.02, 0.08) * sign(random),
            direction_rad: between(random, 0.0, TAU),
        };
        let (temperature_c, salinity_psu, pressure_pa) = profile.tabulate();
        let shape = mode_shapes(&temperature_c, &salinity_psu);
        Self {
            wave_rms_m_s,
            turbulence_m_s,
            turbulence_time_s,
            profile,
            temperature_c,
            salinity_psu,
            pressure_pa,
            shape,
            waves,
            shear,
        }
    }

    /// Gauge pressure of the water column at a depth, Pa (0 above the surface).
    pub fn pressure_pa(&self, depth_m: f64) -> f64 {
        at_depth(&self.pressure_pa, depth_m)
    }

    /// Water at a depth that heaving has brought down from `depth_m - heave_m`.
    pub fn water(&self, depth_m: f64, heave_m: f64) -> Water {
        let origin_m = depth_m - heave_m;
        let temperature_c = at_depth(&self.temperature_c, origin_m);
        let salinity_psu = at_depth(&self.salinity_psu, origin_m);
        let pressure_dbar = self.pressure_pa(depth_m) * 1e-4;
        Water { temperature_c, salinity_psu, density_kg_m3: density_eos80(salinity_psu, temperature_c, pressure_dbar) }
    }

    /// The internal waves at a time since the start, s.
    pub fn waves(&self, time_s: f64) -> Waves {
        self.waves_with(|mode, place| {
            let wave = &self.waves[mode][place];
            (wave.frequency_rad_s * time_s + wave.phase_rad).sin_cos()
        })
    }

    /// The internal waves from the start on, by steps of this length, s.
    pub fn waves_by_step(&self, step_s: f64) -> WavesByStep<'_> {
        let phases = self
            .waves
            .each_ref()
            .map(|mode| mode.map(|wave| [wave.phase_rad.sin_cos(), (wave.frequency_rad_s * step_s).sin_cos()]));
        WavesByStep { ocean: self, phases }
    }

    fn waves_with(&self, sin_cos: impl Fn(usize, usize) -> SinCos) -> Waves {
        let mut now = Waves { velocity_m_s: [0.0; VERTICAL_MODES], heave_m: [0.0; VERTICAL_MODES] };
        for (mode, waves) in self.waves.iter().enumerate() {
            for (place, wave) in waves.iter().enumerate() {
                let (sin, cos) = sin_cos(mode, place);
                now.velocity_m_s[mode] += wave.amplitude_m_s * cos;
                now.heave_m[mode] += wave.amplitude_m_s / wave.frequency_rad_s * sin;
            }
        }
        now
    }

    /// Vertical velocity (m/s, down positive) and downward displacement (m) of the water by the waves.
    pub fn heave(&self, waves: &Waves, depth_m: f64) -> (f64, f64) {
        (0..VERTICAL_MODES).fold((0.0, 0.0), |(velocity, heave), mode| {
            let shape = at_depth(&self.shape[mode], depth_m);
            (velocity + shape * waves.velocity_m_s[mode], heave + shape * waves.heave_m[mode])
        })
    }

    /// Change with depth of the current's component along a heading, 1/s.
    pub fn shear_along(&self, depth_m: f64, time_s: f64, heading_rad: f64) -> f64 {
        let Profile { thermocline_m, thickness_m, .. } = self.profile;
        let cosh = ((depth_m - thermocline_m) / thickness_m).cosh();
        let direction = self.shear.direction_rad + TAU * time_s / INERTIAL_PERIOD_S;
        -self.shear.half_jump_m_s / (thickness_m * cosh * cosh) * (heading_rad - direction).cos()
    }

    /// Temperature difference between the surface and the deep, K.
    pub fn temperature_range_k(&self) -> f64 {
        self.profile.surface_c - self.profile.deep_c
    }
}

impl Profile {
    fn tabulate(&self) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let levels = (self.seabed_m / GRID_M) as usize + 1;
        let top = self.deep_fraction(0.0);
        let mut pressure_pa = 0.0;
        let mut columns = (Vec::with_capacity(levels), Vec::with_capacity(levels), Vec::with_capacity(levels));
        for level in 0..levels {
            let fraction = (self.deep_fraction(level as f64 * GRID_M) - top) / (1.0 - top);
            let temperature_c = self.surface_c + (self.deep_c - self.surface_c) * fraction;
            let salinity_psu = self.surface_psu + (self.deep_psu - self.surface_psu) * fraction;
            columns.0.push(temperature_c);
            columns.1.push(salinity_psu);
            columns.2.push(pressure_pa);
            let density = density_eos80(salinity_psu, temperature_c, pressure_pa * 1e-4);
            pressure_pa += density * GRAVITY_M_S2 * GRID_M;
        }
        columns
    }

    /// From 0 in the mixed layer to 1 in the deep: a thermocline, and below it the slow decay of the main pycnocline.
    fn deep_fraction(&self, depth_m: f64) -> f64 {
        let thermocline = 0.5 * (1.0 + ((depth_m - self.thermocline_m) / self.thickness_m).tanh());
        let main = 1.0 - (-depth_m / 400.0).exp();
        0.7 * thermocline + 0.3 * main
    }
}

/// Random phases, one period in each of six bands from 10 min to 6 h; the first vertical mode carries most. Between the
/// inertial and the buoyancy frequency the vertical velocity of internal waves has a flat spectrum (Garrett and Munk
/// 1979), so a band's variance goes with its width in frequency: as 1/period for bands of equal ratio.
fn draw_waves(random: &mut Stream, rms_m_s: f64) -> [[Wave; WAVES_PER_MODE]; VERTICAL_MODES] {
    const SHARE_OF_VARIANCE: [f64; VERTICAL_MODES] = [0.6, 0.25, 0.15];
    let (shortest_s, longest_s) = (600.0_f64, 6.0 * 3600.0_f64);
    let period_s = |place: f64| shortest_s * (longest_s / shortest_s).powf(place / WAVES_PER_MODE as f64);
    let width = |band: usize| 1.0 / period_s(band as f64 + 0.5);
    let all: f64 = (0..WAVES_PER_MODE).map(width).sum();
    SHARE_OF_VARIANCE.map(|share| {
        std::array::from_fn(|band| Wave {
            amplitude_m_s: rms_m_s * (2.0 * share * width(band) / all).sqrt(),
            frequency_rad_s: TAU / period_s(band as f64 + between(random, 0.0, 1.0)),
            phase_rad: between(random, 0.0, TAU),
        })
    })
}

/// WKB vertical modes: sin(n pi times the share of the integrated buoyancy frequency above), so the velocity vanishes at
/// surface and seabed and the nodes crowd where the stratification is strong.
fn mode_shapes(temperature_c: &[f64], salinity_psu: &[f64]) -> [Vec<f64>; VERTICAL_MODES] {
    let frequency: Vec<f64> = (0..temperature_c.len())
        .map(|i| {
            let j = (i + 1).min(temperature_c.len() - 1);
            let above = density_eos80(salinity_psu[i], temperature_c[i], 0.0);
            let below = density_eos80(salinity_psu[j], temperature_c[j], 0.0);
            (GRAVITY_M_S2 / above * (below - above).max(0.0) / GRID_M).sqrt().max(1e-3)
        })
        .collect();
    let total: f64 = frequency.iter().sum();
    let mut above = 0.0;
    let share: Vec<f64> = frequency
        .iter()
        .map(|n| {
            let here = above / total;
            above += n;
            here
        })
        .collect();
    std::array::from_fn(|mode| share.iter().map(|s| ((mode + 1) as f64 * 0.5 * TAU * s).sin()).collect())
}

fn at_depth(table: &[f64], depth_m: f64) -> f64 {
    let place = (depth_m / GRID_M).clamp(0.0, (table.len() - 1) as f64 - 1e-9);
    let below = place as usize;
    let fraction = place - below as f64;
    table[below] + (table[below + 1] - table[below]) * fraction
}

/// Turbulent velocity along the path: a first-order autoregressive process, one value a step.
#[derive(Debug, Clone, Copy)]
pub struct Wander {
    value: f64,
    sd: f64,
    keep: f64,
}

impl Wander {
    /// A process of standard deviation `sd` and decorrelation time `time_s`, advanced every `step_s`.
    pub fn new(random: &mut Stream, sd: f64, time_s: f64, step_s: f64) -> Self {
        Self { value: sd * normal(random), sd, keep: (-step_s / time_s).exp() }
    }

    /// The present value.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// The next value.
    pub fn next(&mut self, random: &mut Stream) -> f64 {
        self.value = self.keep * self.value + (1.0 - self.keep * self.keep).sqrt() * self.sd * normal(random);
        self.value
    }
}

/// In-situ density of sea water, kg/m3: EOS-80 from practical salinity, temperature in degrees Celsius (ITS-90) and
/// gauge pressure in dbar. Published check: S 35, t68 25, p 10000 dbar gives 1062.53817.
pub fn density_eos80(salinity_psu: f64, temperature_c: f64, pressure_dbar: f64) -> f64 {
    let s = salinity_psu.max(0.0);
    let root = s.sqrt();
    let t = 1.00024 * temperature_c;
    let p = pressure_dbar * 0.1;

    let pure =
        999.842594 + t * (6.793952e-2 + t * (-9.095290e-3 + t * (1.001685e-4 + t * (-1.120083e-6 + t * 6.536332e-9))));
    let linear = 8.24493e-1 + t * (-4.0899e-3 + t * (7.6438e-5 + t * (-8.2467e-7 + t * 5.3875e-9)));
    let three_halves = -5.72466e-3 + t * (1.0227e-4 - t * 1.6546e-6);
    let at_surface = pure + s * (linear + root * three_halves + s * 4.8314e-4);

    let bulk_pure = 19652.21 + t * (148.4206 + t * (-2.327105 + t * (1.360477e-2 - t * 5.155288e-5)));
    let bulk_surface = bulk_pure
        + s * (54.6746 + t * (-0.603459 + t * (1.09987e-2 - t * 6.1670e-5)))
        + s * root * (7.944e-2 + t * (1.6483e-2 - t * 5.3009e-4));
    let first = 3.239908
        + t * (1.43713e-3 + t * (1.16092e-4 - t * 5.77905e-7))
        + s * (2.2838e-3 + t * (-1.0981e-5 - t * 1.6078e-6))
        + s * root * 1.91075e-4;
    let second = 8.50935e-5 + t * (-6.12293e-6 + t * 5.2787e-8) + s * (-9.9348e-7 + t * (2.0816e-8 + t * 9.1697e-10));
    let bulk = bulk_surface + p * (first + p * second);
    at_surface / (1.0 - p / bulk)
}
