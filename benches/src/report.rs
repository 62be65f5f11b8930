//! What a part found: rows of figures beside each other, ratios, goals, remarks, figures.

use std::fmt::Write as _;

use glidepolar::report::Figure;

use crate::contest::Samples;

/// The unit that a row's figures are printed in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    Seconds,
    /// Bytes of memory.
    Bytes,
    /// Machine instructions.
    Instructions,
    /// A pure number.
    Count,
}

/// A goal that a row is held against.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Goal {
    /// The figure itself, at most.
    AtMost(f64),
    /// The other one's figure over this one's, at least.
    Quicker(f64),
    /// This one's figure over the other one's, at most.
    Within(f64),
}

/// One comparison.
#[derive(Debug, Clone)]
pub struct Row {
    pub what: String,
    pub unit: Unit,
    pub ours: Result<Samples, String>,
    pub other: Option<(String, Result<Samples, String>)>,
    pub goal: Option<Goal>,
}

impl Row {
    pub fn new(what: impl Into<String>, unit: Unit, ours: anyhow::Result<Samples>) -> Self {
        Row { what: what.into(), unit, ours: ours.map_err(|e| format!("{e:#}")), other: None, goal: None }
    }

    /// Beside someone else.
    pub fn against(mut self, who: impl Into<String>, other: anyhow::Result<Samples>) -> Self {
        self.other = Some((who.into(), other.map_err(|e| format!("{e:#}"))));
        self
    }

    /// With a goal.
    pub fn goal(mut self, goal: Goal) -> Self {
        self.goal = Some(goal);
        self
    }

    /// The other one's figure over this one's, round by round; above 1 this one is better.
    pub fn ratio(&self) -> Option<Samples> {
        let (ours, (_, other)) = (self.ours.as_ref().ok()?, self.other.as_ref()?);
        Some(other.as_ref().ok()?.over(ours))
    }

    /// Whether the goal is met; `None` without a goal, or where it could not be measured.
    pub fn is_met(&self) -> Option<bool> {
        match self.goal? {
            Goal::AtMost(limit) => Some(self.ours.as_ref().ok()?.median() <= limit),
            Goal::Quicker(factor) => Some(self.ratio()?.median() >= factor),
            Goal::Within(factor) => Some(1.0 / self.ratio()?.median() <= factor),
        }
    }

    /// The cells: what, ours, the other, its figure, ratio, goal, met.
    pub fn cells(&self) -> [String; 7] {
        let (who, other) = match &self.other {
            Some((who, other)) => (who.clone(), shown(self.unit, other)),
            None => (String::new(), String::new()),
        };
        let ratio = self.ratio().map_or_else(String::new, |ratio| ratio_text(&ratio));
        let goal = self.goal.map_or_else(String::new, |goal| self.goal_text(goal));
        let met = match (self.goal, self.is_met()) {
            (None, _) => "",
            (_, Some(true)) => "yes",
            (_, Some(false)) => "**no**",
            (_, None) => "not measured",
        };
        [self.what.clone(), shown(self.unit, &self.ours), who, other, ratio, goal, met.to_owned()]
    }

    fn goal_text(&self, goal: Goal) -> String {
        match goal {
            Goal::AtMost(limit) => format!("≤ {}", quantity(self.unit, limit)),
            Goal::Quicker(factor) => format!("≥ {} times better", figures(factor)),
            Goal::Within(factor) => format!("within {} times", figures(factor)),
        }
    }
}

/// What a part found.
#[derive(Debug, Clone, Default)]
pub struct Part {
    pub heading: String,
    /// What was compared and how, before the table.
    pub text: String,
    pub rows: Vec<Row>,
    /// What a reader has to know of this run, after the table.
    pub remarks: Vec<String>,
    pub figures: Vec<Figure>,
    pub seconds: f64,
}

impl Part {
    pub fn new(heading: &str, text: &str) -> Self {
        Part { heading: heading.to_owned(), text: text.to_owned(), ..Part::default() }
    }

    pub fn row(&mut self, row: Row) {
        self.rows.push(row);
    }

    pub fn remark(&mut self, text: impl Into<String>) {
        self.remarks.push(text.into());
    }
}

