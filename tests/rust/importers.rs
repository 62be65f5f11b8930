//! Other people's Rust crates fly the FMU, through all of its interfaces, and must arrive where the command line does.

use std::path::{Path, PathBuf};
use std::process::Command;

use glidepolar_archive::{Archive, Limits};
use glidepolar_tests::{Built, Trajectory, skip};

const STOP_S: &str = "2208";
const ALL: [Built; 4] = [Built::Fmu2, Built::Fmu3, Built::SpaceFmu2, Built::SpaceFmu3];
const FMI3: [Built; 2] = [Built::Fmu3, Built::SpaceFmu3];
/// Outputs that move on the missions of both models.
const OUTPUTS: [&str; 8] = [
    "depth_m",
    "pitch_rad",
    "glide_angle_rad",
    "speed_m_s",
    "vertical_velocity_m_s",
    "v1_m_s",
    "net_mass_kg",
    "moving_mass_position_m",
];

fn is_space(fmu: Built) -> bool {
    matches!(fmu, Built::SpaceFmu2 | Built::SpaceFmu3)
}

/// Every output that moves on the mission of this archive: a sawtooth in the plane, spirals in space.
fn outputs(fmu: Built) -> Vec<&'static str> {
    let own: &[&str] = match is_space(fmu) {
        false => &["x_m", "lift_N"],
        true => &["north_m", "east_m", "heading_rad", "roll_rad", "v2_m_s", "sideslip_rad", "turn_rate_rad_s"],
    };
    [&OUTPUTS, own].concat()
}

#[test]
fn fmi_rs_flies_co_simulation() {
    for fmu in ALL {
        fly_and_compare(fmu, "fly-with-fmi-rs", &["--interface=cs", "--output-interval=8"], 1e-6);
    }
}

#[test]
fn fmi_rs_flies_co_simulation_with_events_and_early_returns() {
    let options = ["--interface=cs", "--output-interval=8", "--event-mode", "--early-return"];
    for fmu in FMI3 {
        fly_and_compare(fmu, "fly-with-fmi-rs", &options, 1e-6);
    }
}

#[test]
fn fmi_rs_flies_model_exchange() {
    for fmu in ALL {
        fly_and_compare(fmu, "fly-with-fmi-rs", &["--interface=me", "--output-interval=8"], 1e-6);
    }
}

#[test]
fn the_fmi_crate_flies_co_simulation() {
    for fmu in ALL {
        fly_and_compare(fmu, "fly-with-fmi-sim", &["--interface=cs", "--output-interval=8"], 1e-6);
    }
}

/// Its own solver is the forward Euler method: the trajectory is followed, not met. Roll and yaw are faster than pitch, and the
/// error is of first order in the step.
#[test]
fn the_fmi_crate_flies_model_exchange_coarsely() {
    for fmu in ALL {
        let is_space = matches!(fmu, Built::SpaceFmu2 | Built::SpaceFmu3);
        let interval = if is_space { "--output-interval=0.015625" } else { "--output-interval=0.0625" };
        fly_and_compare(fmu, "fly-with-fmi-sim", &["--interface=me", interval], 1e-2);
    }
}

/// A state that one process saves is loaded by another, which flies on as if nothing had happened.
#[test]
fn fmi_rs_saves_the_state_and_flies_on_in_another_process() {
    for fmu in ALL {
        let Some(flight) = Flight::prepare(fmu, "fly-with-fmi-rs") else { return };
        let state = flight.file("state.bin");
        let state = state.to_str().unwrap();
        let whole = flight.fly("whole.csv", &["--output-interval=8", "--stop-time=1600"]);
        flight.fly("first.csv", &["--output-interval=8", "--stop-time=800", "--save-state", state]);
        let second = ["--output-interval=8", "--start-time=800", "--stop-time=1600", "--load-state", state];
        let second = flight.fly("second.csv", &second);
        let split = whole.time_s.iter().position(|time| *time == 800.0).expect("a row at 800 s");
        for name in outputs(fmu) {
            // Bit for bit, not merely close.
            assert_eq!(second.column(name), &whole.column(name)[split..], "{fmu:?}, {name}");
        }
    }
}

