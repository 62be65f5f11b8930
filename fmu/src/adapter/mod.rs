//! What the C functions of both standards do in the same way, written once. Each standard names its functions and their
//! arguments in tables of [`exported`]; the bodies stand here, generic over the [`Version`].
//!
//! # Safety
//! Every body trusts its caller as the functions of the standards do: an array has as many elements as its count says, a
//! text ends with a zero.

pub mod exchange;
pub mod lifecycle;
pub mod states;

use crate::instance::boundary::Standard;
use crate::instance::phase::Phases;

/// What differs between the versions of the standard where their functions do the same.
pub trait Version: Standard + Sized {
    /// C's truth: zero is false.
    type Boolean: Copy + Default + PartialEq + From<bool>;
    /// Every phase but that after a fault.
    const NOT_BROKEN: Phases;
    /// The phases in which there is something to read that follows from the start values.
    const RUNNING: Phases;

    /// What is kept beside the instance is as after instantiation.
    fn reset(&mut self) {}
}

/// Whether C's truth is true.
pub fn is_true<B: Default + PartialEq>(value: B) -> bool {
    value != B::default()
}

/// Exports C functions, one a line: name, arguments after the instance, and the body that carries it out. The body gets
/// the component and the arguments.
macro_rules! exported {
    ($version:ty; $($name:ident($($argument:ident: $type:ty),*) = $body:expr;)*) => {$(
        #[doc = concat!("`", stringify!($name), "`")]
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(instance: *mut std::ffi::c_void, $($argument: $type),*) -> std::ffi::c_int {
            // SAFETY: see the module.
            unsafe {
                $crate::instance::boundary::call::<$version>(instance, stringify!($name), |component| {
                    $body(component, $($argument),*)
                })
            }
        }
    )*};
}

pub(crate) use exported;