fn shown(unit: Unit, samples: &Result<Samples, String>) -> String {
    let samples = match samples {
        Ok(samples) => samples,
        Err(why) => return format!("not measured: {}", why.replace(['\n', '|'], " ")),
    };
    let mut text = quantity(unit, samples.median());
    if samples.len() > 1 {
        let (low, high) = samples.quartiles();
        let _ = write!(text, " ({} to {})", quantity(unit, low), quantity(unit, high));
    }
    text
}

fn ratio_text(ratio: &Samples) -> String {
    let tell = |value: f64| if value >= 1.0 { figures(value) } else { format!("1/{}", figures(1.0 / value)) };
    let (low, high) = ratio.quartiles();
    if ratio.len() > 1 {
        format!("{} ({} to {})", tell(ratio.median()), tell(low), tell(high))
    } else {
        tell(ratio.median())
    }
}

/// A figure with the unit that suits its size.
pub fn quantity(unit: Unit, value: f64) -> String {
    let scales: &[(f64, &str)] = match unit {
        Unit::Seconds => &[(1e-9, "ns"), (1e-6, "µs"), (1e-3, "ms"), (1.0, "s")],
        Unit::Bytes => &[(1.0, "B"), (1e3, "kB"), (1e6, "MB"), (1e9, "GB")],
        Unit::Instructions | Unit::Count => &[(1.0, ""), (1e6, "million")],
    };
    let (scale, name) =
        scales.iter().rev().find(|(scale, _)| value.abs() >= 0.9995 * scale).copied().unwrap_or(scales[0]);
    format!("{} {name}", figures(value / scale)).trim_end().to_owned()
}

/// Three figures, without an exponent.
pub fn figures(value: f64) -> String {
    if !value.is_finite() {
        return "?".to_owned();
    }
    let magnitude = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
    format!("{value:.*}", (2 - magnitude).clamp(0, 6) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(values: &[f64]) -> anyhow::Result<Samples> {
        let mut samples = Samples::default();
        values.iter().for_each(|value| samples.push(*value));
        Ok(samples)
    }

    #[test]
    fn quantities_have_three_figures_and_a_fitting_unit() {
        assert_eq!(quantity(Unit::Seconds, 1.234_56e-7), "123 ns");
        assert_eq!(quantity(Unit::Seconds, 0.012), "12.0 ms");
        assert_eq!(quantity(Unit::Bytes, 1.5e9), "1.50 GB");
        assert_eq!(quantity(Unit::Count, 123_456.0), "123456");
        assert_eq!(quantity(Unit::Seconds, f64::NAN), "? ns");
    }

    #[test]
    fn goals_are_judged_by_medians() {
        let row = |goal| {
            Row::new("a step", Unit::Seconds, measured(&[1.0, 2.0, 9.0]))
                .against("peer", measured(&[10.0, 20.0, 90.0]))
                .goal(goal)
        };
        assert_eq!(row(Goal::AtMost(2.0)).is_met(), Some(true));
        assert_eq!(row(Goal::AtMost(1.9)).is_met(), Some(false));
        assert_eq!(row(Goal::Quicker(10.0)).is_met(), Some(true));
        assert_eq!(row(Goal::Quicker(10.1)).is_met(), Some(false));
        assert_eq!(row(Goal::Within(0.1)).is_met(), Some(true));
        assert_eq!(row(Goal::Within(0.09)).is_met(), Some(false));
        let cells = row(Goal::Quicker(100.0)).cells();
        assert_eq!(
            cells[1..],
            [
                "2.00 s (1.50 s to 5.50 s)",
                "peer",
                "20.0 s (15.0 s to 55.0 s)",
                "10.0 (10.0 to 10.0)",
                "≥ 100 times better",
                "**no**"
            ]
        );
    }

    #[test]
    fn what_was_not_measured_is_said_and_meets_no_goal() {
        let row = Row::new("a fit", Unit::Seconds, measured(&[1.0]))
            .against("peer", Err(anyhow::anyhow!("not\ninstalled")))
            .goal(Goal::Quicker(2.0));
        assert_eq!((row.ratio(), row.is_met()), (None, None));
        let cells = row.cells();
        assert_eq!((cells[3].as_str(), cells[6].as_str()), ("not measured: not installed", "not measured"));
    }
}