fn fly_and_compare(fmu: Built, importer: &str, options: &[&str], tolerance: f64) {
    let Some(flight) = Flight::prepare(fmu, importer) else { return };
    let mut options = options.to_vec();
    options.extend(["--stop-time", STOP_S]);
    let flown = flight.fly("flown.csv", &options);
    let reference = flight.reference();
    for name in outputs(fmu) {
        let deviation = flown.deviation(&reference, name);
        assert!(deviation <= tolerance, "{importer}, {fmu:?}, {options:?}: {name} deviates by {deviation:e}");
    }
}

/// A folder for the files of one flight.
struct Flight {
    is_space: bool,
    fmu: PathBuf,
    importer: PathBuf,
    mission: PathBuf,
    glidepolar: PathBuf,
    folder: tempfile::TempDir,
}

impl Flight {
    fn prepare(fmu: Built, importer: &str) -> Option<Self> {
        let program = Built::Importers.path()?.join(format!("{importer}{}", std::env::consts::EXE_SUFFIX));
        if !program.exists() {
            skip(&format!("{importer} is not built; it needs libclang (apt-get install libclang-dev)"));
            return None;
        }
        let folder = tempfile::tempdir().unwrap();
        let (mut archive, mut mission) = (fmu.path()?, missions().join(mission_of(is_space(fmu))));
        if importer == "fly-with-fmi-sim" {
            (archive, mission) = for_the_fmi_crate(folder.path(), &archive, &mission);
        }
        Some(Self {
            is_space: is_space(fmu),
            fmu: archive,
            importer: program,
            mission,
            glidepolar: Built::Glidepolar.path()?,
            folder,
        })
    }

    fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Flies the mission with the importer.
    fn fly(&self, output: &str, options: &[&str]) -> Trajectory {
        let output = self.file(output);
        let mut command = Command::new(&self.importer);
        command.arg(&self.fmu).arg(&output).args(options).arg("--tolerance=1e-10").arg("--input").arg(&self.mission);
        run(&mut command);
        Trajectory::read(&output)
    }

    /// The same by the command line, tightly.
    fn reference(&self) -> Trajectory {
        let output = self.file("reference.csv");
        let mut command = Command::new(&self.glidepolar);
        command.args(["simulate", "slocum-graver", "--stop", STOP_S, "--interval", "8", "--tolerance", "1e-12"]);
        command.args(self.is_space.then_some("--3d"));
        let mission = missions().join(mission_of(self.is_space));
        run(command.args(["--quiet", "--inputs"]).arg(mission).arg("--csv").arg(&output));
        Trajectory::read(&output)
    }
}

/// Copies that go round faults of the `fmi` crate, version 0.8: it refuses model descriptions of FMI 3.0 with a base
/// unit K (it knows it as `k`) or with units and nominal values at the variables (it knows them in type definitions
/// only); and in FMI 2.0 it sets an input that jumps at a communication point one step late.
fn for_the_fmi_crate(folder: &Path, fmu: &Path, mission: &Path) -> (PathBuf, PathBuf) {
    let mut archive = Archive::read(fmu, &Limits::default()).unwrap();
    let description = String::from_utf8(archive.remove("modelDescription.xml").unwrap()).unwrap();
    let unknown = [" K=\"", " unit=\"", " displayUnit=\"", " nominal=\"", " quantity=\"", " relativeQuantity=\""];
    let is_fmi3 = description.contains("fmiVersion=\"3");
    let plain = match is_fmi3 {
        true => unknown.iter().fold(description, |xml, attribute| without(&xml, attribute)),
        false => description,
    };
    archive.insert("modelDescription.xml", plain).unwrap();
    let copy = folder.join("plain.fmu");
    archive.write(&copy).unwrap();

    if is_fmi3 {
        return (copy, mission.to_owned());
    }
    let early = folder.join("early.csv");
    let text = std::fs::read_to_string(mission).unwrap().replace("\n1104,", "\n1103.999,");
    std::fs::write(&early, text).unwrap();
    (copy, early)
}

/// The text without every attribute that begins so.
fn without(xml: &str, attribute: &str) -> String {
    let mut parts = xml.split(attribute);
    let mut kept = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        kept.push_str(part.split_once('"').expect("the attribute's value ends").1);
    }
    kept
}

fn mission_of(is_space: bool) -> &'static str {
    if is_space { "turning.csv" } else { "sawtooth.csv" }
}

fn missions() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("missions")
}

fn run(command: &mut Command) {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    assert!(output.status.success(), "{command:?}: {}\n{}", output.status, String::from_utf8_lossy(&output.stderr));
}
