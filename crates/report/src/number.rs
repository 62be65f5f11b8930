//! Numbers as a reader wants them: as many digits as their uncertainty supports.

/// `value ± standard error`, the error to two digits and the value to the same place: `1.543 ± 0.021`,
/// `(1.32 ± 0.15)e-10`. Without a usable error, the value to four digits.
pub fn estimate(value: f64, standard_error: f64) -> String {
    if !value.is_finite() {
        return "-".to_owned();
    }
    if !(standard_error.is_finite() && standard_error > 0.0) {
        return significant(value, 4);
    }
    let largest = value.abs().max(standard_error);
    let error_place = place_of_second_digit(standard_error);
    if readable(largest) && error_place >= -7 {
        let decimals = (-error_place).max(0) as usize;
        let (v, s) = (round_to(value, error_place), round_to(standard_error, error_place));
        return format!("{} ± {s:.decimals$}", unsigned_zero(format!("{v:.decimals$}")));
    }
    let exponent = exponent_of(largest);
    let scale = 10f64.powi(exponent);
    let (v, s) = (value / scale, standard_error / scale);
    let decimals = (-place_of_second_digit(s)).clamp(0, 12) as usize;
    format!("({} ± {s:.decimals$})e{exponent}", unsigned_zero(format!("{v:.decimals$}")))
}

/// `low to high`, both to the place that shows the width in two digits: `1.50 to 1.59`.
pub fn interval(low: f64, high: f64) -> String {
    let [low, high] = to_shared_place([low, high], high - low);
    format!("{low} to {high}")
}

/// `value (low to high)`, all to the place that shows the width in two digits: `1.54 (1.42 to 1.67)`.
pub fn with_interval(value: f64, low: f64, high: f64) -> String {
    let [value, low, high] = to_shared_place([value, low, high], high - low);
    format!("{value} ({low} to {high})")
}

fn to_shared_place<const N: usize>(values: [f64; N], width: f64) -> [String; N] {
    let bounded = width.is_finite() && width != 0.0 && values.iter().all(|v| v.is_finite());
    if !bounded {
        return values.map(|v| if v.is_infinite() { "unbounded".to_owned() } else { significant(v, 4) });
    }
    let largest = values.iter().fold(0.0, |l: f64, v| l.max(v.abs()));
    let place = place_of_second_digit(width);
    if readable(largest) && place >= -7 {
        let decimals = (-place).max(0) as usize;
        return values.map(|v| unsigned_zero(format!("{:.decimals$}", round_to(v, place))));
    }
    values.map(|v| significant(v, (exponent_of(v) - place + 1).clamp(2, 12) as usize))
}

/// A probability of chance: `p = 0.24`, `p = 1.9e-6`, `p < 1e-12`. What is smaller rests on tails that no noise has so exactly.
pub fn probability(p: f64) -> String {
    const SMALLEST: f64 = 1e-12;
    match p {
        p if p < SMALLEST => format!("p < {SMALLEST:e}"),
        p if p < 0.01 => format!("p = {p:.1e}"),
        p => format!("p = {p:.2}"),
    }
}

/// A number to so many significant digits, without a needless exponent: `0.001234`, `5.68e-10`, `12350`.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "-".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = digits.clamp(1, 17);
    let scientific = format!("{value:.*e}", digits - 1);
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if !(-4..7).contains(&exponent) {
        return format!("{mantissa}e{exponent}");
    }
    let place = exponent - digits as i32 + 1;
    let decimals = (-place).max(0) as usize;
    format!("{:.decimals$}", round_to(value, place))
}

/// Decimal exponent of the leading digit.
pub(super) fn exponent_of(value: f64) -> i32 {
    if value == 0.0 || !value.is_finite() { 0 } else { value.abs().log10().floor() as i32 }
}

fn readable(largest: f64) -> bool {
    largest == 0.0 || (1e-3..1e7).contains(&largest)
}

/// The decimal place (power of ten) of the second significant digit, after rounding to two.
fn place_of_second_digit(value: f64) -> i32 {
    let shown = format!("{value:.1e}");
    shown.split_once('e').and_then(|(_, e)| e.parse::<i32>().ok()).unwrap_or(0) - 1
}

/// Rounded to a place left of the point; places right of it are left to formatting, which rounds exactly.
fn round_to(value: f64, place: i32) -> f64 {
    if place <= 0 {
        return value;
    }
    let unit = 10f64.powi(place);
    (value / unit).round() * unit
}

/// Without the sign of a zero.
pub(super) fn unsigned_zero(text: String) -> String {
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| matches!(c, '0' | '.')) => rest.to_owned(),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_probability_is_zero() {
        let texts = [7.24e-7, 0.0, 1e-30, 0.238, 1.0].map(probability);
        assert_eq!(texts, ["p = 7.2e-7", "p < 1e-12", "p < 1e-12", "p = 0.24", "p = 1.00"]);
    }

    #[test]
    fn the_error_has_two_digits_and_the_value_ends_at_the_same_place() {
        assert_eq!(estimate(1.54321, 0.0213), "1.543 ± 0.021");
        assert_eq!(estimate(0.25, 0.0999), "0.25 ± 0.10");
        assert_eq!(estimate(-12345.6, 780.0), "-12350 ± 780");
        assert_eq!(estimate(1234.0, 25.4), "1234 ± 25");
        assert_eq!(estimate(5.68e-10, 1.5e-11), "(5.68 ± 0.15)e-10");
        assert_eq!(estimate(-0.0001, 0.02), "0.000 ± 0.020");
        assert_eq!(estimate(0.0, 0.3), "0.00 ± 0.30");
        assert_eq!(estimate(4.7, f64::NAN), "4.700");
        assert_eq!(estimate(f64::NAN, 1.0), "-");
    }

    #[test]
    fn intervals_show_their_width() {
        assert_eq!(interval(1.5012, 1.5934), "1.501 to 1.593");
        assert_eq!(interval(-0.4, 12.0), "0 to 12");
        assert_eq!(interval(5.1e-10, 6.2e-10), "5.1e-10 to 6.2e-10");
        assert_eq!(interval(f64::NEG_INFINITY, 2.0), "unbounded to 2.000");
        assert_eq!(with_interval(1.5432, 1.42, 1.668), "1.54 (1.42 to 1.67)");
        assert_eq!(with_interval(5.68e-10, 5.1e-10, 6.2e-10), "5.7e-10 (5.1e-10 to 6.2e-10)");
        assert_eq!(interval(3.0, 3.0), "3.000 to 3.000");
    }

    #[test]
    fn significant_digits_without_needless_exponents() {
        assert_eq!(significant(0.0012345, 3), "0.00123");
        assert_eq!(significant(123456.0, 3), "123000");
        assert_eq!(significant(9.999, 3), "10.0");
        assert_eq!(significant(1.0e-9, 3), "1.00e-9");
        assert_eq!(significant(-2.5, 2), "-2.5");
        assert_eq!(significant(0.0, 3), "0");
    }
}
