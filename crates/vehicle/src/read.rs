//! From the text of a vehicle file to a [`Vehicle`], every complaint with its line and column.

use std::collections::BTreeMap;
use std::path::Path;

use toml_edit::{Item, TableLike};

use super::Vehicle;
use super::keys::{self, KEYS, Need, Sections};
use glidepolar_dynamics::mechanisms;
use glidepolar_dynamics::{PARAMETERS, parameter_index};
use glidepolar_input::toml::{Bounds, TomlText};
use glidepolar_input::{InputError, Place, nearest, printable};
use glidepolar_spatial::RateLaw;

pub(super) fn read(text: &str, origin: &Path) -> Result<Vehicle, InputError> {
    let toml = TomlText::new(text, origin);
    let document = toml.parse("vehicle file")?;
    let mut reader = Reader {
        toml,
        origin,
        sections: Sections::default(),
        mechanisms: BTreeMap::new(),
        uncertainty: BTreeMap::new(),
        rate_law: RateLaw::default(),
        moving_mass_inertia_kg_m2: None,
    };
    let mut name = None;
    let mut source = None;
    for (key, item) in document.as_table().iter() {
        match key {
            // Shown on terminals and in tables wherever the vehicle is.
            "name" => name = Some(printable(&toml.string(key, item)?)),
            "source" => source = Some(toml.string(key, item)?),
            "schema" => _ = toml.string(key, item)?,
            _ => reader.section(key, item)?,
        }
    }
    reader.complain_of_missing()?;
    let name = name.ok_or_else(|| {
        InputError::new(Place::file(origin), "missing key `name`, the name that reports give the vehicle")
    })?;
    let Reader { sections, mechanisms, uncertainty, rate_law, moving_mass_inertia_kg_m2, .. } = reader;
    let document = document.into_mut();
    let vehicle = Vehicle {
        name,
        source: source.unwrap_or_default(),
        sections,
        mechanisms,
        uncertainty,
        rate_law,
        moving_mass_inertia_kg_m2,
        is_builtin: false,
        document,
    };
    match vehicle.reversed_limits() {
        Some(problem) => Err(InputError::new(Place::file(origin), problem).help("exchange the two")),
        None => Ok(vehicle),
    }
}

/// An unknown key, with the nearest known one.
pub(super) fn unknown_key(path: &str, place: Place) -> InputError {
    let mechanism_paths: Vec<String> =
        mechanisms::vehicle_parameters().map(|parameter| format!("mechanisms.{parameter}")).collect();
    let others = ["name", "source", RATE_LAW, MOVING_MASS_INERTIA];
    let known = KEYS.iter().map(|key| key.path).chain(mechanism_paths.iter().map(String::as_str)).chain(others);
    let error = InputError::new(place, format!("unknown key `{}`", printable(path)));
    match nearest(path, known) {
        Some(near) => error.help(format!("did you mean `{near}`?")),
        None => error.help("`glidepolar vehicles --keys` lists the keys"),
    }
}

/// Whether a dotted name is that of a number in a vehicle file.
pub(super) fn is_number_key(path: &str) -> bool {
    keys::key(path).is_some() || path.strip_prefix("mechanisms.").is_some_and(mechanisms::is_of_vehicle)
}

struct Reader<'a> {
    toml: TomlText<'a>,
    origin: &'a Path,
    sections: Sections,
    mechanisms: BTreeMap<&'static str, f64>,
    uncertainty: BTreeMap<String, f64>,
    rate_law: RateLaw,
    moving_mass_inertia_kg_m2: Option<[f64; 3]>,
}

/// The key whose value is a word.
const RATE_LAW: &str = "lateral.rate_law";
/// The key whose value is three numbers.
const MOVING_MASS_INERTIA: &str = "moving_mass.inertia_kg_m2";

