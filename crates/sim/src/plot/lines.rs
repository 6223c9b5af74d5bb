//! Lines, points and intervals.

use plotters::backend::DrawingBackend;
use plotters::chart::{ChartBuilder, LabelAreaPosition};
use plotters::element::{Circle, PathElement, Rectangle};
use plotters::series::LineSeries;
use plotters::style::{Color, IntoFont, WHITE};

use super::{Area, COLORS, Chart, Drawn, FONT, GRID, INK, span};

/// A series of a chart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// What the legend calls it; no entry if empty.
    pub name: String,
    /// Points (x, y); over names, x is the place of the name, counted from 0.
    pub points: Vec<(f64, f64)>,
    /// Interval (low, high) of the y of each point; may be empty.
    pub intervals: Vec<(f64, f64)>,
    /// Whether a line joins the points.
    pub joined: bool,
    /// Whether the points are marked.
    pub marked: bool,
    /// Whether bars stand under the points.
    pub bars: bool,
}

/// A chart of series over numbers, or over names.
///
/// ```
/// use cohaul_sim::plot::{Lines, Series, svg};
///
/// let chart = Lines {
///     title: "Time over the mass of the load".into(),
///     x: "mass, kg".into(),
///     y: "median time, s".into(),
///     series: vec![Series {
///         name: "flat".into(),
///         points: vec![(1.0, 60.0), (2.0, 66.0), (3.0, 71.0)],
///         intervals: vec![(58.0, 61.0), (63.0, 68.0), (69.0, 74.0)],
///         joined: true,
///         marked: true,
///         ..Series::default()
///     }],
///     ..Lines::default()
/// };
/// let text = svg((640, 420), &chart)?;
/// assert!(text.starts_with("<svg") && text.contains("mass, kg"));
/// # Ok::<(), cohaul_sim::plot::PlotError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lines {
    /// Above the chart.
    pub title: String,
    /// Under the x axis.
    pub x: String,
    /// Beside the y axis.
    pub y: String,
    /// What x counts, where it is no number.
    pub names: Vec<String>,
    /// Least (first) and greatest value that the y axis shows at least; infinite for no wish.
    pub y_shows: Option<(f64, f64)>,
    /// The series.
    pub series: Vec<Series>,
}

impl Lines {
    fn ranges(&self) -> (std::ops::Range<f64>, std::ops::Range<f64>) {
        let points = || self.series.iter().flat_map(|series| series.points.iter().copied());
        let ends = self.series.iter().flat_map(|series| series.intervals.iter().flat_map(|(low, high)| [*low, *high]));
        let bars = self.series.iter().any(|series| series.bars).then_some(0.0);
        let wish = self.y_shows.into_iter().flat_map(|(low, high)| [low, high]);
        let mut y = span(points().map(|(_, y)| y).chain(ends).chain(bars).chain(wish.clone()), 0.06);
        // no room beyond what is asked for, where nothing is beyond it
        for bound in wish.chain(bars) {
            let near = 0.1 * (y.end - y.start);
            if bound > y.start && bound - y.start < near {
                y.start = bound;
            } else if bound < y.end && y.end - bound < near {
                y.end = bound;
            }
        }
        let x = if self.names.is_empty() {
            span(points().map(|(x, _)| x), 0.04)
        } else {
            -0.5..self.names.len() as f64 - 0.5
        };
        (x, y)
    }

    /// Pixels; 0 without a name.
    fn legend_width(&self) -> i32 {
        let longest = self.series.iter().map(|series| series.name.chars().count()).max().unwrap_or(0);
        if longest > 0 { 44 + 8 * longest as i32 } else { 0 }
    }

    fn legend<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB> {
        let style = (FONT, 15).into_font().color(&INK);
        let named = self.series.iter().zip(COLORS.iter().cycle()).filter(|(series, _)| !series.name.is_empty());
        for (line, (series, color)) in (0..).zip(named) {
            let y = 56 + 24 * line;
            area.draw(&PathElement::new([(4, y), (24, y)], color.stroke_width(3)))?;
            area.draw_text(&series.name, &style, (32, y - 7))?;
        }
        Ok(())
    }

    /// Sideways displacement of a series over names, so that intervals do not cover each other where no line joins them; and
    /// half the width of bars.
    fn shift(&self, series: usize) -> (f64, f64) {
        let count = self.series.len().max(1) as f64;
        let apart = !self.names.is_empty() && !self.series.iter().any(|series| series.joined);
        let step = if apart { 0.7 / count } else { 0.0 };
        ((series as f64 - (count - 1.0) / 2.0) * step, 0.42 * step)
    }
}

impl Chart for Lines {
    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB> {
        let (x, y) = self.ranges();
        let tick = 0.008 * (x.end - x.start) * if self.names.is_empty() { 1.0 } else { 0.6 };
        // beside the chart, where it covers nothing
        let (map, beside) = area.split_horizontally(area.dim_in_pixel().0 as i32 - self.legend_width());
        let mut builder = ChartBuilder::on(&map);
        builder.margin(14).set_label_area_size(LabelAreaPosition::Left, 64);
        builder.set_label_area_size(LabelAreaPosition::Bottom, 48);
        if !self.title.is_empty() {
            builder.caption(&self.title, (FONT, 20).into_font().color(&INK));
        }
        let mut chart = builder.build_cartesian_2d(x, y)?;
        let name = |x: &f64| {
            let whole = (x - x.round()).abs() < 1e-6 && x.round() >= 0.0;
            self.names.get(x.round() as usize).filter(|_| whole).cloned().unwrap_or_default()
        };
        let mut mesh = chart.configure_mesh();
        mesh.light_line_style(WHITE.mix(0.0)).bold_line_style(GRID).axis_style(INK);
        mesh.label_style((FONT, 15).into_font().color(&INK)).axis_desc_style((FONT, 16).into_font().color(&INK));
        mesh.x_desc(&self.x).y_desc(&self.y);
        if !self.names.is_empty() {
            // ticks of this many are the whole numbers and the halves between them
            mesh.disable_x_mesh().x_labels(2 * self.names.len() + 1).x_label_formatter(&name);
        }
        mesh.draw()?;
        for (index, series) in self.series.iter().enumerate() {
            let color = COLORS[index % COLORS.len()];
            let (shift, half) = self.shift(index);
            let points: Vec<(f64, f64)> = series
                .points
                .iter()
                .filter(|(x, y)| x.is_finite() && y.is_finite())
                .map(|(x, y)| (x + shift, *y))
                .collect();
            if series.bars {
                let bar =
                    |(x, y): &(f64, f64)| Rectangle::new([(x - half, 0.0), (x + half, *y)], color.mix(0.45).filled());
                chart.draw_series(points.iter().map(bar))?;
            }
            if series.joined {
                chart.draw_series(LineSeries::new(points.iter().copied(), color.stroke_width(2)))?;
            }
            for ((x, _), (low, high)) in series.points.iter().zip(&series.intervals) {
                if low.is_finite() && high.is_finite() {
                    let x = x + shift;
                    let parts = [
                        [(x, *low), (x, *high)],
                        [(x - tick, *low), (x + tick, *low)],
                        [(x - tick, *high), (x + tick, *high)],
                    ];
                    chart.draw_series(parts.map(|part| PathElement::new(part.to_vec(), color.stroke_width(2))))?;
                }
            }
            if series.marked {
                chart.draw_series(points.iter().map(|point| Circle::new(*point, 4, color.filled())))?;
            }
        }
        self.legend(&beside)?;
        Ok(())
    }
}
