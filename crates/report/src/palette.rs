//! Colours that people with colour-blindness can tell apart (Okabe and Ito, 2008), each with a marker of its own.
//! The page's style sheet maps these very values to lighter ones on a dark background: `page.css`.

use plotters::style::RGBColor;

/// Text, axes, black lines.
pub(super) const INK: RGBColor = RGBColor(0x1A, 0x1A, 0x1A);
/// Secondary text.
pub(super) const FAINT: RGBColor = RGBColor(0x59, 0x59, 0x59);
/// Grid lines.
pub(super) const GRID: RGBColor = RGBColor(0xE3, 0xE3, 0xE3);
/// Shaded strips.
pub(super) const SHADE: RGBColor = RGBColor(0xE8, 0xEC, 0xF1);
/// Behind everything, and around markers where they overlap.
pub(super) const PAPER: RGBColor = RGBColor(0xFF, 0xFF, 0xFF);

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Style {
    pub colour: RGBColor,
    pub marker: Marker,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Marker {
    Circle,
    Square,
    Triangle,
    Diamond,
    TriangleDown,
    Cross,
}

/// Okabe-Ito without yellow (too faint on paper) and black (kept for axes and reference lines).
const COLOURS: [RGBColor; 6] = [
    RGBColor(0x00, 0x72, 0xB2),
    RGBColor(0xD5, 0x5E, 0x00),
    RGBColor(0x00, 0x9E, 0x73),
    RGBColor(0xCC, 0x79, 0xA7),
    RGBColor(0xE6, 0x9F, 0x00),
    RGBColor(0x56, 0xB4, 0xE9),
];

const MARKERS: [Marker; 6] =
    [Marker::Circle, Marker::Square, Marker::Triangle, Marker::Diamond, Marker::TriangleDown, Marker::Cross];

/// The style of a slot; colour and marker repeat together only after 36 slots.
pub(super) fn style(slot: usize) -> Style {
    let round = slot / COLOURS.len();
    Style { colour: COLOURS[slot % COLOURS.len()], marker: MARKERS[(slot + round) % MARKERS.len()] }
}
