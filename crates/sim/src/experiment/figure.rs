//! Figures of the experiments.

use std::path::Path;

use plotters::backend::DrawingBackend;

use super::Results;
use super::summary::CellSummary;
use super::trials::{Key, Level};
use crate::files::FileError;
use crate::plot::{self, Area, Chart, Drawn, Lines, PlotError, Series};

/// Charts side by side and below each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Panels {
    /// Rows of charts, from the top.
    pub rows: Vec<Vec<Lines>>,
}

impl Panels {
    /// Size at which every chart is readable, pixels.
    fn size(&self) -> (u32, u32) {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(1).max(1) as u32;
        let wide = if columns == 1 { 1100 } else { 560 * columns };
        (wide, if columns == 1 { 260 } else { 400 } * (self.rows.len().max(1) as u32))
    }
}

impl Chart for Panels {
    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB> {
        let rows = area.split_evenly((self.rows.len().max(1), 1));
        for (row, charts) in rows.iter().zip(&self.rows) {
            for (place, chart) in row.split_evenly((1, charts.len().max(1))).iter().zip(charts) {
                chart.draw(place)?;
            }
        }
        Ok(())
    }
}

/// Writes `panels` as NAME.svg and NAME.png into `folder`.
///
/// # Errors
/// Files that cannot be written.
pub fn save(folder: &Path, name: &str, panels: &Panels) -> Result<(), FileError> {
    match plot::save(&folder.join(name), panels.size(), panels) {
        Ok(_) => Ok(()),
        Err(PlotError::File(error)) => Err(error),
        Err(error) => Err(FileError::Figure(error.to_string())),
    }
}

/// Most characters of a name under a chart.
const LONGEST_NAME: usize = 12;

/// The figure of an experiment that has no other: median times with their quartiles, the paper's times beside them; shares of
/// success where the cells differ in these. One chart per terrain.
///
/// # Errors
/// Files that cannot be written.
pub fn cells(results: &Results, folder: &Path) -> Result<(), FileError> {
    let mut terrains: Vec<Option<Level>> = Vec::new();
    for cell in &results.cells {
        let terrain = cell.key.level("terrain").cloned();
        if !terrains.contains(&terrain) {
            terrains.push(terrain);
        }
    }
    // a terrain per cell makes one chart of three names
    if terrains.len() == results.cells.len() {
        terrains = vec![None];
    }
    let failed = results.cells.iter().any(|cell| cell.reached < cell.n);
    let of = |terrain: &Option<Level>| -> Vec<&CellSummary> {
        results.cells.iter().filter(|cell| terrain.is_none() || cell.key.level("terrain") == terrain.as_ref()).collect()
    };
    let mut charts: Vec<Lines> = terrains.iter().map(|terrain| times(&of(terrain), terrain.as_ref())).collect();
    if failed {
        charts.extend(terrains.iter().map(|terrain| shares(&of(terrain), terrain.as_ref())));
    }
    // below each other, so that the names have room
    save(folder, results.name, &Panels { rows: charts.into_iter().map(|chart| vec![chart]).collect() })
}

/// Names of cells, without the terrain if a chart shows only one; numbers if the names are long.
fn names(cells: &[&CellSummary], terrain: Option<&Level>) -> (Vec<String>, String) {
    let name = |key: &Key| {
        let levels = key.iter().filter(|(factor, _)| terrain.is_none() || *factor != "terrain");
        levels.map(|(_, level)| level.to_string()).collect::<Vec<_>>().join(" / ")
    };
    let names: Vec<String> = cells.iter().map(|cell| name(&cell.key)).collect();
    let factors = cells.first().map_or_else(String::new, |cell| {
        let factors = cell.key.iter().filter(|(factor, _)| terrain.is_none() || *factor != "terrain");
        factors.map(|(factor, _)| factor.to_owned()).collect::<Vec<_>>().join(" / ")
    });
    let room = 110 / names.len().max(1);
    if names.iter().any(|name| name.chars().count() > LONGEST_NAME.min(room.max(1))) {
        let numbers = (1..=names.len()).map(|number| number.to_string()).collect();
        return (numbers, format!("{factors}: row of the table"));
    }
    (names, factors)
}

fn times(cells: &[&CellSummary], terrain: Option<&Level>) -> Lines {
    let (names, x) = names(cells, terrain);
    let at = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let ours = Series {
        name: "median, quartiles".to_owned(),
        points: (0..).zip(cells).map(|(i, cell)| (f64::from(i), at(cell.median_time_s))).collect(),
        intervals: cells.iter().map(|cell| (at(cell.q25_time_s), at(cell.q75_time_s))).collect(),
        marked: true,
        ..Series::default()
    };
    let paper: Vec<(f64, f64)> = (0..)
        .zip(cells)
        .filter_map(|(i, cell)| Some((f64::from(i), cell.paper.as_ref()?.get("time_s")?.as_f64()?)))
        .collect();
    let mut series = vec![ours];
    if !paper.is_empty() {
        series.push(Series { name: "paper, one run".to_owned(), points: paper, marked: true, ..Series::default() });
    }
    Lines {
        title: terrain.map_or_else(|| "Mission time".to_owned(), |terrain| format!("Mission time, {terrain}")),
        x,
        y: "time, s".to_owned(),
        names,
        y_shows: Some((0.0, 0.0)),
        series,
    }
}

fn shares(cells: &[&CellSummary], terrain: Option<&Level>) -> Lines {
    let (names, x) = names(cells, terrain);
    let series = Series {
        name: "reached, 95 %".to_owned(),
        points: (0..).zip(cells).map(|(i, cell)| (f64::from(i), cell.reached as f64 / cell.n.max(1) as f64)).collect(),
        intervals: cells.iter().map(|cell| (cell.wilson[0], cell.wilson[1])).collect(),
        marked: true,
        ..Series::default()
    };
    Lines {
        title: terrain.map_or_else(|| "Success".to_owned(), |terrain| format!("Success, {terrain}")),
        x,
        y: "share that reached the goal".to_owned(),
        names,
        y_shows: Some((0.0, 1.0)),
        series: vec![series],
    }
}
