//! The generated files: as checked in, and right where an importer's own validation does not look.

use std::collections::BTreeSet;
use std::path::Path;

use glidepolar_fmu::description::{files, structure::structure};
use glidepolar_fmu::model::units::UNITS;
use glidepolar_fmu::model::vehicle::Vehicle;
use glidepolar_fmu::model::{Kind, Model, variables};

#[test]
fn the_checked_in_files_are_those_of_the_table() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../modelDescription");
    for (path, text) in files() {
        let found = std::fs::read_to_string(folder.join(&path)).unwrap_or_default();
        assert!(
            found == text,
            "modelDescription/{} is stale: run `cargo run -p glidepolar-fmu --example write_model_description`",
            path.display()
        );
    }
}

#[test]
fn names_are_unique_and_starts_lie_within_their_bounds() {
    for model in Model::ALL {
        check_names_and_starts(model);
    }
}

fn check_names_and_starts(model: Model) {
    let glider = Vehicle::built_in(model).glider;
    let mut names = BTreeSet::new();
    for variable in model.table().rows {
        assert!(names.insert(variable.name), "{} twice", variable.name);
        assert!(!variable.description.is_empty());
        if let (Kind::Real, true, Some((min, max))) = (variable.kind, variable.has_start(), variable.bounds) {
            let start = glider.read().real(variable.slot).unwrap();
            assert!(min <= start && start <= max, "{} starts at {start}, outside {min} .. {max}", variable.name);
        }
    }
}

#[test]
fn every_unit_is_used_and_every_display_unit_has_a_factor() {
    let all = || Model::ALL.into_iter().flat_map(|model| model.table().rows);
    let used: BTreeSet<&str> = all().filter_map(|v| v.unit).map(|unit| unit.name).collect();
    for unit in UNITS {
        assert!(used.contains(unit.name), "unit {} is not used", unit.name);
        assert!(unit.display.is_none_or(|(_, factor)| factor > 0.0));
    }
}

#[test]
fn every_number_has_a_unit() {
    for variable in
        Model::ALL.iter().flat_map(|model| model.table().rows).filter(|variable| variable.kind == Kind::Real)
    {
        assert!(variable.unit.is_some(), "{}", variable.name);
    }
}

#[test]
fn the_step_that_is_proposed_is_one_that_euler_s_method_takes() {
    Model::ALL.into_iter().for_each(euler_takes_the_step);
}

fn euler_takes_the_step(model: Model) {
    use glidepolar_fmu::description::DEFAULT_EXPERIMENT;
    let mut glider = Vehicle::built_in(model).glider;
    let place = |name: &str| match model.table().slot_of(name) {
        Some(glidepolar_fmu::model::Slot::State(i)) => i,
        _ => panic!("no state {name}"),
    };
    let (speed, pitch) = (place("v1_m_s"), place("pitch_rad"));
    let start = glider.values.state;
    // Nudged off its glide, it comes back: a step too long for its fastest mode would drive it away.
    glider.values.state[place(if model == Model::Plane { "pitch_rate_rad_s" } else { "q_rad_s" })] += 1e-3;
    let step = DEFAULT_EXPERIMENT.1;
    for _ in 0..(600.0 / step) as usize {
        let rates = glider.derivative();
        glider.values.state.iter_mut().zip(rates).for_each(|(value, rate)| *value += step * rate);
    }
    let end = glider.values.state;
    for place in [speed, pitch] {
        assert!((end[place] - start[place]).abs() < 1e-6, "{end:?}");
    }
}

#[test]
fn the_token_is_a_guid_and_stays_as_long_as_the_table() {
    for (model, folder) in [(Model::Plane, ""), (Model::Space, "space/")] {
        let token = model.table().token;
        let digits: String = token.chars().filter(char::is_ascii_hexdigit).collect();
        assert_eq!((token.len(), digits.len()), (38, 32), "{token}");
        let path = format!("../modelDescription/{folder}fmi2/modelDescription.xml");
        let description = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap();
        assert!(description.contains(token));
    }
}

#[test]
fn what_physics_says_depends_on_what_stands_in_the_structure() {
    let reference = |name: &str| variables().iter().find(|v| v.name == name).unwrap().reference;
    let structure = structure(Model::Plane);
    let dependencies = |unknowns: &[glidepolar_fmu::description::structure::Unknown], name: &str| {
        let unknown = unknowns.iter().find(|unknown| unknown.reference == reference(name)).unwrap();
        unknown.dependencies.clone()
    };
    let of = |names: &[&str]| {
        let mut references: Vec<u32> = names.iter().map(|name| reference(name)).collect();
        references.sort_unstable();
        references
    };
    // From the kinematics alone.
    assert_eq!(
        dependencies(&structure.derivatives, "der(x_m)"),
        of(&["current_x_m_s", "pitch_rad", "v1_m_s", "v3_m_s"])
    );
    assert_eq!(dependencies(&structure.outputs, "speed_m_s"), of(&["v1_m_s", "v3_m_s"]));
    // Lift differs between descents and ascents, so pitch decides too; density may come from a column against depth.
    assert_eq!(
        dependencies(&structure.outputs, "lift_N"),
        of(&["water_density_kg_m3", "depth_m", "pitch_rad", "v1_m_s", "v3_m_s"])
    );
    assert!(dependencies(&structure.derivatives, "der(v1_m_s)").contains(&reference("seabed_depth_m")));
    // Pumping out costs energy, against the pressure at the depth; taking ballast in costs nothing.
    let pump = of(&["ballast_command_m3", "u4_kg_s", "water_density_kg_m3", "depth_m", "ballast_mass_kg"]);
    let power = dependencies(&structure.derivatives, "der(energy_J)");
    assert!(pump.iter().all(|reference| power.contains(reference)), "{power:?} lacks one of {pump:?}");
    assert_eq!(
        dependencies(&structure.initial, "PP1_kg_m_s"),
        of(&["v1_m_s", "pitch_rate_rad_s", "moving_mass_kg", "moving_mass_height_m", "start_in_trim"])
    );
}
