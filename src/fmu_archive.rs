//! A vehicle packed as an FMU without a compiler: the built library stays as it is, the vehicle goes into the archive's
//! resources, and the start values of the model description follow it.
//!
//! Works on an archive that `cargo xtask fmu` packed. Knows of the FMU its folders and how its description is written.

use glidepolar_archive::Archive;
use glidepolar_fmu_resources::NOT_PUBLISHED;

use crate::dynamics::empirical::PARAMETERS as EMPIRICAL;
use crate::dynamics::{Inputs, PARAMETERS, Parameters};
use crate::fmu_page;
use crate::fmu_token::{marked, resources_hash};
use crate::glide::{Start, start, start_in};
use crate::spatial::steering::with_gains;
use crate::spatial::{self as space, Body, LATERAL};
use crate::vehicle::{MissingKeys, Vehicle};
use crate::water::WaterColumn;

const DESCRIPTION: &str = "modelDescription.xml";
const VEHICLE: &str = "resources/vehicle.toml";
const COLUMN: &str = "resources/water_column.csv";
const PAGE: &str = "documentation/index.html";

/// What the description of the glider in six degrees of freedom says, and no other.
const SPACE: &str = "modelName=\"UnderwaterGlider3D\"";

/// A water column with the text that it was read from.
#[derive(Debug, Clone, Copy)]
pub struct Water<'a> {
    /// The column.
    pub column: &'a WaterColumn,
    /// The text of its table.
    pub text: &'a str,
}

