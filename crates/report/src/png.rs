//! Figures as PNG: the SVG, rasterised with the font that the program carries, so that it looks the same everywhere.

use super::figure::Figure;
use super::text::FONTS;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{self, fontdb};
use std::sync::{Arc, OnceLock};

/// Pixels in the file for one of the figure: 600 wide become 1800, 300 dots per inch in a column of 6 inches.
const SCALE: f32 = 3.0;

impl Figure {
    /// The figure as a PNG file.
    pub fn png(&self) -> Vec<u8> {
        rasterised(&self.svg()).unwrap_or_default()
    }
}

fn rasterised(svg: &str) -> Option<Vec<u8>> {
    let options = usvg::Options { fontdb: fonts(), ..Default::default() };
    let tree = usvg::Tree::from_str(svg, &options).ok()?;
    let size = tree.size();
    let mut pixels = Pixmap::new((size.width() * SCALE).ceil() as u32, (size.height() * SCALE).ceil() as u32)?;
    resvg::render(&tree, Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    pixels.encode_png().ok()
}

fn fonts() -> Arc<fontdb::Database> {
    static FONTS_READ: OnceLock<Arc<fontdb::Database>> = OnceLock::new();
    let read = || {
        let mut fonts = fontdb::Database::new();
        for (bytes, _) in FONTS {
            fonts.load_font_data(bytes.to_vec());
        }
        fonts.set_sans_serif_family("DejaVu Sans");
        Arc::new(fonts)
    };
    FONTS_READ.get_or_init(read).clone()
}
