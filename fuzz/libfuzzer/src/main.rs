//! One target of `glidepolar-fuzz` under libFuzzer: which one stands in `GLIDEPOLAR_FUZZ_TARGET`. In an empty folder
//! `GLIDEPOLAR_FUZZ_SEEDS` what the target begins with is written first.

#![no_main]

use std::sync::OnceLock;

use glidepolar_fuzz::{Target, target};
use libfuzzer_sys::fuzz_target;

static TARGET: OnceLock<&Target> = OnceLock::new();

fn chosen() -> &'static Target {
    let name = std::env::var("GLIDEPOLAR_FUZZ_TARGET").unwrap_or_default();
    let target = target(&name).unwrap_or_else(|| panic!("no target {name:?}"));
    if let Some(folder) = std::env::var_os("GLIDEPOLAR_FUZZ_SEEDS") {
        for (number, seed) in (target.seeds)().iter().enumerate() {
            let path = std::path::Path::new(&folder).join(format!("seed-{number}"));
            std::fs::write(&path, seed).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        }
    }
    if target.catches_panics {
        // Panics that the code under test catches are no finding; one that gets out still ends the process.
        drop(std::panic::take_hook());
    }
    target
}

fuzz_target!(
    init: TARGET.get_or_init(chosen),
    |data: &[u8]| {
        if let Some(target) = TARGET.get() {
            (target.run)(data);
        }
    }
);
