//! Calling an FMU's library the way an importer does, for both standards alike: the same Rust calls the glider and the
//! minimal FMU in C, so that what the caller costs falls on both.

use std::ffi::{CString, c_char, c_int, c_void};
use std::path::Path;
use std::ptr::{null, null_mut};

use anyhow::{Context, Result, ensure};
use libloading::Library;

/// An instance, as C sees it.
pub type Pointer = *mut c_void;

/// Which of the two standards.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standard {
    Fmi2,
    Fmi3,
}

/// Which of the two interfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interface {
    CoSimulation,
    ModelExchange,
}

/// Functions of a loaded library.
pub struct Fmu {
    token: CString,
    functions: Functions,
    // Dropped last: the functions are its own.
    _library: Library,
}

enum Functions {
    Fmi2(Fmi2),
    Fmi3(Fmi3),
}

macro_rules! functions {
    ($name:ident { $($field:ident $symbol:literal : $type:ty;)* }) => {
        struct $name {
            $($field: $type,)*
        }

        impl $name {
            fn load(library: &Library) -> Result<Self> {
                // SAFETY: the types are those of the standard's headers.
                unsafe {
                    Ok($name {
                        $($field: *library.get::<$type>($symbol).with_context(|| {
                            format!("no {}", String::from_utf8_lossy($symbol))
                        })?,)*
                    })
                }
            }
        }
    };
}

type GetOrSet2 = unsafe extern "C" fn(Pointer, *const u32, usize, *mut f64) -> c_int;
type GetOrSet3 = unsafe extern "C" fn(Pointer, *const u32, usize, *mut f64, usize) -> c_int;
type Plain = unsafe extern "C" fn(Pointer) -> c_int;
type All = unsafe extern "C" fn(Pointer, *mut f64, usize) -> c_int;

functions!(Fmi2 {
    instantiate b"fmi2Instantiate": unsafe extern "C" fn(*const c_char, c_int, *const c_char, *const c_char, *const Callbacks, c_int, c_int) -> Pointer;
    free b"fmi2FreeInstance": unsafe extern "C" fn(Pointer);
    setup b"fmi2SetupExperiment": unsafe extern "C" fn(Pointer, c_int, f64, f64, c_int, f64) -> c_int;
    enter_initialization b"fmi2EnterInitializationMode": Plain;
    exit_initialization b"fmi2ExitInitializationMode": Plain;
    update b"fmi2NewDiscreteStates": unsafe extern "C" fn(Pointer, *mut EventInfo) -> c_int;
    enter_continuous b"fmi2EnterContinuousTimeMode": Plain;
    set_time b"fmi2SetTime": unsafe extern "C" fn(Pointer, f64) -> c_int;
    set_states b"fmi2SetContinuousStates": All;
    derivatives b"fmi2GetDerivatives": All;
    states b"fmi2GetContinuousStates": All;
    do_step b"fmi2DoStep": unsafe extern "C" fn(Pointer, f64, f64, c_int) -> c_int;
    get b"fmi2GetReal": GetOrSet2;
    set b"fmi2SetReal": GetOrSet2;
});

functions!(Fmi3 {
    co_simulation b"fmi3InstantiateCoSimulation": unsafe extern "C" fn(*const c_char, *const c_char, *const c_char, u8, u8, u8, u8, *const u32, usize, Pointer, *const c_void, *const c_void) -> Pointer;
    model_exchange b"fmi3InstantiateModelExchange": unsafe extern "C" fn(*const c_char, *const c_char, *const c_char, u8, u8, Pointer, *const c_void) -> Pointer;
    free b"fmi3FreeInstance": unsafe extern "C" fn(Pointer);
    enter_initialization b"fmi3EnterInitializationMode": unsafe extern "C" fn(Pointer, u8, f64, f64, u8, f64) -> c_int;
    exit_initialization b"fmi3ExitInitializationMode": Plain;
    update b"fmi3UpdateDiscreteStates": unsafe extern "C" fn(Pointer, *mut u8, *mut u8, *mut u8, *mut u8, *mut u8, *mut f64) -> c_int;
    enter_continuous b"fmi3EnterContinuousTimeMode": Plain;
    set_time b"fmi3SetTime": unsafe extern "C" fn(Pointer, f64) -> c_int;
    set_states b"fmi3SetContinuousStates": All;
    derivatives b"fmi3GetContinuousStateDerivatives": All;
    states b"fmi3GetContinuousStates": All;
    do_step b"fmi3DoStep": unsafe extern "C" fn(Pointer, f64, f64, u8, *mut u8, *mut u8, *mut u8, *mut f64) -> c_int;
    get b"fmi3GetFloat64": GetOrSet3;
    set b"fmi3SetFloat64": GetOrSet3;
});

