//! What tells one packed vehicle from another: a hash of the files in an FMU's resources, which ends its token and begins
//! its saved states. One source for the program that packs and the library that is packed.

/// What a token of an archive with a vehicle of its own has behind the library's own token.
pub const OWN_VEHICLE: &str = "+vehicle";

/// A number for these resources: the text of the vehicle file and that of the water column, where one travels along.
pub fn resources_hash(vehicle: &str, column: Option<&str>) -> u64 {
    // FNV-1a: stable across compilers and machines. No text holds a zero byte, so the two cannot run into each other.
    let column = column.map(|text| [&[0], text.as_bytes()].concat()).unwrap_or_default();
    let bytes = vehicle.bytes().chain(column);
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

/// The library's token with the mark of these resources behind it; a mark that it has already is replaced.
pub fn marked(token: &str, resources: u64) -> String {
    let plain = token.split_once(OWN_VEHICLE).map_or(token, |(plain, _)| plain);
    format!("{plain}{OWN_VEHICLE}-{resources:016x}")
}

/// The resources that a mark, what stands behind the library's token, tells of; none where it is no such mark.
pub fn resources_of_mark(mark: &str) -> Option<u64> {
    let digits = mark.strip_prefix(OWN_VEHICLE)?.strip_prefix('-')?;
    let is_hex = digits.len() == 16 && digits.bytes().all(|byte| byte.is_ascii_hexdigit());
    is_hex.then(|| u64::from_str_radix(digits, 16).ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mark_tells_of_its_resources() {
        let resources = [("a", None), ("b", None), ("a", Some("c")), ("ac", None), ("a", Some(""))];
        let hashes = resources.map(|(vehicle, column)| resources_hash(vehicle, column));
        for (i, hash) in hashes.iter().enumerate() {
            assert!(!hashes[..i].contains(hash), "{:?}", resources[i]);
            let token = marked("{t}", *hash);
            assert_eq!(resources_of_mark(token.strip_prefix("{t}").unwrap()), Some(*hash));
            assert_eq!(marked(&token, 7), "{t}+vehicle-0000000000000007");
        }
        for wrong in ["", "+vehicle", "+vehicle-", "+vehicle-12", "+vehicle-+00000000000000f", "vehicle"] {
            assert_eq!(resources_of_mark(wrong), None, "{wrong}");
        }
    }
}
