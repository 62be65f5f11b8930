//! Repeated, interleaved measurement: in every round each contender has its turn, so that whatever else the machine does
//! falls on all of them. Absolute times on shared machines mean little; ratios within a round mean more.

use std::time::Instant;

use anyhow::Result;

/// The figures of one contender, one per round.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Samples(Vec<f64>);

impl Samples {
    pub fn one(value: f64) -> Self {
        Samples(vec![value])
    }

    pub fn push(&mut self, value: f64) {
        self.0.push(value);
    }

    /// The same in another unit.
    pub fn times(&self, factor: f64) -> Self {
        Samples(self.0.iter().map(|value| value * factor).collect())
    }

    /// These over those, round by round; where the rounds do not match, over the others' median.
    pub fn over(&self, other: &Samples) -> Self {
        if self.0.len() == other.0.len() {
            return Samples(self.0.iter().zip(&other.0).map(|(a, b)| a / b).collect());
        }
        self.times(1.0 / other.median())
    }

    pub fn median(&self) -> f64 {
        self.quantile(0.5)
    }

    /// The least: what a thing takes when nothing disturbs it.
    pub fn least(&self) -> f64 {
        self.0.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// First and third quartile.
    pub fn quartiles(&self) -> (f64, f64) {
        (self.quantile(0.25), self.quantile(0.75))
    }

    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// By linear interpolation between the order statistics.
    fn quantile(&self, p: f64) -> f64 {
        let mut sorted = self.0.clone();
        sorted.sort_by(f64::total_cmp);
        let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
        let place = p * last as f64;
        let (low, high) = (place.floor() as usize, place.ceil() as usize);
        sorted[low] + (sorted[high] - sorted[low]) * (place - low as f64)
    }
}

/// Someone who takes part: a name, and work that returns its own figure (seconds, mostly).
pub struct Contender<'a> {
    name: String,
    work: Box<dyn FnMut() -> Result<f64> + 'a>,
}

impl<'a> Contender<'a> {
    /// Work that measures itself.
    pub fn new(name: impl Into<String>, work: impl FnMut() -> Result<f64> + 'a) -> Self {
        Contender { name: name.into(), work: Box::new(work) }
    }

    /// Work whose time is taken here, `n` pieces of it at a time: the figure is seconds for one.
    pub fn timed(name: impl Into<String>, n: usize, mut work: impl FnMut() -> Result<()> + 'a) -> Self {
        Contender::new(name, move || {
            let begin = Instant::now();
            work()?;
            Ok(begin.elapsed().as_secs_f64() / n as f64)
        })
    }
}

/// What came of a contender.
pub struct Outcome {
    pub name: String,
    pub samples: Samples,
    /// Why it dropped out, if it did.
    pub failure: Option<String>,
}

impl Outcome {
    /// The figures, or why there are none.
    pub fn samples(&self) -> Result<&Samples> {
        match &self.failure {
            Some(failure) => Err(anyhow::anyhow!("{failure}")),
            None => Ok(&self.samples),
        }
    }
}

/// Runs the rounds after one round to warm up, which counts only where it is all: whether everything runs takes no second one.
/// Who fails once is out; the others go on.
pub fn contest<const N: usize>(rounds: usize, contenders: [Contender<'_>; N]) -> [Outcome; N] {
    let mut running = contenders.map(|contender| {
        let outcome = Outcome { name: contender.name.clone(), samples: Samples::default(), failure: None };
        (contender, outcome)
    });
    for round in 0..=rounds {
        for turn in 0..N {
            // Another one begins each time.
            let (contender, outcome) = &mut running[(turn + round) % N];
            if outcome.failure.is_some() {
                continue;
            }
            match (contender.work)() {
                Ok(_) if round == 0 && rounds > 0 => {}
                Ok(figure) => outcome.samples.push(figure),
                Err(error) => outcome.failure = Some(format!("{}: {error:#}", outcome.name)),
            }
        }
    }
    running.map(|(_, outcome)| outcome)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_textbook() {
        let samples = Samples(vec![4.0, 1.0, 3.0, 2.0, 5.0]);
        assert_eq!((samples.median(), samples.quartiles()), (3.0, (2.0, 4.0)));
        assert_eq!(Samples(vec![1.0, 2.0]).median(), 1.5);
        assert!(Samples::default().median().is_nan());
    }

    #[test]
    fn ratios_are_taken_round_by_round() {
        // Everything was twice as slow in the second round: the ratio does not show it.
        let (ours, theirs) = (Samples(vec![1.0, 2.0]), Samples(vec![3.0, 6.0]));
        assert_eq!(theirs.over(&ours), Samples(vec![3.0, 3.0]));
    }

    #[test]
    fn without_rounds_the_one_to_warm_up_counts() {
        let mut calls = 0;
        let [only] = contest(
            0,
            [Contender::new("only", || {
                calls += 1;
                Ok(2.0)
            })],
        );
        assert_eq!((only.samples.median(), calls), (2.0, 1));
    }

    #[test]
    fn who_fails_is_out_and_the_others_go_on() {
        let mut calls = 0;
        let [good, bad] = contest(
            3,
            [
                Contender::new("good", || {
                    calls += 1;
                    Ok(1.0)
                }),
                Contender::new("bad", || anyhow::bail!("is not installed")),
            ],
        );
        assert_eq!((good.samples.len(), calls), (3, 4));
        assert_eq!(bad.failure.as_deref(), Some("bad: is not installed"));
    }
}