/// `fmi2CallbackFunctions`.
#[repr(C)]
struct Callbacks {
    logger: unsafe extern "C" fn(),
    allocate: unsafe extern "C" fn(usize, usize) -> *mut c_void,
    free: unsafe extern "C" fn(*mut c_void),
    step_finished: *const c_void,
    environment: *mut c_void,
}

/// `fmi2EventInfo`.
#[repr(C)]
#[derive(Default)]
struct EventInfo {
    flags: [c_int; 5],
    next_event_time: f64,
}

unsafe extern "C" fn silent() {}

unsafe extern "C" {
    fn calloc(n: usize, size: usize) -> *mut c_void;
    fn free(pointer: *mut c_void);
}

static CALLBACKS: CallbacksPlace = CallbacksPlace(Callbacks {
    logger: silent,
    allocate: calloc,
    free,
    step_finished: null(),
    environment: null_mut(),
});

struct CallbacksPlace(Callbacks);

// SAFETY: nothing in it ever changes.
unsafe impl Sync for CallbacksPlace {}

impl Fmu {
    /// Loads a library; `token` is the one of its model description.
    pub fn load(library: &Path, standard: Standard, token: &str) -> Result<Fmu> {
        // SAFETY: an FMU's library has no initialisation of its own.
        let loaded = unsafe { Library::new(library) }.with_context(|| format!("cannot load {}", library.display()))?;
        let functions = match standard {
            Standard::Fmi2 => Functions::Fmi2(Fmi2::load(&loaded)?),
            Standard::Fmi3 => Functions::Fmi3(Fmi3::load(&loaded)?),
        };
        Ok(Fmu { token: CString::new(token)?, functions, _library: loaded })
    }

    /// A new instance, not yet initialised.
    pub fn instantiate(&self, interface: Interface) -> Result<Instance<'_>> {
        let (name, token) = (c"bench".as_ptr(), self.token.as_ptr());
        // SAFETY: all arguments live through the call, the callbacks for ever.
        let pointer = unsafe {
            match (&self.functions, interface) {
                (Functions::Fmi2(f), _) => {
                    let kind = c_int::from(interface == Interface::CoSimulation);
                    (f.instantiate)(name, kind, token, null(), &CALLBACKS.0, 0, 0)
                }
                (Functions::Fmi3(f), Interface::CoSimulation) => {
                    (f.co_simulation)(name, token, null(), 0, 0, 0, 0, null(), 0, null_mut(), null(), null())
                }
                (Functions::Fmi3(f), Interface::ModelExchange) => {
                    (f.model_exchange)(name, token, null(), 0, 0, null_mut(), null())
                }
            }
        };
        ensure!(!pointer.is_null(), "the FMU gave no instance");
        Ok(Instance { fmu: self, pointer, interface })
    }

    /// An instance that has begun.
    pub fn begin(&self, interface: Interface, tolerance: f64) -> Result<Instance<'_>> {
        let instance = self.instantiate(interface)?;
        instance.begin(tolerance)?;
        Ok(instance)
    }
}

/// An instance; freed when dropped.
pub struct Instance<'a> {
    fmu: &'a Fmu,
    pointer: Pointer,
    interface: Interface,
}

