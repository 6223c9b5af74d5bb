//! Charts, drawn once for SVG and for PNG.
//!
//! A chart is a type with one generic method ([`Chart`]); [`save`] calls it for either kind of file. [`Lines`] serves for
//! most: lines, points and intervals over numbers or names. Letters are measured with the typeface that is built in, so a
//! chart comes out alike on every machine.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::style::{FontStyle, RGBColor, WHITE, register_font};

use crate::experiment::store::write_text;
use crate::files::FileError;

mod lines;

pub use lines::{Lines, Series};

/// What a chart is drawn on.
pub type Area<DB> = DrawingArea<DB, Shift>;
/// Whether it could be drawn.
pub type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

/// Something that draws itself alike on any kind of picture.
pub trait Chart {
    /// Draws on an area that is white.
    ///
    /// # Errors
    /// Those of the library of charts.
    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB>;
}

/// Typeface of all letters; use it as in `(FONT, 16)`.
pub const FONT: &str = "sans-serif";

/// Colours that people tell apart, those of the replay page first: blue, vermilion, green, pink, amber, sky, grey.
pub const COLORS: [RGBColor; 7] = [
    RGBColor(0x00, 0x72, 0xb2),
    RGBColor(0xd5, 0x5e, 0x00),
    RGBColor(0x00, 0x9e, 0x73),
    RGBColor(0xc7, 0x65, 0xa0),
    RGBColor(0xe6, 0x9f, 0x00),
    RGBColor(0x56, 0xb4, 0xe9),
    RGBColor(0x6b, 0x74, 0x82),
];
/// Colour of letters and axes.
pub const INK: RGBColor = RGBColor(0x1c, 0x24, 0x30);
/// Colour of the grid.
pub const GRID: RGBColor = RGBColor(0xe3, 0xe7, 0xec);

/// A chart that could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// A drawing that fails, such as a chart that is too small for its labels.
    #[error("chart cannot be drawn: {0}")]
    Draw(String),
    /// A file that cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
}

/// Makes the letters known, once.
pub(crate) fn fonts() -> Result<(), PlotError> {
    static FONTS: OnceLock<bool> = OnceLock::new();
    let known =
        *FONTS.get_or_init(|| register_font(FONT, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT).is_ok());
    if known { Ok(()) } else { Err(PlotError::Draw("the built-in typeface is damaged".to_owned())) }
}

/// A chart of `size` (width, height) pixels as SVG.
///
/// # Errors
/// Those of the chart.
pub fn svg(size: (u32, u32), chart: &impl Chart) -> Result<String, PlotError> {
    let mut text = String::new();
    paint(SVGBackend::with_string(&mut text, size), chart)?;
    Ok(text)
}

/// Writes a chart of `size` (width, height) pixels as PATH.svg and PATH.png, and gives their paths.
///
/// # Errors
/// Those of the chart, and files that cannot be written.
pub fn save(path: &Path, size: (u32, u32), chart: &impl Chart) -> Result<(PathBuf, PathBuf), PlotError> {
    // not `with_extension`: a name may have dots
    let with = |ending: &str| {
        let mut name = path.as_os_str().to_owned();
        name.push(ending);
        PathBuf::from(name)
    };
    let files = (with(".svg"), with(".png"));
    write_text(&files.0, &svg(size, chart)?)?;
    paint(BitMapBackend::new(&files.1, size), chart)?;
    Ok(files)
}

fn paint<DB: DrawingBackend>(backend: DB, chart: &impl Chart) -> Result<(), PlotError> {
    fonts()?;
    let area = backend.into_drawing_area();
    let draw = || {
        area.fill(&WHITE)?;
        chart.draw(&area)?;
        area.present()
    };
    draw().map_err(|error| PlotError::Draw(error.to_string()))
}

/// From the least to the greatest finite value, with a `share` of their distance more on either side; some range where
/// there is none.
pub fn span(values: impl IntoIterator<Item = f64>, share: f64) -> Range<f64> {
    let start = (f64::INFINITY, f64::NEG_INFINITY);
    let finite = values.into_iter().filter(|value| value.is_finite());
    let (low, high) = finite.fold(start, |(low, high), value| (low.min(value), high.max(value)));
    if low > high {
        return 0.0..1.0;
    }
    let room = if high > low { share * (high - low) } else { 0.5 * low.abs().max(1.0) };
    low - room..high + room
}
