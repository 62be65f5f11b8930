//! The rate at which the glider passes the water on each leg, without the noise of what is read there.
//!
//! A lag of the pressure and a shear act by the vertical velocity, and the reading of a row is what is to be explained. With one stretch on
//! each leg, at one depth and on one heading, a column that goes by the readings fits all of their noise; with more stretches it fits what
//! lasts for a leg. So the rate is that of the vehicle's steady glide, its mean over the bins of the leg, times the median ratio of what was
//! read to it on all legs of that direction.
//!
//! Knows bins and the vehicle; no fit.

use std::collections::BTreeMap;

use super::model;
use crate::dynamics::Parameters;
use crate::identify::Bin;
use crate::log::{DBAR_PA, Observation, median};

/// The rate of each leg that has bins.
#[derive(Debug, Clone, Default)]
pub struct LegRates {
    /// Vertical velocity, down positive \[m/s\], and rate of the pressure \[dbar/s\].
    of_leg: BTreeMap<u32, [f64; 2]>,
}

impl LegRates {
    /// From bins in which this vehicle flies.
    pub fn new(parameters: &Parameters<f64>, bins: &[Bin]) -> LegRates {
        let predicted: Vec<f64> = bins.iter().map(|bin| model::sink_m_s(parameters, bin)).collect();
        let sinks = |bin: &Bin| bin.mean.sink_m_s > 0.0;
        let ratio = |down: bool| {
            let of_direction = bins.iter().zip(&predicted).filter(|(bin, _)| sinks(bin) == down);
            let ratios = of_direction.map(|(bin, predicted)| bin.mean.sink_m_s / predicted);
            let mut ratios: Vec<f64> = ratios.filter(|ratio| ratio.is_finite() && *ratio > 0.0).collect();
            if ratios.is_empty() { f64::NAN } else { median(&mut ratios) }
        };
        let [down, up] = [ratio(true), ratio(false)];
        let mut sums: BTreeMap<u32, ([f64; 2], f64)> = BTreeMap::new();
        for (bin, predicted) in bins.iter().zip(&predicted) {
            let sink_m_s = predicted * if sinks(bin) { down } else { up };
            let per_metre_dbar = bin.mean.density_kg_m3 * parameters.gravity_m_s2 / DBAR_PA;
            if sink_m_s.is_finite() {
                let (sum, n) = sums.entry(bin.mean.leg).or_default();
                *sum = [sum[0] + sink_m_s, sum[1] + sink_m_s * per_metre_dbar];
                *n += 1.0;
            }
        }
        LegRates { of_leg: sums.into_iter().map(|(leg, (sum, n))| (leg, sum.map(|sum| sum / n))).collect() }
    }

    /// The vertical velocity on a leg \[m/s\]; 0 where it has no bin.
    pub fn sink_m_s(&self, leg: u32) -> f64 {
        self.of_leg.get(&leg).map_or(0.0, |[sink_m_s, _]| *sink_m_s)
    }

    /// Puts the rate of its leg in place of the rate of the pressure that was read; 0 where the leg has no bin.
    pub fn put_into(&self, sample: &mut Observation) {
        sample.pressure_rate_dbar_s = self.of_leg.get(&sample.leg).map_or(0.0, |[_, rate_dbar_s]| *rate_dbar_s);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::sea::{MIN_SAMPLES, steady_log};
    use crate::identify::bins;
    use crate::vehicle::Vehicle;

    /// A leg that reads a twentieth too fast has the rate of the others by pitch and ballast, and what all of them read too fast it has too.
    #[test]
    fn the_noise_of_a_leg_is_not_in_its_rate() {
        let parameters = Vehicle::load("slocum-graver").expect("a vehicle").glide_parameters();
        let log = steady_log::log(&parameters);
        let leg = log[log.len() / 2].leg;
        let rate = |too_fast: &dyn Fn(&Observation) -> bool| {
            let mut read = log.clone();
            read.iter_mut().filter(|o| too_fast(o)).for_each(|o| o.sink_m_s *= 1.05);
            LegRates::new(&parameters, &bins(&read, 400, MIN_SAMPLES)).sink_m_s(leg)
        };
        let clean = rate(&|_| false);
        let [of_noise, of_all] = [rate(&|o| o.leg == leg) / clean, rate(&|_| true) / clean];
        assert!((of_noise - 1.0).abs() < 2e-3 && (of_all - 1.05).abs() < 1e-9, "{of_noise} {of_all}");
    }
}