impl Instance<'_> {
    /// Initialises it; with Model Exchange up to continuous time.
    pub fn begin(&self, tolerance: f64) -> Result<()> {
        let p = self.pointer;
        let exchange = self.interface == Interface::ModelExchange;
        // SAFETY: a live instance and places of its own.
        unsafe {
            match &self.fmu.functions {
                Functions::Fmi2(f) => {
                    ok((f.setup)(p, 1, tolerance, 0.0, 0, 0.0))?;
                    ok((f.enter_initialization)(p))?;
                    ok((f.exit_initialization)(p))?;
                    if exchange {
                        ok((f.update)(p, &mut EventInfo::default()))?;
                        ok((f.enter_continuous)(p))?;
                    }
                }
                Functions::Fmi3(f) => {
                    ok((f.enter_initialization)(p, 1, tolerance, 0.0, 0, 0.0))?;
                    ok((f.exit_initialization)(p))?;
                    if exchange {
                        let (mut a, mut b, mut c, mut d, mut e, mut t) = (0, 0, 0, 0, 0, 0.0);
                        ok((f.update)(p, &mut a, &mut b, &mut c, &mut d, &mut e, &mut t))?;
                        ok((f.enter_continuous)(p))?;
                    }
                }
            }
        }
        Ok(())
    }

    /// One communication step.
    pub fn do_step(&self, from: f64, size: f64) -> Result<()> {
        // SAFETY: a live instance and places of its own.
        ok(unsafe {
            match &self.fmu.functions {
                Functions::Fmi2(f) => (f.do_step)(self.pointer, from, size, 1),
                Functions::Fmi3(f) => {
                    let (mut event, mut terminate, mut early, mut time) = (0, 0, 0, 0.0);
                    (f.do_step)(self.pointer, from, size, 1, &mut event, &mut terminate, &mut early, &mut time)
                }
            }
        })
    }

    /// One right-hand side as a solver asks for it: time, states, derivatives.
    pub fn rates(&self, time: f64, states: &mut [f64], rates: &mut [f64]) -> Result<()> {
        let (p, n) = (self.pointer, states.len());
        // SAFETY: a live instance and arrays of their lengths.
        let statuses = unsafe {
            match &self.fmu.functions {
                Functions::Fmi2(f) => [
                    (f.set_time)(p, time),
                    (f.set_states)(p, states.as_mut_ptr(), n),
                    (f.derivatives)(p, rates.as_mut_ptr(), n),
                ],
                Functions::Fmi3(f) => [
                    (f.set_time)(p, time),
                    (f.set_states)(p, states.as_mut_ptr(), n),
                    (f.derivatives)(p, rates.as_mut_ptr(), n),
                ],
            }
        };
        ok(statuses.into_iter().max().unwrap_or(0))
    }

    /// The continuous states (Model Exchange).
    pub fn states(&self, states: &mut [f64]) -> Result<()> {
        let (p, n) = (self.pointer, states.len());
        // SAFETY: a live instance and an array of its length.
        ok(unsafe {
            match &self.fmu.functions {
                Functions::Fmi2(f) => (f.states)(p, states.as_mut_ptr(), n),
                Functions::Fmi3(f) => (f.states)(p, states.as_mut_ptr(), n),
            }
        })
    }

    /// Values of variables.
    pub fn get<const N: usize>(&self, references: [u32; N]) -> Result<[f64; N]> {
        let mut values = [f64::NAN; N];
        // SAFETY: a live instance and arrays of N.
        ok(unsafe {
            match &self.fmu.functions {
                Functions::Fmi2(f) => (f.get)(self.pointer, references.as_ptr(), N, values.as_mut_ptr()),
                Functions::Fmi3(f) => (f.get)(self.pointer, references.as_ptr(), N, values.as_mut_ptr(), N),
            }
        })?;
        Ok(values)
    }

    /// Sets variables.
    pub fn set<const N: usize>(&self, references: [u32; N], mut values: [f64; N]) -> Result<()> {
        // SAFETY: a live instance and arrays of N; the values are read only.
        ok(unsafe {
            match &self.fmu.functions {
                Functions::Fmi2(f) => (f.set)(self.pointer, references.as_ptr(), N, values.as_mut_ptr()),
                Functions::Fmi3(f) => (f.set)(self.pointer, references.as_ptr(), N, values.as_mut_ptr(), N),
            }
        })
    }
}

