//! The ways of two logs in one picture.

use std::path::Path;

use cohaul_core::scenario;
use cohaul_core::scenario::document::Scenario;
use nalgebra::{Rotation2, Vector2};
use plotters::backend::DrawingBackend;
use plotters::chart::{ChartBuilder, LabelAreaPosition, SeriesLabelPosition};
use plotters::element::{PathElement, Polygon};
use plotters::series::LineSeries;
use plotters::style::{Color, IntoFont, RGBColor, WHITE};

use super::paths::{Instant, Paths, Track};
use crate::plot::{Area, COLORS, Chart, Drawn, FONT, GRID, INK, PlotError, save, span};

/// Pixels around the map: left, right, above, below.
const FRAME: [u32; 4] = [76, 20, 92, 64];
/// Width of the map, pixels.
const WIDTH: u32 = 1000;
/// Least and greatest height of the map, pixels.
const HEIGHT: [f64; 2] = [260.0, 1000.0];
/// Room around what is drawn, m.
const MARGIN: f64 = 0.2;
/// Corners of a circle.
const CORNERS: u32 = 72;

type Points = Vec<(f64, f64)>;

/// The picture's parts in metres.
struct Picture {
    title: [String; 2],
    /// Way, outline at the start and outline at the end of each load, of A and of B.
    ways: [Vec<(Points, Points, Points)>; 2],
    obstacles: Vec<Points>,
    /// Where the loads shall go, with their tolerances.
    waypoints: Vec<Points>,
    x: std::ops::Range<f64>,
    y: std::ops::Range<f64>,
}

/// Draws the ways of two logs over each other, as PATH.svg and PATH.png, and notes the files in `paths`.
///
/// Obstacles and waypoints are those of A.
///
/// # Errors
/// Files that cannot be written.
pub fn draw(paths: &mut Paths, a: &Track, b: &Track, path: &Path) -> Result<(), PlotError> {
    let picture = Picture::new(paths, a, b);
    let (width, height) = (picture.x.end - picture.x.start, picture.y.end - picture.y.start);
    let high = (f64::from(WIDTH) * height / width).clamp(HEIGHT[0], HEIGHT[1]);
    let size = (WIDTH + FRAME[0] + FRAME[1], high.round() as u32 + FRAME[2] + FRAME[3]);
    let (svg, png) = save(path, size, &picture)?;
    (paths.svg, paths.png) = (Some(svg), Some(png));
    Ok(())
}

impl Picture {
    fn new(paths: &Paths, a: &Track, b: &Track) -> Self {
        let scenarios = [a, b].map(|track| {
            // a log of another version may hold a scenario that this one does not read: its ways can be drawn all the same
            scenario::parse("scenario of the log", track.header.scenario_text.as_bytes(), &[]).ok().map(|p| p.scenario)
        });
        let ways = [(a, &scenarios[0]), (b, &scenarios[1])].map(|(track, scenario)| ways(track, scenario.as_ref()));
        let instance = scenarios[0].as_ref().and_then(|scenario| scenario.instance().ok());
        let outline = |points: &[Vector2<f64>]| points.iter().map(|p| (p.x, p.y)).collect::<Points>();
        let obstacles = instance.iter().flat_map(|i| &i.obstacles).map(|o| outline(o.vertices())).collect();
        let teams = scenarios[0].iter().flat_map(|scenario| &scenario.teams);
        let waypoints: Vec<Points> = teams
            .flat_map(|team| {
                team.mission.points().map(|p| circle(p.x, p.y, team.mission.tolerance)).collect::<Vec<_>>()
            })
            .collect();
        let shown: Vec<(f64, f64)> = ways
            .iter()
            .flatten()
            .flat_map(|(way, start, end)| way.iter().chain(start).chain(end))
            .chain(waypoints.iter().flatten())
            .copied()
            .collect();
        let around = |range: std::ops::Range<f64>| range.start - MARGIN..range.end + MARGIN;
        let (mut x, mut y) =
            (around(span(shown.iter().map(|p| p.0), 0.0)), around(span(shown.iter().map(|p| p.1), 0.0)));
        // a metre is as long upwards as sideways, in maps of any shape
        let (width, height) = (x.end - x.start, y.end - y.start);
        let [least, greatest] = HEIGHT.map(|pixels| pixels / f64::from(WIDTH));
        widen(&mut y, width * least);
        widen(&mut x, height / greatest);
        let title = [format!("A  {}", paths.a.text()), format!("B  {}", paths.b.text())];
        Self { title, ways, obstacles, waypoints, x, y }
    }
}

