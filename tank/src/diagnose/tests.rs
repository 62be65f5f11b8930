//! The diagnosis on campaigns of the virtual tank with nothing hidden, to whose reduced runs a law is added: what it names, and
//! what it must not name.

use glidepolar_hull::coefficients::BalanceForce;

use glidepolar_inference::{Problem as _, Verdict};

use super::data::{SteadyData, Tared};
use super::model::{WAVE_TOP, WAVE_WIDTH};
use super::*;
use crate::virtual_tank::{Options as Tank, write_campaign};
use crate::{Options, Results, reduce_campaign};

/// Three hulls of the good tank at several speeds.
fn campaign(seed: u64) -> Results {
    campaign_of(&["LDR8.5", "LDR10.5", "LDR12.5"], seed)
}

fn campaign_of(hulls: &[&str], seed: u64) -> Results {
    let folder = tempfile::tempdir().expect("a folder");
    let runs = folder.path().join("runs");
    let hulls = hulls.iter().map(|hull| (*hull).to_owned()).collect();
    let tank = Tank { seed, hulls, statics_only: true, size_mb: Some(6.0), ..Tank::default() };
    write_campaign(&runs, &tank).expect("a campaign");
    reduce_campaign(&runs, &Options { range_deg: 10.0, strict: false }, &|_| ()).expect("a reduction")
}

/// Adds a force (AF, SF, YM about the moment centre) to every run.
fn add(results: &mut Results, force: impl Fn(&SteadyData) -> [f64; 3]) {
    let hulls = results.steady.hulls.clone();
    for run in &mut results.steady.runs {
        let (hull, [axial_N, side_N, yaw_N_m]) = (&hulls[run.hull], force(run));
        let c = BalanceForce { axial_N, side_N, yaw_N_m }
            .moved(hull.mc_m, hull.geometry.cb_m)
            .in_wind_axes(run.point.alpha_rad())
            .coefficients(run.pressure_Pa, hull.frontal_area_m2(), hull.geometry.loa_m);
        let added = [c.lift, c.drag, c.moment];
        (0..3).for_each(|k| run.point.coefficients[k] += added[k]);
    }
}

fn speed(run: &SteadyData) -> f64 {
    run.point.nominal_speed_m_s.expect("a speed")
}

fn speeds(results: &Results) -> Vec<f64> {
    let mut speeds: Vec<f64> = results.steady.runs.iter().map(speed).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    speeds
}

fn diagnosed(mut results: Results) -> Diagnosis {
    results.diagnose(&Relevance::default());
    results.diagnoses.and_then(|found| found.campaign).expect("a diagnosis of the campaign")
}

fn names(diagnosis: &Diagnosis) -> Vec<&str> {
    diagnosis.causes.iter().map(|cause| cause.cause.as_str()).collect()
}

#[test]
fn a_zero_under_way_is_one_force_at_all_speeds() {
    let mut constant = campaign(51);
    add(&mut constant, |_| [0.0, 0.8, 0.0]);
    assert_eq!(names(&diagnosed(constant)), ["side_force_zero"]);
    let mut growing = campaign(51);
    let slowest = speeds(&growing)[0];
    add(&mut growing, |run| [0.0, 0.8 * speed(run) / slowest, 0.0]);
    let found = diagnosed(growing);
    assert!(names(&found).is_empty(), "{:?}", names(&found));
}

#[test]
fn a_zero_that_the_runs_of_the_strut_have_too_is_known_by_what_the_tare_leaves_of_it() {
    let mut results = campaign(52);
    add(&mut results, |run| [0, 1, 2].map(|to| run.interaction[(to, 1)] * 2.0 * (1.0 - run.tare_weights[to].sum())));
    let found = diagnosed(results);
    assert_eq!(names(&found), ["side_force_zero"]);
    let size = &found.causes[0].parameters["side_force_zero_N"];
    assert!(size.ci95[0] < 2.0 && 2.0 < size.ci95[1], "{size:?}");
}

#[test]
fn two_speeds_do_not_show_by_which_law_the_drag_depends_on_speed() {
    let mut results = campaign(53);
    let speeds = speeds(&results);
    results.steady.runs.retain(|run| speed(run) == speeds[0] || speed(run) == *speeds.last().expect("speeds"));
    add(&mut results, |_| [-0.6, 0.0, 0.0]);
    let found = diagnosed(results);
    assert!(names(&found).is_empty(), "{:?}", names(&found));
}

