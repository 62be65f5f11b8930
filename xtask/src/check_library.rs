//! Whether a built shared library will load on other people's machines: what it needs, and from how new a C library.

use std::collections::BTreeMap;
use std::fmt;

use anyhow::{Context, Result, bail};
use object::read::elf::{ElfFile64, FileHeader};
use object::read::{ImportFlags, NameOrOrdinal};
use object::{Architecture, BinaryFormat, Endianness, File, Object};

use crate::platform::Platform;

/// The newest C library that the packed Linux binary may ask for: that of Debian 10, Ubuntu 18.10 and RHEL 8.
pub const OLDEST_GLIBC: GlibcVersion = GlibcVersion([2, 28, 0]);

/// The C library's own parts, by the names they are loaded by; nothing else is on every Linux machine.
const PARTS_OF_GLIBC: [&str; 5] = ["libc.so", "libm.so", "libpthread.so", "libdl.so", "ld-linux"];

/// One function of each standard and interface. Whether all are there is for the tests of the FMU to say; without these
/// the file is no FMU's library at all.
const EXPORTS: [&str; 3] = ["fmi2Instantiate", "fmi3InstantiateCoSimulation", "fmi3InstantiateModelExchange"];

/// Mathematical functions whose last place each C library has its own way. The equations have theirs compiled in, so that
/// all platforms fly alike; `pow` alone may be asked for, by a crate whose step sizes are rounded.
const MATHEMATICS: [&str; 19] = [
    "sin", "cos", "tan", "sincos", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp", "exp2", "expm1",
    "log", "log2", "log10", "log1p", "hypot",
];

/// A version of the GNU C library, as in `GLIBC_2.28`.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct GlibcVersion([u32; 3]);

impl GlibcVersion {
    /// Reads `GLIBC_2.2.5` and the like; `None` for a name that is no numbered version of the C library.
    fn parse(name: &str) -> Option<Self> {
        let mut numbers = [0; 3];
        let parts: Vec<&str> = name.strip_prefix("GLIBC_")?.split('.').collect();
        if !(2..=3).contains(&parts.len()) {
            return None;
        }
        for (number, part) in numbers.iter_mut().zip(parts) {
            *number = part.parse().ok()?;
        }
        Some(Self(numbers))
    }
}

impl fmt::Display for GlibcVersion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [major, minor, patch] = self.0;
        write!(f, "{major}.{minor}")?;
        if patch == 0 { Ok(()) } else { write!(f, ".{patch}") }
    }
}

/// Fails unless the library exports the functions of an FMU.
pub fn check_exports(library: &[u8]) -> Result<()> {
    let file = File::parse(library).context("the built library cannot be read")?;
    let mut missing: Vec<&str> = EXPORTS.to_vec();
    for export in file.exports()? {
        let export = export?;
        if let NameOrOrdinal::Name(name) = export.name() {
            // On macOS names begin with an underscore.
            let is_mach = file.format() == BinaryFormat::MachO;
            let name = name.strip_prefix(b"_").filter(|_| is_mach).unwrap_or(name);
            missing.retain(|wanted| wanted.as_bytes() != name);
        }
    }
    if !missing.is_empty() {
        bail!("the built library does not export {}: it is no FMU's library", missing.join(", "));
    }
    Ok(())
}

/// Fails if the library asks the system for a mathematical function: flights would differ between platforms.
pub fn check_mathematics(library: &[u8]) -> Result<()> {
    let file = File::parse(library).context("the built library cannot be read")?;
    let mut asked = Vec::new();
    for import in file.imports()? {
        if let NameOrOrdinal::Name(name) = import?.name() {
            let name = String::from_utf8_lossy(name).into_owned();
            let plain = name.trim_start_matches('_');
            if MATHEMATICS.contains(&plain.split('@').next().unwrap_or(plain)) {
                asked.push(name);
            }
        }
    }
    if !asked.is_empty() {
        bail!(
            "the built library takes {} from the system, so that its flights depend on the platform: call \
             `glidepolar_number::functions` in the equations",
            asked.join(", ")
        );
    }
    Ok(())
}

/// Whether this is a library for that platform at all, by its own header.
pub fn is_built_for(library: &[u8], platform: &Platform) -> bool {
    let Ok(file) = File::parse(library) else {
        return false;
    };
    let (machine, system) = platform.fmi3.split_once('-').unwrap_or_default();
    let machine_fits = match machine {
        "x86_64" => file.architecture() == Architecture::X86_64,
        "aarch64" => file.architecture() == Architecture::Aarch64,
        _ => false,
    };
    let system_fits = match system {
        "linux" => file.format() == BinaryFormat::Elf,
        "windows" => file.format() == BinaryFormat::Pe,
        "darwin" => file.format() == BinaryFormat::MachO,
        _ => false,
    };
    machine_fits && system_fits
}

