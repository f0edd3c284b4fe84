//! A drawing in pixels.

use std::sync::Arc;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

use super::FONT;
use crate::error::Error;

/// Renders an SVG, so many pixels for one of its own, as a PNG.
pub(super) fn render(svg: &str, zoom: f32) -> Result<Vec<u8>, Error> {
    let cannot = |why: String| Error::data(format!("the plot cannot be drawn: {why}"));
    let mut fonts = fontdb::Database::new();
    fonts.load_font_data(FONT.to_vec());
    let options =
        Options { fontdb: Arc::new(fonts), font_family: "Imu Sans".into(), ..Options::default() };
    let tree = Tree::from_str(svg, &options).map_err(|e| cannot(e.to_string()))?;
    let size = tree.size().to_int_size().scale_by(zoom);
    let pixels = size.and_then(|size| Pixmap::new(size.width(), size.height()));
    let mut pixels = pixels.ok_or_else(|| cannot("it is too large".into()))?;
    resvg::render(&tree, Transform::from_scale(zoom, zoom), &mut pixels.as_mut());
    pixels.encode_png().map_err(|e| cannot(e.to_string()))
}