impl Drop for Instance<'_> {
    fn drop(&mut self) {
        // SAFETY: made by this library, freed once.
        unsafe {
            match &self.fmu.functions {
                Functions::Fmi2(f) => (f.free)(self.pointer),
                Functions::Fmi3(f) => (f.free)(self.pointer),
            }
        }
    }
}

fn ok(status: c_int) -> Result<()> {
    ensure!(status == 0, "the FMU answered with status {status}");
    Ok(())
}

/// The glider's library, and what its model description says of it.
pub struct FmuGlider {
    pub fmu: Fmu,
    pub ballast_command: u32,
    pub moving_mass_command: u32,
    pub ballast_offset: u32,
    pub x: u32,
    pub depth: u32,
    /// How many continuous states it has.
    pub n_states: usize,
}

/// Time between two turns of the voyage \[s\]: down for one leg, up for the next.
pub const LEG_S: f64 = 375.0;

/// Legs of a day.
pub const LEGS_PER_DAY: f64 = 86_400.0 / LEG_S;

/// The voyage's tolerance.
pub const TOLERANCE: f64 = 1e-6;

/// A model description below this folder, and its token.
fn description(folder: &Path, standard: Standard) -> Result<(String, String)> {
    let (name, key) = match standard {
        Standard::Fmi2 => ("fmi2", "guid=\""),
        Standard::Fmi3 => ("fmi3", "instantiationToken=\""),
    };
    let file = folder.join(name).join("modelDescription.xml");
    let text = std::fs::read_to_string(&file).with_context(|| format!("cannot read {}", file.display()))?;
    let token = text.split(key).nth(1).and_then(|after| after.split('"').next()).context("no token")?.to_owned();
    Ok((text, token))
}

/// How many continuous states a model description has: each is the derivative's variable once, in either standard.
fn states_of(description: &str) -> usize {
    description.matches(" derivative=\"").count()
}

/// Loads the same library as the glider in space, with how many continuous states that has.
pub fn in_space(root: &Path, library: &Path, standard: Standard) -> Result<(Fmu, usize)> {
    let (text, token) = description(&root.join("modelDescription/space"), standard)?;
    Ok((Fmu::load(library, standard, &token)?, states_of(&text)))
}

impl FmuGlider {
    /// Loads the glider's library; its model description is read from the checkout.
    pub fn load(root: &Path, library: &Path, standard: Standard) -> Result<FmuGlider> {
        let (text, token) = description(&root.join("modelDescription"), standard)?;
        let reference = |name: &str| -> Result<u32> {
            let after = text.split(&format!("name=\"{name}\" valueReference=\"")).nth(1);
            let digits = after.and_then(|after| after.split('"').next());
            Ok(digits.with_context(|| format!("no variable {name}"))?.parse()?)
        };
        Ok(FmuGlider {
            fmu: Fmu::load(library, standard, &token)?,
            ballast_command: reference("ballast_command_m3")?,
            moving_mass_command: reference("moving_mass_command_m")?,
            ballast_offset: reference("ballast_offset_kg")?,
            x: reference("x_m")?,
            depth: reference("depth_m")?,
            n_states: states_of(&text),
        })
    }

    /// Flies a saw-tooth by communication steps: all commands change sign at every turn.
    pub fn fly(&self, instance: &Instance<'_>, legs: usize, step_s: f64) -> Result<()> {
        let references = [self.ballast_command, self.moving_mass_command];
        let commands = instance.get(references)?;
        let steps = (LEG_S / step_s).round() as usize;
        for leg in 0..legs {
            let sign = if leg % 2 == 0 { 1.0 } else { -1.0 };
            instance.set(references, commands.map(|command| sign * command))?;
            for step in 0..steps {
                instance.do_step(leg as f64 * LEG_S + step as f64 * step_s, step_s)?;
            }
        }
        Ok(())
    }
}
