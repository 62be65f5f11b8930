use super::*;
use crate::dynamics::Parameters;
use crate::vehicle::Vehicle;

const MISSION: &str = r#"
name = "shelf"
[voyage]
duration_h = 5
[dive]
max_depth_m = 180
altimeter_m = 20
climb_to_m = 10
[glide]
pitch_down_deg = -26
pitch_up_deg = 26
ballast_down_cc = -230
ballast_up_cc = 230
[surfacing]
first_after_h = 1.0
every_h = 2.5
stay_min = 12
[seabed]
distance_km = [0.0, 7.0]
depth_m = [175, 100]
"#;

fn mission(text: &str) -> Mission {
    Mission::parse(text, Path::new("m.toml")).unwrap_or_else(|error| panic!("{error}"))
}

fn slocum() -> Parameters<f64> {
    Vehicle::load("slocum-049").unwrap().parameters().unwrap()
}

fn flown(text: &str) -> (Mission, Flight, Vec<Moment>) {
    let mission = mission(text);
    let mut moments = Vec::new();
    let flight = fly_mission(&slocum(), &mission, 10.0, 1e-7, |moment| {
        moments.push(*moment);
        true
    })
    .unwrap_or_else(|error| panic!("{error}"));
    (mission, flight, moments)
}

#[test]
fn the_turns_follow_the_rising_seabed_and_the_largest_depth() {
    let (mission, flight, _) = flown(&MISSION.replace("[175, 100]", "[260, 100]"));
    let turns: Vec<&Leg> =
        flight.legs.iter().filter(|leg| matches!(leg.ended_by, Turn::Altimeter | Turn::MaxDepth)).collect();
    assert!(turns.len() > 10, "{} turns", turns.len());
    for leg in &turns {
        let expected = mission.turning_depth_m(leg.end_x_m);
        assert!((leg.end_depth_m - expected).abs() < 1e-6, "{leg:?} against {expected}");
    }
    assert_eq!(turns[0].ended_by, Turn::MaxDepth);
    assert_eq!(turns.last().unwrap().ended_by, Turn::Altimeter);
    assert!(turns.last().unwrap().end_depth_m < 150.0);
    assert_eq!(flight.groundings, 0);
    assert_eq!(flight.ending, Ending::Duration);
    assert_eq!(flight.duration_s, 5.0 * 3600.0);
    assert!((flight.legs.last().unwrap().end_s - flight.duration_s).abs() < 1e-9);
}

#[test]
fn it_comes_up_when_it_is_time_and_stays_as_long_as_set() {
    let (_, flight, _) = flown(MISSION);
    let due: Vec<f64> =
        flight.legs.iter().filter(|leg| leg.ended_by == Turn::SurfacingDue).map(|leg| leg.end_s).collect();
    assert!((due[0] - 3600.0).abs() < 1e-9, "{due:?}");
    let stays: Vec<&Leg> = flight.legs.iter().filter(|leg| leg.kind == LegKind::Surface).collect();
    assert!((stays[0].end_s - stays[0].start_s - 720.0).abs() < 1e-9);
    assert!((due[1] - stays[0].end_s - 2.5 * 3600.0).abs() < 1e-9, "{due:?}");
    // The legs follow each other without a gap.
    for pair in flight.legs.windows(2) {
        assert_eq!((pair[0].end_s, pair[0].end_x_m), (pair[1].start_s, pair[1].start_x_m));
    }
}

#[test]
fn without_a_clock_it_comes_up_after_each_dive() {
    let text = MISSION.replace("first_after_h = 1.0\nevery_h = 2.5\n", "");
    let (_, flight, _) = flown(&text);
    assert!(!flight.legs.iter().any(|leg| matches!(leg.ended_by, Turn::ClimbTo | Turn::SurfacingDue)));
    assert!(flight.legs.iter().filter(|leg| leg.ended_by == Turn::Surfaced).count() > 5);
}

#[test]
fn the_glides_are_the_steady_glides_of_their_pitch_and_ballast() {
    use crate::dynamics::Surroundings;
    use crate::glide::{Attitude, at_pitch};
    let p = slocum();
    let (_, _, moments) = flown(MISSION);
    for (leg, pitch, ballast) in [(LegKind::Descent, -26.0f64, -230e-6), (LegKind::Ascent, 26.0, 230e-6)] {
        let water = Surroundings {
            density_kg_m3: p.reference_density_kg_m3,
            pressure_Pa: 0.0,
            temperature_C: 15.0,
            time_s: 0.0,
        };
        let net_mass_kg = p.net_mass_kg(ballast, &water);
        let steady = at_pitch(&p, &water, Attitude { pitch_rad: pitch.to_radians(), net_mass_kg }).unwrap();
        let mut speeds: Vec<f64> =
            moments.iter().filter(|m| m.leg == leg && m.row[1] > 30.0).map(|m| m.row[7]).collect();
        speeds.sort_by(f64::total_cmp);
        let median = speeds[speeds.len() / 2];
        assert!((median / steady.speed_m_s - 1.0).abs() < 0.01, "{leg:?}: {median} against {}", steady.speed_m_s);
    }
}

