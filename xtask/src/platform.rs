//! The platforms an FMU can carry binaries for, and what each standard calls their folders.

use std::path::PathBuf;

use anyhow::{Context, Result};

use crate::workspace::Workspace;

/// One platform. FMI 2.0 names folders for 32- and 64-bit x86 only and refers to the tuples of FMI 3.0 for everything
/// else (FMI 2.0.5, section 2.3; FMI 3.0, section 2.5.1.4.1).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Platform {
    /// FMI 3.0's folder below `binaries/`.
    pub fmi3: &'static str,
    /// FMI 2.0's folder below `binaries/`.
    pub fmi2: &'static str,
    /// Where importers older than FMI 2.0.4 look on this platform, used while no x86 binary claims the folder.
    pub fmi2_old: Option<&'static str>,
    /// What cargo builds it for.
    pub triple: &'static str,
    /// What it is built for on a machine of another platform, where the linker is zig's.
    pub crossed: &'static str,
    /// How cargo names a shared library: before and after its name.
    pub library: (&'static str, &'static str),
}

/// Every platform this project packs for.
pub const PLATFORMS: [Platform; 5] = [
    Platform {
        fmi3: "x86_64-linux",
        fmi2: "linux64",
        fmi2_old: None,
        triple: "x86_64-unknown-linux-gnu",
        crossed: "x86_64-unknown-linux-gnu",
        library: ("lib", ".so"),
    },
    Platform {
        fmi3: "aarch64-linux",
        fmi2: "aarch64-linux",
        fmi2_old: Some("linux64"),
        triple: "aarch64-unknown-linux-gnu",
        crossed: "aarch64-unknown-linux-gnu",
        library: ("lib", ".so"),
    },
    Platform {
        fmi3: "x86_64-windows",
        fmi2: "win64",
        fmi2_old: None,
        triple: "x86_64-pc-windows-msvc",
        crossed: "x86_64-pc-windows-gnu",
        library: ("", ".dll"),
    },
    Platform {
        fmi3: "x86_64-darwin",
        fmi2: "darwin64",
        fmi2_old: None,
        triple: "x86_64-apple-darwin",
        crossed: "x86_64-apple-darwin",
        library: ("lib", ".dylib"),
    },
    Platform {
        fmi3: "aarch64-darwin",
        fmi2: "aarch64-darwin",
        fmi2_old: Some("darwin64"),
        triple: "aarch64-apple-darwin",
        crossed: "aarch64-apple-darwin",
        library: ("lib", ".dylib"),
    },
];

impl Platform {
    /// The platform of this machine.
    pub fn host() -> Result<&'static Platform> {
        let os = match std::env::consts::OS {
            "macos" => "darwin",
            os => os,
        };
        let tuple = format!("{}-{os}", std::env::consts::ARCH);
        PLATFORMS.iter().find(|platform| platform.fmi3 == tuple).with_context(|| {
            let known: Vec<_> = PLATFORMS.iter().map(|platform| platform.fmi3).collect();
            format!("no FMU can be packed on {tuple}; known platforms are {}", known.join(", "))
        })
    }

    /// What the library is called inside an FMU.
    pub fn file_name(&self, identifier: &str) -> String {
        format!("{identifier}{}", self.library.1)
    }

    pub fn is_linux(&self) -> bool {
        self.library.1 == ".so"
    }
}

/// Flags that keep this machine out of the binary: no paths of it in the messages, on Windows no runtime library to
/// install first.
pub fn rustc_flags(workspace: &Workspace, host: &Platform) -> Vec<String> {
    let mut flags = vec![format!("--remap-path-prefix={}=glidepolar", workspace.path("").display())];
    let home = |variable: &str, below: &str| {
        std::env::var_os(variable).map(PathBuf::from).or_else(|| Some(std::env::home_dir()?.join(below)))
    };
    if let Some(cargo) = home("CARGO_HOME", ".cargo") {
        flags.push(format!("--remap-path-prefix={}=cargo", cargo.display()));
    }
    if host.triple.ends_with("windows-msvc") && cfg!(windows) {
        flags.push("-Ctarget-feature=+crt-static".to_owned());
    }
    flags
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folder_names_are_unique_in_each_standard() {
        for (index, one) in PLATFORMS.iter().enumerate() {
            for other in &PLATFORMS[index + 1..] {
                assert_ne!(one.fmi3, other.fmi3);
                assert_ne!(one.fmi2, other.fmi2);
                assert_ne!(one.triple, other.triple);
            }
        }
    }

    #[test]
    fn the_tests_run_on_a_known_platform() {
        let host = Platform::host().unwrap();
        assert!(host.triple.starts_with(std::env::consts::ARCH));
    }
}
