//! Saved states as bytes: what another process, or a damaged file, gives to an instance.

use glidepolar_fmu::instance::log::Log;
use glidepolar_fmu::instance::phase::Phase;
use glidepolar_fmu::instance::refusal::Outcome;
use glidepolar_fmu::instance::{Abilities, Instance, Interface};
use glidepolar_fmu::model::vehicle::Vehicle;
use glidepolar_fmu::model::{Kind, Model};

use crate::Target;

pub const STATE: Target = Target {
    name: "fmu_state",
    what: "the fields of a serialized state, its header and checksum put right; and the run that goes on from it",
    run: state,
    seeds: states,
    catches_panics: false,
};

const CHECKSUM_BYTES: usize = 4;

/// Its bits choose the interface, whether the bytes are taken as they are, and the model.
const EXCHANGE: u8 = 1;
const AS_THEY_ARE: u8 = 2;
const SPACE: u8 = 4;

/// The first byte is the choice.
fn state(data: &[u8]) {
    let Some((&choice, content)) = data.split_first() else { return };
    let mut instance = fresh(choice);
    let bytes = if choice & AS_THEY_ARE == 0 { sealed(&mut instance, content) } else { content.to_vec() };
    let Ok(handle) = instance.deserialized(&bytes) else { return };
    let written = instance.serialized(handle).expect("what was read can be written");
    let again = instance.deserialized(&written).expect("what was written can be read");
    assert_eq!(instance.serialized(again).expect("and written again"), written);
    let _ = go_on(&mut instance, handle);
}

fn fresh(choice: u8) -> Instance {
    let interface = if choice & EXCHANGE == 0 { Interface::CoSimulation } else { Interface::ModelExchange };
    let model = if choice & SPACE == 0 { Model::Plane } else { Model::Space };
    Instance::new(interface, Abilities::default(), &Vehicle::built_in(model), Log::new(None, false))
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
    let token = instance.table().token;
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
    let reals = instance.table().rows.iter().filter(|variable| variable.kind == Kind::Real);
    let references: Vec<u32> = reals.map(|variable| variable.reference).collect();
    instance.get_reals(&references, &mut vec![0.0; references.len()])?;
    instance.derivatives(&mut vec![0.0; instance.model().n_states()])?;
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
    for choice in [0, EXCHANGE, SPACE, SPACE | EXCHANGE] {
        let mut instance = fresh(choice);
        let mut keep = |instance: &mut Instance| {
            let bytes = saved(instance).expect("a state can always be saved");
            let content = &bytes[header(instance).len()..bytes.len() - CHECKSUM_BYTES];
            states.push([[choice].as_slice(), content].concat());
            states.push([[choice | AS_THEY_ARE].as_slice(), &bytes].concat());
        };
        keep(&mut instance);
        instance.set_up(Some(1e-6), 0.0, Some(100.0)).expect("plain figures");
        instance.enter_initialization().expect("it is fresh");
        instance.exit_initialization(Phase::Step).expect("the default vehicle flies");
        if choice & EXCHANGE == 0 {
            instance.whole_step(0.0, 10.0).expect("the default vehicle flies");
        }
        keep(&mut instance);
        // The run that goes on must be one, else nothing of it is looked at.
        let handle = instance.save(0).expect("a state can always be saved");
        go_on(&mut instance, handle).expect("a state of its own goes on");
    }
    states
}
