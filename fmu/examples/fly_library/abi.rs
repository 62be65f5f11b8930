//! What both standards' instances do for the flight, and how their functions are found in the library.

/// What drives an instance.
#[derive(Clone, Copy, PartialEq)]
pub enum Interface {
    CoSimulation,
    ModelExchange,
}

/// An instance in Co-Simulation. Every call must succeed.
pub trait Simulation {
    fn begin(&self);
    fn set(&self, reference: u32, value: f64);
    fn get(&self, reference: u32) -> f64;
    fn step(&self, from_s: f64, size_s: f64);
    /// The state, written out.
    fn saved(&self) -> Vec<u8>;
    fn restore(&self, bytes: &[u8]);
    /// The partial derivative of an unknown with respect to a known.
    fn derivative(&self, unknown: u32, known: u32) -> f64;
}

/// An instance in Model Exchange.
pub trait Exchange {
    /// Up to Continuous-Time Mode.
    fn begin(&self);
    fn states(&self, states: &mut [f64]);
    fn rates(&self, rates: &mut [f64]);
    fn go_to(&self, time_s: f64, states: &[f64]);
}

/// Declares a struct of C functions that are looked up by their names; what a function returns stands behind its
/// arguments.
macro_rules! functions {
    ($name:ident { $($function:ident($($type:ty),*) -> $out:ty;)* }) => {
        pub struct $name {
            $(pub $function: unsafe extern "C" fn($($type),*) -> $out,)*
        }

        impl $name {
            pub fn of(library: &libloading::Library) -> Self {
                // SAFETY: the types are those of the standard's headers.
                $(let $function = unsafe { library.get::<unsafe extern "C" fn($($type),*) -> $out>(stringify!($function)) };)*
                $name { $($function: *$function.expect(stringify!($function)),)* }
            }
        }
    };
}

pub(crate) use functions;

/// Refuses every status but OK.
pub fn ok(status: i32) {
    assert_eq!(status, 0, "a call failed");
}
