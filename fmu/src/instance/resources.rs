//! What travels in the archive: the vehicle, `resources/vehicle.toml`, and a water column, `resources/water_column.csv`.

use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use glidepolar_environment::WaterColumn;
use glidepolar_fmu_resources::token::{resources_hash, resources_of_mark};

use super::log::Log;
use super::refusal::{Outcome, Refusal};
use crate::model::Model;
use crate::model::vehicle::Vehicle;

/// File in the resources folder that describes the vehicle.
pub const VEHICLE_FILE: &str = "vehicle.toml";

/// File in the resources folder that describes the water against depth.
pub const COLUMN_FILE: &str = "water_column.csv";

/// The vehicle of a new instance, after a look at the name and the token that the importer gave.
///
/// # Errors
/// Where the archive and this library do not belong together, or its vehicle cannot be used.
pub fn chosen(name: &str, given: &str, folder: Option<&Path>, log: &Log) -> Outcome<Vehicle> {
    if name.is_empty() {
        return Err(Refusal::error("the instance has no name; give it one"));
    }
    let Some((model, expected)) = carries_vehicle(given) else {
        return Err(Refusal::error(format!(
            "the token (guid) \"{given}\" is not that of this binary; modelDescription.xml and binary come from different builds"
        )));
    };
    let vehicle = vehicle(model, folder, expected).map_err(Refusal::error)?;
    log.event(&format!("the vehicle is \"{}\"", vehicle.name));
    Ok(vehicle)
}

/// The model of this library whose token it is, and whether the archive says that it carries its own vehicle.
pub fn carries_vehicle(given: &str) -> Option<(Model, bool)> {
    match Model::of_token(given.trim())? {
        (model, "") => Some((model, false)),
        (model, mark) => resources_of_mark(mark).map(|_| (model, true)),
    }
}

/// The vehicle in this folder, or the default one where there is none and none is expected.
///
/// # Errors
/// Where there is a vehicle file that cannot be used, or one is expected and missing: no other vehicle may silently take
/// its place.
pub fn vehicle(model: Model, folder: Option<&Path>, expected: bool) -> Result<Vehicle, String> {
    let missing = |why: String| {
        let advice = "instantiate with the path of the resources folder of the unpacked archive";
        if expected {
            Err(format!("this FMU carries a vehicle of its own, but {why}; {advice}"))
        } else {
            Ok(Vehicle::built_in(model))
        }
    };
    let Some(folder) = folder else {
        return missing("the importer gave no resource path".to_owned());
    };
    let path = folder.join(VEHICLE_FILE);
    let Some(text) = text_of(&path)? else {
        return missing(format!("{} does not exist", path.display()));
    };
    let vehicle = Vehicle::parse(model, &text, &path)?;
    let path = folder.join(COLUMN_FILE);
    let Some(column) = text_of(&path)? else { return Ok(vehicle) };
    let resources = resources_hash(&text, Some(&column));
    let column = WaterColumn::parse(&column, &path).map_err(|error| error.to_string())?;
    Ok(Vehicle { resources, ..vehicle.in_water(column) })
}

/// The text of this file, if there is one.
fn text_of(path: &Path) -> Result<Option<String>, String> {
    match std::fs::read_to_string(path) {
        Ok(text) => Ok(Some(text)),
        // Whatever is given as a folder and is none has no files in it.
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => Ok(None),
        Err(error) => Err(format!("{} cannot be read: {error}", path.display())),
    }
}

/// The folder that a resource URI names (RFC 3986 `file:` URIs, percent-encoded); a plain path is taken as it is.
///
/// # Errors
/// Where it is a URI of another kind.
pub fn folder_of_uri(uri: &str) -> Result<PathBuf, String> {
    let lower = uri.get(..5).unwrap_or_default().to_ascii_lowercase();
    if lower != "file:" {
        return match uri.split_once("://") {
            Some((scheme, _)) => Err(format!("the resource location {uri} is of scheme {scheme}, expected file")),
            None => Ok(PathBuf::from(uri)),
        };
    }
    let rest = &uri[5..];
    let path = match rest.strip_prefix("//") {
        // What stands before the next slash is a host; only this one can be meant.
        Some(with_host) => with_host.find('/').map_or("/", |slash| &with_host[slash..]),
        None => rest,
    };
    let decoded = percent_decoded(path);
    // file:///C:/folder names C:/folder.
    let bytes = decoded.as_slice();
    let has_drive = bytes.len() > 2 && bytes[0] == b'/' && bytes[1].is_ascii_alphabetic() && bytes[2] == b':';
    Ok(path_of(if has_drive { bytes[1..].to_vec() } else { decoded }))
}

fn percent_decoded(text: &str) -> Vec<u8> {
    let bytes = text.as_bytes();
    let (mut decoded, mut i) = (Vec::with_capacity(bytes.len()), 0);
    while i < bytes.len() {
        let digits = bytes.get(i + 1..i + 3).filter(|pair| pair.iter().all(u8::is_ascii_hexdigit));
        let hex = digits.and_then(|pair| std::str::from_utf8(pair).ok());
        match (bytes[i], hex.and_then(|pair| u8::from_str_radix(pair, 16).ok())) {
            (b'%', Some(byte)) => {
                decoded.push(byte);
                i += 3;
            }
            (byte, _) => {
                decoded.push(byte);
                i += 1;
            }
        }
    }
    decoded
}

#[cfg(unix)]
fn path_of(bytes: Vec<u8>) -> PathBuf {
    use std::os::unix::ffi::OsStringExt;
    PathBuf::from(OsString::from_vec(bytes))
}

#[cfg(not(unix))]
fn path_of(bytes: Vec<u8>) -> PathBuf {
    PathBuf::from(OsString::from(String::from_utf8_lossy(&bytes).into_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glidepolar_fmu_resources::token::marked;

    #[test]
    fn uris_become_folders() {
        for (uri, folder) in [
            ("file:///tmp/my%20fmu/resources", "/tmp/my fmu/resources"),
            ("file:/tmp/resources", "/tmp/resources"),
            ("file://localhost/tmp/resources/", "/tmp/resources/"),
            ("FILE:///tmp/100%25", "/tmp/100%"),
            ("file:///C:/fmu/resources", "C:/fmu/resources"),
            ("/tmp/plain path", "/tmp/plain path"),
            ("file:///tmp/%zz%4", "/tmp/%zz%4"),
            ("file:///tmp/%+1", "/tmp/%+1"),
        ] {
            assert_eq!(folder_of_uri(uri).unwrap(), Path::new(folder), "{uri}");
        }
        assert!(folder_of_uri("http://example.org/resources").unwrap_err().contains("http"));
    }

    #[test]
    fn only_a_vehicle_that_was_promised_is_missed() {
        assert_eq!(vehicle(Model::Plane, None, false).unwrap().name, Vehicle::default().name);
        assert!(vehicle(Model::Space, None, true).unwrap_err().contains("no resource path"));
        let message = vehicle(Model::Plane, Some(Path::new("/no/such/folder")), true).unwrap_err();
        assert!(message.contains("/no/such/folder/vehicle.toml does not exist"), "{message}");
        for model in Model::ALL {
            let token = model.table().token;
            assert_eq!(carries_vehicle(token), Some((model, false)));
            assert_eq!(carries_vehicle(&marked(token, 5)), Some((model, true)));
            assert_eq!(carries_vehicle(&format!("{token}+vehicle")), None);
        }
        assert_eq!(carries_vehicle("{other}"), None);
    }
}
