//! What stands along the axes: quantity, symbol and unit as a journal writes them.

use super::canvas::LABEL_SIZE;
use super::figure::Axis;
use super::text::{clean, symbol, width, without_markup};
use super::ticks::{Scale, superscript};

/// `Angle of attack  α [deg]`, with the factor that tick labels leave out.
pub(super) fn axis_label(axis: &Axis, scale: &Scale) -> String {
    let parts = [clean(&axis.label, 80), quantity(axis, scale)];
    parts.into_iter().filter(|p| !p.is_empty()).collect::<Vec<_>>().join("\u{A0} ")
}

/// Symbol and unit: `α [deg]`, `w [10⁻³ m/s]`, `t − 1469600000 [s]`.
fn quantity(axis: &Axis, scale: &Scale) -> String {
    let mut text = symbol(&axis.symbol);
    if scale.offset != 0.0 {
        text += &format!(" − {}", scale.offset);
    }
    let unit = [scale.factor.clone(), powers(&clean(&axis.unit, 24))]
        .into_iter()
        .filter(|p| !p.is_empty())
        .collect::<Vec<_>>()
        .join(" ");
    match (text.is_empty(), unit.is_empty()) {
        (_, true) => text,
        (true, false) => format!("[{unit}]"),
        (false, false) => format!("{text} [{unit}]"),
    }
}

/// Powers in a unit raised: `1/rad^2` and `1/rad2` become `1/rad²`.
pub(super) fn powers(unit: &str) -> String {
    let mut out = String::new();
    let mut rest = unit;
    while let Some(c) = rest.chars().next() {
        let marked = c == '^';
        let begin = if marked { &rest[1..] } else { rest };
        let after_letter = out.chars().next_back().is_some_and(char::is_alphabetic);
        let end = begin.find(|c: char| !(c.is_ascii_digit() || marked && c == '-')).unwrap_or(begin.len());
        let ends_word = begin[end..].chars().next().is_none_or(|c| !c.is_alphanumeric());
        match begin[..end].parse() {
            Ok(power) if marked || (after_letter && ends_word) => {
                out += &superscript(power);
                rest = &begin[end..];
            }
            // Digits that are no power stay together.
            Ok(_) if !marked => {
                out += &begin[..end];
                rest = &begin[end..];
            }
            _ => {
                out.push(c);
                rest = &rest[c.len_utf8()..];
            }
        }
    }
    out
}

/// The units in a heading raised: `c [1/rad2]` becomes `c [1/rad²]`. What stands outside of brackets is no unit.
pub(super) fn heading(text: &str) -> String {
    let Some((before, rest)) = text.split_once('[') else { return text.to_owned() };
    let Some((unit, after)) = rest.split_once(']') else { return text.to_owned() };
    format!("{before}[{}]{}", powers(unit), heading(after))
}

/// On one line where it fits into that length, otherwise on two.
pub(super) fn label_lines(axis: &Axis, scale: &Scale, length: f64) -> Vec<String> {
    let whole = axis_label(axis, scale);
    if width(&without_markup(&whole), LABEL_SIZE, false) <= length {
        return vec![whole];
    }
    [clean(&axis.label, 80), quantity(axis, scale)].into_iter().filter(|p| !p.is_empty()).collect()
}
