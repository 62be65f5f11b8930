//! Messages on their way to the importer, the only place where they go.

use std::ffi::{CStr, CString};

use super::refusal::Status;
use crate::description::LOG_CATEGORIES;

/// What carries a message out: status, category, message.
pub type Sink = Box<dyn Fn(Status, &CStr, &CStr) + Send>;

/// The log of one instance. Warnings and errors always go out; events when the importer asked for them.
pub struct Log {
    sink: Option<Sink>,
    events: bool,
}

impl Log {
    /// A log into `sink`; `None` drops everything.
    pub fn new(sink: Option<Sink>, events: bool) -> Self {
        Log { sink, events }
    }

    /// Whether events are wanted: whoever builds a message for one asks first.
    pub fn wants_events(&self) -> bool {
        self.events && self.sink.is_some()
    }

    /// Something happened as it should.
    pub fn event(&self, message: &str) {
        if self.wants_events() {
            self.send(Status::Ok, "logEvents", message);
        }
    }

    /// Something went wrong, or might have.
    pub fn problem(&self, status: Status, message: &str) {
        let category = match status {
            Status::Ok | Status::Warning => "logStatusWarning",
            Status::Discard => "logStatusDiscard",
            Status::Error => "logStatusError",
        };
        self.send(status, category, message);
    }

    /// Switches events on or off. `categories` empty means all.
    ///
    /// # Errors
    /// The first category that does not exist; nothing is changed then.
    pub fn switch<'a>(&mut self, on: bool, categories: &[&'a str]) -> Result<(), &'a str> {
        if let Some(unknown) = categories.iter().find(|name| !LOG_CATEGORIES.iter().any(|(known, _)| known == *name)) {
            return Err(unknown);
        }
        if categories.is_empty() || categories.contains(&"logEvents") {
            self.events = on;
        }
        Ok(())
    }

    fn send(&self, status: Status, category: &str, message: &str) {
        let Some(sink) = &self.sink else { return };
        let clean = |text: &str| CString::new(text.replace('\0', " ")).unwrap_or_default();
        sink(status, &clean(category), &clean(message));
    }
}
