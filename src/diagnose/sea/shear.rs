//! A current that the log does not have, and that changes with depth.
//!
//! Water whose velocity changes with depth by `S` accelerates the glider that sinks through it: in the frame of the water its mass
//! needs the force `m S w`, against the heading where the current along it grows on the way. A tenth of a metre per second over a
//! shelf of 40 m is a tenth of the drag. No steady current profile is known of a log without one, but how large such
//! profiles are is. So its shear is part of the model with coefficients that have a prior and no name:
//!
//! ```text
//! S(z) = U zeta'(z) sum_k s_k phi_k(zeta)        s_k ~ N(0, 1), north and east
//! zeta' = (N(z) / mean N + 1) / 2H               phi_0 = 1, phi_k = sqrt(2) cos(k pi zeta)
//! ```
//!
//! Coefficients of equal variance make the current itself a random walk along `zeta` from 0 at the surface to 1 at the deepest,
//! whose ends differ by `U` in the root mean square. Shear goes with the buoyancy frequency `N`: stratified water carries it until
//! the Richardson number `(N/S)^2` falls below 1/4 (Miles 1961), mixed water does not (WKB stretching, Leaman and Sanford 1975). Half
//! of the current's change is spread evenly, since friction at the bottom and wind shear mixed water as well. On one heading a
//! shear is nearly a change of the net mass with depth; dives on other headings separate them.
//!
//! Knows bins and samples; no mechanism.

use super::leg_rates::LegRates;
use crate::dynamics::buoyancy::WATER_COMPRESSIBILITY_PER_PA;
use crate::identify::Bin;
use crate::identify::unknown_shear::DIFFERENCE_M_S;
use crate::log::{DBAR_PA, Observation};

/// Layers over which the stratification is averaged.
const LAYERS: usize = 32;

/// Modes at most: layers down to an eighth of the depth. What is thinner lasts for less than the glider needs to follow.
const MOST_MODES: usize = 8;

/// Rows that each coefficient needs at least.
const ROWS_PER_MODE: usize = 10;

/// Names and unit of the coefficients; on an unknown heading the first ones lie along it.
const NAMES: [[&str; MOST_MODES]; 2] = [
    [
        "shear_north_0",
        "shear_north_1",
        "shear_north_2",
        "shear_north_3",
        "shear_north_4",
        "shear_north_5",
        "shear_north_6",
        "shear_north_7",
    ],
    [
        "shear_east_0",
        "shear_east_1",
        "shear_east_2",
        "shear_east_3",
        "shear_east_4",
        "shear_east_5",
        "shear_east_6",
        "shear_east_7",
    ],
];

/// The shear of an unknown current as the bins meet it.
#[derive(Debug, Clone, Default)]
pub struct UnknownShear {
    /// For each coefficient its name, and what a unit of it changes of the water's velocity along the heading in each bin, as late
    /// as the glider follows \[m/s2\].
    modes: Vec<(&'static str, Vec<f64>)>,
}

impl UnknownShear {
    /// From the bins and the samples they are made of; `late` is what the glider follows of what its samples meet, in each bin.
    pub fn new(
        bins: &[Bin],
        samples: &[Observation],
        leg_rates: &LegRates,
        late: impl Fn(&[f64]) -> Vec<f64>,
    ) -> UnknownShear {
        let water: Vec<(f64, f64)> = samples.iter().map(|o| (depth_m(o), surface_density_kg_m3(o))).collect();
        let Some(stretching) = Stretching::new(&water) else { return UnknownShear::default() };
        let headings = headings(samples);
        let components = headings.first().map_or(0, |components| components.len());
        let n_modes = MOST_MODES.min(depths_of_a_dive(bins)).min(bins.len() / (ROWS_PER_MODE * components.max(1)));
        let mut modes = Vec::new();
        for (component, names) in NAMES.iter().enumerate().take(components) {
            for (k, name) in names.iter().enumerate().take(n_modes) {
                let met: Vec<f64> = (0..samples.len())
                    .map(|i| {
                        stretching.shear(k, depth_m(&samples[i]))
                            * leg_rates.sink_m_s(samples[i].leg)
                            * headings[i][component]
                    })
                    .map(|met| if met.is_finite() { met } else { 0.0 })
                    .collect();
                let late = late(&met);
                if late.iter().any(|met| *met != 0.0) {
                    modes.push((*name, late));
                }
            }
        }
        UnknownShear { modes }
    }