impl Reader<'_> {
    fn section(&mut self, path: &str, item: &Item) -> Result<(), InputError> {
        let known = KEYS.iter().any(|key| key.path.starts_with(&format!("{path}.")));
        if !known && path != "mechanisms" && path != "uncertainty" {
            return Err(unknown_key(path, self.toml.place(item.span())));
        }
        let Some(table) = item.as_table_like() else {
            return Err(self.toml.wrong_kind(path, item, "a section"));
        };
        self.entries(path, table)
    }

    fn entries(&mut self, section: &str, table: &dyn TableLike) -> Result<(), InputError> {
        for (name, item) in table.iter() {
            let path = format!("{section}.{name}");
            let place = self.toml.place_of_key(table, name);
            let nested = item.as_table_like();
            match (section, nested) {
                ("mechanisms", _) => {
                    let Some(index) = parameter_index(name).filter(|_| mechanisms::is_of_vehicle(name)) else {
                        return Err(unknown_key(&path, place));
                    };
                    let row = &PARAMETERS[index];
                    let value = self.number(&path, item, row.min, row.max)?;
                    self.mechanisms.insert(row.name, value);
                }
                ("uncertainty", Some(nested)) => self.nested_uncertainty(name, nested)?,
                ("uncertainty", None) => self.one_uncertainty(name, item, place)?,
                (_, Some(_)) => self.section(&path, item)?,
                (_, None) if path == RATE_LAW => self.rate_law = self.law(item)?,
                (_, None) if path == MOVING_MASS_INERTIA => self.moving_mass_inertia_kg_m2 = Some(self.three(item)?),
                (_, None) => {
                    let Some(key) = keys::key(&path) else {
                        return Err(unknown_key(&path, place));
                    };
                    let value = self.number(&path, item, key.min, f64::MAX)?;
                    *self.sections.slot(&path).expect("a key of the table has its place") = Some(value);
                }
            }
        }
        Ok(())
    }

    /// `hydro.a_per_rad = 0.3` under `[uncertainty]` without quotes is a table in TOML.
    fn nested_uncertainty(&mut self, prefix: &str, table: &dyn TableLike) -> Result<(), InputError> {
        for (name, item) in table.iter() {
            let path = format!("{prefix}.{name}");
            let place = self.toml.place_of_key(table, name);
            match item.as_table_like() {
                Some(deeper) if path.matches('.').count() < 3 => self.nested_uncertainty(&path, deeper)?,
                _ => self.one_uncertainty(&path, item, place)?,
            }
        }
        Ok(())
    }

    fn one_uncertainty(&mut self, path: &str, item: &Item, place: Place) -> Result<(), InputError> {
        if !is_number_key(path) {
            return Err(unknown_key(path, place));
        }
        let value = self.number(path, item, 0.0, f64::MAX)?;
        self.uncertainty.insert(path.to_owned(), value);
        Ok(())
    }

    fn law(&self, item: &Item) -> Result<RateLaw, InputError> {
        match self.toml.string(RATE_LAW, item)?.as_str() {
            "V" => Ok(RateLaw::Speed),
            "V2" => Ok(RateLaw::SpeedSquared),
            other => {
                let problem = format!("`{RATE_LAW}` is \"{}\", expected \"V\" or \"V2\"", printable(other));
                let help = "\"V\": forces by a rate grow with the speed, rates times length over speed; \"V2\": with its square";
                Err(InputError::new(self.toml.place(item.span()), problem).help(help))
            }
        }
    }

    fn three(&self, item: &Item) -> Result<[f64; 3], InputError> {
        let numbers: Vec<f64> = item
            .as_array()
            .into_iter()
            .flatten()
            .filter_map(|value| value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64)))
            .collect();
        let length = item.as_array().map_or(0, toml_edit::Array::len);
        match numbers.as_slice() {
            &[x, y, z] if length == 3 && numbers.iter().all(|n| n.is_finite() && *n >= 0.0) => Ok([x, y, z]),
            _ => {
                let problem = format!("`{MOVING_MASS_INERTIA}`: expected three numbers not below zero [kg.m2]");
                let help = "write [x, y, z], about axes through its own centre";
                Err(InputError::new(self.toml.place(item.span()), problem).help(help))
            }
        }
    }

    fn number(&self, path: &str, item: &Item, min: f64, max: f64) -> Result<f64, InputError> {
        let unit = keys::key(path).map_or("", |key| key.unit);
        self.toml.number(path, item, Bounds { min, max, unit })
    }

    fn complain_of_missing(&mut self) -> Result<(), InputError> {
        for key in KEYS {
            let given = self.sections.slot(key.path).is_some_and(|slot| slot.is_some());
            if let (Need::Always(purpose), false) = (key.need, given) {
                let problem = format!("missing key `{}` [{}]: {} ({purpose})", key.path, key.unit, key.meaning);
                return Err(InputError::new(Place::file(self.origin), problem).help(format!(
                    "add `{} = ...` under [{}]",
                    name_of(key.path),
                    section_of(key.path)
                )));
            }
        }
        Ok(())
    }
}

fn section_of(path: &str) -> &str {
    path.rsplit_once('.').map_or("", |(section, _)| section)
}

fn name_of(path: &str) -> &str {
    path.rsplit_once('.').map_or(path, |(_, name)| name)
}
