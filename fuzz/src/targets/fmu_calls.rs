//! Calls of the C functions of both standards in any order, with arguments right and wrong.
//!
//! Each call is three bytes: which function, and how its arguments are drawn. Calls can so be cut, repeated and mixed
//! between inputs. The first byte chooses standard, interface, flags and model.

use std::sync::atomic::Ordering;

use glidepolar_fmu::fmi2::*;
use glidepolar_fmu::fmi3::*;
use glidepolar_fmu::model::Model;

use crate::Target;

#[allow(dead_code, missing_docs, reason = "shared with the tests that call at random")]
#[path = "../../../fmu/tests/abuse/caller.rs"]
mod caller;

use caller::{AnyFunction, Counter, ERROR, Loaded, Memory, OK, Random, Victim, begin, instantiate_of};

pub const CALLS: Target = Target {
    name: "fmu_calls",
    what: "calls of the FMU in any order",
    run: calls,
    seeds: sequences,
    catches_panics: true,
};

/// Calls that one instance lives through.
const MOST_CALLS: usize = 80;

fn calls(data: &[u8]) {
    // The caller's one type for all functions holds where arguments go into registers of their own.
    if !cfg!(all(target_arch = "x86_64", unix)) {
        return;
    }
    thread_local!(static LOADED: Loaded = Loaded::new(linked));
    LOADED.with(|loaded| sequence(loaded, data));
}

fn sequence(loaded: &Loaded, data: &[u8]) {
    let Some((&how, calls)) = data.split_first() else { return };
    let (standard, exchange) = (2 + usize::from(how & 1), how & 2 != 0);
    let counter = Counter::default();
    let model = if how & 32 == 0 { Model::Plane } else { Model::Space };
    let pointer = instantiate_of(loaded, model, standard, exchange, usize::from(how >> 2 & 3), &counter);
    assert_ne!(pointer, 0);
    if how & 16 != 0 {
        begin(loaded, standard, exchange, pointer);
    }
    let functions = if standard == 2 { &loaded.two } else { &loaded.three };
    let mut victim = Victim { functions, pointer, states: Vec::new(), time: 0.0 };
    let mut memory = Memory::new();
    memory.model = model;
    for call in calls.chunks_exact(3).take(MOST_CALLS) {
        let function = &functions[usize::from(call[0]) % functions.len()];
        let mut random = Random((u64::from(call[1]) << 8 | u64::from(call[2])).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        let before = counter.problems.load(Ordering::Relaxed);
        let status = victim.call(function, &mut random, &mut memory, pointer);
        let messages = counter.problems.load(Ordering::Relaxed) - before;
        let context = format!("{}: status {status}, {messages} messages", function.name);
        assert!((OK..=ERROR).contains(&status), "{context}");
        assert_eq!(messages, usize::from(status != OK), "{context}");
        victim.reads_time(&mut memory);
    }
    assert_eq!(counter.empty.load(Ordering::Relaxed), 0, "a message that tells nothing");
    assert_eq!(counter.faults.load(Ordering::Relaxed), 0, "a panic inside, caught");
    let free = if standard == 2 { "fmi2FreeInstance" } else { "fmi3FreeInstance" };
    // SAFETY: a live instance, freed once.
    unsafe { loaded.get(free)(pointer, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.0, 0.0, 0.0) };
}

/// A few calls of every function of both models, before and after the simulation has begun.
fn sequences() -> Vec<Vec<u8>> {
    (0..64u8)
        .map(|how| {
            let calls = (0..40u8).flat_map(|i| [i.wrapping_mul(7).wrapping_add(how), how, i]);
            std::iter::once(how).chain(calls).collect()
        })
        .collect()
}

macro_rules! linked {
    ($($name:ident)*) => {
        /// The function of this name, as it is linked into this program.
        fn linked(name: &str) -> AnyFunction {
            let address = match name {
                $(stringify!($name) => $name as *const (),)*
                other => panic!("{other} is in no standard"),
            };
            // SAFETY: a function; called with arguments of the kinds that the caller's table says.
            unsafe { std::mem::transmute::<*const (), AnyFunction>(address) }
        }
    };
}

linked! {
    fmi2SetDebugLogging fmi2SetupExperiment fmi2EnterInitializationMode fmi2ExitInitializationMode fmi2Terminate
    fmi2Reset fmi2GetReal fmi2GetInteger fmi2GetBoolean fmi2GetString fmi2SetReal fmi2SetInteger fmi2SetBoolean
    fmi2SetString fmi2GetFMUstate fmi2SetFMUstate fmi2FreeFMUstate fmi2SerializedFMUstateSize
    fmi2SerializeFMUstate fmi2DeSerializeFMUstate fmi2GetDirectionalDerivative fmi2EnterEventMode
    fmi2NewDiscreteStates fmi2EnterContinuousTimeMode fmi2CompletedIntegratorStep fmi2SetTime
    fmi2SetContinuousStates fmi2GetDerivatives fmi2GetEventIndicators fmi2GetContinuousStates
    fmi2GetNominalsOfContinuousStates fmi2SetRealInputDerivatives fmi2GetRealOutputDerivatives fmi2DoStep
    fmi2CancelStep fmi2GetStatus fmi2GetRealStatus fmi2GetIntegerStatus fmi2GetBooleanStatus fmi2GetStringStatus
    fmi3SetDebugLogging fmi3EnterInitializationMode fmi3ExitInitializationMode fmi3EnterEventMode fmi3Terminate
    fmi3Reset fmi3GetFloat32 fmi3GetFloat64 fmi3GetInt8 fmi3GetUInt8 fmi3GetInt16 fmi3GetUInt16 fmi3GetInt32
    fmi3GetUInt32 fmi3GetInt64 fmi3GetUInt64 fmi3GetBoolean fmi3GetString fmi3GetBinary fmi3GetClock
    fmi3SetFloat32 fmi3SetFloat64 fmi3SetInt8 fmi3SetUInt8 fmi3SetInt16 fmi3SetUInt16 fmi3SetInt32 fmi3SetUInt32
    fmi3SetInt64 fmi3SetUInt64 fmi3SetBoolean fmi3SetString fmi3SetBinary fmi3SetClock
    fmi3GetNumberOfVariableDependencies fmi3GetVariableDependencies fmi3GetFMUState fmi3SetFMUState
    fmi3FreeFMUState fmi3SerializedFMUStateSize fmi3SerializeFMUState fmi3DeserializeFMUState
    fmi3GetDirectionalDerivative fmi3GetAdjointDerivative fmi3EnterConfigurationMode fmi3ExitConfigurationMode
    fmi3GetIntervalDecimal fmi3GetIntervalFraction fmi3GetShiftDecimal fmi3GetShiftFraction
    fmi3SetIntervalDecimal fmi3SetIntervalFraction fmi3SetShiftDecimal fmi3SetShiftFraction
    fmi3EvaluateDiscreteStates fmi3UpdateDiscreteStates fmi3EnterContinuousTimeMode fmi3CompletedIntegratorStep
    fmi3SetTime fmi3SetContinuousStates fmi3GetContinuousStateDerivatives fmi3GetEventIndicators
    fmi3GetContinuousStates fmi3GetNominalsOfContinuousStates fmi3GetNumberOfEventIndicators
    fmi3GetNumberOfContinuousStates fmi3EnterStepMode fmi3GetOutputDerivatives fmi3DoStep
    fmi3ActivateModelPartition fmi2Instantiate fmi2FreeInstance fmi3InstantiateModelExchange
    fmi3InstantiateCoSimulation fmi3FreeInstance
}