/// What keeps a Linux library from loading on a machine with [`OLDEST_GLIBC`] and nothing beside it, in words; empty if
/// nothing does.
pub fn portability_faults(library: &[u8]) -> Result<Vec<String>> {
    let needs = Needs::read(library)?;
    let mut faults = Vec::new();
    for library in &needs.libraries {
        if !PARTS_OF_GLIBC.iter().any(|part| library.starts_with(part)) {
            faults.push(format!("it needs {library}, which is no part of the C library"));
        }
    }
    for (version, symbols) in &needs.versions {
        let symbols = if symbols.is_empty() { "the loader".to_owned() } else { symbols.join(", ") };
        match GlibcVersion::parse(version) {
            Some(found) if found > OLDEST_GLIBC => {
                faults.push(format!("it needs glibc {found} or newer (for {symbols}); the limit is {OLDEST_GLIBC}"));
            }
            None if version.starts_with("GLIBC_") => {
                faults
                    .push(format!("it needs {version} (for {symbols}), which only newer or special C libraries have"));
            }
            _ => {}
        }
    }
    Ok(faults)
}

/// The newest numbered version of the C library that a Linux library asks for.
pub fn newest_glibc(library: &[u8]) -> Result<Option<GlibcVersion>> {
    Ok(Needs::read(library)?.versions.keys().filter_map(|name| GlibcVersion::parse(name)).max())
}

/// What an ELF library asks the loader for.
struct Needs {
    libraries: Vec<String>,
    /// Symbol versions, each with the symbols that need it. A version without symbols is one that the loader itself
    /// must know, as `GLIBC_ABI_DT_RELR`.
    versions: BTreeMap<String, Vec<String>>,
}

impl Needs {
    fn read(library: &[u8]) -> Result<Self> {
        let file = ElfFile64::<Endianness>::parse(library).context("not a 64-bit ELF library")?;
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();

        let mut libraries = Vec::new();
        for library in file.import_libraries()? {
            libraries.push(text(library?.name()));
        }

        let mut versions: BTreeMap<String, Vec<String>> = BTreeMap::new();
        let (endian, data) = (file.endian(), file.data());
        let sections = file.elf_header().sections(endian, data)?;
        if let Some((needs, strings)) = sections.gnu_verneed(endian, data)? {
            let strings = sections.strings(endian, data, strings)?;
            for need in needs {
                let (_, required) = need?;
                for version in required {
                    versions.entry(text(version?.name(endian, strings)?)).or_default();
                }
            }
        }
        for import in file.imports()? {
            let import = import?;
            if let (NameOrOrdinal::Name(name), ImportFlags::Elf { version: Some(version), .. }) =
                (import.name(), import.flags())
            {
                versions.entry(text(version)).or_default().push(text(name));
            }
        }
        Ok(Self { libraries, versions })
    }
}

/// Fails if a library that was linked to load everywhere does not.
pub fn check_portable(name: &str, library: &[u8]) -> Result<()> {
    let faults = portability_faults(library)?;
    if !faults.is_empty() {
        bail!("{name} does not load on every Linux machine:\n  - {}", faults.join("\n  - "));
    }
    let newest = newest_glibc(library)?.map_or_else(|| "any".to_owned(), |version| version.to_string());
    eprintln!("{name} needs nothing but glibc {newest} or newer");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::PLATFORMS;

    #[test]
    fn versions_are_compared_as_numbers() {
        let version = |name| GlibcVersion::parse(name).unwrap();
        assert!(version("GLIBC_2.9") < version("GLIBC_2.28"));
        assert!(version("GLIBC_2.2.5") < version("GLIBC_2.3"));
        assert!(version("GLIBC_2.34") > OLDEST_GLIBC);
        assert!(version("GLIBC_2.28") == OLDEST_GLIBC);
        assert_eq!(version("GLIBC_2.2.5").to_string(), "2.2.5");
        assert_eq!(version("GLIBC_2.28").to_string(), "2.28");
    }

    #[test]
    fn other_names_are_no_versions() {
        for name in
            ["GLIBC_PRIVATE", "GLIBC_ABI_DT_RELR", "GCC_3.0", "GLIBC_2", "GLIBC_2.", "GLIBC_2.3.4.5", "", "2.28"]
        {
            assert!(GlibcVersion::parse(name).is_none(), "{name}");
        }
    }

    /// This very test program is built by plain cargo against the machine's own C library, and a Rust program needs
    /// libgcc_s for unwinding: it must be found out.
    #[test]
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    fn a_plain_build_is_found_to_need_libgcc() {
        let program = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        let faults = portability_faults(&program).unwrap();
        assert!(faults.iter().any(|fault| fault.contains("libgcc_s.so.1")), "{faults:?}");
        assert!(newest_glibc(&program).unwrap().is_some());
        assert!(check_exports(&program).is_err());
    }

    /// This very test program asks for a sine.
    #[test]
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    fn a_library_with_the_systems_sine_is_found() {
        let zero = std::hint::black_box(0.0_f64).sin();
        let program = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        let error = check_mathematics(&program).unwrap_err().to_string();
        assert!(zero == 0.0 && error.contains("takes ") && error.contains("sin"), "{error}");
    }

    #[test]
    fn a_program_is_distinguished_from_one_for_another_platform() {
        let program = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        let host = Platform::host().unwrap();
        for platform in &PLATFORMS {
            assert_eq!(is_built_for(&program, platform), platform == host, "{}", platform.fmi3);
        }
        assert!(!is_built_for(b"not a program", host));
    }

    #[test]
    fn something_else_than_a_library_is_an_error() {
        assert!(portability_faults(b"#!/bin/sh").is_err());
        assert!(check_exports(b"").is_err());
    }
}
