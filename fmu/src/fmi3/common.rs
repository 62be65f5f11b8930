//! Getting and setting variables, their dependencies and partial derivatives.

use std::ffi::c_char;

use super::types::*;
use crate::adapter::Version;
use crate::instance::Instance;
use crate::instance::boundary::{call, elements, room, same_length};
use crate::instance::refusal::{Outcome, Refusal};
use crate::model::Kind;

macro_rules! get {
    ($(#[$doc:meta])* $function:ident, $type:ty, |$instance:ident, $references:ident, $values:ident| $body:expr) => {
        $(#[$doc])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $function(
            instance: Pointer,
            value_references: *const u32,
            n_value_references: usize,
            values: *mut $type,
            n_values: usize,
        ) -> FmiStatus {
            // SAFETY: see the module.
            unsafe {
                call::<Fmi3>(instance, stringify!($function), |c| {
                    let $instance = &c.instance;
                    $instance.allow(Fmi3::NOT_BROKEN)?;
                    same_length(n_value_references, n_values)?;
                    let $references = elements(value_references, n_value_references, "valueReferences")?;
                    let $values = room(values, n_values, "values")?;
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
            instance: Pointer,
            value_references: *const u32,
            n_value_references: usize,
            values: *const $type,
            n_values: usize,
        ) -> FmiStatus {
            // SAFETY: see the module.
            unsafe {
                call::<Fmi3>(instance, stringify!($function), |c| {
                    let $instance = &mut c.instance;
                    $instance.allow(Fmi3::NOT_BROKEN)?;
                    same_length(n_value_references, n_values)?;
                    let $references = elements(value_references, n_value_references, "valueReferences")?;
                    let $values = elements(values, n_values, "values")?;
                    $body
                })
            }
        }
    };
}

get!(/** `fmi3GetFloat64` */ fmi3GetFloat64, f64, |i, references, values| i.get_reals(references, values));
get!(/** `fmi3GetInt32` */ fmi3GetInt32, i32, |i, references, values| i.get_integers(references, values));
get!(/** `fmi3GetBoolean` */ fmi3GetBoolean, Boolean, |i, references, values| {
    i.get_booleans(references, |place, value| values[place] = Boolean::from(value))
});
get!(/** `fmi3GetString` */ fmi3GetString, *const c_char, |i, references, values| {
    i.get_texts(references, |place, value| values[place] = value.as_ptr())
});

set!(/** `fmi3SetFloat64` */ fmi3SetFloat64, f64, |i, references, values| i.set_reals(references, values));
set!(/** `fmi3SetInt32` */ fmi3SetInt32, i32, |i, references, values| i.set_integers(references, values));
set!(/** `fmi3SetBoolean` */ fmi3SetBoolean, Boolean, |i, references, _values| i.set_none(references, Kind::Boolean));
set!(/** `fmi3SetString` */ fmi3SetString, *const c_char, |i, references, _values| i.set_none(references, Kind::Text));

get!(/** `fmi3GetInt64`: how FMI 3.0 reads an enumeration. */ fmi3GetInt64, i64, |i, references, values| {
    for (reference, value) in references.iter().zip(values) {
        let mut number = 0;
        i.get_integers(std::slice::from_ref(reference), std::slice::from_mut(&mut number))?;
        *value = i64::from(number);
    }
    Ok(())
});
set!(/** `fmi3SetInt64`: how FMI 3.0 sets an enumeration. */ fmi3SetInt64, i64, |i, references, values| {
    // What no enumeration has is beyond every bound, too.
    let numbers: Vec<i32> = values.iter().map(|value| i32::try_from(*value).unwrap_or(i32::MAX)).collect();
    i.set_integers(references, &numbers)
});

/// Pairs of functions for types of which there is no variable.
macro_rules! no_variables {
    ($($type:ty: $get:ident, $set:ident;)*) => {
        $(
            get!(/** No variable is of this type. */ $get, $type, |i, references, _values| wrong_type(i, references, stringify!($get)));
            set!(/** No variable is of this type. */ $set, $type, |i, references, _values| wrong_type(i, references, stringify!($set)));
        )*
    };
}

no_variables! {
    f32: fmi3GetFloat32, fmi3SetFloat32;
    i8: fmi3GetInt8, fmi3SetInt8;
    u8: fmi3GetUInt8, fmi3SetUInt8;
    i16: fmi3GetInt16, fmi3SetInt16;
    u16: fmi3GetUInt16, fmi3SetUInt16;
    u32: fmi3GetUInt32, fmi3SetUInt32;
    u64: fmi3GetUInt64, fmi3SetUInt64;
}

/// `fmi3GetBinary`: no variable is binary.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetBinary(
    instance: Pointer,
    value_references: *const u32,
    n_value_references: usize,
    _value_sizes: *mut usize,
    _values: *mut *const u8,
    _n_values: usize,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe { none_of_this_type(instance, value_references, n_value_references, "fmi3GetBinary") }
}

/// `fmi3SetBinary`: no variable is binary.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetBinary(
    instance: Pointer,
    value_references: *const u32,
    n_value_references: usize,
    _value_sizes: *const usize,
    _values: *const *const u8,
    _n_values: usize,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe { none_of_this_type(instance, value_references, n_value_references, "fmi3SetBinary") }
}

/// Refuses any variable.
///
/// # Safety
/// See the module.
pub(super) unsafe fn none_of_this_type(
    instance: Pointer,
    value_references: *const u32,
    n_value_references: usize,
    function: &str,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, function, |c| {
            c.instance.allow(Fmi3::NOT_BROKEN)?;
            wrong_type(&c.instance, elements(value_references, n_value_references, "valueReferences")?, function)
        })
    }
}

