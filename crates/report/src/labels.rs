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

/// Powers in a unit raised: `1/rad^2` becomes `1/rad²`.
fn powers(unit: &str) -> String {
    let mut parts = unit.split('^');
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |out, part| {
        let digits = part.find(|c: char| !c.is_ascii_digit() && c != '-').unwrap_or(part.len());
        match part[..digits].parse() {
            Ok(power) => out + &superscript(power) + &part[digits..],
            Err(_) => out + "^" + part,
        }
    })
}

/// On one line where it fits beside the panel, otherwise on two.
pub(super) fn y_label(axis: &Axis, scale: &Scale, height: f64) -> Vec<String> {
    let whole = axis_label(axis, scale);
    if width(&without_markup(&whole), LABEL_SIZE, false) <= height + 16.0 {
        return vec![whole];
    }
    [clean(&axis.label, 80), quantity(axis, scale)].into_iter().filter(|p| !p.is_empty()).collect()
}