    /// How many coefficients there are.
    pub fn len(&self) -> usize {
        self.modes.len()
    }

    /// Name and unit of each coefficient.
    pub fn names(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        self.modes.iter().map(|(name, _)| (*name, "1"))
    }

    /// The force along the heading that a unit of a coefficient exerts on a glider of this mass in a bin \[N\].
    pub fn unit_N(&self, coefficient: usize, bin: usize, mass_kg: f64) -> f64 {
        -mass_kg * self.modes[coefficient].1[bin]
    }

    /// By how much the current differs between the surface and the deepest: the first mode of each component \[m/s\].
    pub fn difference_m_s(&self, coefficients: &[f64]) -> f64 {
        let is_first = |name: &str| NAMES.iter().any(|names| names[0] == name);
        let first = self.modes.iter().zip(coefficients).filter(|((name, _), _)| is_first(name));
        DIFFERENCE_M_S * first.map(|(_, value)| value * value).sum::<f64>().sqrt()
    }

    /// The force along the heading in a bin \[N\].
    pub fn along_N(&self, coefficients: &[f64], bin: usize, mass_kg: f64) -> f64 {
        let of = |(j, value): (usize, &f64)| value * self.unit_N(j, bin, mass_kg);
        coefficients.iter().enumerate().map(of).sum()
    }
}

/// Depth stretched by the stratification.
struct Stretching {
    deepest_m: f64,
    /// `zeta'` in each layer \[1/m\].
    slope: [f64; LAYERS],
    /// `zeta` at the top of each layer.
    top: [f64; LAYERS],
}

impl Stretching {
    /// By the mean density of the layers, from depth and density at p = 0 of each sample; even where no sample has a density.
    fn new(water: &[(f64, f64)]) -> Option<Stretching> {
        let deepest_m = water.iter().map(|(depth_m, _)| *depth_m).filter(|z| z.is_finite()).fold(0.0, f64::max);
        if deepest_m <= 0.0 {
            return None;
        }
        let (mut sum, mut n) = ([0.0; LAYERS], [0.0; LAYERS]);
        for (depth_m, density) in water.iter().filter(|(depth_m, density)| density.is_finite() && *depth_m >= 0.0) {
            let layer = ((depth_m / deepest_m * LAYERS as f64) as usize).min(LAYERS - 1);
            sum[layer] += density;
            n[layer] += 1.0;
        }
        // N up to a factor: the root of the density's gradient, between the layers around each one that have samples.
        let known: Vec<usize> = (0..LAYERS).filter(|layer| n[*layer] > 0.0).collect();
        let frequency: [f64; LAYERS] = std::array::from_fn(|layer| {
            let above = known.iter().rev().find(|other| **other < layer).or(known.first());
            let below = known.iter().find(|other| **other > layer).or(known.last());
            match (above, below) {
                (Some(above), Some(below)) if below > above => {
                    let denser = sum[*below] / n[*below] - sum[*above] / n[*above];
                    (denser / (below - above) as f64).max(0.0).sqrt()
                }
                _ => 0.0,
            }
        });
        let mean = frequency.iter().sum::<f64>() / LAYERS as f64;
        let relative = frequency.map(|frequency| if mean > 0.0 { frequency / mean } else { 1.0 });
        let slope = relative.map(|relative| (relative + 1.0) / (2.0 * deepest_m));
        let layer_m = deepest_m / LAYERS as f64;
        let mut reached = 0.0;
        let top = slope.map(|slope| {
            let top = reached;
            reached += slope * layer_m;
            top
        });
        Some(Stretching { deepest_m, slope, top })
    }