fn wrong_type(instance: &Instance, references: &[u32], function: &str) -> Outcome {
    let Some(reference) = references.first() else { return Ok(()) };
    let of = function.trim_start_matches("fmi3Get").trim_start_matches("fmi3Set");
    let name = instance.table().variable(*reference).map_or("unknown", |variable| variable.name);
    Err(Refusal::error(format!("no variable is of type {of}; value reference {reference} ({name}) is not")))
}

/// `fmi3GetNumberOfVariableDependencies`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNumberOfVariableDependencies(
    instance: Pointer,
    _value_reference: u32,
    _n_dependencies: *mut usize,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe { call::<Fmi3>(instance, "fmi3GetNumberOfVariableDependencies", |_| in_the_description()) }
}

/// `fmi3GetVariableDependencies`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetVariableDependencies(
    instance: Pointer,
    _dependent: u32,
    _element_indices_of_dependent: *mut usize,
    _independents: *mut u32,
    _element_indices_of_independents: *mut usize,
    _dependency_kinds: *mut FmiStatus,
    _n_dependencies: usize,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe { call::<Fmi3>(instance, "fmi3GetVariableDependencies", |_| in_the_description()) }
}

fn in_the_description() -> Outcome {
    Err(Refusal::error(
        "not provided (providesPerElementDependencies is false): the dependencies stand in modelDescription.xml",
    ))
}

macro_rules! derivative {
    ($(#[$doc:meta])* $function:ident, $method:ident, |$n_unknowns:ident, $n_knowns:ident| $seeded:ident, $sensitive:ident) => {
        $(#[$doc])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $function(
            instance: Pointer,
            unknowns: *const u32,
            $n_unknowns: usize,
            knowns: *const u32,
            $n_knowns: usize,
            seed: *const f64,
            n_seed: usize,
            sensitivity: *mut f64,
            n_sensitivity: usize,
        ) -> FmiStatus {
            // SAFETY: see the module.
            unsafe {
                call::<Fmi3>(instance, stringify!($function), |c| {
                    c.instance.allow(Fmi3::RUNNING)?;
                    same_length($seeded, n_seed)?;
                    same_length($sensitive, n_sensitivity)?;
                    c.instance.$method(
                        elements(unknowns, $n_unknowns, "unknowns")?,
                        elements(knowns, $n_knowns, "knowns")?,
                        elements(seed, n_seed, "seed")?,
                        room(sensitivity, n_sensitivity, "sensitivity")?,
                    )
                })
            }
        }
    };
}

derivative!(/** `fmi3GetDirectionalDerivative` */ fmi3GetDirectionalDerivative, directional_derivative,
    |n_unknowns, n_knowns| n_knowns, n_unknowns);
derivative!(/** `fmi3GetAdjointDerivative` */ fmi3GetAdjointDerivative, adjoint_derivative,
    |n_unknowns, n_knowns| n_unknowns, n_knowns);
