//! The effects of a campaign as they are asked for: names and sizes checked against the catalogue, what is not given drawn
//! from the seed.

use super::Error;
use super::catalogue::CATALOGUE;
use super::effects::{EffectRequest, Hidden, HiddenEffect};
use super::random::{Purpose, Stream};

impl EffectRequest {
    /// Reads `NAME[=SIZE][,NAME[=SIZE]...]`; `none` asks for nothing.
    ///
    /// # Errors
    /// [`Error::EffectSize`] for a size that is no number. Names are checked when the campaign is written.
    pub fn parse_list(text: &str) -> Result<Vec<Self>, Error> {
        let items = text.split(',').map(str::trim);
        items.filter(|item| *item != "none").map(Self::parse).collect()
    }

    fn parse(item: &str) -> Result<Self, Error> {
        let Some((name, size)) = item.split_once('=') else {
            return Ok(Self { name: item.to_owned(), size: None });
        };
        let number: f64 = size.trim().parse().map_err(|_| Error::EffectSize {
            name: name.to_owned(),
            found: size.to_owned(),
            expected: "a number, as in speed_scale=1.02".to_owned(),
        })?;
        Ok(Self { name: name.trim().to_owned(), size: Some(number) })
    }
}

/// Draws what was asked for: the effects as the simulation uses them and as the truth states them.
pub(super) fn hide(requests: &[EffectRequest], seed: u64) -> Result<(Hidden, Vec<HiddenEffect>), Error> {
    let mut hidden = Hidden::default();
    let mut stated = Vec::new();
    let mut taken = [false; CATALOGUE.len()];
    for request in requests.iter().filter(|request| request.name != "none") {
        let place =
            CATALOGUE.iter().position(|entry| entry.name == request.name).ok_or_else(|| unknown(&request.name))?;
        if std::mem::replace(&mut taken[place], true) {
            return Err(Error::EffectTwice { name: request.name.clone() });
        }
        let entry = &CATALOGUE[place];
        let mut stream = Stream::new(seed, Purpose::Effect(place));
        // Drawn even when given, so that a given size leaves the particulars as they were.
        let drawn = entry.draw.size(&mut stream);
        let value = request.size.unwrap_or(drawn);
        if !(entry.bounds.0..=entry.bounds.1).contains(&value) {
            let unit = if entry.unit.is_empty() { String::new() } else { format!(" {}", entry.unit) };
            return Err(Error::EffectSize {
                name: request.name.clone(),
                found: value.to_string(),
                expected: format!("{} from {} to {}{}", entry.parameter, entry.bounds.0, entry.bounds.1, unit),
            });
        }
        let detail = (entry.act)(&mut hidden, value, &mut stream);
        stated.push(HiddenEffect {
            name: entry.name.to_owned(),
            parameter: entry.parameter.to_owned(),
            unit: entry.unit.to_owned(),
            value,
            meaning: entry.meaning.to_owned(),
            detail,
        });
    }
    Ok((hidden, stated))
}

fn unknown(name: &str) -> Error {
    let nearest = CATALOGUE
        .iter()
        .map(|entry| (strsim::jaro_winkler(entry.name, name), entry.name))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|(likeness, _)| *likeness > 0.8)
        .map(|(_, name)| name);
    Error::UnknownEffect {
        name: name.to_owned(),
        nearest: nearest.map(|name| format!(" (did you mean {name}?)")).unwrap_or_default(),
        known: CATALOGUE.iter().map(|entry| entry.name).collect::<Vec<_>>().join(", "),
    }
}
