//! An importer for the tests: the C functions of both standards, called as C would, with every message kept.

#![allow(dead_code, reason = "each test uses its part")]

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr::{null, null_mut};
use std::sync::Mutex;

use glidepolar_fmu::fmi2::*;
use glidepolar_fmu::fmi3::*;
use glidepolar_fmu::model::table::token;
use glidepolar_fmu::model::{Model, variables};

pub const OK: c_int = 0;
pub const WARNING: c_int = 1;
pub const DISCARD: c_int = 2;
pub const ERROR: c_int = 3;

/// The value reference of a variable.
pub fn vr(name: &str) -> u32 {
    let found = variables().iter().find(|variable| variable.name == name);
    found.unwrap_or_else(|| panic!("no variable {name}")).reference
}

/// The value reference of a variable of this model.
pub fn vr_of(model: Model, name: &str) -> u32 {
    let found = model.table().rows.iter().find(|variable| variable.name == name);
    found.unwrap_or_else(|| panic!("no variable {name}")).reference
}

/// What the instance said.
#[derive(Default)]
pub struct Messages(Mutex<Vec<(c_int, String)>>);

impl Messages {
    pub fn push(&self, status: c_int, text: *const c_char) {
        // SAFETY: the instance's own text.
        let text = unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned();
        self.0.lock().unwrap().push((status, text));
    }

    /// All since the last call.
    pub fn take(&self) -> Vec<(c_int, String)> {
        std::mem::take(&mut self.0.lock().unwrap())
    }
}

pub unsafe extern "C" fn log_3(environment: *mut c_void, status: c_int, _: *const c_char, message: *const c_char) {
    // SAFETY: the environment of `Glider3`.
    unsafe { (*environment.cast::<Environment>()).messages.push(status, message) }
}

unsafe extern "C" fn log_2(
    environment: *mut c_void,
    _: *const c_char,
    status: c_int,
    _: *const c_char,
    message: *const c_char,
) {
    // SAFETY: the environment of `Glider2`.
    unsafe { (*environment.cast::<Environment>()).messages.push(status, message) }
}

/// What an importer does when it is let in.
pub type LookIn = Box<dyn FnMut(Pointer, f64, bool) -> Option<f64>>;

/// What the callbacks get back.
#[derive(Default)]
pub struct Environment {
    pub messages: Messages,
    pub look_in: Option<LookIn>,
    pub instance: usize,
}

/// An instance driven through FMI 3.0.
pub struct Glider3 {
    pub model: Model,
    pub instance: Pointer,
    pub environment: Box<Environment>,
}

#[derive(Clone, Copy, Default)]
pub struct Options {
    pub event_mode: bool,
    pub early_return: bool,
    pub look_in: bool,
}

/// How a step ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stepped {
    pub status: c_int,
    pub event: bool,
    pub early: bool,
    pub time: f64,
}

unsafe extern "C" fn look_in(
    environment: *mut c_void,
    time: f64,
    set_requested: u8,
    get_allowed: u8,
    finished: u8,
    can_return: u8,
    requested: *mut u8,
    return_time: *mut f64,
) {
    assert_eq!((get_allowed, finished), (1, 1));
    let _ = set_requested;
    // SAFETY: the environment of `Glider3`; the step waits.
    unsafe {
        let environment = environment.cast::<Environment>();
        let instance = (*environment).instance as Pointer;
        if let Some(look_in) = (*environment).look_in.as_mut()
            && let Some(wanted) = look_in(instance, time, can_return != 0)
        {
            (*requested, *return_time) = (1, wanted);
        }
    }
}

/// What an event has brought, with the flags as they were written.
pub struct Discrete {
    /// Whether another update is needed, the simulation ends, nominal values have changed.
    pub flags: [u8; 3],
    /// Whether continuous states have changed.
    pub values: u8,
    /// Time of the next event, where one is known.
    pub next_s: Option<f64>,
}

impl Glider3 {
    pub fn co_simulation(options: Options) -> Self {
        Self::with_resources(options, null(), token()).expect("an instance without resources")
    }

    /// A co-simulation with a resource path, of an archive with this token; what was said where there is none.
    pub fn with_resources(options: Options, path: *const c_char, token: &str) -> Result<Self, Vec<(c_int, String)>> {
        let mut environment = Box::<Environment>::default();
        let token = CString::new(token).unwrap();
        let pointer: *mut c_void = (&raw mut *environment).cast();
        // SAFETY: all arguments live through the call, the environment through the instance.
        let instance = unsafe {
            fmi3InstantiateCoSimulation(
                c"glider".as_ptr(),
                token.as_ptr(),
                path,
                0,
                0,
                options.event_mode.into(),
                options.early_return.into(),
                null(),
                0,
                pointer,
                Some(log_3),
                options.look_in.then_some(look_in as IntermediateUpdate),
            )
        };
        if instance.is_null() {
            return Err(environment.messages.take());
        }
        environment.instance = instance as usize;
        let (model, _) = Model::of_token(&token.to_string_lossy()).expect("a token of the library");
        Ok(Glider3 { model, instance, environment })
    }

