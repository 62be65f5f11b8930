//! The SUBOFF bare hull, Roddy 1990: the figures that the table gives were computed apart from this project.

use std::path::{Path, PathBuf};

use glidepolar_hull::hull_tests::HullFit;
use glidepolar_inference::Relevance;
use glidepolar_tank::{Results, reduce_points};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(name)
}

fn suboff(range_deg: f64) -> Results {
    reduce_points(&data("suboff_roddy1990.csv"), &data("suboff.toml"), range_deg).unwrap()
}

fn fit(results: &Results) -> HullFit {
    results.hulls[0].fit.as_ref().unwrap().estimates.clone()
}

fn assert_near(found: f64, expected: f64, relative: f64) {
    assert!((found / expected - 1.0).abs() < relative, "{found}, expected {expected}");
}

#[test]
fn the_three_parameters_are_those_of_the_table() {
    let results = suboff(10.0);
    assert_eq!(results.hulls[0].fit.as_ref().unwrap().rows.len(), 15);
    let fit = fit(&results);
    assert_near(fit.a.value, 0.840, 0.01);
    assert_near(fit.b.value, 0.0931, 0.01);
    assert_near(fit.c.value, 1.146, 0.01);
    assert_near(fit.d.value, 1.036, 0.01);
    assert!(fit.a.ci95[0] < 0.84 && fit.a.ci95[1] > 0.84);
}

#[test]
fn one_point_more_moves_the_lift_slope_and_the_report_says_so() {
    assert_near(fit(&suboff(10.1)).a.value, 0.905, 0.002);
    let warnings = suboff(10.0).warnings;
    let warning = warnings.iter().find(|w| w.contains("depend")).expect("a warning about the range");
    assert!(warning.contains("a = 0.84") && warning.contains("0.90"), "{warning}");
}

/// Every point as converted apart from this code, to the last printed place.
#[test]
fn points_convert_to_coefficients_about_the_centre_of_buoyancy() {
    let results = suboff(10.0);
    let points = &results.hulls[0].sweep.points;
    for (id, expected) in [
        ("152", [-0.0092, 0.0950, 0.0086]),
        ("159", [0.1997, 0.1308, 0.1757]),
        ("164", [0.6075, 0.2618, 0.2610]),
        ("168", [-0.0314, 0.0961, -0.0523]),
        ("172", [-0.1894, 0.1315, -0.1641]),
        ("176", [-0.6098, 0.2790, -0.2568]),
    ] {
        let point = points.iter().find(|p| p.run_id == id).unwrap();
        for (found, expected) in point.coefficients.into_iter().zip(expected) {
            assert!((found - expected).abs() < 1.01e-4, "point {id}: {found}, expected {expected}");
        }
    }
}

/// Errors of prediction (each point left out in turn) and coefficients of other forms.
#[test]
fn other_forms_predict_as_published() {
    let check = |range: f64, coefficient: usize, form: &str, rms: f64, parameters: &[f64]| {
        let results = suboff(range);
        let fit = results.hulls[0].fit.as_ref().unwrap();
        let candidate = fit.adequacy[coefficient].iter().find(|c| c.form == form).unwrap();
        assert_near(candidate.left_out_rms, rms, 0.01);
        for (found, expected) in candidate.parameters.iter().zip(parameters) {
            assert!((found.0 - expected).abs() < 6e-4 + 6e-4 * expected.abs(), "{form}: {found:?}, {expected}");
        }
    };
    check(20.0, 0, "x", 0.0703, &[1.543]);
    check(20.0, 0, "x + x|x|", 0.0067, &[0.128, 5.728]);
    check(20.0, 0, "1 + x + x|x|", 0.0065, &[-0.0026, 0.128, 5.726]);
    check(20.0, 1, "1 + x^2", 0.00882, &[0.0879, 1.709]);
    check(20.0, 1, "1 + x^2 + |x|^3", 0.00516, &[0.0941, 0.505, 4.012]);
    check(20.0, 2, "x", 0.0158, &[0.890]);
    check(10.1, 0, "x", 0.0239, &[0.905]);
    check(10.1, 2, "1 + x + x^3", 0.00196, &[0.0063, 1.153, -5.995]);
}

/// The same points as forces and as coefficients give the same fit.
#[test]
fn the_three_forms_of_a_table_agree() {
    let folder = tempfile::tempdir().unwrap();
    let from_primes = suboff(10.0);
    let mut coefficients = "yaw_deg,CL,CD,CM\n".to_owned();
    let mut forces = "yaw_deg,AF_N,SF_N,YM_N_m,speed_m_s\n".to_owned();
    // By hand: rho = 998.204 kg/m3 (fresh, 20 degC), Lpp = 4.2609 m, U = 3.344 m/s.
    let q = 0.5 * 998.204 * 3.344f64.powi(2) * 4.2609f64.powi(2);
    let text = std::fs::read_to_string(data("suboff_roddy1990.csv")).unwrap();
    let rows = text.lines().filter(|line| !line.starts_with(['#', 'r']));
    for (row, point) in rows.zip(&from_primes.hulls[0].sweep.points) {
        let cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        let (yaw, x, y, n) = (cells[1], cells[2], cells[3], cells[4]);
        let [cl, cd, cm] = point.coefficients;
        coefficients += &format!("{yaw},{cl},{cd},{cm}\n");
        forces += &format!("{yaw},{},{},{},3.344\n", -x * q, y * q, n * q * 4.2609);
    }
    for table in [coefficients, forces] {
        let file = folder.path().join("points.csv");
        std::fs::write(&file, table).unwrap();
        let results = reduce_points(&file, &data("suboff.toml"), 10.0).unwrap();
        let (found, expected) = (fit(&results), fit(&from_primes));
        assert_near(found.a.value, expected.a.value, 2e-6);
        assert_near(found.b.value, expected.b.value, 2e-6);
        assert_near(found.c.value, expected.c.value, 2e-6);
        assert_near(found.d.value, expected.d.value, 2e-6);
    }
}

