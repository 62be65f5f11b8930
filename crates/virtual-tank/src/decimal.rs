//! Writes numbers with a fixed count of decimals straight into a byte buffer: most of the work of writing a campaign.

/// Appends `value` rounded to `DECIMALS` places. `value` is finite and below 9e18 / 10^DECIMALS in size.
#[inline]
pub(super) fn push_fixed<const DECIMALS: usize>(buffer: &mut Vec<u8>, value: f64) {
    let scaled = value * const { 10u64.pow(DECIMALS as u32) as f64 };
    let rounded = (scaled + 0.5f64.copysign(scaled)) as i64;
    if rounded < 0 {
        buffer.push(b'-');
    }
    let mut digits = itoa::Buffer::new();
    let digits = digits.format(rounded.unsigned_abs()).as_bytes();
    if digits.len() > DECIMALS {
        let (whole, fraction) = digits.split_at(digits.len() - DECIMALS);
        buffer.extend_from_slice(whole);
        buffer.push(b'.');
        buffer.extend_from_slice(fraction);
    } else {
        buffer.extend_from_slice(b"0.");
        buffer.extend_from_slice(&[b'0'; DECIMALS][digits.len()..]);
        buffer.extend_from_slice(digits);
    }
}

#[cfg(test)]
mod tests {
    use super::push_fixed;

    /// The standard library's own formatting is the reference; a rounded-off negative zero loses its sign.
    #[test]
    fn writes_what_the_standard_library_writes() {
        let mut values = vec![0.0, -0.00001, 0.00005, 1.0, -1.0, 9.99996, 123.4567, -0.0501, 1e5, -98765.4321];
        values.extend((0..5000).map(|i| (f64::from(i) * 0.731).sin() * 10f64.powi(i % 7 - 3)));
        for value in values {
            let mut written = Vec::new();
            push_fixed::<4>(&mut written, value);
            let expected = format!("{value:.4}");
            let expected =
                if expected.trim_matches(['-', '0', '.']).is_empty() { "0.0000".to_owned() } else { expected };
            let written = String::from_utf8(written).unwrap();
            // Ties may go the other way: the difference is then one unit of the last place of a number that is half way.
            let difference = written.parse::<f64>().unwrap() - expected.parse::<f64>().unwrap();
            assert!(
                written == expected || (difference.abs() < 1.01e-4 && (value * 1e4).fract().abs() == 0.5),
                "{written} for {expected}"
            );
        }
    }
}
