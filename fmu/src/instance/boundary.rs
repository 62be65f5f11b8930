//! Where calls come in from C: pointers are checked before they are used, and no panic gets out.

use std::cell::{Cell, RefCell};
use std::ffi::{CStr, c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind};
use std::sync::OnceLock;

use super::Instance;
use super::phase::Phase;
use super::refusal::{Outcome, Refusal, Status};

/// More elements than any caller can mean.
const MOST_ELEMENTS: usize = 1 << 24;

thread_local! {
    static INSIDE: Cell<bool> = const { Cell::new(false) };
    static PANIC: RefCell<Option<String>> = const { RefCell::new(None) };
}

type Hook = Box<dyn Fn(&PanicHookInfo<'_>) + Send + Sync>;

/// What a standard keeps beside the instance.
pub trait Standard {
    /// A number that tells the components of one standard from those of another, and from anything else.
    const MARK: u64;
}

/// What a caller holds a pointer to.
#[repr(C)]
pub struct Component<S> {
    mark: u64,
    /// The simulation.
    pub instance: Instance,
    /// What the standard keeps beside it.
    pub standard: S,
}

impl<S: Standard> Component<S> {
    /// The pointer that the caller holds from now on.
    pub fn into_pointer(instance: Instance, standard: S) -> *mut c_void {
        Box::into_raw(Box::new(Component { mark: S::MARK, instance, standard })).cast()
    }

    /// The component behind a caller's pointer, unless it is none.
    ///
    /// # Safety
    /// `pointer` must be null or come from [`Component::into_pointer`] of any standard and not be freed.
    pub unsafe fn from_pointer(pointer: *mut c_void) -> Option<*mut Self> {
        let mark = pointer.cast::<u64>();
        // SAFETY: every component begins with its mark.
        let ours = !mark.is_null() && mark.is_aligned() && unsafe { *mark } == S::MARK;
        ours.then_some(pointer.cast())
    }

    /// Frees the component behind a caller's pointer; nothing happens when it is none.
    ///
    /// # Safety
    /// As [`Component::from_pointer`]; the pointer must not be used again.
    pub unsafe fn free(pointer: *mut c_void) {
        // SAFETY: the caller's word.
        if let Some(component) = unsafe { Self::from_pointer(pointer) } {
            // SAFETY: it was made by `Box::into_raw`.
            let _ = caught(|| drop(unsafe { Box::from_raw(component) }));
        }
    }
}

/// Carries out a call on a component: a refusal or a panic goes to its log, the status to the caller.
///
/// # Safety
/// As [`Component::from_pointer`]; nobody else may use the component meanwhile.
pub unsafe fn call<S: Standard>(
    pointer: *mut c_void,
    function: &str,
    body: impl FnOnce(&mut Component<S>) -> Outcome,
) -> c_int {
    // SAFETY: the caller's word; the reference ends with the call.
    unsafe { call_open(pointer, function, |component| body(&mut *component)) }
}

/// As [`call`] for a body that lets the caller use the component meanwhile, from callbacks: it gets a pointer and must
/// hold no reference while a callback runs.
///
/// # Safety
/// As [`Component::from_pointer`].
pub unsafe fn call_open<S: Standard>(
    pointer: *mut c_void,
    function: &str,
    body: impl FnOnce(*mut Component<S>) -> Outcome,
) -> c_int {
    // SAFETY: the caller's word.
    let Some(component) = (unsafe { Component::<S>::from_pointer(pointer) }) else {
        return Status::Error as c_int;
    };
    let result = caught(|| body(component));
    // SAFETY: the body is over, so this is the only reference.
    let instance = unsafe { &mut (*component).instance };
    match result {
        Ok(Ok(())) => Status::Ok as c_int,
        Ok(Err(refusal)) => {
            instance.log.problem(refusal.status, &format!("{function}: {}", refusal.message));
            refusal.status as c_int
        }
        Err(panic) => {
            instance.enter(Phase::Broken);
            let advice = "this is a fault of the FMU; reset or free the instance and report it";
            instance.log.problem(Status::Error, &format!("{function}: {panic}; {advice}"));
            Status::Error as c_int
        }
    }
}

/// Runs `body`; a panic inside becomes an error that says where. Nothing is printed.
pub fn caught<R>(body: impl FnOnce() -> R) -> Result<R, String> {
    static HOOK: OnceLock<Hook> = OnceLock::new();
    // The hook captures nothing and what it needs lives in a static: a library that is unloaded leaves nothing behind.
    HOOK.get_or_init(|| {
        let usual = std::panic::take_hook();
        std::panic::set_hook(Box::new(|info| {
            if INSIDE.get() {
                PANIC.set(Some(info.to_string()));
            } else if let Some(usual) = HOOK.get() {
                usual(info);
            }
        }));
        usual
    });
    let outer = INSIDE.replace(true);
    let result = catch_unwind(AssertUnwindSafe(body));
    INSIDE.set(outer);
    result.map_err(|_| PANIC.take().unwrap_or_else(|| "no message".to_owned()))
}

/// The elements that a caller's array holds. `what` names the argument.
///
/// # Safety
/// `pointer` must be null or point to `count` elements that nobody changes during `'a`.
pub unsafe fn elements<'a, T>(pointer: *const T, count: usize, what: &str) -> Outcome<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    check(pointer, count, what)?;
    // SAFETY: not null and aligned; that it holds `count` elements is the caller's word.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// The room that a caller's array offers. `what` names the argument.
///
/// # Safety
/// `pointer` must be null or point to room for `count` elements that nobody else uses during `'a`.
pub unsafe fn room<'a, T>(pointer: *mut T, count: usize, what: &str) -> Outcome<&'a mut [T]> {
    if count == 0 {
        return Ok(&mut []);
    }
    check(pointer, count, what)?;
    // SAFETY: not null and aligned; that it has room for `count` elements is the caller's word.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, count) })
}

/// The single place that a caller's pointer offers.
///
/// # Safety
/// As [`room`] with one element.
pub unsafe fn place<'a, T>(pointer: *mut T, what: &str) -> Outcome<&'a mut T> {
    check(pointer, 1, what)?;
    // SAFETY: as in `room`.
    Ok(unsafe { &mut *pointer })
}

/// A caller's text; `None` for a null pointer. What is not UTF-8 is replaced.
///
/// # Safety
/// `pointer` must be null or point to a text that ends with a zero.
pub unsafe fn text(pointer: *const c_char) -> Option<String> {
    if pointer.is_null() {
        return None;
    }
    // SAFETY: not null; that it ends is the caller's word.
    Some(unsafe { CStr::from_ptr(pointer) }.to_string_lossy().into_owned())
}

/// Refuses arrays of different length that belong together.
pub fn same_length(references: usize, values: usize) -> Outcome {
    if references == values {
        return Ok(());
    }
    Err(Refusal::error(format!("{references} variables but {values} values; every variable here is a single value")))
}

fn check<T>(pointer: *const T, count: usize, what: &str) -> Outcome {
    if pointer.is_null() {
        return Err(Refusal::error(format!("{what} is a null pointer, expected {count} element(s)")));
    }
    if !pointer.is_aligned() {
        return Err(Refusal::error(format!("{what} is not aligned for its type")));
    }
    if count > MOST_ELEMENTS {
        return Err(Refusal::error(format!("{what} is said to hold {count} elements, more than can be meant")));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instance::log::Log;
    use crate::instance::{Abilities, Interface};
    use crate::model::vehicle::Vehicle;
    use std::sync::{Arc, Mutex};

    struct Some3;

    impl Standard for Some3 {
        const MARK: u64 = 3;
    }

    struct Other2;

    impl Standard for Other2 {
        const MARK: u64 = 2;
    }

    #[test]
    fn a_panic_becomes_an_error_and_a_message_and_only_a_reset_helps() {
        let messages = Arc::new(Mutex::new(Vec::new()));
        let kept = messages.clone();
        let log = Log::new(Some(Box::new(move |_, _, text| kept.lock().unwrap().push(text.to_owned()))), false);
        let instance = Instance::new(Interface::CoSimulation, Abilities::default(), &Vehicle::default(), log);
        let pointer = Component::into_pointer(instance, Some3);
        // SAFETY: a live component, freed once.
        unsafe {
            let status = call::<Some3>(pointer, "test", |_| panic!("a fault of the test's own"));
            assert_eq!(status, Status::Error as c_int);
            let message = messages.lock().unwrap().pop().unwrap().into_string().unwrap();
            assert!(message.contains("a fault of the test's own") && message.contains("boundary.rs"), "{message}");
            let refused = call::<Some3>(pointer, "test", |c| {
                c.instance.allow(super::super::phase::Phases::of(&[Phase::Step, Phase::Instantiated]))
            });
            assert_eq!(refused, Status::Error as c_int);
            let reset = call::<Some3>(pointer, "test", |c| {
                c.instance.reset();
                c.instance.allow(super::super::phase::Phases::of(&[Phase::Instantiated]))
            });
            assert_eq!(reset, Status::Ok as c_int);
            // Nobody else's pointer.
            assert!(Component::<Other2>::from_pointer(pointer).is_none());
            assert_eq!(call::<Other2>(pointer, "test", |_| Ok(())), Status::Error as c_int);
            Component::<Other2>::free(pointer);
            Component::<Some3>::free(pointer);
        }
    }

    #[test]
    fn arrays_are_looked_at_before_they_are_used() {
        let numbers = [1.0, 2.0];
        // SAFETY: null, or two numbers.
        unsafe {
            assert!(elements::<f64>(std::ptr::null(), 0, "none").unwrap().is_empty());
            assert!(elements::<f64>(std::ptr::null(), 1, "null").is_err());
            assert!(elements(numbers.as_ptr(), usize::MAX, "endless").is_err());
            assert!(elements(numbers.as_ptr().byte_add(1), 1, "askew").is_err());
            assert_eq!(elements(numbers.as_ptr(), 2, "two").unwrap(), numbers);
            assert!(room::<f64>(std::ptr::null_mut(), 3, "null").is_err());
        }
    }
}
