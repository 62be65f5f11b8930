//! Random numbers of the virtual tank: one independent stream per purpose and run, so that a seed means the same
//! campaign whatever the number of threads, and so that hiding an effect leaves everything else as it was.

use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;

/// What a stream of random numbers is for.
#[derive(Debug, Clone, Copy)]
pub(super) enum Purpose {
    /// The five hulls' coefficients and masses.
    Hulls,
    /// Order, waiting times, temperatures, setting errors.
    Programme,
    /// Interaction matrix, strut, drift of the zeros.
    Balance,
    /// What differs from tank to tank.
    World,
    /// Random walk of the zeros.
    Walk,
    /// Size and particulars of the hidden effect with this place in the catalogue.
    Effect(usize),
    /// Everything within the run with this number.
    Run(usize),
}

/// One stream of random numbers.
pub(super) struct Stream(Xoshiro256PlusPlus);

impl Stream {
    pub(super) fn new(seed: u64, purpose: Purpose) -> Self {
        let (family, number) = match purpose {
            Purpose::Hulls => (1, 0),
            Purpose::Programme => (2, 0),
            Purpose::Balance => (3, 0),
            Purpose::Effect(number) => (4, number as u64),
            Purpose::Run(number) => (5, number as u64),
            Purpose::World => (6, 0),
            Purpose::Walk => (7, 0),
        };
        Self(Xoshiro256PlusPlus::seed_from_u64(mix(mix(mix(seed) ^ family) ^ number)))
    }

    /// Standard normal.
    #[inline]
    pub(super) fn normal(&mut self) -> f64 {
        self.0.sample(StandardNormal)
    }

    /// Uniform between the two bounds.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// -1 or +1.
    pub(super) fn sign(&mut self) -> f64 {
        if self.0.random::<bool>() { 1.0 } else { -1.0 }
    }

    /// One of `0..count`.
    pub(super) fn index(&mut self, count: usize) -> usize {
        (self.0.random::<f64>() * count as f64) as usize
    }

    /// Fisher-Yates.
    pub(super) fn shuffle<T>(&mut self, items: &mut [T]) {
        for last in (1..items.len()).rev() {
            items.swap(last, self.index(last + 1));
        }
    }
}

/// The finaliser of SplitMix64 (Steele, Lea and Flood, 2014): neighbouring seeds give unrelated streams.
fn mix(value: u64) -> u64 {
    let mut z = value.wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}
