//! Calls with arguments of every kind, right and wrong, for whoever chooses their order: the tests at random, the
//! fuzzer by what it has not seen yet.
//!
//! One call type serves all functions: on x86-64 under Unix integers and floating-point numbers are passed in registers
//! of their own and what does not fit follows on the stack in order, so that surplus arguments do no harm.

use std::ffi::{CString, c_char, c_int, c_void};
use std::sync::atomic::{AtomicUsize, Ordering};

use glidepolar_fmu::fmi2::CallbackFunctions;
use glidepolar_fmu::model::{Kind, Model};

pub const OK: c_int = 0;
/// What was done, but perhaps not as meant.
const WARNING: c_int = 1;
pub const ERROR: c_int = 3;

/// Every function that takes an instance, and the kinds of its arguments after it: `b` truth, `i` small integer, `u`
/// reference, `d` number, `n` count, `s` texts, `r` references, `x` numbers to read, `k` integers to read, `y` room,
/// `f` state, `F` place of a state, `B` bytes of a state.
const FUNCTIONS_2: &str = "
SetDebugLogging b n s | SetupExperiment b d d b d | EnterInitializationMode | ExitInitializationMode | Terminate | Reset
GetReal r n y | GetInteger r n y | GetBoolean r n y | GetString r n y
SetReal r n x | SetInteger r n k | SetBoolean r n k | SetString r n s
GetFMUstate F | SetFMUstate f | FreeFMUstate F | SerializedFMUstateSize f y | SerializeFMUstate f y n
DeSerializeFMUstate B n F | GetDirectionalDerivative r n r n x y
EnterEventMode | NewDiscreteStates y | EnterContinuousTimeMode | CompletedIntegratorStep b y y | SetTime d
SetContinuousStates x n | GetDerivatives y n | GetEventIndicators y n | GetContinuousStates y n
GetNominalsOfContinuousStates y n | SetRealInputDerivatives r n k x | GetRealOutputDerivatives r n k y
DoStep d d b | CancelStep | GetStatus i y | GetRealStatus i y | GetIntegerStatus i y | GetBooleanStatus i y
GetStringStatus i y";

const FUNCTIONS_3: &str = "
SetDebugLogging b n s | EnterInitializationMode b d d b d | ExitInitializationMode | EnterEventMode | Terminate | Reset
GetFloat32 r n y n | GetFloat64 r n y n | GetInt8 r n y n | GetUInt8 r n y n | GetInt16 r n y n | GetUInt16 r n y n
GetInt32 r n y n | GetUInt32 r n y n | GetInt64 r n y n | GetUInt64 r n y n | GetBoolean r n y n | GetString r n y n
GetBinary r n y y n | GetClock r n y
SetFloat32 r n x n | SetFloat64 r n x n | SetInt8 r n k n | SetUInt8 r n k n | SetInt16 r n k n | SetUInt16 r n k n
SetInt32 r n k n | SetUInt32 r n k n | SetInt64 r n k n | SetUInt64 r n k n | SetBoolean r n k n | SetString r n s n
SetBinary r n x x n | SetClock r n k | GetNumberOfVariableDependencies u y | GetVariableDependencies u y y y y n
GetFMUState F | SetFMUState f | FreeFMUState F | SerializedFMUStateSize f y | SerializeFMUState f y n
DeserializeFMUState B n F | GetDirectionalDerivative r n r n x n y n | GetAdjointDerivative r n r n x n y n
EnterConfigurationMode | ExitConfigurationMode
GetIntervalDecimal r n y y | GetIntervalFraction r n y y y | GetShiftDecimal r n y | GetShiftFraction r n y y
SetIntervalDecimal r n x | SetIntervalFraction r n x x | SetShiftDecimal r n x | SetShiftFraction r n x x
EvaluateDiscreteStates | UpdateDiscreteStates y y y y y y | EnterContinuousTimeMode | CompletedIntegratorStep b y y
SetTime d | SetContinuousStates x n | GetContinuousStateDerivatives y n | GetEventIndicators y n
GetContinuousStates y n | GetNominalsOfContinuousStates y n | GetNumberOfEventIndicators y
GetNumberOfContinuousStates y | EnterStepMode | GetOutputDerivatives r n k y n | DoStep d d b y y y y
ActivateModelPartition u d";

pub type AnyFunction =
    unsafe extern "C" fn(u64, u64, u64, u64, u64, u64, u64, u64, u64, u64, u64, u64, f64, f64, f64) -> u64;

pub struct Function {
    pub name: String,
    kinds: Vec<char>,
    call: AnyFunction,
}

pub struct Loaded {
    find: Box<dyn Fn(&str) -> AnyFunction>,
    pub two: Vec<Function>,
    pub three: Vec<Function>,
}

