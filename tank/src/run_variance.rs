//! How much the mean of one steady run scatters, from that run and from those like it. A single record tells its own
//! variance on a few degrees of freedom only; taken at its word, a run that looks quiet by chance would outweigh the rest,
//! and the fit believe itself better than it is.

use std::collections::BTreeMap;

/// Degrees of freedom of a run's own variance: four squares at least.
pub const OWN_DOF: f64 = 4.0;
/// Weight of what runs at one speed share against a run's own, in degrees of freedom.
const SPEED_DOF: f64 = 30.0;
/// Weight of the trend over all speeds against the mean of the runs at one, in degrees of freedom.
const TREND_DOF: f64 = 12.0;

/// Draws the variances of runs towards the mean of those at the same speed, and that towards a power of the speed through
/// all of them where there are three speeds or more: a run that is alone at its speed has no other company.
pub fn share(variances: &[f64], speeds_m_s: &[f64]) -> Vec<f64> {
    let mut by_speed: BTreeMap<u64, (f64, Vec<f64>)> = BTreeMap::new();
    for (variance, speed) in variances.iter().zip(speeds_m_s) {
        by_speed.entry(speed.to_bits()).or_insert((*speed, vec![])).1.push(*variance);
    }
    let groups: Vec<Group> = by_speed.into_values().map(|(speed_m_s, own)| Group::new(speed_m_s, &own)).collect();
    let shared = |speed_m_s: f64| {
        let group = groups.iter().find(|group| group.speed_m_s == speed_m_s)?;
        let own_dof = OWN_DOF * group.runs;
        Some(match trend(&groups) {
            Some(trend) => (own_dof * group.mean + TREND_DOF * trend(speed_m_s)) / (own_dof + TREND_DOF),
            None if group.runs > 1.0 => group.mean,
            None => return None,
        })
    };
    let drawn = |(variance, speed_m_s): (&f64, &f64)| match shared(*speed_m_s) {
        Some(shared) => (OWN_DOF * variance + SPEED_DOF * shared) / (OWN_DOF + SPEED_DOF),
        None => *variance,
    };
    variances.iter().zip(speeds_m_s).map(drawn).collect()
}

/// The runs at one speed.
struct Group {
    speed_m_s: f64,
    runs: f64,
    mean: f64,
}

impl Group {
    fn new(speed_m_s: f64, variances: &[f64]) -> Group {
        let runs = variances.len() as f64;
        Group { speed_m_s, runs, mean: variances.iter().sum::<f64>() / runs }
    }
}

/// Variance as a power of the speed: a straight line in logarithms through the means, each with the weight of its runs.
fn trend(groups: &[Group]) -> Option<impl Fn(f64) -> f64> {
    if groups.len() < 3 || groups.iter().any(|group| group.speed_m_s <= 0.0 || group.mean <= 0.0) {
        return None;
    }
    let runs: f64 = groups.iter().map(|group| group.runs).sum();
    let mean = |of: &dyn Fn(&Group) -> f64| groups.iter().map(|group| group.runs * of(group)).sum::<f64>() / runs;
    let (x, y) = (mean(&|group| group.speed_m_s.ln()), mean(&|group| group.mean.ln()));
    let xx = mean(&|group| (group.speed_m_s.ln() - x).powi(2));
    let xy = mean(&|group| (group.speed_m_s.ln() - x) * (group.mean.ln() - y));
    Some(move |speed_m_s: f64| (y + xy / xx * (speed_m_s.ln() - x)).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_alone_at_its_speed_is_drawn_to_the_power_law_of_the_others() {
        // Ten runs each at 1 and 3 m/s whose variance falls with the fourth power of speed; one at 2 m/s, a hundredth of its share.
        let speeds: Vec<f64> = (0..21).map(|i| if i == 20 { 2.0 } else { f64::from(1 + 2 * (i % 2)) }).collect();
        let law = |speed: f64| speed.powi(-4);
        let mut variances: Vec<f64> = speeds.iter().map(|speed| law(*speed)).collect();
        variances[20] *= 0.01;
        let drawn = share(&variances, &speeds);
        assert!((drawn[0] / law(1.0) - 1.0).abs() < 0.15 && (drawn[1] / law(3.0) - 1.0).abs() < 0.15, "{drawn:?}");
        assert!((0.5..1.0).contains(&(drawn[20] / law(2.0))), "{}", drawn[20] / law(2.0));
    }

    #[test]
    fn one_speed_is_drawn_to_its_mean_and_one_run_is_left_as_it_is() {
        assert_eq!(share(&[3.0], &[2.0]), [3.0]);
        let drawn = share(&[1.0, 3.0], &[2.0, 2.0]);
        assert!(drawn[0] > 1.7 && drawn[1] < 2.3 && (drawn[0] + drawn[1] - 4.0).abs() < 1e-12, "{drawn:?}");
    }
}