    /// A co-simulation of this model.
    pub fn of(model: Model, options: Options) -> Self {
        Self::with_resources(options, null(), model.table().token).expect("an instance without resources")
    }

    pub fn model_exchange() -> Self {
        Self::model_exchange_of(Model::Plane)
    }

    pub fn model_exchange_of(model: Model) -> Self {
        let mut environment = Box::<Environment>::default();
        let token = CString::new(model.table().token).unwrap();
        let pointer: *mut c_void = (&raw mut *environment).cast();
        // SAFETY: as above.
        let instance = unsafe {
            fmi3InstantiateModelExchange(c"glider".as_ptr(), token.as_ptr(), null(), 0, 0, pointer, Some(log_3))
        };
        assert!(!instance.is_null(), "{:?}", environment.messages.take());
        Glider3 { model, instance, environment }
    }

    /// A co-simulation that has begun, after these start values.
    pub fn started(options: Options, starts: &[(&str, f64)]) -> Self {
        let glider = Self::co_simulation(options);
        glider.set(starts);
        glider.begin(None);
        glider
    }

    /// Asks what an event has brought.
    pub fn update_discrete_states(&self) -> Discrete {
        let (mut needed, mut terminate, mut nominals, mut values, mut defined, mut next) = (9, 9, 9, 9, 9, f64::NAN);
        // SAFETY: a live instance and places of its own.
        self.ok(unsafe {
            fmi3UpdateDiscreteStates(
                self.instance,
                &mut needed,
                &mut terminate,
                &mut nominals,
                &mut values,
                &mut defined,
                &mut next,
            )
        });
        Discrete { flags: [needed, terminate, nominals], values, next_s: (defined == 1).then_some(next) }
    }

    pub fn begin(&self, tolerance: Option<f64>) {
        // SAFETY: a live instance.
        unsafe {
            let (defined, tolerance) = (u8::from(tolerance.is_some()), tolerance.unwrap_or(0.0));
            self.ok(fmi3EnterInitializationMode(self.instance, defined, tolerance, 0.0, 0, 0.0));
            self.ok(fmi3ExitInitializationMode(self.instance));
        }
    }

    pub fn ok(&self, status: c_int) {
        assert_eq!(status, OK, "{:?}", self.environment.messages.take());
    }

    pub fn set(&self, values: &[(&str, f64)]) {
        let references: Vec<u32> = values.iter().map(|(name, _)| self.vr(name)).collect();
        let numbers: Vec<f64> = values.iter().map(|(_, value)| *value).collect();
        let n = references.len();
        // SAFETY: a live instance and arrays of n.
        self.ok(unsafe { fmi3SetFloat64(self.instance, references.as_ptr(), n, numbers.as_ptr(), n) });
    }

    pub fn set_actuation(&self, number: i32) {
        // SAFETY: as above.
        self.ok(unsafe { fmi3SetInt32(self.instance, &vr("actuation"), 1, &number, 1) });
    }

    fn vr(&self, name: &str) -> u32 {
        vr_of(self.model, name)
    }

    pub fn get(&self, name: &str) -> f64 {
        let mut value = f64::NAN;
        // SAFETY: a live instance.
        self.ok(unsafe { fmi3GetFloat64(self.instance, &self.vr(name), 1, &mut value, 1) });
        value
    }

    /// Chooses an item of a list, before the simulation begins.
    pub fn choose(&self, name: &str, number: i32) {
        // SAFETY: as above.
        self.ok(unsafe { fmi3SetInt32(self.instance, &self.vr(name), 1, &number, 1) });
    }

    pub fn is(&self, name: &str) -> bool {
        let mut value = 9;
        // SAFETY: as above.
        self.ok(unsafe { fmi3GetBoolean(self.instance, &self.vr(name), 1, &mut value, 1) });
        assert!(value < 2);
        value != 0
    }

    pub fn integer(&self, name: &str) -> i32 {
        let mut value = 99;
        // SAFETY: as above.
        self.ok(unsafe { fmi3GetInt32(self.instance, &self.vr(name), 1, &mut value, 1) });
        value
    }

    pub fn step(&self, from: f64, size: f64) -> Stepped {
        let (mut event, mut terminate, mut early, mut time) = (9, 9, 9, f64::NAN);
        // SAFETY: a live instance and places of its own.
        let status =
            unsafe { fmi3DoStep(self.instance, from, size, 1, &mut event, &mut terminate, &mut early, &mut time) };
        assert!(terminate != 1);
        Stepped { status, event: event == 1, early: early == 1, time }
    }

    /// Steps to a time, each step done in full.
    pub fn run(&self, from: f64, to: f64, size: f64) {
        let steps = ((to - from) / size).round() as usize;
        for i in 0..steps {
            let start = from + i as f64 * size;
            let stepped = self.step(start, size);
            assert_eq!(stepped.status, OK, "{:?}", self.environment.messages.take());
            assert_eq!((stepped.early, stepped.time), (false, start + size));
        }
    }