#[test]
fn friction_does_not_grow_with_the_reynolds_number() {
    let mut results = campaign(54);
    let median = crate::series::median(&results.steady.runs.iter().map(speed).collect::<Vec<_>>());
    let area = results.steady.hulls[0].frontal_area_m2();
    add(&mut results, |run| [run.pressure_Pa * area * 0.13 * ((speed(run) / median).powf(0.08) - 1.0), 0.0, 0.0]);
    let found = diagnosed(results);
    assert!(!names(&found).contains(&"reynolds_drag"), "{:?}", names(&found));
}

#[test]
fn waves_have_one_size_at_all_drift_angles() {
    let mut results = campaign(56);
    let hulls = results.steady.hulls.clone();
    add(&mut results, |run| {
        let hull = &hulls[run.hull];
        let froude = speed(run) / (9.81 * hull.geometry.loa_m).sqrt();
        let bump = 0.03 * (-((froude - WAVE_TOP) / WAVE_WIDTH).powi(2)).exp();
        // Three times as high at 10 degrees as ahead.
        [bump * (1.0 + run.point.yaw_deg.abs() / 5.0) * run.pressure_Pa * hull.frontal_area_m2(), 0.0, 0.0]
    });
    let found = diagnosed(results);
    assert!(names(&found).is_empty(), "{:?}", names(&found));
}

#[test]
fn the_height_of_a_bump_of_drag_must_be_known() {
    let results = campaign(56);
    let relevance = Relevance::default();
    let problem = TankProblem::new(&results.steady, &results.hulls, &relevance);
    for (candidate, shape) in problem.shapes().iter().enumerate() {
        let expected = if shape.mechanism().name == "free_surface" { 6.0 } else { 0.0 };
        assert_eq!(problem.least_known(candidate), expected, "{}", shape.mechanism().name);
    }
}

/// Shifts of CL by a side force, hull by hull alike.
#[test]
fn what_a_tare_leaves_of_a_zero_at_two_speeds_may_be_any_law_of_the_speed() {
    let mut results = campaign(57);
    let speeds = speeds(&results);
    results.steady.runs.retain(|run| speed(run) == speeds[0] || speed(run) == speeds[2]);
    let fast = speeds[2];
    // What is left of a force in proportion to the speed when its share in proportion to the dynamic pressure is gone.
    let left = |run: &SteadyData| 1.5 * (speed(run) / fast - (speed(run) / fast).powi(2) * 1.3);
    add(&mut results, |run| [0.0, left(run), 0.0]);
    let found = diagnosed(results);
    assert!(!names(&found).contains(&"side_force_zero"), "{:?}", names(&found));
}

#[test]
fn walls_do_not_slow_the_water_down() {
    let mut results = campaign(58);
    for run in &mut results.steady.runs {
        let across = run.point.alpha_rad().sin().abs();
        run.point.coefficients.iter_mut().for_each(|c| *c *= 1.0 - 1.8 * across * across);
    }
    let found = diagnosed(results);
    assert!(!names(&found).contains(&"blockage"), "{:?}", names(&found));
}

/// A step of the drag between two speeds, which waves and a friction of the wrong sign resemble together.
#[test]
fn a_fit_in_full_does_not_leave_what_physics_allows() {
    for seed in [59, 60] {
        let mut results = campaign(seed);
        let area = results.steady.hulls[0].frontal_area_m2();
        add(&mut results, |run| [0.02 * run.pressure_Pa * area / (1.0 + (-(speed(run) - 1.7) / 0.05).exp()), 0.0, 0.0]);
        let found = diagnosed(results);
        let exponent = found.causes.iter().find_map(|cause| cause.parameters.get("drag_exponent"));
        assert!(exponent.is_none_or(|exponent| exponent.value <= 0.02), "{:?}", names(&found));
    }
}

#[test]
fn waves_do_not_need_a_drift_angle() {
    let mut results = campaign(55);
    let fastest = *speeds(&results).last().expect("speeds");
    let area = results.steady.hulls[0].frontal_area_m2();
    add(&mut results, |run| {
        let acts = speed(run) == fastest && run.point.yaw_deg.abs() > 4.0;
        [if acts { 0.03 * run.pressure_Pa * area } else { 0.0 }, 0.0, 0.0]
    });
    let found = diagnosed(results);
    assert!(names(&found).is_empty(), "{:?}", names(&found));
}

