//! The energy account against the battery counters of a Seaglider at sea: SG542, South Atlantic, dives 304 to 317.

use glidepolar_tests::{Built, measured_data};
use std::process::Command;

#[test]
fn a_held_out_dive_is_predicted_within_five_per_cent_of_its_charge() {
    let (Some(program), Some(data)) = (Built::Glidepolar.path(), measured_data()) else {
        return;
    };
    let output = Command::new(program)
        .args(["plan", "seaglider", "--json", "-", "--moves"])
        .arg(data.join("sg542_motor_moves.csv"))
        .arg("--dives")
        .arg(data.join("sg542_dives.csv"))
        .output()
        .expect("glidepolar starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON and nothing else");
    let calibration = &report["calibration"];
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    assert_eq!((calibration["pump"]["strokes"].as_u64(), calibration["dives"]["dives"].as_u64()), (Some(57), Some(13)));

    let left_out = number(&calibration["dives"]["charge_error_left_out"]);
    let of_the_mean = number(&calibration["dives"]["charge_error_of_the_mean"]);
    assert!(left_out <= 0.05, "{left_out}");
    assert!(left_out < 0.5 * of_the_mean, "{left_out} against {of_the_mean} of the plain mean");
    assert!(number(&calibration["pump"]["relative_rms"]) <= 0.073);
    // The counters' own bill: what the pump's motor took, the battery gave; hotel power is what a Seaglider's is.
    let factor = &calibration["dives"]["pump_factor"]["ci95"];
    assert!(number(&factor[0]) < 1.0 && number(&factor[1]) > 1.0, "{factor}");
    assert!((0.05..0.5).contains(&number(&calibration["dives"]["hotel_W"]["value"])));
}
