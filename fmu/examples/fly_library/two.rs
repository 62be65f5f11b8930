//! FMI 2.0.

use std::ffi::{c_char, c_void};
use std::ptr::{null, null_mut};

use libloading::Library;

use crate::abi::{Exchange, Interface, Simulation, functions, ok};
use crate::c_string;

type Pointer = *mut c_void;
type Text = *const c_char;

/// `fmi2CallbackFunctions`: no logger, and nothing else that the library would call.
#[repr(C)]
struct Callbacks([*const c_void; 5]);

/// `fmi2EventInfo`.
#[repr(C)]
#[derive(Default)]
pub struct EventInfo {
    flags: [i32; 5],
    next_s: f64,
}

functions! { Functions {
    fmi2Instantiate(Text, i32, Text, Text, *const c_void, i32, i32) -> Pointer;
    fmi2SetupExperiment(Pointer, i32, f64, f64, i32, f64) -> i32;
    fmi2EnterInitializationMode(Pointer) -> i32;
    fmi2ExitInitializationMode(Pointer) -> i32;
    fmi2SetReal(Pointer, *const u32, usize, *const f64) -> i32;
    fmi2GetReal(Pointer, *const u32, usize, *mut f64) -> i32;
    fmi2DoStep(Pointer, f64, f64, i32) -> i32;
    fmi2GetFMUstate(Pointer, *mut Pointer) -> i32;
    fmi2SetFMUstate(Pointer, Pointer) -> i32;
    fmi2FreeFMUstate(Pointer, *mut Pointer) -> i32;
    fmi2SerializedFMUstateSize(Pointer, Pointer, *mut usize) -> i32;
    fmi2SerializeFMUstate(Pointer, Pointer, *mut u8, usize) -> i32;
    fmi2DeSerializeFMUstate(Pointer, *const u8, usize, *mut Pointer) -> i32;
    fmi2GetDirectionalDerivative(Pointer, *const u32, usize, *const u32, usize, *const f64, *mut f64) -> i32;
    fmi2NewDiscreteStates(Pointer, *mut EventInfo) -> i32;
    fmi2EnterContinuousTimeMode(Pointer) -> i32;
    fmi2SetTime(Pointer, f64) -> i32;
    fmi2GetContinuousStates(Pointer, *mut f64, usize) -> i32;
    fmi2SetContinuousStates(Pointer, *const f64, usize) -> i32;
    fmi2GetDerivatives(Pointer, *mut f64, usize) -> i32;
    fmi2FreeInstance(Pointer) -> ();
}}

pub struct Instance {
    f: Functions,
    pointer: Pointer,
    /// The standard wants it to live as long as the instance.
    _callbacks: Box<Callbacks>,
}

impl Instance {
    pub fn new(library: &Library, token: &str, interface: Interface) -> Self {
        let f = Functions::of(library);
        let callbacks = Box::new(Callbacks([null(); 5]));
        let (name, token) = (c"glider".as_ptr(), c_string(token));
        let kind = i32::from(interface == Interface::CoSimulation);
        let functions = std::ptr::from_ref(&*callbacks).cast();
        // SAFETY: texts that live through the call.
        let pointer = unsafe { (f.fmi2Instantiate)(name, kind, token.as_ptr(), null(), functions, 0, 0) };
        assert!(!pointer.is_null(), "no instance");
        Instance { f, pointer, _callbacks: callbacks }
    }

    fn initialise(&self) {
        // SAFETY: a live instance.
        unsafe {
            ok((self.f.fmi2SetupExperiment)(self.pointer, 0, 0.0, 0.0, 0, 0.0));
            ok((self.f.fmi2EnterInitializationMode)(self.pointer));
            ok((self.f.fmi2ExitInitializationMode)(self.pointer));
        }
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: a live instance, freed once.
        unsafe { (self.f.fmi2FreeInstance)(self.pointer) }
    }
}

impl Simulation for Instance {
    fn begin(&self) {
        self.initialise();
    }

    fn set(&self, reference: u32, value: f64) {
        // SAFETY: a live instance, one value.
        ok(unsafe { (self.f.fmi2SetReal)(self.pointer, &reference, 1, &value) });
    }

    fn get(&self, reference: u32) -> f64 {
        let mut value = f64::NAN;
        // SAFETY: as above.
        ok(unsafe { (self.f.fmi2GetReal)(self.pointer, &reference, 1, &mut value) });
        value
    }

    fn step(&self, from_s: f64, size_s: f64) {
        // SAFETY: a live instance.
        ok(unsafe { (self.f.fmi2DoStep)(self.pointer, from_s, size_s, 0) });
    }

    fn saved(&self) -> Vec<u8> {
        let (mut state, mut size) = (null_mut(), 0);
        // SAFETY: a live instance, room for the bytes.
        unsafe {
            ok((self.f.fmi2GetFMUstate)(self.pointer, &mut state));
            ok((self.f.fmi2SerializedFMUstateSize)(self.pointer, state, &mut size));
            let mut bytes = vec![0; size];
            ok((self.f.fmi2SerializeFMUstate)(self.pointer, state, bytes.as_mut_ptr(), size));
            ok((self.f.fmi2FreeFMUstate)(self.pointer, &mut state));
            bytes
        }
    }

    fn restore(&self, bytes: &[u8]) {
        let mut state = null_mut();
        // SAFETY: as above.
        unsafe {
            ok((self.f.fmi2DeSerializeFMUstate)(self.pointer, bytes.as_ptr(), bytes.len(), &mut state));
            ok((self.f.fmi2SetFMUstate)(self.pointer, state));
            ok((self.f.fmi2FreeFMUstate)(self.pointer, &mut state));
        }
    }

    fn derivative(&self, unknown: u32, known: u32) -> f64 {
        let mut slope = f64::NAN;
        let get = self.f.fmi2GetDirectionalDerivative;
        // SAFETY: as above.
        ok(unsafe { get(self.pointer, &unknown, 1, &known, 1, &1.0, &mut slope) });
        slope
    }
}

impl Exchange for Instance {
    fn begin(&self) {
        self.initialise();
        let mut event = EventInfo::default();
        // SAFETY: a live instance and a place of its own.
        unsafe {
            ok((self.f.fmi2NewDiscreteStates)(self.pointer, &mut event));
            ok((self.f.fmi2EnterContinuousTimeMode)(self.pointer));
        }
    }

    fn states(&self, states: &mut [f64]) {
        // SAFETY: room for all states.
        ok(unsafe { (self.f.fmi2GetContinuousStates)(self.pointer, states.as_mut_ptr(), states.len()) });
    }

    fn rates(&self, rates: &mut [f64]) {
        // SAFETY: as above.
        ok(unsafe { (self.f.fmi2GetDerivatives)(self.pointer, rates.as_mut_ptr(), rates.len()) });
    }

    fn go_to(&self, time_s: f64, states: &[f64]) {
        // SAFETY: all states.
        unsafe {
            ok((self.f.fmi2SetTime)(self.pointer, time_s));
            ok((self.f.fmi2SetContinuousStates)(self.pointer, states.as_ptr(), states.len()));
        }
    }
}
