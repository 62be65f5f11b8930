//! Order statistics.

/// The median, the upper one of an even number; not a number where there are no values. The slice is reordered.
pub fn median(values: &mut [f64]) -> f64 {
    quantile(values, 0.5)
}

/// The value next to this share of the way from the least to the greatest, the upper one where two are as near; not a number
/// where there are no values. The slice is reordered.
pub fn quantile(values: &mut [f64], share: f64) -> f64 {
    let Some(last) = values.len().checked_sub(1) else { return f64::NAN };
    let place = (last as f64 * share).round() as usize;
    *values.select_nth_unstable_by(place, f64::total_cmp).1
}

/// The mean of the two middle values of an even number, the middle one of an odd number; not a number where there are no
/// values. The slice is reordered.
pub fn central_value(values: &mut [f64]) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let Some(last) = values.len().checked_sub(1) else { return f64::NAN };
    0.5 * (values[last / 2] + values[values.len() / 2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_few_values_is_found_by_hand() {
        assert_eq!((median(&mut [3.0, 1.0, 2.0]), central_value(&mut [3.0, 1.0, 2.0])), (2.0, 2.0));
        assert_eq!((median(&mut [4.0, 1.0, 3.0, 2.0]), central_value(&mut [4.0, 1.0, 3.0, 2.0])), (3.0, 2.5));
        assert!(median(&mut []).is_nan() && central_value(&mut []).is_nan());
        let mut values = [5.0, 1.0, 4.0, 2.0, 3.0];
        assert_eq!([0.0, 0.25, 0.9, 1.0].map(|share| quantile(&mut values, share)), [1.0, 2.0, 5.0, 5.0]);
    }
}
