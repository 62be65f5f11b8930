//! Writes the generated files below `modelDescription/` anew.

use std::path::Path;

fn main() -> std::io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../modelDescription");
    for (path, text) in glidepolar_fmu::description::files() {
        let path = folder.join(path);
        std::fs::create_dir_all(path.parent().expect("a file in a folder"))?;
        std::fs::write(&path, text)?;
    }
    Ok(())
}
