//! Getting and setting variables, and their partial derivatives.

use std::ffi::{c_char, c_int};

use super::types::*;
use crate::adapter::Version;
use crate::instance::boundary::{call, elements, room};
use crate::model::Kind;

macro_rules! get {
    ($(#[$doc:meta])* $function:ident, $type:ty, |$instance:ident, $references:ident, $values:ident| $body:expr) => {
        $(#[$doc])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $function(
            component: Component,
            value_references: *const u32,
            n: usize,
            values: *mut $type,
        ) -> FmiStatus {
            // SAFETY: see the module.
            unsafe {
                call::<Fmi2>(component, stringify!($function), |c| {
                    let $instance = &c.instance;
                    $instance.allow(Fmi2::NOT_BROKEN)?;
                    let $references = elements(value_references, n, "vr")?;
                    let $values = room(values, n, "value")?;
                    $body
                })
            }
        }
    };
}

macro_rules! set {
    ($(#[$doc:meta])* $function:ident, $type:ty, |$instance:ident, $references:ident, $values:ident| $body:expr) => {
        $(#[$doc])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $function(
            component: Component,
            value_references: *const u32,
            n: usize,
            values: *const $type,
        ) -> FmiStatus {
            // SAFETY: see the module.
            unsafe {
                call::<Fmi2>(component, stringify!($function), |c| {
                    let $instance = &mut c.instance;
                    $instance.allow(Fmi2::NOT_BROKEN)?;
                    let $references = elements(value_references, n, "vr")?;
                    let $values = elements(values, n, "value")?;
                    $body
                })
            }
        }
    };
}

get!(/** `fmi2GetReal` */ fmi2GetReal, f64, |i, references, values| i.get_reals(references, values));
get!(/** `fmi2GetInteger` */ fmi2GetInteger, c_int, |i, references, values| i.get_integers(references, values));
get!(/** `fmi2GetBoolean` */ fmi2GetBoolean, Boolean, |i, references, values| {
    i.get_booleans(references, |place, value| values[place] = Boolean::from(value))
});
get!(/** `fmi2GetString` */ fmi2GetString, *const c_char, |i, references, values| {
    i.get_texts(references, |place, value| values[place] = value.as_ptr())
});

set!(/** `fmi2SetReal` */ fmi2SetReal, f64, |i, references, values| i.set_reals(references, values));
set!(/** `fmi2SetInteger` */ fmi2SetInteger, c_int, |i, references, values| i.set_integers(references, values));
set!(/** `fmi2SetBoolean` */ fmi2SetBoolean, Boolean, |i, references, _values| i.set_none(references, Kind::Boolean));
set!(/** `fmi2SetString` */ fmi2SetString, *const c_char, |i, references, _values| i.set_none(references, Kind::Text));

/// `fmi2GetDirectionalDerivative`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDirectionalDerivative(
    component: Component,
    unknowns: *const u32,
    n_unknowns: usize,
    knowns: *const u32,
    n_knowns: usize,
    seed: *const f64,
    sensitivity: *mut f64,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2GetDirectionalDerivative", |c| {
            c.instance.allow(Fmi2::RUNNING)?;
            c.instance.directional_derivative(
                elements(unknowns, n_unknowns, "vUnknown_ref")?,
                elements(knowns, n_knowns, "vKnown_ref")?,
                elements(seed, n_knowns, "dvKnown")?,
                room(sensitivity, n_unknowns, "dvUnknown")?,
            )
        })
    }
}
