//! Axis ranges, ticks and their labels.

use super::figure::Axis;
use super::number::exponent_of;
use super::text::clean;

/// An axis ready to be drawn: a finite, non-empty range, its ticks, and what its numbers are multiplied by.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scale {
    pub from: f64,
    pub to: f64,
    pub reversed: bool,
    pub ticks: Vec<(f64, String)>,
    /// What the unit says in front: `10⁻³`, or nothing.
    pub factor: String,
    /// What was taken off the numbers, where they differ in their last digits only.
    pub offset: f64,
}

impl Scale {
    /// Around the data `low..high` (any values, NaN where there are none), with room of a fraction of the range on
    /// either side, and at most about `most` ticks.
    pub fn new(axis: &Axis, data: (f64, f64), room: f64, most: usize) -> Scale {
        let (from, to) = match axis.range.filter(|(a, b)| a.is_finite() && b.is_finite() && a != b) {
            Some((a, b)) => (a.min(b), a.max(b)),
            None => widened(data, room),
        };
        let plain = Scale { from, to, reversed: axis.reversed, ticks: Vec::new(), factor: String::new(), offset: 0.0 };
        if axis.names.is_empty() {
            return plain.with_numbers(&axis.unit, most);
        }
        let inside = axis.names.iter().filter(|(at, _)| (from..=to).contains(at));
        Scale { ticks: inside.map(|(at, name)| (*at, clean(name, 36))).collect(), ..plain }
    }

    /// Where a value lies, 0 at the left or lower end, 1 at the other.
    pub fn fraction(&self, value: f64) -> f64 {
        let f = (value - self.from) / (self.to - self.from);
        if self.reversed { 1.0 - f } else { f }
    }

    fn with_numbers(self, unit: &str, most: usize) -> Scale {
        let step = nice_step(self.from, self.to, most.max(3), unit);
        let largest = self.from.abs().max(self.to.abs());
        // Numbers that share more digits than a label can hold are shown from an offset.
        let offset =
            if step > 0.0 && largest / step > 1e5 { (self.from / step / 10.0).floor() * step * 10.0 } else { 0.0 };
        let shown = (self.from - offset).abs().max((self.to - offset).abs());
        let exponent = exponent_of(shown);
        let power = if (-2..5).contains(&exponent) { 0 } else { exponent.div_euclid(3) * 3 };
        let unit_size = 10f64.powi(power);
        let decimals = (-exponent_of(step / unit_size * (1.0 + 1e-9))).clamp(0, 8) as usize;
        let decimals = if is_whole(step / unit_size * 10f64.powi(decimals as i32)) { decimals } else { decimals + 1 };
        // The first tick is not below the range, nor is the last above it, but for rounding.
        let first = ((self.from - offset) / step - 1e-6).ceil();
        let last = ((self.to - offset) / step + 1e-6).floor();
        let count = if (last - first).is_finite() { (last - first).clamp(-1.0, 200.0) as i64 } else { -1 };
        let ticks = (0..=count).map(|i| {
            let value = (first + i as f64) * step;
            (offset + value, label(value / unit_size, decimals))
        });
        let ticks = ticks.collect();
        let factor = if power == 0 { String::new() } else { format!("10{}", superscript(power)) };
        Scale { ticks, factor, offset, ..self }
    }
}

/// The range of finite numbers, NaN where there are none.
pub(super) fn extent(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let finite = values.into_iter().filter(|v| v.is_finite());
    finite.fold((f64::NAN, f64::NAN), |(low, high), v| (low.min(v), high.max(v)))
}

/// A range that can be drawn, from whatever the data have.
fn widened((low, high): (f64, f64), room: f64) -> (f64, f64) {
    if !(low.is_finite() && high.is_finite()) {
        return (0.0, 1.0);
    }
    // Beyond this a range's width overflows.
    let (low, high) = (low.max(-1e300), high.min(1e300));
    let width = high - low;
    // One value, or values that differ by rounding only.
    if width <= low.abs().max(high.abs()) * 1e-12 {
        let half = if low == 0.0 { 1.0 } else { low.abs() * 0.1 };
        return (low - half, high + half);
    }
    (low - width * room, high + width * room)
}

