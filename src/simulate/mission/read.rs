//! From the text of a mission file to a [`Mission`], every complaint with its line and column.

use std::collections::BTreeMap;
use std::path::Path;

use toml_edit::TableLike;

use super::keys::{KEYS, Key};
use super::{LegOrder, Mission, Origin, PitchControl, Profile, Route, Steering, Surfacing, Tide};
use crate::input::toml::{Bounds, TomlText};
use crate::input::{InputError, Place, nearest, printable};

pub(super) fn read(text: &str, origin: &Path) -> Result<Mission, InputError> {
    let toml = TomlText::new(text, origin);
    let document = toml.parse("mission file")?;
    let mut reader = Reader { toml, origin, values: BTreeMap::new(), places: BTreeMap::new() };
    let (mut name, mut source) = (None, None);
    for (key, item) in document.as_table().iter() {
        match (key, item.as_table_like()) {
            // Shown on terminals and in tables wherever the mission is.
            ("name", _) => name = Some(printable(&toml.string(key, item)?)),
            ("source", _) => source = Some(toml.string(key, item)?),
            (_, Some(section)) => reader.section(key, section, &toml.place_of_key(document.as_table(), key))?,
            _ => return Err(unknown_key(key, toml.place_of_key(document.as_table(), key))),
        }
    }
    reader.complain_of_missing()?;
    let name = name.ok_or_else(|| {
        InputError::new(Place::file(origin), "missing key `name`, the name that reports give the mission")
    })?;
    reader.mission(name, source.unwrap_or_default())
}

fn unknown_key(path: &str, place: Place) -> InputError {
    let error = InputError::new(place, format!("unknown key `{}`", printable(path)));
    let sections = KEYS.iter().filter_map(|key| key.path.split('.').next()).chain(["name", "source"]);
    // A misspelt section is compared with sections, a misspelt key with keys.
    let near = match path.contains('.') {
        true => nearest(path, KEYS.iter().map(|key| key.path)),
        false => nearest(path, sections),
    };
    match near {
        Some(near) => error.help(format!("did you mean `{near}`?")),
        None => error.help("`glidepolar simulate --mission-keys` lists the keys"),
    }
}

struct Reader<'a> {
    toml: TomlText<'a>,
    origin: &'a Path,
    values: BTreeMap<&'static str, Vec<f64>>,
    places: BTreeMap<&'static str, Place>,
}