/// Straight lines through the points of smallest drift hold the report's derivatives in their intervals: Yv' within a wide one,
/// for the side force so near zero is small against its own zero error.
#[test]
fn straight_lines_at_small_drift_hold_the_derivatives_of_the_report() {
    let results = suboff(3.2);
    let hull = &results.hulls[0].hull;
    let (fit, scale) = (fit(&results), hull.frontal_area_m2() / hull.geometry.loa_m.powi(2));
    let ratio: f64 = 4.2609 / 4.356;
    let (yv_report, nv_report) = (-0.005948 * ratio.powi(2), -0.012789 * ratio.powi(3));
    assert_near(-fit.d.value * scale, nv_report, 0.04);
    assert!((fit.d.ci95[0]..=fit.d.ci95[1]).contains(&(-nv_report / scale)), "{:?}", fit.d);
    assert!((fit.a.ci95[0]..=fit.a.ci95[1]).contains(&(-yv_report / scale - fit.b.value)), "{:?}", fit.a);
}

/// The report states Yv' = -0.005948 and Nv' = -0.012795 on Lpp about its moment reference, static derivatives good to 4 or
/// 5 %. About the centre of buoyancy, 4.4 mm further forward, that is Nv' = -0.012789. The range of the straight lines has no
/// part in them.
#[test]
fn derivatives_at_zero_drift_are_those_of_the_report() {
    let ratio: f64 = 4.2609 / 4.356;
    let (yv_report, nv_report) = (-0.005948 * ratio.powi(2), -0.012789 * ratio.powi(3));
    for range_deg in [6.1, 10.0, 14.1, 20.0] {
        let results = suboff(range_deg);
        let hull = &results.hulls[0];
        let fit = hull.fit.as_ref().unwrap();
        let [yv, nv] = glidepolar_tank::derivatives::from_sweep(&hull.hull, fit);
        println!("{range_deg} deg: Yv' {:.6} +- {:.6}, Nv' {:.6} +- {:.6}", yv.value, yv.se, nv.value, nv.se);
        assert_near(yv.value, yv_report, 0.04);
        assert_near(nv.value, nv_report, 0.04);
        assert!((yv.ci95[0]..=yv.ci95[1]).contains(&yv_report), "{yv:?}");
        assert_eq!(fit.zero_drift.each_ref().map(|slope| (slope.order, slope.points)), [(5, 24); 2]);
    }
}

/// The same 24 points hold a law of the wrong kind, a zero of the yaw moment and an axial force that goes with the side
/// force: named in this order, with nothing else beside them.
#[test]
fn the_diagnosis_names_crossflow_and_predicts_lift_tenfold_better() {
    let mut results = suboff(10.0);
    results.diagnose(&Relevance::default());
    let reduced = results.reduction();
    let diagnosis = reduced.hulls[0].diagnosis.as_ref().expect("a diagnosis");
    let causes = diagnosis["causes"].as_array().unwrap();
    let mut names: Vec<&str> = causes.iter().map(|cause| cause["cause"].as_str().unwrap()).collect();
    assert_eq!(names[0], "crossflow");
    names.sort_unstable();
    assert_eq!(names, ["crossflow", "interaction", "yaw_moment_zero"]);
    let gains = diagnosis["gains"].as_array().unwrap();
    let lift = gains.iter().find(|gain| gain["quantity"] == "CL").unwrap();
    let of = |key: &str| lift[key].as_f64().unwrap();
    assert!(of("holdout_rms_before") / of("holdout_rms_after") > 8.0);
    // A fit of Roddy's lift alone gives 5.7; X' odd is 1.13 % of Y' odd; N' even is 7e-5, 27 N m at 3.344 m/s.
    let size = |cause: &str, name: &str| {
        let cause = causes.iter().find(|c| c["cause"] == cause).unwrap();
        cause["parameters"][name]["value"].as_f64().unwrap()
    };
    assert_near(size("crossflow", "crossflow_per_rad2"), 5.9, 0.1);
    assert_near(size("interaction", "af_from_sf").abs(), 0.0113, 0.25);
    assert_near(size("yaw_moment_zero", "yaw_moment_zero_N_m"), 27.0, 0.25);
    let extended = reduced.hulls[0].extended.as_ref().unwrap();
    assert!(extended.nonlinear_lift_per_rad2.is_some() && extended.fit.a.value < 0.3);
    let rejected = diagnosis["rejected"].as_array().unwrap();
    assert!(rejected.iter().any(|r| r["cause"] == "speed_scale" && r["remark"].as_str().unwrap().contains("absorb")));
}
