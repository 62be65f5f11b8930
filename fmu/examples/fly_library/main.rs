//! Flies a built shared library as an importer of its platform does: both models, both standards, Co-Simulation and
//! Model Exchange. Knows of the library what the model description says, and nothing of its sources.
//!
//!     fly_library LIBRARY FMI2_DESCRIPTION FMI3_DESCRIPTION ...
//!
//! Prints a heading for each part, and below it rows of numbers.

#![allow(non_snake_case, reason = "the functions have the standards' names")]

mod abi;
mod description;
mod three;
mod two;

use std::error::Error;
use std::ffi::CString;

use abi::{Exchange, Simulation};
use description::Description;
use libloading::Library;

/// Communication step of the flight \[s\].
const STEP_S: f64 = 10.0;

/// Step of Euler's method in Model Exchange, as simple importers have it \[s\].
const EULER_STEP_S: f64 = 0.05;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let library = arguments.next().ok_or("usage: fly_library LIBRARY DESCRIPTION...")?;
    // SAFETY: the library has no initialisers of its own.
    let library = unsafe { Library::new(library) }?;
    for path in arguments {
        let of = Description::read(&path)?;
        let heading = |part: &str| println!("# {} FMI {} {part}", of.model, of.version);
        heading("Co-Simulation");
        fly(&of, simulation(&library, &of));
        heading("Model Exchange");
        glide(&of, exchange(&library, &of));
    }
    Ok(())
}

fn simulation(library: &Library, of: &Description) -> Box<dyn Simulation> {
    match of.version {
        2 => Box::new(two::Instance::new(library, &of.token, abi::Interface::CoSimulation)),
        _ => Box::new(three::Instance::new(library, &of.token, abi::Interface::CoSimulation)),
    }
}

fn exchange(library: &Library, of: &Description) -> Box<dyn Exchange> {
    match of.version {
        2 => Box::new(two::Instance::new(library, &of.token, abi::Interface::ModelExchange)),
        _ => Box::new(three::Instance::new(library, &of.token, abi::Interface::ModelExchange)),
    }
}

/// A dive onto the seabed and a climb to the surface, the climb twice: the second time from the state that was written
/// out. The glider in space turns on the way. At the end a partial derivative.
fn fly(of: &Description, glider: Box<dyn Simulation>) {
    let set = |names: &[(&str, f64)]| names.iter().for_each(|(name, value)| glider.set(of.reference(name), *value));
    // A hull at rest has no direction of flight.
    let directions: Vec<u32> = ["glide_angle_rad", "angle_of_attack_rad", "sideslip_rad"]
        .into_iter()
        .filter(|name| of.has(name))
        .map(|name| of.reference(name))
        .collect();
    let outputs = || {
        let at_rest = glider.get(of.reference("speed_m_s")) < 1e-3;
        let value =
            |reference: &u32| if at_rest && directions.contains(reference) { 0.0 } else { glider.get(*reference) };
        of.outputs.iter().map(value).collect::<Vec<_>>()
    };
    let steps = |from: u32, to: u32| -> Vec<Vec<f64>> {
        let step = |i| {
            glider.step(f64::from(i) * STEP_S, STEP_S);
            outputs()
        };
        (from..to).map(step).collect()
    };
    set(&[("seabed_depth_m", 60.0)]);
    glider.begin();
    print(&steps(0, 30));
    if of.has("rudder_command_rad") {
        set(&[("rudder_command_rad", 0.2), ("current_east_m_s", 0.05)]);
    }
    print(&steps(30, 60));
    let state = glider.saved();
    let climb = || {
        set(&[("ballast_command_m3", 3e-4), ("moving_mass_command_m", -0.02)]);
        steps(60, 120)
    };
    let first = climb();
    glider.restore(&state);
    let second = climb();
    assert_eq!(first, second, "a restored state goes on as the state that was saved");
    print(&first);
    let slope = glider.derivative(of.reference("der(v1_m_s)"), of.reference("pitch_rad"));
    print(&[vec![slope]]);
}

/// A minute of a dive by Euler's method: states and rates.
fn glide(of: &Description, glider: Box<dyn Exchange>) {
    glider.begin();
    let mut states = vec![0.0; of.n_states];
    let mut rates = states.clone();
    glider.states(&mut states);
    for i in 1..=1200 {
        glider.rates(&mut rates);
        states.iter_mut().zip(&rates).for_each(|(state, rate)| *state += EULER_STEP_S * rate);
        glider.go_to(f64::from(i) * EULER_STEP_S, &states);
        if i % 40 == 0 {
            print(&[states.clone(), rates.clone()]);
        }
    }
}

fn print(rows: &[Vec<f64>]) {
    for row in rows {
        println!("{}", row.iter().map(|value| format!("{value:?}")).collect::<Vec<_>>().join(","));
    }
}

/// The token as C reads it.
fn c_string(text: &str) -> CString {
    CString::new(text).expect("a text without zeros")
}
