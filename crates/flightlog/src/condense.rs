//! A log of any length in bounded memory: what is more than a limit is averaged, or thinned by whole dives.
//!
//! Steady glides change slowly: once there are more samples than the limit, steady neighbours of one leg are replaced by
//! their mean, two by two, again and again as more comes; samples that are not steady are dropped then. For flights
//! through time every sample counts, so that every other dive is dropped instead. Shorter logs pass as they are.

use super::Observation;

/// Most observations that are held.
pub const MOST_OBSERVATIONS: usize = 200_000;

/// How a log is shortened that is longer than the limit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Shorten {
    /// Means of steady neighbours.
    #[default]
    Means,
    /// Every other dive, whole.
    Dives,
}

/// A log on its way into bounded memory.
#[derive(Debug, Clone)]
pub struct Condenser {
    how: Shorten,
    most: usize,
    /// How often everything was halved.
    halvings: u32,
    held: Vec<Observation>,
    /// Means of 1, 2, 4 ... samples that wait for their neighbour; what they wait for is of the same leg.
    waiting: Vec<Option<Observation>>,
    count: usize,
}

impl Condenser {
    /// Holds no more than `most` observations, and few more for a moment.
    pub fn new(how: Shorten, most: usize) -> Self {
        Condenser { how, most: most.max(2), halvings: 0, held: Vec::new(), waiting: Vec::new(), count: 0 }
    }

    /// Takes what has come, in the order of time; `batch` is empty afterwards.
    pub fn take(&mut self, batch: &mut Vec<Observation>) {
        for observation in batch.drain(..) {
            self.count += 1;
            match self.how {
                Shorten::Dives => {
                    if observation.dive % (1 << self.halvings.min(31)) == 0 {
                        self.held.push(observation);
                    }
                }
                Shorten::Means if self.halvings == 0 => self.held.push(observation),
                Shorten::Means => {
                    if observation.steady {
                        self.wait(observation);
                    }
                }
            }
            if self.held.len() > self.most && self.halvings < 31 {
                self.halve();
            }
        }
    }

    /// The observations, and what was done to them, where anything was.
    pub fn finish(mut self) -> (Vec<Observation>, Option<String>) {
        self.release();
        let factor = 1u64 << self.halvings;
        let said = (self.halvings > 0).then(|| match self.how {
            Shorten::Means => {
                format!("{} samples of a long log: steady neighbours of one leg averaged by up to {factor}", self.count)
            }
            Shorten::Dives => format!("{} samples of a long log: one dive in {factor} taken, whole", self.count),
        });
        (self.held, said)
    }

    fn halve(&mut self) {
        self.halvings += 1;
        match self.how {
            Shorten::Dives => self.held.retain(|o| o.dive % (1 << self.halvings) == 0),
            Shorten::Means => {
                // What waits is younger than all that is held, and goes on waiting for neighbours of its own size.
                let mut merged: Vec<Observation> = Vec::with_capacity(self.most + 1);
                let mut one: Option<Observation> = None;
                for o in self.held.drain(..).filter(|o| o.steady) {
                    one = match one {
                        Some(first) if first.leg == o.leg => {
                            merged.push(mean(&first, &o));
                            None
                        }
                        Some(alone) => {
                            merged.push(alone);
                            Some(o)
                        }
                        None => Some(o),
                    };
                }
                merged.extend(one);
                self.held = merged;
                self.waiting.resize(self.halvings as usize, None);
            }
        }
    }

    /// As a binary counter: two of one size make one of the next.
    fn wait(&mut self, mut observation: Observation) {
        if self.waiting.iter().flatten().any(|other| other.leg != observation.leg) {
            self.release();
        }
        for place in &mut self.waiting {
            match place.take() {
                Some(first) => observation = mean(&first, &observation),
                None => {
                    *place = Some(observation);
                    return;
                }
            }
        }
        self.held.push(observation);
    }

    /// The end of a leg: what waits is held as it is, the oldest, which stand for most, first.
    fn release(&mut self) {
        for place in self.waiting.iter_mut().rev() {
            self.held.extend(place.take());
        }
    }
}

/// The mean of two; what only one has, is that one's.
fn mean(a: &Observation, b: &Observation) -> Observation {
    let of = |value: fn(&Observation) -> f64| {
        let (x, y) = (value(a), value(b));
        match (x.is_finite(), y.is_finite()) {
            (true, true) => 0.5 * (x + y),
            (false, true) => y,
            _ => x,
        }
    };
    // Headings turn over: the shorter way round.
    let turn = std::f64::consts::TAU;
    let (h, k) = (a.heading_rad, b.heading_rad);
    let heading_rad = match (h.is_finite(), k.is_finite()) {
        (true, true) => (h + 0.5 * (k - h - turn * ((k - h) / turn).round())).rem_euclid(turn),
        (false, true) => k,
        _ => h,
    };
    Observation { heading_rad, ..a.with(of) }
}