    /// All states.
    pub fn states(&self) -> Vec<f64> {
        STATES.iter().map(|name| self.get(name)).collect()
    }

    pub fn save(&self) -> FmuState3 {
        let mut state = null_mut();
        // SAFETY: a live instance.
        self.ok(unsafe { fmi3GetFMUState(self.instance, &mut state) });
        state
    }

    pub fn restore(&self, state: FmuState3) {
        // SAFETY: a live instance.
        self.ok(unsafe { fmi3SetFMUState(self.instance, state) });
    }

    pub fn serialize(&self, state: FmuState3) -> Vec<u8> {
        let mut size = 0;
        // SAFETY: a live instance and a buffer of its size.
        unsafe {
            self.ok(fmi3SerializedFMUStateSize(self.instance, state, &mut size));
            let mut bytes = vec![0; size];
            self.ok(fmi3SerializeFMUState(self.instance, state, bytes.as_mut_ptr(), size));
            bytes
        }
    }

    pub fn deserialize(&self, bytes: &[u8]) -> Result<FmuState3, Vec<(c_int, String)>> {
        let mut state = null_mut();
        // SAFETY: a live instance and its bytes.
        let status = unsafe { fmi3DeserializeFMUState(self.instance, bytes.as_ptr(), bytes.len(), &mut state) };
        if status == OK { Ok(state) } else { Err(self.environment.messages.take()) }
    }
}

pub type FmuState3 = *mut c_void;

/// Reads a number, from inside a callback too.
pub fn get_3(instance: Pointer, name: &str) -> f64 {
    let mut value = f64::NAN;
    // SAFETY: a live instance.
    assert_eq!(unsafe { fmi3GetFloat64(instance, &vr(name), 1, &mut value, 1) }, OK);
    value
}

pub const STATES: [&str; 16] = [
    "x_m",
    "depth_m",
    "pitch_rad",
    "pitch_rate_rad_s",
    "v1_m_s",
    "v3_m_s",
    "moving_mass_position_m",
    "moving_mass_position_3_m",
    "PP1_kg_m_s",
    "PP3_kg_m_s",
    "ballast_mass_kg",
    "creep_pressure_Pa",
    "carried_density_kg_m3",
    "late_temperature_K",
    "leaked_back_m3",
    "energy_J",
];

impl Drop for Glider3 {
    fn drop(&mut self) {
        // SAFETY: made by this importer, freed once.
        unsafe { fmi3FreeInstance(self.instance) }
    }
}

/// An instance driven through FMI 2.0.
pub struct Glider2 {
    pub component: Component,
    pub environment: Box<Environment>,
}

impl Glider2 {
    pub fn new(fmu_type: c_int) -> Self {
        let mut environment = Box::<Environment>::default();
        let functions = callbacks((&raw mut *environment).cast());
        let token = CString::new(token()).unwrap();
        // SAFETY: all arguments live through the call, the environment through the instance.
        let component =
            unsafe { fmi2Instantiate(c"glider".as_ptr(), fmu_type, token.as_ptr(), null(), &functions, 0, 0) };
        assert!(!component.is_null(), "{:?}", environment.messages.take());
        Glider2 { component, environment }
    }

    pub fn begin(&self) {
        // SAFETY: a live component.
        unsafe {
            self.ok(fmi2SetupExperiment(self.component, 0, 0.0, 0.0, 0, 0.0));
            self.ok(fmi2EnterInitializationMode(self.component));
            self.ok(fmi2ExitInitializationMode(self.component));
        }
    }

    pub fn ok(&self, status: c_int) {
        assert_eq!(status, OK, "{:?}", self.environment.messages.take());
    }

    pub fn get(&self, name: &str) -> f64 {
        let mut value = f64::NAN;
        // SAFETY: a live component.
        self.ok(unsafe { fmi2GetReal(self.component, &vr(name), 1, &mut value) });
        value
    }

    pub fn set(&self, name: &str, value: f64) {
        // SAFETY: a live component.
        self.ok(unsafe { fmi2SetReal(self.component, &vr(name), 1, &value) });
    }

    pub fn slope(&self, name: &str, order: c_int, value: f64) {
        // SAFETY: a live component.
        self.ok(unsafe { fmi2SetRealInputDerivatives(self.component, &vr(name), 1, &order, &value) });
    }

    pub fn step(&self, from: f64, size: f64) -> c_int {
        // SAFETY: a live component.
        unsafe { fmi2DoStep(self.component, from, size, 1) }
    }
}

impl Drop for Glider2 {
    fn drop(&mut self) {
        // SAFETY: made by this importer, freed once.
        unsafe { fmi2FreeInstance(self.component) }
    }
}

/// FMI 2.0's callbacks into an [`Environment`].
pub fn callbacks(environment: *mut c_void) -> CallbackFunctions {
    type Plain = unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char);
    // SAFETY: a C function may be called as variadic with the arguments that it has, on every platform tested here.
    let logger = unsafe { std::mem::transmute::<Plain, Logger>(log_2) };
    CallbackFunctions {
        logger: Some(logger),
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        component_environment: environment,
    }
}