impl Reader<'_> {
    fn section(&mut self, section: &str, table: &dyn TableLike, place: &Place) -> Result<(), InputError> {
        if !KEYS.iter().any(|key| key.path.split('.').next() == Some(section)) {
            return Err(unknown_key(section, place.clone()));
        }
        for (name, item) in table.iter() {
            let path = format!("{section}.{name}");
            let place = self.toml.place_of_key(table, name);
            let Some(key) = KEYS.iter().find(|key| key.path == path) else {
                return Err(unknown_key(&path, place));
            };
            let bounds = Bounds { min: key.min, max: key.max, unit: key.unit };
            let values = if key.list {
                self.toml.numbers(&path, item, bounds)?
            } else {
                vec![self.toml.number(&path, item, bounds)?]
            };
            self.values.insert(key.path, values);
            self.places.insert(key.path, place);
        }
        Ok(())
    }

    fn complain_of_missing(&self) -> Result<(), InputError> {
        match KEYS.iter().find(|key| key.needed && !self.values.contains_key(key.path)) {
            None => Ok(()),
            Some(Key { path, unit, meaning, .. }) => {
                let (section, name) = path.split_once('.').unwrap_or(("", path));
                let problem = format!("missing key `{path}` [{unit}]: {meaning}");
                Err(InputError::new(Place::file(self.origin), problem)
                    .help(format!("add `{name} = ...` under [{section}]")))
            }
        }
    }

    fn mission(&self, name: String, source: String) -> Result<Mission, InputError> {
        let ballast_up = self.number("glide.ballast_up_cc");
        let every_s = self.given("surfacing.every_h").map(|hours| hours * 3600.0);
        let mission = Mission {
            name,
            source,
            duration_s: self.number("voyage.duration_h") * 3600.0,
            distance_m: self.given("voyage.distance_km").map_or(f64::INFINITY, |km| km * 1e3),
            max_depth_m: self.number("dive.max_depth_m"),
            altimeter_m: self.number("dive.altimeter_m"),
            climb_to_m: self.number("dive.climb_to_m"),
            descent: LegOrder {
                pitch_rad: self.number("glide.pitch_down_deg").to_radians(),
                ballast_m3: self.number("glide.ballast_down_cc") * 1e-6,
            },
            ascent: LegOrder {
                pitch_rad: self.number("glide.pitch_up_deg").to_radians(),
                ballast_m3: ballast_up * 1e-6,
            },
            surfacing: Surfacing {
                first_s: self.given("surfacing.first_after_h").map(|hours| hours * 3600.0).or(every_s),
                every_s,
                stay_s: self.number("surfacing.stay_min") * 60.0,
                ballast_m3: self.given("surfacing.ballast_cc").unwrap_or(ballast_up) * 1e-6,
                pitch_rad: self.number("surfacing.pitch_deg").to_radians(),
            },
            control: PitchControl {
                period_s: self.number("control.period_s"),
                deadband_rad: self.number("control.deadband_deg").to_radians(),
                gain: self.number("control.gain"),
            },
            seabed: self
                .profile("seabed.distance_km", 1e3, "seabed.depth_m")?
                .unwrap_or(Profile::constant(self.number("seabed.depth_m"))),
            density: self.profile("water.depth_m", 1.0, "water.density_kg_m3")?,
            temperature: self.profile("water.depth_m", 1.0, "water.temperature_C")?,
            current: self
                .profile("current.depth_m", 1.0, "current.along_m_s")?
                .unwrap_or(Profile::constant(self.number("current.along_m_s"))),
            tide: Tide {
                along_m_s: self.number("current.tide_m_s"),
                period_s: self.number("current.tide_period_h") * 3600.0,
                most_at_s: self.number("current.tide_most_at_h") * 3600.0,
            },
            route: self.route()?,
        };
        self.complain_of_contradictions(&mission)?;
        Ok(mission)
    }

    fn route(&self) -> Result<Route, InputError> {
        let origin = Origin {
            latitude_deg: self.number("route.start_latitude_deg"),
            longitude_deg: self.number("route.start_longitude_deg"),
        };
        let by_way = self.pairs("route.north_km", "route.east_km")?;
        let by_place = self.pairs("route.latitude_deg", "route.longitude_deg")?;
        if !by_way.is_empty() && !by_place.is_empty() {
            let place = self.places["route.latitude_deg"].clone();
            let problem = "waypoints by `route.latitude_deg` beside waypoints by `route.north_km`";
            return Err(InputError::new(place, problem).help("state them in one of the two ways"));
        }
        let current = |values: &'static str| {
            Ok::<_, InputError>(self.profile("current.depth_m", 1.0, values)?.unwrap_or(Profile::constant(0.0)))
        };
        Ok(Route {
            waypoints_m: by_way
                .into_iter()
                .map(|way| way.map(|km| km * 1e3))
                .chain(by_place.into_iter().map(|[latitude, longitude]| origin.way_m(latitude, longitude)))
                .collect(),
            origin,
            reached_m: self.number("route.reached_m"),
            steering: self
                .given("steering.actuator")
                .map(|number| if number < 1.5 { Steering::HeadingByRudder } else { Steering::HeadingByRollMass }),
            period_s: self.number("steering.period_s"),
            deadband_rad: self.number("steering.deadband_deg").to_radians(),
            current_north: current("current.north_m_s")?,
            current_east: current("current.east_m_s")?,
        })
    }

    /// Two lists of equal length, pair by pair.
    fn pairs(&self, first: &'static str, second: &'static str) -> Result<Vec<[f64; 2]>, InputError> {
        let of = |path: &str| self.values.get(path).map(Vec::as_slice).unwrap_or_default();
        let (a, b) = (of(first), of(second));
        if a.len() != b.len() {
            let path = if self.places.contains_key(first) { first } else { second };
            let problem = format!("`{first}` has {} values, `{second}` {}", a.len(), b.len());
            return Err(InputError::new(self.places[path].clone(), problem).help("give each waypoint both"));
        }
        Ok(a.iter().zip(b).map(|(a, b)| [*a, *b]).collect())
    }

    fn complain_of_contradictions(&self, mission: &Mission) -> Result<(), InputError> {
        let complaint = |path: &str, problem: String, help: &str| {
            let place = self.places.get(path).cloned().unwrap_or(Place::file(self.origin));
            Err(InputError::new(place, problem).help(help))
        };
        if mission.climb_to_m >= mission.max_depth_m {
            let problem = format!(
                "`dive.climb_to_m` ({}) is not above `dive.max_depth_m` ({})",
                mission.climb_to_m, mission.max_depth_m
            );
            return complaint("dive.climb_to_m", problem, "turn down again at a smaller depth");
        }
        if mission.descent.ballast_m3 >= mission.ascent.ballast_m3 {
            let problem = format!(
                "`glide.ballast_down_cc` ({}) is not below `glide.ballast_up_cc` ({})",
                mission.descent.ballast_m3 * 1e6,
                mission.ascent.ballast_m3 * 1e6
            );
            return complaint(
                "glide.ballast_down_cc",
                problem,
                "a larger ballast volume makes the glider more buoyant",
            );
        }
        Ok(())
    }

    /// A quantity against place: one number, or as many numbers as there are places; none where the file has it not.
    fn profile(&self, places: &'static str, scale: f64, values: &'static str) -> Result<Option<Profile>, InputError> {
        let Some(given) = self.values.get(values) else {
            return Ok(None);
        };
        let complaint = |path: &str, problem: String, help: &str| {
            Err(InputError::new(self.places[path].clone(), problem).help(help))
        };
        match self.values.get(places) {
            // One value, be it beside a list of places that was made for another quantity.
            _ if given.len() == 1 => Ok(Some(Profile::constant(given[0]))),
            None => {
                let problem = format!("`{values}` is a list of {} without `{places}`", given.len());
                complaint(values, problem, "state the places of the values, or one value for all")
            }
            Some(at) if at.len() != given.len() => {
                let problem = format!("`{values}` has {} values, `{places}` {}", given.len(), at.len());
                complaint(values, problem, "give each place one value")
            }
            Some(at) => match Profile::new(at.iter().map(|x| x * scale).collect(), given.clone()) {
                Some(profile) => Ok(Some(profile)),
                None => {
                    let problem = format!("`{places}` does not increase from value to value");
                    complaint(places, problem, "order the points by their place, each place once")
                }
            },
        }
    }

    fn given(&self, path: &str) -> Option<f64> {
        self.values.get(path).and_then(|values| values.first().copied())
    }

    fn default(&self, path: &str) -> Option<f64> {
        KEYS.iter().find(|key| key.path == path)?.default
    }

    /// A needed key, or one with a default.
    fn number(&self, path: &str) -> f64 {
        self.given(path).or_else(|| self.default(path)).unwrap_or(f64::NAN)
    }
}
