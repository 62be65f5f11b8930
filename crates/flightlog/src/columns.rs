//! What a user says of the columns of a log beyond their usual names: which one to take, in which unit it really is, and
//! where a Slocum's lists of sensors lie.

use std::path::{Path, PathBuf};

use super::channels::{CHANNELS, Channel};
use super::dates::DateOrder;
use super::units::{self, Conversion};
use glidepolar_input::{nearest, printable};

/// Which column of a file holds a channel, and in which unit, where it is not the usual one.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Columns {
    chosen: Vec<(Channel, String, Option<Conversion>)>,
    units: Vec<(Channel, Conversion)>,
    caches: Vec<PathBuf>,
    date_order: Option<DateOrder>,
}

impl Columns {
    /// Takes a channel from this column, in the unit that the file states.
    pub fn choose(&mut self, channel: Channel, column: &str) {
        self.chosen.retain(|(chosen, ..)| *chosen != channel);
        self.chosen.push((channel, column.to_owned(), None));
    }

    /// Takes a choice as a user writes it, `pitch_deg=pitch_corr`: a name of the channel, then the column. A name other than
    /// the channel's first says the unit as well.
    ///
    /// # Errors
    /// A text without `=`, or a channel that does not exist; the message names the nearest one.
    pub fn choose_text(&mut self, text: &str) -> Result<(), String> {
        let (name, column) = text
            .split_once('=')
            .ok_or_else(|| format!("`{}` is no choice of a column, expected CHANNEL=COLUMN", printable(text)))?;
        let (channel, conversion) = channel(name)?;
        self.choose(channel, column);
        if CHANNELS[channel as usize].name != name
            && let Some(last) = self.chosen.last_mut()
        {
            last.2 = Some(conversion);
        }
        Ok(())
    }

    /// Takes a unit as a user writes it, `pitch_rad=deg`: a name of the channel, then the unit in which the file has it,
    /// whatever the file says.
    ///
    /// # Errors
    /// A text without `=`, a channel or a unit that does not exist; the message names what there is.
    pub fn unit_text(&mut self, text: &str) -> Result<(), String> {
        let (name, unit) = text
            .split_once('=')
            .ok_or_else(|| format!("`{}` states no unit, expected CHANNEL=UNIT", printable(text)))?;
        let (channel, _) = channel(name)?;
        if let Some(order) = DateOrder::parse(unit).filter(|_| channel == Channel::Time) {
            self.date_order = Some(order);
            return Ok(());
        }
        let conversion = units::conversion(channel, unit).ok_or_else(|| {
            let known = units::known(channel);
            let known = if known.is_empty() { "it has none".to_owned() } else { format!("known are {known}") };
            format!("`{}` is no unit of `{}`; {known}", printable(unit), CHANNELS[channel as usize].name)
        })?;
        self.units.retain(|(stated, _)| *stated != channel);
        self.units.push((channel, conversion));
        Ok(())
    }

    /// What the user says of the order of day and month in dates.
    pub(super) fn date_order(&self) -> Option<DateOrder> {
        self.date_order
    }

    /// Looks for a Slocum's lists of sensors in this folder, before those beside the files.
    pub fn cache(&mut self, folder: impl AsRef<Path>) {
        self.caches.push(folder.as_ref().to_owned());
    }

    /// The column chosen for a channel.
    pub fn chosen(&self, channel: Channel) -> Option<&str> {
        self.chosen.iter().find(|(chosen, ..)| *chosen == channel).map(|(_, column, _)| column.as_str())
    }

    /// What the user says of the unit of a channel: by `--unit`, else by the name under which the column was chosen.
    pub(super) fn unit(&self, channel: Channel) -> Option<Conversion> {
        let by_name = || self.chosen.iter().find(|(chosen, ..)| *chosen == channel).and_then(|(.., unit)| *unit);
        self.units.iter().find(|(stated, _)| *stated == channel).map(|(_, unit)| *unit).or_else(by_name)
    }

    /// Folders with lists of sensors.
    pub(super) fn caches(&self) -> &[PathBuf] {
        &self.caches
    }
}

/// The channel of a name; `pitch` is enough, the shortest name that begins so is meant.
fn channel(name: &str) -> Result<(Channel, Conversion), String> {
    if let Some(found) = units::named(name) {
        return Ok(found);
    }
    let of_stem = CHANNELS.iter().filter(|info| info.name.split_once('_').map_or(info.name, |(stem, _)| stem) == name);
    if let Some(info) = of_stem.min_by_key(|info| info.name.len()) {
        return Ok((info.channel, Conversion::NONE));
    }
    let names = CHANNELS.iter().flat_map(|info| std::iter::once(info.name).chain(info.aliases.iter().map(|a| a.0)));
    let hint = nearest(name, names).map(|near| format!("; did you mean `{near}`?")).unwrap_or_default();
    Err(format!("there is no channel `{}`{hint}", printable(name)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_choice_by_another_name_states_the_unit() {
        let mut columns = Columns::default();
        columns.choose_text("pitch_deg=PITCH_CORR").unwrap();
        assert_eq!(columns.chosen(Channel::Pitch), Some("PITCH_CORR"));
        assert!((columns.unit(Channel::Pitch).unwrap().convert(180.0) - std::f64::consts::PI).abs() < 1e-12);
        columns.choose_text("pitch_rad=p").unwrap();
        assert_eq!(columns.unit(Channel::Pitch), None);
        assert!(columns.choose_text("pich_deg=p").unwrap_err().contains("pitch_deg"));
    }

    #[test]
    fn a_unit_can_be_stated_and_a_wrong_one_is_refused() {
        let mut columns = Columns::default();
        columns.unit_text("pitch_rad=rad").unwrap();
        assert_eq!(columns.unit(Channel::Pitch), Some(Conversion::NONE));
        columns.unit_text("pitch=deg").unwrap();
        assert!(columns.unit(Channel::Pitch).unwrap().convert(90.0) < 1.6);
        let error = columns.unit_text("pitch_rad=furlong").unwrap_err();
        assert!(error.contains("furlong") && error.contains("deg, rad"), "{error}");
        assert!(columns.unit_text("pitch").is_err() && columns.unit_text("x=y").is_err());
    }
}