    /// The shear of a unit of a mode at a depth \[1/s\].
    fn shear(&self, mode: usize, depth_m: f64) -> f64 {
        let layer_m = self.deepest_m / LAYERS as f64;
        let layer = ((depth_m.max(0.0) / layer_m) as usize).min(LAYERS - 1);
        let zeta = self.top[layer] + self.slope[layer] * (depth_m.max(0.0) - layer as f64 * layer_m);
        let phi = match mode {
            0 => 1.0,
            k => std::f64::consts::SQRT_2 * (std::f64::consts::PI * k as f64 * zeta).cos(),
        };
        DIFFERENCE_M_S * self.slope[layer] * phi
    }
}

/// A decibar is a metre to a hundredth.
fn depth_m(o: &Observation) -> f64 {
    o.pressure_dbar
}

/// Density of the water brought to p = 0 \[kg/m3\].
fn surface_density_kg_m3(o: &Observation) -> f64 {
    o.density_kg_m3 / (1.0 + WATER_COMPRESSIBILITY_PER_PA * DBAR_PA * o.pressure_dbar)
}

/// North and east component of each sample's heading, the last known one where there is none; one component along the heading
/// where the log has none at all.
fn headings(samples: &[Observation]) -> Vec<Vec<f64>> {
    let Some(first) = samples.iter().map(|o| o.heading_rad).find(|heading| heading.is_finite()) else {
        return vec![vec![1.0]; samples.len()];
    };
    let mut last = first;
    let known = samples.iter().map(|o| {
        if o.heading_rad.is_finite() {
            last = o.heading_rad;
        }
        vec![last.cos(), last.sin()]
    });
    known.collect()
}

/// At how many depths a dive has bins: as many as the median leg has. One on each leg are two where descents and ascents have theirs
/// at other depths, by what the thinnest mode resolves; a row that stands for a whole leg is in the middle on both.
fn depths_of_a_dive(bins: &[Bin]) -> usize {
    let mut counts: Vec<f64> = bins.chunk_by(|a, b| a.mean.leg == b.mean.leg).map(|leg| leg.len() as f64).collect();
    if counts.is_empty() {
        return 0;
    }
    let of_a_leg = crate::log::median(&mut counts) as usize;
    let median_depth_m = |sinks: bool| {
        let of_legs = bins.iter().filter(|bin| (bin.mean.sink_m_s > 0.0) == sinks);
        let mut depths_m: Vec<f64> = of_legs.map(|bin| depth_m(&bin.mean)).collect();
        if depths_m.is_empty() { f64::NAN } else { crate::log::median(&mut depths_m) }
    };
    let deepest_m = bins.iter().map(|bin| depth_m(&bin.mean)).fold(0.0, f64::max);
    let are_apart = (median_depth_m(true) - median_depth_m(false)).abs() > deepest_m / MOST_MODES as f64;
    of_a_leg.max(if are_apart { 2 } else { 1 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Depth and density from the surface to the deepest.
    fn column(deepest_m: f64, density: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        (0..1000).map(|i| deepest_m * f64::from(i) / 999.0).map(|depth_m| (depth_m, density(depth_m))).collect()
    }

    fn difference(stretching: &Stretching, mode: usize, from_m: f64, to_m: f64) -> f64 {
        let n = 100_000;
        let step = (to_m - from_m) / f64::from(n);
        (0..n).map(|i| stretching.shear(mode, from_m + (f64::from(i) + 0.5) * step) * step).sum()
    }

    /// The current is the integral of its shear: with the first mode it changes by the stated difference over the whole depth, with
    /// the others, which are orthogonal to it, by nothing.
    #[test]
    fn the_current_at_the_ends_differs_by_the_first_mode_alone() {
        for deepest_m in [30.0, 200.0, 1000.0] {
            let water = column(deepest_m, |z| 1026.0 + (0.1 * (z - 0.3 * deepest_m)).tanh());
            let stretching = Stretching::new(&water).expect("a depth");
            for mode in 0..MOST_MODES {
                let found = difference(&stretching, mode, 0.0, deepest_m);
                let expected = if mode == 0 { DIFFERENCE_M_S } else { 0.0 };
                assert!((found - expected).abs() < 1e-5, "mode {mode}, {deepest_m} m: {found} m/s");
            }
        }
    }

    #[test]
    fn shear_is_where_the_water_is_stratified_and_even_where_it_is_mixed() {
        let mixed = Stretching::new(&column(100.0, |_| 1026.0)).expect("a depth");
        assert!((difference(&mixed, 0, 0.0, 25.0) - 0.25 * DIFFERENCE_M_S).abs() < 1e-6);
        // One step of the density at 50 m: half of the change of the current lies within the layers about it.
        let step = Stretching::new(&column(100.0, |z| if z < 50.0 { 1024.0 } else { 1026.0 })).expect("a depth");
        let about = difference(&step, 0, 43.75, 56.25);
        assert!((about - (0.5 + 0.5 * 0.125) * DIFFERENCE_M_S).abs() < 0.01 * DIFFERENCE_M_S, "{about} m/s");
    }
}