impl Loaded {
    /// The functions as `find` gives them by their names.
    pub fn new(find: impl Fn(&str) -> AnyFunction + 'static) -> Self {
        let functions = |prefix: &str, table: &str| {
            let entries = table.split(['|', '\n']).map(str::trim).filter(|entry| !entry.is_empty());
            let function = |entry: &str| {
                let mut words = entry.split_whitespace();
                let name = format!("{prefix}{}", words.next().unwrap());
                let kinds = words.map(|word| word.chars().next().unwrap()).collect();
                let call = find(&name);
                Function { name, kinds, call }
            };
            entries.map(function).collect::<Vec<_>>()
        };
        let (two, three) = (functions("fmi2", FUNCTIONS_2), functions("fmi3", FUNCTIONS_3));
        Loaded { find: Box::new(find), two, three }
    }

    pub fn get(&self, name: &str) -> AnyFunction {
        (self.find)(name)
    }
}

/// Messages that came, and whether one of them told nothing.
#[derive(Default)]
pub struct Counter {
    pub messages: AtomicUsize,
    pub problems: AtomicUsize,
    pub empty: AtomicUsize,
    /// Of a fault inside, which was caught.
    pub faults: AtomicUsize,
}

fn count(environment: *mut c_void, status: c_int, message: *const c_char) {
    // SAFETY: the environment is a `Counter`, the message a text.
    unsafe {
        let counter = &*environment.cast::<Counter>();
        counter.messages.fetch_add(1, Ordering::Relaxed);
        // A warning may come with a call that is done.
        counter.problems.fetch_add(usize::from(status > WARNING), Ordering::Relaxed);
        let message = std::ffi::CStr::from_ptr(message).to_bytes();
        counter.empty.fetch_add(usize::from(message.len() < 20), Ordering::Relaxed);
        let tells_of_fault = String::from_utf8_lossy(message).contains("a fault of the FMU");
        counter.faults.fetch_add(usize::from(tells_of_fault), Ordering::Relaxed);
    }
}

/// The log of FMI 3.
pub unsafe extern "C" fn log_3(environment: *mut c_void, status: c_int, _: *const c_char, message: *const c_char) {
    count(environment, status, message);
}

unsafe extern "C" fn log_2(
    environment: *mut c_void,
    _: *const c_char,
    status: c_int,
    _: *const c_char,
    message: *const c_char,
) {
    count(environment, status, message);
}

/// Random numbers (xorshift).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }

    pub fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    pub fn number(&mut self, time: f64) -> f64 {
        match self.below(14) {
            0 => f64::NAN,
            1 => f64::INFINITY,
            2 => f64::NEG_INFINITY,
            3 => -1.0,
            4 => 1e300,
            5 => 5e-324,
            6 => 0.0,
            7 | 8 => 1.0,
            9 => 30.0,
            _ => time,
        }
    }
}

const ROOM: usize = 4096;
const MOST: usize = 64;

/// Memory that arguments point to. Every array has room for far more elements than any count says.
pub struct Memory {
    /// The model that is called.
    pub model: Model,
    references: Vec<u32>,
    numbers: Vec<f64>,
    integers: Vec<i32>,
    texts: Vec<*const c_char>,
    rooms: Vec<Vec<u64>>,
    bytes: Vec<u8>,
    state: usize,
    owned: Vec<CString>,
}

impl Memory {
    pub fn new() -> Self {
        let owned: Vec<CString> =
            ["logAll", "logEvents", "", "\u{fc}"].iter().map(|text| CString::new(*text).unwrap()).collect();
        Memory {
            model: Model::Plane,
            references: vec![0; MOST],
            numbers: vec![0.0; ROOM],
            integers: vec![0; ROOM],
            texts: vec![std::ptr::null(); MOST],
            rooms: vec![vec![0; ROOM]; 6],
            bytes: vec![0; ROOM],
            state: 0,
            owned,
        }
    }

