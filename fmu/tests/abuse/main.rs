//! The shared library as an importer loads it, called in every wrong way: null and misaligned pointers, unknown
//! references, wrong counts, numbers that are none, calls out of order, states that are none.
//!
//! Nothing may abort, hang or corrupt; every call ends in a status of the standard, and a call that is refused leaves
//! one message. Arguments and order come from generators with fixed seeds: `GLIDEPOLAR_ABUSE_SEQUENCES` asks for more
//! of them than the usual number, `GLIDEPOLAR_ABUSE_SEED` for others.

#![cfg(all(target_arch = "x86_64", unix))]

mod caller;

use std::ffi::CString;
use std::sync::atomic::Ordering;

use caller::{
    AnyFunction, Counter, ERROR, Loaded, Memory, OK, Random, Victim, begin, instantiate, instantiate_of, log_3,
};
use glidepolar_fmu::model::Model;
use glidepolar_fmu::model::table::token;

/// Functions without an instance as their first argument.
const MAKERS: [&str; 8] = [
    "fmi2GetTypesPlatform",
    "fmi2GetVersion",
    "fmi2Instantiate",
    "fmi2FreeInstance",
    "fmi3GetVersion",
    "fmi3InstantiateModelExchange",
    "fmi3InstantiateCoSimulation",
    "fmi3InstantiateScheduledExecution",
];

/// The library as it was built beside the tests.
fn loaded() -> Loaded {
    let folder = std::env::current_exe().unwrap().parent().unwrap().to_owned();
    let name = libloading::library_filename("glidepolar_fmu");
    let path = [folder.join(&name), folder.parent().unwrap().join(&name)].into_iter().find(|path| path.exists());
    let path = path.expect("cargo builds the shared library beside the tests");
    // SAFETY: the library has no initialisers of its own.
    let library = unsafe { libloading::Library::new(&path) }.unwrap();
    // SAFETY: called with arguments of the kinds that the caller's table says.
    Loaded::new(move |name| unsafe { *library.get::<AnyFunction>(name.as_bytes()).unwrap() })
}

fn sequences() -> u64 {
    std::env::var("GLIDEPOLAR_ABUSE_SEQUENCES").ok().and_then(|n| n.parse().ok()).unwrap_or(3000)
}

fn seed() -> u64 {
    std::env::var("GLIDEPOLAR_ABUSE_SEED").ok().and_then(|n| n.parse().ok()).unwrap_or(0x00c0_ffee)
}

#[test]
fn every_function_of_both_standards_is_there_and_listed() {
    let loaded = loaded();
    for maker in MAKERS {
        loaded.get(maker);
    }
    loaded.get("fmi3FreeInstance");
    assert_eq!((loaded.two.len() + 4, loaded.three.len() + 5), (44, 75));
}

#[test]
fn random_calls_in_random_order_never_hurt() {
    let loaded = loaded();
    let free = |standard: usize, pointer: u64| {
        let name = if standard == 2 { "fmi2FreeInstance" } else { "fmi3FreeInstance" };
        // SAFETY: a live instance or null, freed once.
        unsafe { loaded.get(name)(pointer, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.0, 0.0, 0.0) };
    };
    let mut memory = Memory::new();
    let (mut done, mut refused) = (0u64, 0u64);
    for sequence in 0..sequences() {
        let mut random = Random((seed() + sequence).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        let standard = if sequence % 2 == 0 { 3 } else { 2 };
        let exchange = random.one_in(2);
        let counter = Counter::default();
        // Every third is the glider in space.
        let model = if sequence % 3 == 2 { Model::Space } else { Model::Plane };
        memory.model = model;
        let pointer = instantiate_of(&loaded, model, standard, exchange, random.below(4), &counter);
        assert_ne!(pointer, 0);
        let foreign = instantiate(&loaded, 5 - standard, exchange, 0, &counter);
        if !random.one_in(3) {
            begin(&loaded, standard, exchange, pointer);
        }
        let functions = if standard == 2 { &loaded.two } else { &loaded.three };
        let mut victim = Victim { functions, pointer, states: Vec::new(), time: 0.0 };
        for _ in 0..60 {
            let mut function = &functions[random.below(functions.len())];
            // What ends a run may come, but not before anything else could.
            while ["Terminate", "Reset"].iter().any(|end| function.name.ends_with(end)) && !random.one_in(10) {
                function = &functions[random.below(functions.len())];
            }
            let to = match random.below(40) {
                0 => 0,
                1 => foreign,
                _ => pointer,
            };
            let before = counter.problems.load(Ordering::Relaxed);
            let status = victim.call(function, &mut random, &mut memory, to);
            let messages = counter.problems.load(Ordering::Relaxed) - before;
            let context = format!("{} in sequence {sequence}: status {status}, {messages} messages", function.name);
            assert!((OK..=ERROR).contains(&status), "{context}");
            let expected = usize::from(status != OK && to == pointer);
            assert_eq!(messages, expected, "{context}");
            assert!(to == pointer || status == ERROR, "{context}");
            if status == OK {
                done += 1
            } else {
                refused += 1
            }
            victim.reads_time(&mut memory);
        }
        assert_eq!(counter.empty.load(Ordering::Relaxed), 0);
        assert_eq!(counter.faults.load(Ordering::Relaxed), 0, "sequence {sequence}");
        free(standard, pointer);
        free(5 - standard, foreign);
        free(standard, 0);
    }
    // The generator must reach both what works and what does not.
    assert!(done * 5 > refused && refused * 5 > done, "{done} calls done, {refused} refused");
}

#[test]
fn instances_are_made_only_from_what_fits() {
    let loaded = loaded();
    let counter = Counter::default();
    let environment = std::ptr::from_ref(&counter) as u64;
    let log = log_3 as *const () as u64;
    let right = CString::new(token()).unwrap();
    let make = |name: u64, token: u64, resources: u64, log: u64| {
        let make = loaded.get("fmi3InstantiateCoSimulation");
        // SAFETY: texts or null.
        let pointer = unsafe { make(name, token, resources, 0, 1, 0, 0, 0, 0, environment, log, 0, 0.0, 0.0, 0.0) };
        if pointer != 0 {
            // SAFETY: just made.
            unsafe { loaded.get("fmi3FreeInstance")(pointer, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.0, 0.0, 0.0) };
        }
        (pointer != 0, counter.messages.swap(0, Ordering::Relaxed))
    };
    let (name, token) = (c"name".as_ptr() as u64, right.as_ptr() as u64);
    let text = |text: &'static std::ffi::CStr| text.as_ptr() as u64;
    // One message says which vehicle it is.
    assert_eq!(make(name, token, 0, log), (true, 1));
    assert_eq!(make(name, token, text(c""), log), (true, 1));
    assert_eq!(make(name, token, text(c"/no/such/folder"), log), (true, 1));
    assert_eq!(make(name, token, text(c"\xff\xfe not UTF-8"), log), (true, 1));
    assert_eq!(make(name, token, 0, 0), (true, 0));
    // And one why there is none.
    assert_eq!(make(0, token, 0, log), (false, 1));
    assert_eq!(make(text(c""), token, 0, log), (false, 1));
    assert_eq!(make(name, 0, 0, log), (false, 1));
    assert_eq!(make(name, text(c"{another}"), 0, log), (false, 1));
    assert_eq!(make(name, 0, 0, 0), (false, 0));
    // FMI 2.0 without callbacks at all, and of a type that is none.
    let make = loaded.get("fmi2Instantiate");
    // SAFETY: null callbacks are what is tested.
    assert_eq!(unsafe { make(name, 0, token, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.0, 0.0, 0.0) }, 0);
}
