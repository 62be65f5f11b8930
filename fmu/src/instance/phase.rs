//! Where an instance stands between instantiation and its end, and which calls each place allows.

use std::fmt;

/// Where an instance stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Phase {
    /// Fresh, or reset.
    Instantiated = 0,
    /// Start values are being set and looked at.
    Initialization = 1,
    /// At an event.
    Event = 2,
    /// Between events, driven by an importer's integrator.
    ContinuousTime = 3,
    /// At a communication point.
    Step = 4,
    /// Inside a communication step, while the importer looks in.
    Intermediate = 5,
    /// Ended.
    Terminated = 6,
    /// A fault inside was caught; only a reset helps.
    Broken = 7,
}

impl Phase {
    /// All of them, by number.
    pub const ALL: [Phase; 8] = [
        Phase::Instantiated,
        Phase::Initialization,
        Phase::Event,
        Phase::ContinuousTime,
        Phase::Step,
        Phase::Intermediate,
        Phase::Terminated,
        Phase::Broken,
    ];

    /// Whether the simulation has not begun, so that what is calculated at the start still follows the start values.
    pub fn is_starting(self) -> bool {
        matches!(self, Phase::Instantiated | Phase::Initialization)
    }

    fn name(self) -> &'static str {
        match self {
            Phase::Instantiated => "Instantiated",
            Phase::Initialization => "Initialization Mode",
            Phase::Event => "Event Mode",
            Phase::ContinuousTime => "Continuous-Time Mode",
            Phase::Step => "Step Mode",
            Phase::Intermediate => "Intermediate Update Mode",
            Phase::Terminated => "Terminated",
            Phase::Broken => "an internal error",
        }
    }
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A set of phases.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Phases(u16);

impl Phases {
    /// These phases.
    pub const fn of(phases: &[Phase]) -> Self {
        let (mut bits, mut i) = (0, 0);
        while i < phases.len() {
            bits |= 1 << phases[i] as u16;
            i += 1;
        }
        Phases(bits)
    }

    /// Whether the phase is one of them.
    pub fn contain(self, phase: Phase) -> bool {
        self.0 & (1 << phase as u16) != 0
    }
}

impl fmt::Display for Phases {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<&str> = Phase::ALL.into_iter().filter(|p| self.contain(*p)).map(Phase::name).collect();
        f.write_str(&names.join(", "))
    }
}