    pub fn fill(&mut self, random: &mut Random, time: f64, polite: bool, function: &str) {
        let variables = self.model.table().rows;
        let n = variables.len();
        let kind = [("Real", Kind::Real), ("Float64", Kind::Real), ("Derivative", Kind::Real)]
            .into_iter()
            .chain([("Boolean", Kind::Boolean), ("String", Kind::Text)])
            .find(|(part, _)| function.contains(part))
            .map_or(Kind::Integer, |(_, kind)| kind);
        for reference in &mut self.references {
            *reference = if random.one_in(20) { random.next() as u32 } else { 1 + random.below(n) as u32 };
        }
        // Often one kind of variable throughout, or nothing could ever be set.
        if polite || random.one_in(2) {
            // Mostly of the function's own type, of which there are few beside the numbers.
            let fitting = polite || !random.one_in(4);
            let first = (0..)
                .map(|_| random.below(n))
                .find(|i| {
                    let found = variables[*i].kind;
                    // Integers of FMI 2.0 set enumerations, too.
                    !fitting || found == kind || (kind == Kind::Integer && matches!(found, Kind::Choice(_)))
                })
                .expect("a variable of every kind");
            let alike: Vec<u32> = (0..n)
                .filter(|i| {
                    let (a, b) = (&variables[*i], &variables[first]);
                    a.kind == b.kind && a.causality == b.causality && a.variability == b.variability
                })
                .map(|i| variables[i].reference)
                .collect();
            self.references.iter_mut().for_each(|reference| *reference = alike[random.below(alike.len())]);
        }
        let plain = polite || random.one_in(2);
        for number in &mut self.numbers[..MOST] {
            *number = if plain { 0.02 } else { random.number(time) };
        }
        for integer in &mut self.integers[..MOST] {
            *integer = if polite { 1 } else { random.below(5) as i32 - 1 };
        }
        for text in &mut self.texts {
            *text =
                if random.one_in(4) { std::ptr::null() } else { self.owned[random.below(self.owned.len())].as_ptr() };
        }
    }
}

impl Memory {
    /// A number that the function wrote and that is none.
    fn not_finite(&self, function: &Function) -> Option<f64> {
        /// Functions whose room is for numbers of double precision; the room was filled with zeros before.
        const NUMBERS: [&str; 14] = [
            "GetReal",
            "GetFloat64",
            "GetDerivatives",
            "GetContinuousStateDerivatives",
            "GetEventIndicators",
            "GetContinuousStates",
            "GetNominalsOfContinuousStates",
            "GetDirectionalDerivative",
            "GetAdjointDerivative",
            "GetRealOutputDerivatives",
            "GetOutputDerivatives",
            "GetRealStatus",
            "GetIntervalDecimal",
            "GetShiftDecimal",
        ];
        if !NUMBERS.contains(&&function.name["fmi2".len()..]) {
            return None;
        }
        self.rooms[0][..MOST].iter().map(|bits| f64::from_bits(*bits)).find(|number| !number.is_finite())
    }
}

/// One instance under abuse.
pub struct Victim<'a> {
    pub functions: &'a [Function],
    pub pointer: u64,
    pub states: Vec<usize>,
    pub time: f64,
}

impl Victim<'_> {
    pub fn call(&mut self, function: &Function, random: &mut Random, memory: &mut Memory, pointer: u64) -> c_int {
        let polite = random.one_in(2);
        memory.fill(random, self.time, polite, &function.name);
        let (mut whole, mut numbers) = ([0u64; 12], [0.0f64; 3]);
        whole[0] = pointer;
        let (mut at, mut number, mut room) = (1, 0, 0);
        let usual = random.below(16);
        let n_states = memory.model.n_states() as u64;
        memory.rooms.iter_mut().for_each(|room| room[..MOST].fill(0));
        let misaligned = u64::from(!polite && random.one_in(30));
        memory.state = match random.below(4) {
            0 => 0,
            1 if !polite => 0x1001,
            _ if self.states.is_empty() => 0,
            _ => self.states[random.below(self.states.len())],
        };
        for kind in &function.kinds {
            if *kind == 'd' {
                // The first two numbers of a step are time and size.
                numbers[number] = match (function.name.ends_with("DoStep"), number) {
                    (true, 0) if polite || !random.one_in(5) => self.time,
                    (true, 1) if polite || !random.one_in(5) => 0.5,
                    _ if polite => self.time,
                    _ => random.number(self.time),
                };
                number += 1;
                continue;
            }
            let array = |pointer: u64, random: &mut Random| {
                if !polite && random.one_in(12) { 0 } else { pointer + misaligned }
            };
            whole[at] = match kind {
                'b' | 'i' => random.below(5) as u64,
                'u' => random.next() & 0xffff_ffff,
                'n' if polite => match function.name.as_str() {
                    name if name.ends_with("GetEventIndicators") => memory.model.n_events() as u64,
                    name if name.contains("ContinuousStates") || name.contains("StateDerivatives") => n_states,
                    name if name.ends_with("GetDerivatives") => n_states,
                    _ => usual as u64,
                },
                'n' => match random.below(20) {
                    0 => u64::MAX,
                    1 => 1 << 40,
                    2 => random.below(MOST) as u64,
                    3 => 0,
                    4 => n_states,
                    5 => memory.model.n_events() as u64,
                    _ => usual as u64,
                },
                's' => array(memory.texts.as_ptr() as u64, random),
                'r' => array(memory.references.as_ptr() as u64, random),
                'x' => array(memory.numbers.as_ptr() as u64, random),
                'k' => array(memory.integers.as_ptr() as u64, random),
                'y' => {
                    room += 1;
                    array(memory.rooms[room - 1].as_mut_ptr() as u64, random)
                }
                'f' => memory.state as u64,
                'F' => array((&raw mut memory.state) as u64, random),
                'B' => array(memory.bytes.as_ptr() as u64, random),
                other => panic!("no kind {other}"),
            };
            at += 1;
        }
        let [a, b, c, d, e, f, g, h, i, j, k, l] = whole;
        let [x, y, z] = numbers;
        // SAFETY: what C cannot check is right: live instance, and room for every count up to the library's own limit.
        let status = unsafe { (function.call)(a, b, c, d, e, f, g, h, i, j, k, l, x, y, z) } as c_int;
        if status == OK && pointer == self.pointer {
            let name = function.name.as_str();
            if name.contains("GetFMU") || name.contains("erializeFMU") && name.contains("De") {
                self.states.push(memory.state);
            }
            assert_eq!(memory.not_finite(function), None, "{name} ended OK");
        }
        status
    }

    pub fn reads_time(&mut self, memory: &mut Memory) {
        let get =
            self.functions.iter().find(|f| f.name.ends_with("GetReal") || f.name.ends_with("GetFloat64")).unwrap();
        memory.references[0] = memory.model.table().rows[0].reference;
        let (references, room) = (memory.references.as_ptr() as u64, memory.rooms[0].as_mut_ptr() as u64);
        // SAFETY: one reference, room for one number.
        let status = unsafe { (get.call)(self.pointer, references, 1, room, 1, 0, 0, 0, 0, 0, 0, 0, 0.0, 0.0, 0.0) };
        assert_eq!(status as c_int, OK);
        self.time = f64::from_bits(memory.rooms[0][0]);
        assert!(self.time.is_finite());
    }
}