#[test]
fn a_slope_of_the_drag_with_speed_is_no_bump() {
    let mut results = campaign(56);
    let fastest = *speeds(&results).last().expect("speeds");
    let area = results.steady.hulls[0].frontal_area_m2();
    // Half of a bump broader than all Froude numbers: its height may be anything.
    add(&mut results, |run| [0.03 * run.pressure_Pa * area * (1.0 - (speed(run) / fastest).powi(2)), 0.0, 0.0]);
    let found = diagnosed(results);
    assert!(!names(&found).contains(&"free_surface"), "{:?}", names(&found));
}

/// Without a tare the drags of hull and strut cannot be separated; an exponent of the hull's is identified from how the drag depends on
/// speed all the same.
#[test]
fn friction_is_found_beside_a_strut_that_was_never_tared() {
    let mut results = campaign_of(&["LDR10.5"], 56);
    results.steady.tared = Tared::Never;
    let areas: Vec<f64> = results.steady.hulls.iter().map(|hull| hull.frontal_area_m2()).collect();
    add(&mut results, |run| {
        let exponent = -0.06;
        let growth = (speed(run) / 2.0).powf(2.0 * exponent) - 1.0;
        let drag_N = 0.12 * growth * run.pressure_Pa * areas[run.hull];
        [drag_N * run.point.alpha_rad().cos(), drag_N * run.point.alpha_rad().sin(), 0.0]
    });
    let found = diagnosed(results);
    assert_eq!(names(&found), ["reynolds_drag"]);
    let size = &found.causes[0].parameters["drag_exponent"];
    assert!(size.ci95[0] < -0.06 && -0.06 < size.ci95[1], "{size:?}");
}

/// One hole of the yaw table is off by a degree: no curve along the angle, and repeats at one setting are as good as ever.
#[test]
fn one_setting_that_is_wrong_is_unexplained_by_its_repeats() {
    let mut results = campaign(61);
    for run in results.steady.runs.iter_mut().filter(|run| run.point.nominal_yaw_deg == -6.0) {
        run.point.coefficients[0] -= 0.05;
        run.point.coefficients[2] -= 0.02;
    }
    let found = diagnosed(results);
    assert!(names(&found).is_empty() && found.verdict == Verdict::Unexplained, "{:?}", found.verdict);
}

/// Rows of a campaign without times stand in the order of the runs: the load before a run is known.
#[test]
fn a_balance_that_keeps_a_share_of_its_load_shows_in_runs_without_times() {
    let mut results = campaign(62);
    results.steady.in_time = false;
    for run in &mut results.steady.runs {
        let order = run.point.order as f64;
        (run.zeros.time_s, run.zeros.zeros) = (order, vec![(0.0, 1.0)]);
    }
    let relevance = Relevance::default();
    let problem = TankProblem::new(&results.steady, &results.hulls, &relevance);
    assert!(problem.shapes().iter().any(|shape| shape.mechanism().name == "balance_hysteresis"));
    let loads = problem.loads_before();
    let by_order = problem.order();
    for pair in by_order.windows(2) {
        let kept = loads[pair[1]]
            - problem.map(pair[1]) * results.steady.runs[pair[1]].interaction * reading(&problem, pair[0]);
        assert!(kept.norm() < 1e-12, "{kept}");
    }
}

/// What the balance showed under the load of a run.
fn reading(problem: &TankProblem<'_>, run: usize) -> nalgebra::Vector3<f64> {
    let data = &problem.data.runs[run];
    data.interaction.try_inverse().expect("a matrix of a balance") * (problem.force(run) + data.strut)
}

/// A scatter from run to run that the records do not allow is reported: without repeats no test separates it from a misfit.
#[test]
fn runs_that_scatter_beyond_their_records_are_warned_of() {
    let warned = |results: &Results| {
        let found = results.diagnoses.as_ref().expect("a diagnosis");
        found.warnings.iter().filter(|warning| warning.contains("from run to run")).count()
    };
    let mut results = campaign_of(&["LDR10.5"], 63);
    results.diagnose(&Relevance::default());
    assert_eq!(warned(&results), 0);
    for (i, run) in results.steady.runs.iter_mut().enumerate() {
        run.point.coefficients[1] *= 1.0 + 0.08 * if (i * 7) % 5 < 2 { 1.0 } else { -1.0 };
    }
    results.diagnose(&Relevance::default());
    assert_eq!(warned(&results), 1);
}
