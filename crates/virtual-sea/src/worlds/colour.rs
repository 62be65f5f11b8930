//! Noise of any colour: white, heavy-tailed, of one time scale, of many.

use crate::random::{Stream, between, chance, normal};

/// How a noise is correlated and distributed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Colour {
    /// Independent, normal.
    White,
    /// Independent, Student's t of 5 degrees of freedom.
    HeavyTailed,
    /// White and a first-order autoregressive process of this time \[s\], with equal variances.
    Red(f64),
    /// 1/f: autoregressive processes of equal variance, each lasting four times as long as the one before, from this time
    /// \[s\] on, beside white noise.
    Pink(f64),
}

impl Colour {
    /// Draws a colour; what lasts does so no longer than `longest_s`, not at all where that is zero.
    pub fn draw(random: &mut Stream, longest_s: f64) -> Colour {
        let lasts = longest_s > 0.0 && chance(random, 0.4);
        match (lasts, chance(random, 0.35)) {
            (false, false) => Colour::White,
            (false, true) => Colour::HeavyTailed,
            (true, false) => Colour::Red(between(random, 0.1, 1.0) * longest_s),
            (true, true) => Colour::Pink(longest_s / 16.0),
        }
    }

    /// Times of its autoregressive parts, s.
    fn times_s(self) -> Vec<f64> {
        match self {
            Colour::White | Colour::HeavyTailed => Vec::new(),
            Colour::Red(time_s) => vec![time_s],
            Colour::Pink(time_s) => vec![time_s, 4.0 * time_s, 16.0 * time_s],
        }
    }
}

/// A noise in the course of time.
#[derive(Debug, Clone)]
pub struct Noise {
    /// Its colour.
    pub colour: Colour,
    /// Its standard deviation.
    pub sd: f64,
    slow: Vec<(f64, f64)>,
}

impl Noise {
    /// A noise in its steady state.
    pub fn new(random: &mut Stream, colour: Colour, sd: f64) -> Noise {
        let slow = colour.times_s().into_iter().map(|time_s| (time_s, normal(random))).collect();
        Noise { colour, sd, slow }
    }

    /// Lets time pass.
    pub fn advance(&mut self, random: &mut Stream, step_s: f64) {
        for (time_s, value) in &mut self.slow {
            let kept = (-step_s / *time_s).exp();
            *value = kept * *value + (1.0 - kept * kept).sqrt() * normal(random);
        }
    }

    /// The error of a reading now.
    pub fn value(&self, random: &mut Stream) -> f64 {
        let fast = match self.colour {
            // t5 has the variance 5/3.
            Colour::HeavyTailed => {
                let chi2: f64 = (0..5).map(|_| normal(random).powi(2)).sum();
                normal(random) / (chi2 / 5.0).sqrt() / (5.0f64 / 3.0).sqrt()
            }
            _ => normal(random),
        };
        let parts = 1.0 + self.slow.len() as f64;
        self.sd * (fast + self.slow.iter().map(|(_, value)| value).sum::<f64>()) / parts.sqrt()
    }
}
