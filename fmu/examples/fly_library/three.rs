//! FMI 3.0.

use std::ffi::{c_char, c_void};
use std::ptr::{null, null_mut};

use libloading::Library;

use crate::abi::{Exchange, Interface, Simulation, functions, ok};
use crate::c_string;

type Pointer = *mut c_void;
type Log = Option<unsafe extern "C" fn(Pointer, i32, *const c_char, *const c_char)>;
type Update = Option<unsafe extern "C" fn()>;
type Text = *const c_char;

functions! { Functions {
    fmi3InstantiateCoSimulation(Text, Text, Text, bool, bool, bool, bool, *const u32, usize, Pointer, Log, Update) -> Pointer;
    fmi3InstantiateModelExchange(Text, Text, Text, bool, bool, Pointer, Log) -> Pointer;
    fmi3EnterInitializationMode(Pointer, bool, f64, f64, bool, f64) -> i32;
    fmi3ExitInitializationMode(Pointer) -> i32;
    fmi3SetFloat64(Pointer, *const u32, usize, *const f64, usize) -> i32;
    fmi3GetFloat64(Pointer, *const u32, usize, *mut f64, usize) -> i32;
    fmi3DoStep(Pointer, f64, f64, bool, *mut bool, *mut bool, *mut bool, *mut f64) -> i32;
    fmi3GetFMUState(Pointer, *mut Pointer) -> i32;
    fmi3SetFMUState(Pointer, Pointer) -> i32;
    fmi3FreeFMUState(Pointer, *mut Pointer) -> i32;
    fmi3SerializedFMUStateSize(Pointer, Pointer, *mut usize) -> i32;
    fmi3SerializeFMUState(Pointer, Pointer, *mut u8, usize) -> i32;
    fmi3DeserializeFMUState(Pointer, *const u8, usize, *mut Pointer) -> i32;
    fmi3GetDirectionalDerivative(Pointer, *const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize) -> i32;
    fmi3UpdateDiscreteStates(Pointer, *mut bool, *mut bool, *mut bool, *mut bool, *mut bool, *mut f64) -> i32;
    fmi3EnterContinuousTimeMode(Pointer) -> i32;
    fmi3SetTime(Pointer, f64) -> i32;
    fmi3GetContinuousStates(Pointer, *mut f64, usize) -> i32;
    fmi3SetContinuousStates(Pointer, *const f64, usize) -> i32;
    fmi3GetContinuousStateDerivatives(Pointer, *mut f64, usize) -> i32;
    fmi3FreeInstance(Pointer) -> ();
}}

pub struct Instance {
    f: Functions,
    pointer: Pointer,
}

impl Instance {
    pub fn new(library: &Library, token: &str, interface: Interface) -> Self {
        let f = Functions::of(library);
        let (name, token) = (c"glider".as_ptr(), c_string(token));
        // SAFETY: texts that live through the call.
        let pointer = unsafe {
            match interface {
                Interface::ModelExchange => {
                    (f.fmi3InstantiateModelExchange)(name, token.as_ptr(), null(), false, false, null_mut(), None)
                }
                Interface::CoSimulation => {
                    let (no, make) = (false, f.fmi3InstantiateCoSimulation);
                    make(name, token.as_ptr(), null(), no, no, no, no, null(), 0, null_mut(), None, None)
                }
            }
        };
        assert!(!pointer.is_null(), "no instance");
        Instance { f, pointer }
    }

    fn initialise(&self) {
        // SAFETY: a live instance.
        unsafe {
            ok((self.f.fmi3EnterInitializationMode)(self.pointer, false, 0.0, 0.0, false, 0.0));
            ok((self.f.fmi3ExitInitializationMode)(self.pointer));
        }
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: a live instance, freed once.
        unsafe { (self.f.fmi3FreeInstance)(self.pointer) }
    }
}

impl Simulation for Instance {
    fn begin(&self) {
        self.initialise();
    }

    fn set(&self, reference: u32, value: f64) {
        // SAFETY: a live instance, one value.
        ok(unsafe { (self.f.fmi3SetFloat64)(self.pointer, &reference, 1, &value, 1) });
    }

    fn get(&self, reference: u32) -> f64 {
        let mut value = f64::NAN;
        // SAFETY: as above.
        ok(unsafe { (self.f.fmi3GetFloat64)(self.pointer, &reference, 1, &mut value, 1) });
        value
    }

    fn step(&self, from_s: f64, size_s: f64) {
        let (mut event, mut end, mut early, mut reached) = (false, false, false, 0.0);
        let step = self.f.fmi3DoStep;
        // SAFETY: as above.
        ok(unsafe { step(self.pointer, from_s, size_s, false, &mut event, &mut end, &mut early, &mut reached) });
    }

    fn saved(&self) -> Vec<u8> {
        let (mut state, mut size) = (null_mut(), 0);
        // SAFETY: a live instance, room for the bytes.
        unsafe {
            ok((self.f.fmi3GetFMUState)(self.pointer, &mut state));
            ok((self.f.fmi3SerializedFMUStateSize)(self.pointer, state, &mut size));
            let mut bytes = vec![0; size];
            ok((self.f.fmi3SerializeFMUState)(self.pointer, state, bytes.as_mut_ptr(), size));
            ok((self.f.fmi3FreeFMUState)(self.pointer, &mut state));
            bytes
        }
    }

    fn restore(&self, bytes: &[u8]) {
        let mut state = null_mut();
        // SAFETY: as above.
        unsafe {
            ok((self.f.fmi3DeserializeFMUState)(self.pointer, bytes.as_ptr(), bytes.len(), &mut state));
            ok((self.f.fmi3SetFMUState)(self.pointer, state));
            ok((self.f.fmi3FreeFMUState)(self.pointer, &mut state));
        }
    }

    fn derivative(&self, unknown: u32, known: u32) -> f64 {
        let mut slope = f64::NAN;
        let get = self.f.fmi3GetDirectionalDerivative;
        // SAFETY: as above.
        ok(unsafe { get(self.pointer, &unknown, 1, &known, 1, &1.0, 1, &mut slope, 1) });
        slope
    }
}

impl Exchange for Instance {
    fn begin(&self) {
        self.initialise();
        let (mut a, mut b, mut c, mut d, mut e, mut next) = (false, false, false, false, false, 0.0);
        // SAFETY: a live instance and places of its own.
        unsafe {
            ok((self.f.fmi3UpdateDiscreteStates)(self.pointer, &mut a, &mut b, &mut c, &mut d, &mut e, &mut next));
            ok((self.f.fmi3EnterContinuousTimeMode)(self.pointer));
        }
    }

    fn states(&self, states: &mut [f64]) {
        // SAFETY: room for all states.
        ok(unsafe { (self.f.fmi3GetContinuousStates)(self.pointer, states.as_mut_ptr(), states.len()) });
    }

    fn rates(&self, rates: &mut [f64]) {
        // SAFETY: as above.
        ok(unsafe { (self.f.fmi3GetContinuousStateDerivatives)(self.pointer, rates.as_mut_ptr(), rates.len()) });
    }

    fn go_to(&self, time_s: f64, states: &[f64]) {
        // SAFETY: all states.
        unsafe {
            ok((self.f.fmi3SetTime)(self.pointer, time_s));
            ok((self.f.fmi3SetContinuousStates)(self.pointer, states.as_ptr(), states.len()));
        }
    }
}
