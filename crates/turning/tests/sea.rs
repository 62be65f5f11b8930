//! Causes of turning that the virtual sea hides.

mod hidden;
mod logs;

use glidepolar_turning::causes::{KnownTurning, causes};
use glidepolar_virtual_sea::vehicle::Hull;

/// What is named first, and the group that it stands in.
fn first(effect: &str, hull: Hull, seed: u64) -> (String, Vec<&'static str>) {
    let found = causes(&hidden::log(effect, hull, seed).0, KnownTurning::default()).expect("enough steady stretches");
    let cause = found.causes.first();
    cause.map_or((String::new(), Vec::new()), |cause| (cause.cause.to_owned(), cause.indistinguishable_from.clone()))
}

/// Each on the glider that shows it. Twenty seeds and the whole diagnosis: `tests/rust/turning_sea.rs`.
#[test]
fn what_turns_or_leans_a_glider_is_named() {
    for (effect, hull) in [
        ("static_list=0.0873", Hull::Seaglider),
        ("roll_offset=0.0873", Hull::Seaglider),
        ("yaw_asymmetry=6e-4", Hull::Seaglider),
        ("static_list=0.0873", Hull::Slocum200),
        ("rudder_offset=0.0524", Hull::Slocum200),
    ] {
        let (wanted, _) = effect.split_once('=').expect("a size");
        let named = (7001..7004).filter(|seed| first(effect, hull, *seed).0 == wanted).count();
        assert!(named >= 2, "{effect} on a {hull:?}: {named} of 3");
    }
}

#[test]
fn what_looks_the_same_is_one_group() {
    for (effect, hull) in [("roll_mass_offset=0.16", Hull::Seaglider), ("yaw_asymmetry=6e-4", Hull::Slocum200)] {
        let (wanted, _) = effect.split_once('=').expect("a size");
        let grouped = (7001..7004).filter(|seed| {
            let (name, group) = first(effect, hull, *seed);
            name == wanted || group.contains(&wanted)
        });
        assert!(grouped.count() >= 2, "{effect} on a {hull:?}");
    }
}

#[test]
fn a_straight_glider_has_no_cause_of_turning() {
    for hull in [Hull::Seaglider, Hull::Slocum200] {
        for seed in 7001..7004 {
            assert_eq!(first("none", hull, seed).0, "", "{hull:?} {seed}");
        }
    }
}

/// The size lies in its interval and is that of the question.
#[test]
fn a_bent_rudder_has_its_angle() {
    let found = causes(&hidden::log("rudder_offset=0.0524", Hull::Slocum200, 7001).0, KnownTurning::default())
        .expect("enough stretches");
    let angle = &found.causes[0].parameters["rudder_offset_rad"];
    assert!((angle.value - 0.0524).abs() < 0.010 && angle.se < 0.005, "{angle:?}");
    assert!(found.causes[0].holdout_rms_after < 0.7 * found.causes[0].holdout_rms_before);
}

#[test]
fn a_log_without_heading_says_nothing() {
    let (mut log, _) = hidden::log("rudder_offset=0.0524", Hull::Slocum200, 7001);
    log.iter_mut().for_each(|o| o.heading_rad = f64::NAN);
    assert!(causes(&log, KnownTurning::default()).is_none());
}