/// Makes a range at least as long as `length`.
fn widen(range: &mut std::ops::Range<f64>, length: f64) {
    let missing = (length - (range.end - range.start)).max(0.0) / 2.0;
    *range = range.start - missing..range.end + missing;
}

fn circle(x: f64, y: f64, radius: f64) -> Points {
    let angle = |corner: u32| std::f64::consts::TAU * f64::from(corner) / f64::from(CORNERS);
    (0..=CORNERS).map(angle).map(|angle| (x + radius * angle.cos(), y + radius * angle.sin())).collect()
}

/// Of each load: its way, and its outlines at both ends of it.
fn ways(track: &Track, scenario: Option<&Scenario>) -> Vec<(Points, Points, Points)> {
    let instance = scenario.and_then(|scenario| scenario.instance().ok());
    let place = |name: &String| track.header.loads.iter().position(|load| load == name);
    let ways = track.loads.iter().map(|(name, way)| {
        let load = place(name).and_then(|index| instance.as_ref()?.loads.get(index));
        let outline = |at: Option<&Instant>| -> Points {
            let Some((at, load)) = at.zip(load) else { return Points::new() };
            let turn = Rotation2::new(at.yaw);
            let mut corners: Points =
                load.polygon.vertices().iter().map(|v| at.at + turn * v).map(|v| (v.x, v.y)).collect();
            corners.extend(corners.first().copied());
            corners
        };
        (way.iter().map(|instant| (instant.at.x, instant.at.y)).collect(), outline(way.first()), outline(way.last()))
    });
    ways.collect()
}

impl Chart for Picture {
    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB> {
        let [left, right, above, below] = FRAME;
        let (title, map) = area.split_vertically(above - 14);
        for (line, text) in (0..).zip(&self.title) {
            let style = (FONT, 19).into_font().color(&COLORS[line as usize]);
            title.draw_text(text, &style, (left as i32, 16 + 28 * line))?;
        }
        let mut builder = ChartBuilder::on(&map);
        builder.margin_top(14).margin_right(right).margin_bottom(14).margin_left(14);
        builder.set_label_area_size(LabelAreaPosition::Left, left - 14);
        builder.set_label_area_size(LabelAreaPosition::Bottom, below - 14);
        let mut chart = builder.build_cartesian_2d(self.x.clone(), self.y.clone())?;
        let label = (FONT, 16).into_font().color(&INK);
        chart
            .configure_mesh()
            .light_line_style(WHITE.mix(0.0))
            .bold_line_style(GRID)
            .axis_style(INK)
            .label_style(label.clone())
            .axis_desc_style(label.clone())
            .x_desc("x, m")
            .y_desc("y, m")
            .draw()?;
        let grey = RGBColor(0x8a, 0x94, 0xa2);
        chart.draw_series(self.obstacles.iter().map(|o| Polygon::new(o.clone(), grey.mix(0.5))))?;
        chart.draw_series(self.waypoints.iter().map(|w| PathElement::new(w.clone(), grey.stroke_width(1))))?;
        // B lies over A: it is thinner, so that both are seen
        for ((name, color, width), ways) in [("A", COLORS[0], 6), ("B", COLORS[1], 2)].into_iter().zip(&self.ways) {
            let outlines = |end: bool| ways.iter().map(move |(_, start, last)| if end { last } else { start });
            chart.draw_series(outlines(true).map(|o| Polygon::new(o.clone(), color.mix(0.15))))?;
            let outlines = outlines(false).chain(outlines(true));
            chart.draw_series(outlines.map(|o| PathElement::new(o.clone(), color.mix(0.6).stroke_width(1))))?;
            let mut label = Some(name);
            for (way, _, _) in ways {
                let drawn = chart.draw_series(LineSeries::new(way.iter().copied(), color.stroke_width(width)))?;
                if let Some(name) = label.take() {
                    drawn
                        .label(name)
                        .legend(move |(x, y)| PathElement::new([(x, y), (x + 22, y)], color.stroke_width(width)));
                }
            }
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .background_style(WHITE.mix(0.85))
            .label_font((FONT, 17).into_font().color(&INK))
            .draw()?;
        Ok(())
    }
}