pub fn instantiate(loaded: &Loaded, standard: usize, exchange: bool, flags: usize, counter: &Counter) -> u64 {
    instantiate_of(loaded, Model::Plane, standard, exchange, flags, counter)
}

/// An instance of this model.
pub fn instantiate_of(
    loaded: &Loaded,
    model: Model,
    standard: usize,
    exchange: bool,
    flags: usize,
    counter: &Counter,
) -> u64 {
    let token = CString::new(model.table().token).unwrap();
    let environment = std::ptr::from_ref(counter) as u64;
    let (name, token) = (c"victim".as_ptr() as u64, token.as_ptr() as u64);
    let (a, b) = (flags as u64 & 1, flags as u64 >> 1 & 1);
    // SAFETY: arguments as the standards declare them.
    unsafe {
        match (standard, exchange) {
            (2, _) => {
                type Plain = unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char);
                let functions = CallbackFunctions {
                    logger: Some(std::mem::transmute::<Plain, glidepolar_fmu::fmi2::Logger>(log_2)),
                    allocate_memory: None,
                    free_memory: None,
                    step_finished: None,
                    component_environment: environment as *mut c_void,
                };
                let kind = u64::from(!exchange);
                let functions = (&raw const functions) as u64;
                let make = loaded.get("fmi2Instantiate");
                make(name, kind, token, 0, functions, 0, 0, 0, 0, 0, 0, 0, 0.0, 0.0, 0.0)
            }
            (_, true) => {
                let make = loaded.get("fmi3InstantiateModelExchange");
                make(name, token, 0, 0, 0, environment, log_3 as *const () as u64, 0, 0, 0, 0, 0, 0.0, 0.0, 0.0)
            }
            (_, false) => {
                let make = loaded.get("fmi3InstantiateCoSimulation");
                let log = log_3 as *const () as u64;
                make(name, token, 0, 0, 0, a, b, 0, 0, environment, log, 0, 0.0, 0.0, 0.0)
            }
        }
    }
}

/// The usual way into a simulation, so that later phases are reached as well.
pub fn begin(loaded: &Loaded, standard: usize, exchange: bool, pointer: u64) {
    let call = |name: &str| {
        // SAFETY: a live instance; numbers are tolerance, start and stop.
        unsafe { loaded.get(name)(pointer, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.0, 0.0, 0.0) }
    };
    let names: &[&str] = match (standard, exchange) {
        (2, _) => &["fmi2SetupExperiment", "fmi2EnterInitializationMode", "fmi2ExitInitializationMode"],
        _ => &["fmi3EnterInitializationMode", "fmi3ExitInitializationMode"],
    };
    for name in names {
        assert_eq!(call(name) as c_int, OK, "{name}");
    }
}
