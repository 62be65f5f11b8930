//! What a call that is not carried out says.

/// How a call ended; the numbers are those of both standards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(i32)]
pub enum Status {
    /// Done.
    Ok = 0,
    /// Done, but something is odd.
    Warning = 1,
    /// Not possible this way; the instance is as before and another way may work.
    Discard = 2,
    /// Refused; the instance is as before.
    Error = 3,
}

/// Why a call was not carried out, and what to do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refusal {
    /// How the call ends.
    pub status: Status,
    /// What was found, what was expected, what to do.
    pub message: String,
}

impl Refusal {
    /// A call that must not be made, or not like this.
    pub fn error(message: impl Into<String>) -> Self {
        Refusal { status: Status::Error, message: message.into() }
    }

    /// A call that could not be completed this time.
    pub fn discard(message: impl Into<String>) -> Self {
        Refusal { status: Status::Discard, message: message.into() }
    }
}

/// The result of a call.
pub type Outcome<T = ()> = Result<T, Refusal>;
