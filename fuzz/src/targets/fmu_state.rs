//! Saved states as bytes: what another process, or a damaged file, gives to an instance.

use glidepolar_fmu::instance::log::Log;
use glidepolar_fmu::instance::phase::Phase;
use glidepolar_fmu::instance::refusal::Outcome;
use glidepolar_fmu::instance::{Abilities, Instance, Interface};
use glidepolar_fmu::model::vehicle::Vehicle;
use glidepolar_fmu::model::{Kind, variables};

use crate::Target;

pub const STATE: Target = Target {
    name: "fmu_state",
    what: "the fields of a serialized state, its header and checksum put right; and the run that goes on from it",
    run: state,
    seeds: states,
    catches_panics: false,
};

const CHECKSUM_BYTES: usize = 4;

/// The first byte chooses the interface and whether the bytes are taken as they are.
fn state(data: &[u8]) {
    let Some((&choice, content)) = data.split_first() else { return };
    let interface = if choice & 1 == 0 { Interface::CoSimulation } else { Interface::ModelExchange };
    let mut instance = fresh(interface);
    let bytes = if choice & 2 == 0 { sealed(&mut instance, content) } else { content.to_vec() };
    let Ok(handle) = instance.deserialized(&bytes) else { return };
    let written = instance.serialized(handle).expect("what was read can be written");
    let again = instance.deserialized(&written).expect("what was written can be read");
    assert_eq!(instance.serialized(again).expect("and written again"), written);
    let _ = go_on(&mut instance, handle);
}

fn fresh(interface: Interface) -> Instance {
    Instance::new(interface, Abilities::default(), &Vehicle::default(), Log::new(None, false))
}

/// These fields behind the header of a true state, with the checksum of all.
fn sealed(instance: &mut Instance, fields: &[u8]) -> Vec<u8> {
    let mut bytes = header(instance);
    bytes.extend(fields);
    bytes.extend(checksum(&bytes).to_le_bytes());
    bytes
}

/// What every state of this instance begins with: two states that differ in phase share no more than that.
fn header(instance: &mut Instance) -> Vec<u8> {
    let token = glidepolar_fmu::model::table::token();
    let mut bytes = saved(instance).expect("a state can always be saved");
    // Mark, version, token, interface.
    bytes.truncate(8 + 4 + token.len() + 1);
    bytes
}

fn saved(instance: &mut Instance) -> Outcome<Vec<u8>> {
    let handle = instance.save(0)?;
    let bytes = instance.serialized(handle);
    instance.forget(handle)?;
    bytes
}

/// CRC-32 as zip archives and PNG have it.
fn checksum(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0u32, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| if sum & 1 == 1 { (sum >> 1) ^ 0xEDB8_8320 } else { sum >> 1 })
    })
}

fn go_on(instance: &mut Instance, handle: usize) -> Outcome {
    instance.restore(handle)?;
    let reals = variables().iter().enumerate().filter(|(_, variable)| variable.kind == Kind::Real);
    let references: Vec<u32> = reals.map(|(place, _)| place as u32).collect();
    instance.get_reals(&references, &mut vec![0.0; references.len()])?;
    instance.derivatives(&mut [0.0; 12])?;
    if instance.interface() == Interface::CoSimulation && instance.phase() == Phase::Step {
        for _ in 0..2 {
            instance.whole_step(instance.time_s(), 0.5)?;
        }
    } else {
        instance.handle_event();
    }
    Ok(())
}

fn states() -> Vec<Vec<u8>> {
    let mut states = Vec::new();
    for (choice, interface) in [(0, Interface::CoSimulation), (1, Interface::ModelExchange)] {
        let mut instance = fresh(interface);
        let mut keep = |instance: &mut Instance| {
            let bytes = saved(instance).expect("a state can always be saved");
            let content = &bytes[header(instance).len()..bytes.len() - CHECKSUM_BYTES];
            states.push([[choice].as_slice(), content].concat());
            states.push([[choice | 2].as_slice(), &bytes].concat());
        };
        keep(&mut instance);
        instance.set_up(Some(1e-6), 0.0, Some(100.0)).expect("plain figures");
        instance.enter_initialization().expect("it is fresh");
        instance.exit_initialization(Phase::Step).expect("the default vehicle flies");
        if interface == Interface::CoSimulation {
            instance.whole_step(0.0, 10.0).expect("the default vehicle flies");
        }
        keep(&mut instance);
    }
    states
}
