//! Steps, reading and setting allocate nothing: no memory grows over a long run, and no step waits for an allocator.

mod support;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use glidepolar_fmu::fmi2::*;
use support::*;

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: passes every call on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: the caller's word.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's word.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations(body: impl FnOnce()) -> usize {
    let before = ALLOCATIONS.get();
    body();
    ALLOCATIONS.get() - before
}

#[test]
fn a_run_with_events_allocates_nothing() {
    assert_eq!(allocations(|| drop(std::hint::black_box(Box::new(1)))), 1, "the count counts");

    for tolerance in [None, Some(1e-6)] {
        run_with_events(tolerance);
    }
}

fn run_with_events(tolerance: Option<f64>) {
    let glider = Glider3::co_simulation(Options::default());
    glider.set(&[("seabed_depth_m", 30.0), ("step_time_s", 50.0), ("drag_step", 0.5)]);
    glider.set(&[("net_mass_step_time_s", 60.0), ("net_mass_step_kg", 0.01)]);
    glider.begin(tolerance);
    let counted = allocations(|| {
        for second in 0..1000 {
            let time = f64::from(second);
            assert_eq!(glider.step(time, 1.0).status, OK);
        }
    });
    assert!(glider.is("on_seabed"));
    assert_eq!(counted, 0);
}

#[test]
fn reading_setting_and_moving_inputs_allocate_nothing() {
    let glider = Glider2::new(CO_SIMULATION);
    glider.begin();
    let names = ["depth_m", "speed_m_s", "lift_N", "der(v1_m_s)"].map(vr);
    let current = vr("current_x_m_s");
    let (mut values, order) = ([0.0; 4], 1);
    let counted = allocations(|| {
        for second in 0..100 {
            let time = f64::from(second);
            let (value, slope) = (0.001 * time, 0.001);
            // SAFETY: a live component and arrays of these lengths.
            unsafe {
                assert_eq!(fmi2SetReal(glider.component, &current, 1, &value), OK);
                assert_eq!(fmi2SetRealInputDerivatives(glider.component, &current, 1, &order, &slope), OK);
                assert_eq!(fmi2DoStep(glider.component, time, 1.0, 1), OK);
                assert_eq!(fmi2GetReal(glider.component, names.as_ptr(), 4, values.as_mut_ptr()), OK);
            }
        }
    });
    assert_eq!(counted, 0);
}