#[test]
fn the_slow_correction_brings_a_wrong_trim_to_the_ordered_pitch() {
    // The pitch sensor is askew by 4 deg, and the feed-forward knows nothing of the ballast's lever.
    let p = Parameters { offset_mass_forward_m: 0.01, offset_mass_kg: 10.0, ..slocum() };
    let off = |gain: &str| {
        let text = format!("{MISSION}\n[control]\ndeadband_deg = 0.5\ngain = {gain}\n")
            .replace("climb_to_m = 10", "climb_to_m = 20");
        let mut mission = mission(&text);
        // The trim is computed for a glider without the offset.
        let mut last = 0.0;
        let mut worst: f64 = 0.0;
        mission.surfacing.first_s = Some(1e6);
        let controller = controller::Controller::new(&slocum(), &mission).unwrap();
        let flight = flight::fly_with(&p, &mission, controller, 10.0, 1e-7, |moment| {
            if moment.leg == LegKind::Descent && moment.row[1] > 60.0 && moment.row[0] > 7200.0 {
                worst = worst.max((moment.row[3].to_degrees() + 26.0).abs());
            }
            last = moment.row[0];
            true
        });
        assert!(flight.is_ok() && last >= 18_000.0);
        worst
    };
    let (without, with) = (off("0.0"), off("0.5"));
    assert!(without > 3.0, "the disturbance is felt: {without} deg");
    assert!(with < 1.2, "{with} deg with the correction, {without} without");
}

#[test]
fn a_glider_that_is_not_heavy_cannot_be_sent_down() {
    let text = MISSION.replace("ballast_down_cc = -230", "ballast_down_cc = 100");
    let error = fly_mission(&slocum(), &mission(&text), 10.0, 1e-7, |_| true).unwrap_err().to_string();
    assert!(error.contains("the descent cannot be flown at 0 m: with 100 cc of ballast"), "{error}");
}

#[test]
fn water_too_shallow_to_dive_ends_the_mission() {
    let (_, flight, _) = flown(&MISSION.replace("[175, 100]", "[40, 10]"));
    assert_eq!(flight.ending, Ending::TooShallow);
}

#[test]
fn the_current_carries_the_glider_and_the_way_ends_the_mission() {
    let base = MISSION.replace("duration_h = 5", "duration_h = 2");
    let (_, still, _) = flown(&base);
    let (_, carried, _) = flown(&format!("{base}\n[current]\nalong_m_s = 0.1\n").replace("[0.0, 7.0]", "[0.0, 7.5]"));
    assert!((carried.distance_m - still.distance_m - 720.0).abs() < 5.0);
    let (_, short, _) = flown(&base.replace("[dive]", "distance_km = 1.5\n[dive]"));
    assert_eq!(short.ending, Ending::Distance);
    assert!((short.distance_m - 1500.0).abs() < 1e-6, "{}", short.distance_m);
}

#[test]
fn bad_files_are_refused_with_place_cause_and_next_step() {
    let broken = |from: &str, to: &str| {
        assert!(MISSION.contains(from), "{from}");
        Mission::parse(&MISSION.replace(from, to), Path::new("m.toml")).unwrap_err().to_string()
    };
    let cases = [
        (
            broken("max_depth_m = 180", "max_dept_m = 180"),
            "m.toml:6:1: unknown key `dive.max_dept_m`; did you mean `dive.max_depth_m`?",
        ),
        (
            broken("max_depth_m = 180\n", ""),
            "missing key `dive.max_depth_m` [m]: Turn up at this depth; add `max_depth_m = ...` under [dive]",
        ),
        (
            broken("max_depth_m = 180", "max_depth_m = \"180\""),
            "m.toml:6:15: `dive.max_depth_m` is a string, expected a number",
        ),
        (
            broken("pitch_down_deg = -26", "pitch_down_deg = 26"),
            "`glide.pitch_down_deg` is 26, expected a number between -89 and -1 [deg]",
        ),
        (
            broken("climb_to_m = 10", "climb_to_m = 200"),
            "m.toml:8:1: `dive.climb_to_m` (200) is not above `dive.max_depth_m` (180)",
        ),
        (broken("ballast_down_cc = -230", "ballast_down_cc = 330"), "is not below `glide.ballast_up_cc`"),
        (broken("[0.0, 7.0]", "[0.0, 7.0, 8.0]"), "`seabed.depth_m` has 2 values, `seabed.distance_km` 3"),
        (broken("[0.0, 7.0]", "[7.0, 0.0]"), "m.toml:19:1: `seabed.distance_km` does not increase"),
        (broken("distance_km = [0.0, 7.0]\n", ""), "`seabed.depth_m` is a list of 2 without `seabed.distance_km`"),
        (broken("[175, 100]", "[175, \"x\"]"), "m.toml:20:17: `seabed.depth_m` has a string in its list"),
        (broken("[seabed]", "[sebed]"), "m.toml:18:2: unknown key `sebed`; did you mean `seabed`?"),
        (broken("name = \"shelf\"", ""), "missing key `name`"),
        (broken("[dive]", "[dive"), "not valid TOML"),
    ];
    for (message, expected) in cases {
        assert!(message.contains(expected), "{message:?} lacks {expected:?}");
    }
}
