//! Text in figures: made harmless, measured, and marked up where a symbol has italics and subscripts.

use glidepolar_input::turns;
use plotters::style::{FontStyle, IntoFont, register_font};
use std::sync::Once;

/// Joins the lines of a text into one paragraph: a file breaks its lines where its editor ended.
pub fn paragraph(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The regular, bold and oblique cut of the font that measures text and draws it in PNG files.
pub(super) const FONTS: [(&[u8], FontStyle); 3] = [
    (include_bytes!("fonts/DejaVuSans.subset.ttf"), FontStyle::Normal),
    (include_bytes!("fonts/DejaVuSans-Bold.subset.ttf"), FontStyle::Bold),
    (include_bytes!("fonts/DejaVuSans-Oblique.subset.ttf"), FontStyle::Oblique),
];

/// The family that SVG files name. Whatever a reader's machine has for it is hardly wider than the measured font.
pub(super) const FAMILY: &str = "sans-serif";

// Private-use characters that carry markup through the drawing library, which writes plain text only.
const ITALIC: char = '\u{E000}';
const SUBSCRIPT: char = '\u{E001}';
const END: char = '\u{E002}';
const END_SUBSCRIPT: char = '\u{E003}';

/// Text from outside: without control characters (invalid in XML), private-use characters (ours) and those that turn
/// the direction of text round, and not longer than fits into a figure.
pub(super) fn clean(text: &str, max: usize) -> String {
    let harmless =
        |c: &char| !c.is_control() && !matches!(c, '\u{E000}'..='\u{F8FF}' | '\u{FFFE}' | '\u{FFFF}') && !turns(*c);
    let mut kept: String = text.chars().filter(harmless).take(max).collect();
    if text.chars().filter(harmless).nth(max).is_some() {
        kept.pop();
        kept.push('…');
    }
    kept
}

/// A symbol with its markup: `C_L` in italics with a lowered, upright L.
pub(super) fn symbol(symbol: &str) -> String {
    let mut out = String::new();
    let clean = clean(symbol, 40);
    let mut rest = clean.as_str();
    while let Some(c) = rest.chars().next() {
        if c == '_' {
            rest = &rest[1..];
            let (lowered, after) = match rest.strip_prefix('{').and_then(|r| r.split_once('}')) {
                Some(split) => split,
                None => rest.split_at(rest.chars().next().map_or(0, char::len_utf8)),
            };
            out.extend([SUBSCRIPT]);
            out += lowered;
            out.extend([END_SUBSCRIPT]);
            rest = after;
        } else if c.is_alphabetic() {
            out.extend([ITALIC, c, END]);
            rest = &rest[c.len_utf8()..];
        } else {
            out.push(c);
            rest = &rest[c.len_utf8()..];
        }
    }
    out
}

/// The markup as SVG, in a finished document.
pub(super) fn expand_markup(svg: &str) -> String {
    // After a subscript the next character goes back up: browsers and renderers differ on `baseline-shift`, none on `dy`.
    // The subscript's own em is 0.72 of the text's, so 0.28 em down is 0.2016 em up.
    const BACK: &str = " dy=\"-0.2016em\"";
    let mut out = String::with_capacity(svg.len() + 256);
    let mut lowered = false;
    for c in svg.chars() {
        match c {
            ITALIC => {
                let back = if std::mem::take(&mut lowered) { BACK } else { "" };
                out += &format!("<tspan font-style=\"italic\"{back}>");
            }
            SUBSCRIPT => out += "<tspan dy=\"0.28em\" font-size=\"72%\">",
            END => out += "</tspan>",
            END_SUBSCRIPT => {
                out += "</tspan>";
                lowered = true;
            }
            '<' | '\n' => {
                lowered = false;
                out.push(c);
            }
            // An entity is one character in several.
            '&' => out.push(c),
            _ if std::mem::take(&mut lowered) => out += &format!("<tspan{BACK}>{c}</tspan>"),
            _ => out.push(c),
        }
    }
    out
}

/// The symbol as plain text, for descriptions and tables.
pub(super) fn without_markup(text: &str) -> String {
    text.chars().filter(|c| !('\u{E000}'..='\u{E003}').contains(c)).collect()
}

/// Width of a line of text in pixels at a font size in pixels.
pub(super) fn width(text: &str, size: f64, bold: bool) -> f64 {
    static REGISTERED: Once = Once::new();
    REGISTERED.call_once(|| {
        for (bytes, style) in FONTS {
            // A font that ships with the program and does not parse leaves text unmeasured; the estimate below takes over.
            let _ = register_font(FAMILY, style, bytes);
        }
    });
    let plain = without_markup(text);
    let style = if bold { FontStyle::Bold } else { FontStyle::Normal };
    // Measured large, since the library rounds to whole pixels; its sizes are 1.24 em.
    let font = (FAMILY, 1240.0, style).into_font();
    let wide = font.box_size(&plain).map_or(620.0 * plain.chars().count() as f64, |(w, _)| f64::from(w));
    // The renderer gives the scaled font height (ascent to descent, 1.164 em) the nominal size.
    wide * size / (1240.0 / 1.164)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_get_italics_and_subscripts() {
        let svg = expand_markup(&symbol("C_L"));
        assert!(svg.contains("<tspan font-style=\"italic\">C</tspan>"), "{svg}");
        assert!(svg.contains("font-size=\"72%\">L</tspan>"), "{svg}");
        assert_eq!(without_markup(&symbol("r_{p1}")), "rp1");
        assert_eq!(without_markup(&symbol("_")), "");
    }

    #[test]
    fn text_from_outside_cannot_smuggle_markup_or_control_characters() {
        assert_eq!(clean("a\u{E000}b\u{0}c\nd", 10), "abcd");
        assert_eq!(clean("abcdef", 3), "ab…");
    }

    #[test]
    fn widths_are_those_of_the_font() {
        // Advance widths of DejaVu Sans 2.37 in 1/2048 em: "0" 1303, "m" 1995, "i" 569.
        assert!((width("0000000000", 12.0, false) - 10.0 * 12.0 * 1303.0 / 2048.0).abs() < 0.2);
        assert!((width("mi", 100.0, false) - 100.0 * (1995.0 + 569.0) / 2048.0).abs() < 1.0);
    }
}