/// The finest round step with at most so many ticks: 1, 2, 5 times a power of ten, but parts of a turn for angles and
/// of a day or an hour for time.
fn nice_step(from: f64, to: f64, most: usize, unit: &str) -> f64 {
    let special: &[f64] = match unit {
        "deg" => &[10.0, 15.0, 30.0, 45.0, 90.0, 180.0],
        "h" => &[1.0, 2.0, 3.0, 6.0, 12.0, 24.0, 48.0],
        "s" | "min" => &[10.0, 15.0, 30.0, 60.0, 120.0, 300.0, 600.0],
        _ => &[],
    };
    let fits = |step: &f64| (to / step + 1e-6).floor() - (from / step - 1e-6).ceil() < most as f64;
    let finest = (to - from) / (most + 1) as f64;
    let power = 10f64.powi(exponent_of(finest));
    let decimal = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0].map(|f| f * power).into_iter().find(|s| *s >= finest && fits(s));
    let decimal = decimal.unwrap_or(100.0 * power);
    // Both kinds hold 10, below which they agree.
    let first = special.first().copied().unwrap_or(f64::INFINITY);
    special.iter().copied().find(|s| decimal >= first && *s >= finest && fits(s)).unwrap_or(decimal)
}

fn is_whole(x: f64) -> bool {
    (x - x.round()).abs() < 1e-6 * x.abs().max(1.0)
}

/// With the typographic minus, and never a negative zero.
fn label(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let digits = text.trim_start_matches('-');
    let zero = digits.chars().all(|c| matches!(c, '0' | '.'));
    if text.starts_with('-') && !zero { format!("−{digits}") } else { digits.to_owned() }
}

/// A whole number in raised digits.
pub(super) fn superscript(power: i32) -> String {
    let digit = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        c => char::from_u32(0x2070 + c as u32 - '0' as u32).unwrap_or(c),
    };
    power.to_string().chars().map(digit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(unit: &str, from: f64, to: f64) -> (Vec<String>, String) {
        let scale = Scale::new(&Axis::new("", "", unit).range(from, to), (0.0, 0.0), 0.0, 6);
        (scale.ticks.into_iter().map(|(_, l)| l).collect(), scale.factor)
    }

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(labels("", -0.62, 0.63).0, ["−0.5", "0.0", "0.5"]);
        assert_eq!(labels("deg", -20.0, 20.0).0, ["−20", "−10", "0", "10", "20"]);
        assert_eq!(labels("deg", 0.0, 90.0).0, ["0", "30", "60", "90"]);
        assert_eq!(labels("h", 0.0, 38.0).0, ["0", "12", "24", "36"]);
        assert_eq!(
            labels("", 0.0, 0.0025),
            (["0.0", "0.5", "1.0", "1.5", "2.0", "2.5"].map(String::from).to_vec(), "10⁻³".into())
        );
        assert_eq!(
            labels("", 0.0, 2.0e6),
            (["0.0", "0.5", "1.0", "1.5", "2.0"].map(String::from).to_vec(), "10⁶".into())
        );
    }

    #[test]
    fn close_numbers_are_counted_from_an_offset() {
        let axis = Axis::new("Time", "t", "s").range(1_469_600_003.0, 1_469_600_047.0);
        let scale = Scale::new(&axis, (0.0, 0.0), 0.0, 6);
        assert!(scale.offset > 1.4e9);
        assert!(scale.ticks.iter().all(|(_, l)| l.len() <= 3), "{:?}", scale.ticks);
    }

    #[test]
    fn any_data_give_a_range() {
        let axis = Axis::new("", "", "");
        for data in [
            (f64::NAN, f64::NAN),
            (0.0, 0.0),
            (5.0, 5.0),
            (-1e308, 1e308),
            (1e-320, 1e-319),
            (f64::MIN_POSITIVE, f64::MIN_POSITIVE),
            (1e17, 1e17 + 16.0),
        ] {
            let s = Scale::new(&axis, data, 0.05, 6);
            assert!(s.from.is_finite() && s.to.is_finite() && s.from < s.to, "{data:?} {s:?}");
            assert!(s.ticks.len() < 50, "{data:?}");
        }
        let empty = Scale::new(&axis, (f64::NAN, f64::NAN), 0.05, 6);
        assert_eq!((empty.from, empty.to, empty.factor.as_str()), (0.0, 1.0, ""));
        assert_eq!(extent([f64::NAN, f64::INFINITY, 2.0, -1.0]), (-1.0, 2.0));
    }
}
