//! Faults of rig, model and water that are in no catalogue: how they change the runs as they are made, and the loads that
//! the balance measures. Knows runs and loads; no statistics.

use super::effects::RigFaults;
use super::hull::Loads;
use super::planned_run::PlannedRun;

/// Speed about which layered water holds a model back, and how wide the range is, m/s.
const DEAD_WATER_M_S: (f64, f64) = (1.0, 0.5);
/// A day's length, h, after which layers are as strong as stated.
const DAY_H: f64 = 6.0;
/// Width of a transition in speed and of a resonance, m/s.
const TRANSITION_M_S: f64 = 0.3;
const RESONANCE_M_S: f64 = 0.25;
/// A model that touches hands over its share within this angle, rad.
const TOUCHES_WITHIN_RAD: f64 = 0.009;

/// Lets the faults act on runs: their drag, their true angle, their recorded speed.
pub(super) fn mislead(runs: &mut [PlannedRun], hulls: &[usize], faults: &RigFaults) {
    let chosen = |fraction: f64| hulls[((hulls.len() as f64 * fraction) as usize).min(hulls.len() - 1)];
    for (number, run) in runs.iter_mut().enumerate() {
        run.speed_slip = scattered(number);
        if run.hull.is_none() {
            continue;
        }
        let speed = run.command.speed_m_s;
        if faults.dead_water_cd != 0.0 {
            let near = (-((speed - DEAD_WATER_M_S.0) / DEAD_WATER_M_S.1).powi(2)).exp();
            run.extra_cd += faults.dead_water_cd * near * run.hours / DAY_H;
        }
        if let Some((cd, time_constant_h)) = faults.air {
            run.extra_cd += cd * (-run.hours / time_constant_h).exp();
        }
        if let Some(strip) = faults.torn_strip.filter(|strip| run.hull == Some(chosen(strip.hull_fraction))) {
            let share = if strip.side * run.command.yaw_deg >= 0.0 { 1.0 } else { 0.4 };
            let below = 0.5 * (1.0 - ((speed - strip.speed_m_s) / TRANSITION_M_S).tanh());
            run.extra_cd -= strip.drag_saved * share * below;
        }
    }
    for hull in hulls {
        let of_hull = |run: &&mut PlannedRun| run.hull == Some(*hull) && run.command.speed_m_s > 0.0;
        let count = runs.iter_mut().filter(of_hull).count() as f64;
        if let Some((from, block)) = faults.flipped_block {
            let first = (from * count) as usize;
            for run in runs.iter_mut().filter(of_hull).skip(first).take(block) {
                run.yaw_error_deg -= 2.0 * run.command.yaw_deg;
            }
        }
        if let Some((degrees, _, from)) = faults.yaw_slip.filter(|(_, fraction, _)| *hull == chosen(*fraction)) {
            for run in runs.iter_mut().filter(of_hull).skip((from * count) as usize) {
                run.yaw_error_deg += degrees;
            }
        }
    }
}

impl RigFaults {
    /// The load that the balance measures, from that of hull, strut and inertia.
    #[inline]
    pub(super) fn on_balance(&self, load: Loads, speed_m_s: f64, heading_rad: f64, yaw_deg: f64) -> Loads {
        let mut load = load;
        if let Some(touching) = self.touching {
            let beyond = (touching.side * heading_rad - touching.onset_rad) / TOUCHES_WITHIN_RAD;
            let kept = 1.0 - touching.share * 0.5 * (1.0 + beyond.tanh());
            load = Loads { x: kept * load.x, y: kept * load.y, n: kept * load.n };
        }
        if let Some((share, at_m_s)) = self.resonance {
            load.n *= 1.0 + share * (-((speed_m_s - at_m_s) / RESONANCE_M_S).powi(2)).exp();
        }
        let (moment, side) = self.cable_per_deg;
        load.n += moment * yaw_deg;
        load.y += side * yaw_deg;
        load
    }
}

/// Numbers without order, of zero mean and unit variance: the golden section's multiples are spread evenly.
fn scattered(number: usize) -> f64 {
    let even = (number as f64 * 0.618_033_988_749_894_9 + 0.37).fract();
    (even - 0.5) * 12f64.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scattered_numbers_have_unit_variance() {
        let numbers: Vec<f64> = (0..1000).map(scattered).collect();
        let mean = numbers.iter().sum::<f64>() / 1000.0;
        let variance = numbers.iter().map(|x| x * x).sum::<f64>() / 1000.0;
        assert!(mean.abs() < 0.01 && (variance - 1.0).abs() < 0.01, "{mean} {variance}");
    }

    #[test]
    fn without_faults_the_balance_feels_the_load() {
        let load = Loads { x: -3.0, y: 5.0, n: 2.0 };
        assert_eq!(RigFaults::default().on_balance(load, 2.0, 0.1, 5.0), load);
    }
}