/// Why a vehicle could not be packed.
#[derive(Debug, thiserror::Error)]
pub enum PackError {
    /// The template is not one of this project's FMUs.
    #[error("the template is no FMU of this project: {0}; pack one with `cargo xtask fmu`")]
    Template(String),
    /// The vehicle file lacks what motion needs.
    #[error(transparent)]
    MissingKeys(#[from] MissingKeys),
    /// A figure of the vehicle lies outside what the FMU takes.
    #[error("{name} = {value} {unit} lies outside the FMU's bounds, {min} to {max}")]
    OutOfBounds {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Its unit.
        unit: &'static str,
        /// Smallest value.
        min: f64,
        /// Largest value.
        max: f64,
    },
}

/// The template with this vehicle in it, in this water where one travels along.
///
/// # Errors
/// Where the template is none, or the vehicle cannot fly in it.
pub fn pack(template: &Archive, vehicle: &Vehicle, water: Option<Water<'_>>) -> Result<Archive, PackError> {
    let description = template.get(DESCRIPTION).unwrap_or_default();
    let flies_in_space = String::from_utf8_lossy(description).contains(SPACE);
    let starts = match flies_in_space {
        true => starts_in_space(&with_gains(&vehicle.body()?), water),
        false => starts(&vehicle.parameters()?, water),
    };
    let parameters = if flies_in_space { vehicle.body()?.plane } else { vehicle.parameters()? };
    check_bounds(&starts)?;
    let text = |name: &str| {
        let bytes = template.get(name).ok_or_else(|| PackError::Template(format!("it has no {name}")))?;
        String::from_utf8(bytes.to_vec()).map_err(|_| PackError::Template(format!("{name} is not UTF-8")))
    };
    let mut description = Description::read(&text(DESCRIPTION)?);
    let toml = vehicle.to_toml();
    description.mark_own_vehicle(resources_hash(&toml, water.map(|water| water.text)))?;
    for (name, value) in &starts {
        description.set_start(name, &written(*value))?;
    }
    description.set_start("water_source", if water.is_some() { "1" } else { "0" })?;
    description.set_text_if_stated("vehicle_name", &vehicle.name);

    let page = page(&text(PAGE)?, &vehicle.name, (&parameters, &starts), water, description.stop_time_s());
    let mut archive = template.clone();
    let mut insert = |name: &str, contents: String| {
        archive.insert(name, contents).map_err(|fault| PackError::Template(fault.to_string()))
    };
    insert(DESCRIPTION, description.text())?;
    insert(VEHICLE, toml)?;
    insert(PAGE, page)?;
    match water {
        Some(water) => insert(COLUMN, water.text.to_owned())?,
        None => drop(archive.remove(COLUMN)),
    }
    Ok(archive)
}

fn check_bounds(starts: &[(&'static str, f64)]) -> Result<(), PackError> {
    let row_of = |name: &str| PARAMETERS.iter().chain(LATERAL).find(|row| row.name == name);
    for (row, value) in starts.iter().filter_map(|(name, value)| row_of(name).zip(Some(*value))) {
        if !(row.min..=row.max).contains(&value) {
            let (name, unit, min, max) = (row.name, row.unit, row.min, row.max);
            return Err(PackError::OutOfBounds { name, value, unit, min, max });
        }
    }
    Ok(())
}

fn start_of(parameters: &Parameters<f64>, water: Option<Water<'_>>) -> Start {
    match water {
        Some(water) => start_in(parameters, |depth_m| water.column.at(depth_m)),
        None => start(parameters),
    }
}

/// Whether the packed glider starts at rest, since no steady glide down is within its reach.
///
/// # Errors
/// Where the vehicle file lacks what motion needs.
pub fn starts_at_rest(vehicle: &Vehicle, water: Option<Water<'_>>) -> Result<bool, MissingKeys> {
    Ok(start_of(&vehicle.parameters()?, water).is_at_rest())
}

/// Every start value that follows from the vehicle and its water, by the FMU's name for it.
fn starts(parameters: &Parameters<f64>, water: Option<Water<'_>>) -> Vec<(&'static str, f64)> {
    let Start { state, inputs } = start_of(parameters, water);
    let published = PARAMETERS.iter().zip(parameters.as_array()).filter(|(row, _)| !NOT_PUBLISHED.contains(&row.name));
    let mut starts: Vec<_> = published.map(|(row, value)| (row.name, value)).collect();
    starts.extend(Inputs::NAMES.iter().copied().zip(inputs.as_array()));
    starts.extend([
        ("x_m", state.x_m),
        ("depth_m", state.depth_m),
        ("pitch_rad", state.pitch_rad),
        ("pitch_rate_rad_s", state.pitch_rate_rad_s),
        ("v1_m_s", state.v1_m_s),
        ("v3_m_s", state.v3_m_s),
        ("moving_mass_position_m", state.moving_mass_1_m),
        ("moving_mass_position_3_m", state.moving_mass_3_m),
        ("PP1_kg_m_s", state.momentum_1_kg_m_s),
        ("PP3_kg_m_s", state.momentum_3_kg_m_s),
        ("ballast_mass_kg", state.ballast_mass_kg),
        ("energy_J", state.energy_J),
        ("creep_pressure_Pa", state.creep_pressure_Pa),
        ("carried_density_kg_m3", state.carried_density_kg_m3),
        ("late_temperature_K", state.late_temperature_K),
        ("leaked_back_m3", state.leaked_back_m3),
    ]);
    starts
}

/// The same of the glider in space.
fn starts_in_space(body: &Body<f64>, water: Option<Water<'_>>) -> Vec<(&'static str, f64)> {
    let start = start_of(&body.plane, water);
    let (state, inputs) = (space::State::in_glide(&start.state), space::Inputs::in_glide(&start.inputs));
    let names_of_states = space::State::<f64>::NAMES.iter().map(|name| match *name {
        "moving_mass_m" => "moving_mass_position_m",
        "roll_mass_rate_rad_s" => "roll_mass_speed_rad_s",
        name => name,
    });
    // The empirical table is that of the plane.
    let is_published = |name: &str| !NOT_PUBLISHED.contains(&name) && !EMPIRICAL.contains(&name);
    let plane = PARAMETERS.iter().zip(body.plane.as_array()).filter(|(row, _)| is_published(row.name));
    let parameters = plane.chain(LATERAL.iter().zip(body.lateral.as_array())).map(|(row, value)| (row.name, value));
    let inputs = space::Inputs::<f64>::NAMES.iter().copied().zip(inputs.as_array());
    parameters.chain(inputs).chain(names_of_states.zip(state.as_array())).collect()
}

/// A number in the shortest form that reads back as the same number.
fn written(value: f64) -> String {
    format!("{value:?}").trim_end_matches(".0").to_owned()
}

/// A model description, line by line: each element stands on a line of its own, as the FMU's generator writes it.
struct Description {
    lines: Vec<String>,
}

impl Description {
    fn read(text: &str) -> Self {
        Description { lines: text.lines().map(str::to_owned).collect() }
    }

    fn text(self) -> String {
        self.lines.join("\n") + "\n"
    }

    /// Marks the token, which FMI 2.0 calls guid, with the resources that are packed: the library then knows that its
    /// defaults are not what the description says, and importers that these are different FMUs.
    fn mark_own_vehicle(&mut self, resources: u64) -> Result<(), PackError> {
        let root = self.lines.iter_mut().find(|line| line.contains("<fmiModelDescription"));
        let root = root.ok_or_else(|| PackError::Template("its description has no root element".to_owned()))?;
        for attribute in ["guid", "instantiationToken"] {
            if let Some(token) = attribute_of(root, attribute) {
                let token = marked(token, resources);
                set_attribute(root, attribute, &token);
                return Ok(());
            }
        }
        Err(PackError::Template("its description has no token".to_owned()))
    }

    /// How long the run is that the description proposes \[s\].
    fn stop_time_s(&self) -> f64 {
        let stated = self.lines.iter().find_map(|line| attribute_of(line, "stopTime"));
        stated.and_then(|text| text.parse().ok()).unwrap_or(600.0)
    }

    /// Sets the start value of a variable: an attribute of its element in FMI 3.0, of the element below it in FMI 2.0.
    fn set_start(&mut self, name: &str, value: &str) -> Result<(), PackError> {
        let mark = format!(" name=\"{name}\"");
        let place = self.lines.iter().position(|line| line.contains(&mark));
        let lines = place.map(|place| &mut self.lines[place..]).unwrap_or_default();
        match lines.iter_mut().take(2).find(|line| attribute_of(line, "start").is_some()) {
            Some(line) => {
                set_attribute(line, "start", value);
                Ok(())
            }
            None => Err(PackError::Template(format!("its description gives {name} no start value"))),
        }
    }

    /// Sets the start of a text, where the description states one.
    fn set_text_if_stated(&mut self, name: &str, value: &str) {
        let mark = format!(" name=\"{name}\"");
        let Some(place) = self.lines.iter().position(|line| line.contains(&mark)) else { return };
        // What follows an element without content is another variable's.
        let own = if self.lines[place].trim_end().ends_with("/>") { 1 } else { 2 };
        for line in self.lines[place..].iter_mut().take(own) {
            let attribute = if line.contains("<Start ") { "value" } else { "start" };
            if attribute_of(line, attribute).is_some() {
                set_attribute(line, attribute, &escaped(value));
            }
        }
    }
}

/// The value of an attribute, as it stands between its quotes.
fn attribute_of<'a>(line: &'a str, attribute: &str) -> Option<&'a str> {
    let (_, rest) = line.split_once(&format!(" {attribute}=\""))?;
    rest.split_once('"').map(|(value, _)| value)
}

fn set_attribute(line: &mut String, attribute: &str, value: &str) {
    let mark = format!(" {attribute}=\"");
    let range = line.split_once(&mark).and_then(|(before, rest)| {
        let from = before.len() + mark.len();
        rest.find('"').map(|length| from..from + length)
    });
    if let Some(range) = range {
        line.replace_range(range, value);
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The page with the figures of this vehicle, and a word at its top where there is more to say.
fn page(
    page: &str,
    name: &str,
    (parameters, starts): (&Parameters<f64>, &[(&'static str, f64)]),
    water: Option<Water<'_>>,
    stop_s: f64,
) -> String {
    let start = start_of(parameters, water);
    let mut page = page.to_owned();
    for (key, value) in fmu_page::figures(parameters, &start, water.map(|water| water.column), stop_s) {
        fill(&mut page, fmu_page::PROSE_MARK, key, &value);
    }
    fill(&mut page, fmu_page::PROSE_MARK, "vehicle", &escaped(name));
    for (variable, value) in starts {
        fill(&mut page, fmu_page::CELL_MARK, variable, &fmu_page::short(&written(*value)));
    }
    fill(&mut page, fmu_page::CELL_MARK, "water_source", if water.is_some() { "1" } else { "0" });
    fill(&mut page, fmu_page::CELL_MARK, "vehicle_name", &escaped(name));
    notice(&mut page, water.is_some(), start.is_at_rest());
    page
}

/// Replaces the text of every element that carries this mark.
fn fill(page: &mut String, mark: &str, key: &str, value: &str) {
    let mark = format!("{mark}=\"{key}\">");
    let mut from = 0;
    while let Some(found) = page[from..].find(&mark) {
        let begin = from + found + mark.len();
        let Some(length) = page[begin..].find('<') else { return };
        page.replace_range(begin..begin + length, value);
        from = begin + value.len();
    }
}

/// Says below the title what the prose cannot know: water of the archive's own, a glider that cannot glide.
fn notice(page: &mut String, has_water: bool, is_at_rest: bool) {
    const BEGIN: &str = "\n<p id=\"own-vehicle\">";
    const END: &str = "</p>";
    if let Some(begin) = page.find(BEGIN)
        && let Some(length) = page[begin..].find(END)
    {
        page.replace_range(begin..begin + length + END.len(), "");
    }
    let mut notice = String::new();
    if has_water {
        notice.push_str("This archive carries water of its own, <code>resources/water_column.csv</code>: the start is steady in it. ");
    }
    if is_at_rest {
        notice.push_str("<b>This vehicle has no steady glide within its limits: it starts level and at rest.</b>");
    }
    if let Some(title) = page.find("</h1>").filter(|_| !notice.is_empty()) {
        page.insert_str(title + "</h1>".len(), &format!("{BEGIN}{}{END}", notice.trim_end()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn template(standard: &str) -> Archive {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("modelDescription");
        let read = |path: &str| std::fs::read_to_string(folder.join(path)).unwrap();
        let mut archive = Archive::new();
        archive.insert(DESCRIPTION, read(&format!("{standard}/modelDescription.xml"))).unwrap();
        archive.insert(PAGE, read("documentation/index.html")).unwrap();
        archive.insert("binaries/x86_64-linux/UnderwaterGlider.so", "machine code").unwrap();
        archive
    }

    fn description(archive: &Archive) -> String {
        String::from_utf8(archive.get(DESCRIPTION).unwrap().to_vec()).unwrap()
    }

    fn stated(description: &str, name: &str) -> f64 {
        let (_, rest) = description.split_once(&format!(" name=\"{name}\"")).unwrap();
        attribute_of(rest, "start").unwrap().parse().unwrap()
    }

    #[test]
    fn a_vehicle_in_space_brings_its_lateral_figures_and_gains() {
        for standard in ["fmi2", "fmi3"] {
            let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("modelDescription/space");
            let read = |path: &str| std::fs::read_to_string(folder.join(path)).unwrap();
            let mut template = Archive::new();
            template.insert(DESCRIPTION, read(&format!("{standard}/modelDescription.xml"))).unwrap();
            template.insert(PAGE, read("documentation/index.html")).unwrap();
            let seaglider = Vehicle::load("seaglider").unwrap();
            let text = description(&pack(&template, &seaglider, None).unwrap());
            let body = with_gains(&seaglider.body().unwrap());
            assert_eq!(stated(&text, "CN_beta_per_rad"), body.lateral.CN_beta_per_rad);
            assert_eq!(stated(&text, "roll_mass_kg"), body.lateral.roll_mass_kg);
            // In FMI 3 it stands right behind the vehicle's name, which has no start there.
            assert_eq!(stated(&text, "pitch_move_J"), body.plane.pitch_move_J);
            let gains = ["heading_roll_gain_descent", "heading_roll_gain_ascent"].map(|name| stated(&text, name));
            assert!(gains[0] * gains[1] < 0.0, "a roll turns the other way on the other leg: {gains:?}");
            assert_eq!(stated(&text, "moving_mass_position_m"), start(&body.plane).state.moving_mass_1_m);
            assert!(matches!(pack(&template, &Vehicle::load("rogue").unwrap(), None), Err(PackError::MissingKeys(_))));
        }
    }

    #[test]
    fn start_values_are_those_of_the_vehicle_and_of_its_glide() {
        let rogue = Vehicle::load("rogue").unwrap();
        for standard in ["fmi2", "fmi3"] {
            let template = template(standard);
            let packed = pack(&template, &rogue, None).unwrap();
            let text = description(&packed);
            let start = start(&rogue.parameters().unwrap());
            assert_eq!(stated(&text, "hull_mass_kg"), 8.22);
            assert_eq!(stated(&text, "pitch_rad"), start.state.pitch_rad);
            assert_eq!(stated(&text, "moving_mass_command_m"), start.inputs.moving_mass_command_m);
            assert_eq!(stated(&text, "water_density_kg_m3"), 1000.0);
            let mark = marked("}", resources_hash(&rogue.to_toml(), None));
            assert!(text.contains(&format!("{mark}\"")), "{mark}");
            // Nothing but starts and the token differs: as many lines, the same names.
            assert_eq!(text.lines().count(), description(&template).lines().count());
            assert_eq!(packed.get(VEHICLE).unwrap(), rogue.to_toml().as_bytes());
            assert_eq!(packed.get("binaries/x86_64-linux/UnderwaterGlider.so"), Some(b"machine code".as_slice()));
            // Packed again, nothing is marked twice, and another vehicle gets its own mark.
            assert_eq!(pack(&packed, &rogue, None).unwrap(), packed);
            let slocum = Vehicle::load("slocum-graver").unwrap();
            assert_eq!(
                description(&pack(&packed, &slocum, None).unwrap()),
                description(&pack(&template, &slocum, None).unwrap())
            );
        }
    }

    #[test]
    fn the_default_vehicle_gives_the_template_s_own_starts() {
        let vehicle = Vehicle::load("slocum-graver").unwrap();
        let template = template("fmi3");
        let packed = pack(&template, &vehicle, None).unwrap();
        let mark = marked("", resources_hash(&vehicle.to_toml(), None));
        assert_eq!(description(&packed).replace(&mark, ""), description(&template));
        assert_eq!(packed.get(PAGE), template.get(PAGE));
    }

    #[test]
    fn water_that_travels_along_decides_the_start() {
        let table = "depth_m,density_kg_m3,temperature_C\n0,1020,15\n100,1028,5\n";
        let column = WaterColumn::parse(table, Path::new("water.csv")).unwrap();
        let vehicle = Vehicle::load("slocum-graver").unwrap();
        let water = Water { column: &column, text: table };
        let packed = pack(&template("fmi3"), &vehicle, Some(water)).unwrap();
        assert_eq!(packed.get(COLUMN), Some(table.as_bytes()));
        let text = description(&packed);
        assert_eq!(stated(&text, "water_source"), 1.0);
        assert_eq!(stated(&text, "water_density_kg_m3"), column.at(10.0).density_kg_m3);
        let page = String::from_utf8(packed.get(PAGE).unwrap().to_vec()).unwrap();
        assert!(page.contains("water of its own"));
        let density = fmu_page::short(&written(column.at(10.0).density_kg_m3));
        assert!(page.contains(&format!("data-start=\"water_density_kg_m3\">{density}<")), "{density}");
        assert_eq!(pack(&packed, &vehicle, None).unwrap().get(COLUMN), None);
    }

    #[test]
    fn the_page_tells_of_the_vehicle_that_is_packed() {
        let page = |vehicle: &str| {
            let packed = pack(&template("fmi2"), &Vehicle::load(vehicle).unwrap(), None).unwrap();
            String::from_utf8(packed.get(PAGE).unwrap().to_vec()).unwrap()
        };
        let rogue = page("rogue");
        // ROGUE glides at 30 deg where 25 deg would be asked of it, or whatever it can: read off its own description.
        let start = start(&Vehicle::load("rogue").unwrap().parameters().unwrap());
        let (pitch, mass) = (start.state.pitch_rad.to_degrees(), start.inputs.moving_mass_command_m);
        for expected in [
            format!("steady glide down: pitch {pitch:.1} deg, "),
            format!("data-fill=\"down_mass\">{mass:.5}<"),
            "data-start=\"hull_mass_kg\">8.22<".to_owned(),
            "data-start=\"water_density_kg_m3\">1000<".to_owned(),
        ] {
            assert!(rogue.contains(&expected), "{expected}");
        }
        // Every cell of a start value is one that packing fills, but for what is the FMU's own.
        let default = page("slocum-graver");
        let cells = |page: &str| page.matches("data-start=").count();
        assert_eq!(cells(&rogue), cells(&default));
        assert_eq!(rogue.matches("<td").count(), default.matches("<td").count());
        assert!(!rogue.contains("SLOCUM"), "a word of another vehicle");
    }

    #[test]
    fn the_page_tells_what_the_run_in_its_own_water_does() {
        let prose = |vehicle: &Vehicle, water: Option<Water<'_>>| {
            let packed = pack(&template("fmi3"), vehicle, water).unwrap();
            let page = String::from_utf8(packed.get(PAGE).unwrap().to_vec()).unwrap();
            let (_, rest) = page.split_once("data-fill=\"first_run\">").unwrap();
            rest.split_once('<').unwrap().0.to_owned()
        };
        let mut vehicle = Vehicle::load("slocum-graver").unwrap();
        assert!(prose(&vehicle, None).contains("Left alone, it is 86.1 m deep after 600 s, and goes on like that"));
        // Water that grows denser stops the dive where it carries the glider: by Archimedes, whatever the equations.
        let table = "depth_m,density_kg_m3,temperature_C\n0,1025,15\n20,1025,15\n40,1040,5\n";
        let column = WaterColumn::parse(table, Path::new("water.csv")).unwrap();
        let stopped = prose(&vehicle, Some(Water { column: &column, text: table }));
        let (_, rest) = stopped.split_once("it is ").unwrap();
        let depth: f64 = rest.split_once(" m deep after 600 s: ").unwrap().0.parse().unwrap();
        assert!((20.0..40.0).contains(&depth), "{stopped}");
        let start = start_in(&vehicle.parameters().unwrap(), |depth_m| column.at(depth_m));
        let displaced = 50.0 / 1027.0 + start.inputs.ballast_command_m3;
        assert!((column.at(depth).density_kg_m3 * displaced - 50.0).abs() < 0.05, "{stopped}");
        // A buoyancy engine too small for any glide.
        vehicle.set("ballast.min_cc", -1.0).unwrap();
        vehicle.set("ballast.max_cc", 1.0).unwrap();
        assert!(starts_at_rest(&vehicle, None).unwrap());
        let resting = prose(&vehicle, None);
        assert!(resting.contains("no steady glide down") && !resting.contains("without a transient"), "{resting}");
    }

    #[test]
    fn what_is_no_fmu_of_ours_is_refused() {
        let vehicle = Vehicle::load("rogue").unwrap();
        let error = pack(&Archive::new(), &vehicle, None).unwrap_err().to_string();
        assert!(error.contains("it has no modelDescription.xml"), "{error}");
        let mut other = template("fmi3");
        other.insert(DESCRIPTION, "<fmiModelDescription guid=\"x\">\n</fmiModelDescription>").unwrap();
        let error = pack(&other, &vehicle, None).unwrap_err().to_string();
        assert!(error.contains("no start value"), "{error}");
    }
}
