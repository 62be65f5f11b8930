//! Flies a built shared library through its C functions, as an importer of that platform would: a dive over the seabed, a saved
//! state, a climb to the surface, derivatives. Prints a row of numbers for each part.

use std::ffi::{CString, c_char, c_void};
use std::ptr::{null, null_mut};

use glidepolar_fmu::fmi3::{FmuState, LogMessage, Pointer};
use glidepolar_fmu::model::table::token;
use glidepolar_fmu::model::variables;
use libloading::Library;

type Instantiate = unsafe extern "C" fn(
    *const c_char,
    *const c_char,
    *const c_char,
    u8,
    u8,
    u8,
    u8,
    *const u32,
    usize,
    *mut c_void,
    Option<LogMessage>,
    Option<glidepolar_fmu::fmi3::IntermediateUpdate>,
) -> Pointer;
type Access = unsafe extern "C" fn(Pointer, *const u32, usize, *mut f64, usize) -> i32;
type Enter = unsafe extern "C" fn(Pointer, u8, f64, f64, u8, f64) -> i32;
type Plain = unsafe extern "C" fn(Pointer) -> i32;
type DoStep = unsafe extern "C" fn(Pointer, f64, f64, u8, *mut u8, *mut u8, *mut u8, *mut f64) -> i32;
type State = unsafe extern "C" fn(Pointer, *mut FmuState) -> i32;
type SetState = unsafe extern "C" fn(Pointer, FmuState) -> i32;
type Derivative =
    unsafe extern "C" fn(Pointer, *const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize) -> i32;

fn vr(name: &str) -> u32 {
    variables().iter().find(|v| v.name == name).expect("a variable").reference
}

fn main() {
    let path = std::env::args().nth(1).expect("the library's path");
    // SAFETY: the library of this very crate, its functions with the types that it gives them.
    unsafe {
        let library = Library::new(path).expect("the library loads");
        macro_rules! function {
            ($type:ty, $name:literal) => {
                *library.get::<$type>($name).expect("the library has all functions")
            };
        }
        let token = CString::new(token()).expect("a token");
        let name = c"glider".as_ptr();
        let instantiate = function!(Instantiate, b"fmi3InstantiateCoSimulation");
        let glider = instantiate(name, token.as_ptr(), null(), 0, 0, 0, 0, null(), 0, null_mut(), None, None);
        assert!(!glider.is_null(), "no instance");
        let (get, put) = (function!(Access, b"fmi3GetFloat64"), function!(Access, b"fmi3SetFloat64"));
        let set = |name: &str, mut value: f64| assert_eq!(put(glider, &vr(name), 1, &mut value, 1), 0, "{name}");
        let step = function!(DoStep, b"fmi3DoStep");
        let row = || {
            let outputs = variables().iter().filter(|v| v.causality == glidepolar_fmu::model::Causality::Output);
            let numbers: Vec<String> = outputs
                .map(|v| {
                    let mut value = f64::NAN;
                    assert_eq!(get(glider, &v.reference, 1, &mut value, 1), 0, "{}", v.name);
                    format!("{value:?}")
                })
                .collect();
            println!("{}", numbers.join(","));
        };
        let fly = |from: i32, to: i32| {
            for i in from..to {
                let (mut event, mut end, mut early, mut reached) = (0, 0, 0, 0.0);
                let time = f64::from(i) * 10.0;
                assert_eq!(step(glider, time, 10.0, 0, &mut event, &mut end, &mut early, &mut reached), 0);
                row();
            }
        };
        set("seabed_depth_m", 60.0);
        assert_eq!(function!(Enter, b"fmi3EnterInitializationMode")(glider, 0, 0.0, 0.0, 0, 0.0), 0);
        assert_eq!(function!(Plain, b"fmi3ExitInitializationMode")(glider), 0);
        fly(0, 60);
        let mut state = null_mut();
        assert_eq!(function!(State, b"fmi3GetFMUState")(glider, &mut state), 0);
        for _ in 0..2 {
            set("ballast_command_m3", 3e-4);
            set("moving_mass_command_m", -0.02);
            fly(60, 120);
            assert_eq!(function!(SetState, b"fmi3SetFMUState")(glider, state), 0);
        }
        let (unknown, known, mut slope) = (vr("der(v1_m_s)"), vr("pitch_rad"), f64::NAN);
        let derivative = function!(Derivative, b"fmi3GetDirectionalDerivative");
        assert_eq!(derivative(glider, &unknown, 1, &known, 1, &1.0, 1, &mut slope, 1), 0);
        println!("{slope:?}");
        function!(unsafe extern "C" fn(Pointer), b"fmi3FreeInstance")(glider);
    }
}
