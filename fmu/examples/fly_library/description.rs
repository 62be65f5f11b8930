//! What an importer needs of a modelDescription.xml.

use std::collections::HashMap;
use std::error::Error;

/// Token and variables of one archive.
pub struct Description {
    pub model: String,
    /// 2 or 3.
    pub version: u8,
    pub token: String,
    pub n_states: usize,
    /// The numbers among the outputs.
    pub outputs: Vec<u32>,
    references: HashMap<String, u32>,
}

impl Description {
    pub fn read(path: &str) -> Result<Self, Box<dyn Error>> {
        let text = std::fs::read_to_string(path).map_err(|error| format!("{path}: {error}"))?;
        let head = text.lines().find(|line| line.contains("<fmiModelDescription")).ok_or("no description")?;
        let get = |name| attribute(head, name).map(str::to_owned).ok_or_else(|| format!("{path}: no {name}"));
        let version = if get("fmiVersion")?.starts_with('2') { 2 } else { 3 };
        let mut references = HashMap::new();
        let mut outputs = Vec::new();
        let mut n_states = 0;
        // In FMI 2.0 the type is a line of its own.
        let variables = text.split_once("<ModelVariables>").ok_or("no variables")?.1.split_once("</ModelVariables>");
        let lines: Vec<&str> = variables.ok_or("no end of the variables")?.0.lines().collect();
        for (i, line) in lines.iter().enumerate() {
            let Some(reference) = attribute(line, "valueReference") else { continue };
            let reference = reference.parse()?;
            let name = attribute(line, "name").ok_or("modelDescription.xml: a variable has no attribute `name`")?;
            let kind = if version == 2 { lines[i + 1] } else { line };
            let is_number = kind.contains("<Real") || kind.contains("<Float64");
            n_states += usize::from(attribute(kind, "derivative").is_some());
            if is_number && attribute(line, "causality") == Some("output") {
                outputs.push(reference);
            }
            references.insert(name.to_owned(), reference);
        }
        let token = get(if version == 2 { "guid" } else { "instantiationToken" })?;
        Ok(Description { model: get("modelName")?, version, token, n_states, outputs, references })
    }

    pub fn has(&self, name: &str) -> bool {
        self.references.contains_key(name)
    }

    pub fn reference(&self, name: &str) -> u32 {
        *self.references.get(name).unwrap_or_else(|| panic!("no variable {name}"))
    }
}

fn attribute<'a>(element: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = element.split_once(&format!(" {name}=\""))?;
    rest.split_once('"').map(|(value, _)| value)
}
