//! Maps and scenarios of the MovingAI benchmark.
//!
//! # Source
//! The files' own description at movingai.com/benchmarks/formats.html. `.`, `G` and `S` (swamp, entered from plain ground) are
//! free here, `@`, `O`, `T` and `W` blocked; agents move to the four neighbours only.

use std::fmt::Write as _;

use super::error::{FormatError, FormatProblem, abbreviated};
use super::{MAX_AGENTS, MAX_BYTES, MAX_CELLS};
use crate::instance::{Cell, GridAgent, GridInstance};

/// A file with its name.
#[derive(Clone, Copy, Debug)]
pub struct Text<'a> {
    /// The file's name, for messages.
    pub name: &'a str,
    /// What stands in it.
    pub text: &'a str,
}

impl<'a> Text<'a> {
    fn error(self, line: usize, column: usize, problem: FormatProblem) -> FormatError {
        FormatError::new(self.name, line, column, problem)
    }

    fn wrong(self, line: usize, column: usize, found: &str, expected: &str) -> FormatError {
        let found = if found.is_empty() { "nothing".to_owned() } else { format!("`{}`", abbreviated(found)) };
        self.error(line, column, FormatProblem::Line { found, expected: expected.to_owned() })
    }

    fn lines(self) -> Result<impl Iterator<Item = (usize, &'a str)>, FormatError> {
        let Self { text, .. } = self;
        if text.len() > MAX_BYTES {
            let problem = FormatProblem::TooMany { what: "bytes of the file", count: text.len(), most: MAX_BYTES };
            return Err(self.error(1, 1, problem));
        }
        Ok(text.lines().enumerate().map(|(index, line)| (index + 1, line.trim_end())))
    }
}

/// Name of the map that a scenario is for, as it stands in the scenario; nothing where it has no rows.
pub fn map_name(scenario: &str) -> Option<&str> {
    scenario.lines().skip(1).find_map(|line| line.split_whitespace().nth(1))
}

/// The first `agents` rows (all of them without a number) of a scenario on its map. Agents are called agent0, agent1, ….
///
/// # Errors
/// What is wrong, and where.
pub fn read(map: Text<'_>, scenario: Text<'_>, agents: Option<usize>) -> Result<GridInstance, FormatError> {
    let (width, height, blocked) = read_map(map)?;
    let mut lines = scenario.lines()?;
    let expected = "`version 1`";
    match lines.next() {
        Some((_, line)) if line.split_whitespace().next() == Some("version") => {}
        other => return Err(scenario.wrong(1, 1, other.map_or("", |(_, line)| line), expected)),
    }
    let mut rows = Vec::new();
    for (number, line) in lines.filter(|(_, line)| !line.is_empty()) {
        if agents.is_some_and(|agents| rows.len() >= agents) {
            break;
        }
        if rows.len() >= MAX_AGENTS {
            let problem = FormatProblem::TooMany { what: "agents", count: rows.len() + 1, most: MAX_AGENTS };
            return Err(scenario.error(number, 1, problem));
        }
        let name = format!("agent{}", rows.len());
        rows.push(read_row(scenario, number, line, name, (width, height))?);
    }
    if let Some(asked) = agents
        && rows.len() < asked
    {
        let problem = FormatProblem::TooFewAgents { asked, present: rows.len() };
        return Err(scenario.error(1, 1, problem));
    }
    Ok(GridInstance { width, height, blocked, agents: rows, assignment: false })
}

fn read_row(
    file: Text<'_>,
    number: usize,
    line: &str,
    name: String,
    (width, height): (i32, i32),
) -> Result<GridAgent, FormatError> {
    let expected = "a row: bucket, map, width, height, start x, start y, goal x, goal y, length";
    let fields: Vec<&str> = line.split_whitespace().collect();
    if fields.len() < 8 {
        return Err(file.wrong(number, 1, line, expected));
    }
    let mut values = [0; 6];
    for (value, field) in values.iter_mut().zip(&fields[2..8]) {
        // the fields lie in the line, so the difference of addresses is the column
        let column = 1 + (field.as_ptr() as usize).saturating_sub(line.as_ptr() as usize);
        *value = field
            .parse::<i32>()
            .ok()
            .filter(|value| value.abs() <= 1 << 24)
            .ok_or_else(|| file.wrong(number, column, field, "a whole number"))?;
    }
    let [scenario_width, scenario_height, start_x, start_y, goal_x, goal_y] = values;
    if (scenario_width, scenario_height) != (width, height) {
        let problem = FormatProblem::OtherMap { scenario_width, scenario_height, width, height };
        return Err(file.error(number, 1, problem));
    }
    let (start, goal) = (Cell { x: start_x, y: start_y }, Cell { x: goal_x, y: goal_y });
    Ok(GridAgent { name, start, goals: vec![goal] })
}

/// Columns, rows, and which cells are blocked, row by row.
fn read_map(file: Text<'_>) -> Result<(i32, i32, Vec<bool>), FormatError> {
    let mut lines = file.lines()?;
    let mut next = |expected: &str| match lines.next() {
        Some(line) => Ok(line),
        None => Err(file.wrong(1 + file.text.lines().count(), 1, "", expected)),
    };
    let (number, line) = next("`type octile`")?;
    if line.split_whitespace().next() != Some("type") {
        return Err(file.wrong(number, 1, line, "`type octile`"));
    }
    let mut sides = [0; 2];
    for (side, key) in sides.iter_mut().zip(["height", "width"]) {
        let expected = format!("`{key}` and a whole number between 1 and 16777216");
        let (number, line) = next(&expected)?;
        let value = line.strip_prefix(key).and_then(|rest| rest.trim().parse::<i32>().ok());
        *side = value
            .filter(|value| (1..=1 << 24).contains(value))
            .ok_or_else(|| file.wrong(number, 1, line, &expected))?;
    }
    let [height, width] = sides;
    let cells = width as usize * height as usize;
    if cells > MAX_CELLS {
        let (width, height) = (f64::from(width), f64::from(height));
        let problem = FormatProblem::TooLarge { width, height, cells: cells as f64, most: MAX_CELLS };
        return Err(file.error(2, 1, problem));
    }
    let (number, line) = next("`map`")?;
    if line != "map" {
        return Err(file.wrong(number, 1, line, "`map`"));
    }
    let mut blocked = Vec::with_capacity(cells);
    for _ in 0..height {
        let expected = format!("a row of {width} cells");
        let (number, line) = next(&expected)?;
        for (index, character) in line.chars().enumerate() {
            blocked.push(match character {
                '.' | 'G' | 'S' => false,
                '@' | 'O' | 'T' | 'W' => true,
                _ => return Err(file.error(number, index + 1, FormatProblem::UnknownCharacter { character })),
            });
        }
        let length = line.chars().count();
        if length != width as usize {
            let found = format!("a row of {length} cells");
            return Err(file.error(number, 1, FormatProblem::Line { found, expected }));
        }
    }
    Ok((width, height, blocked))
}

/// The map and the scenario of an instance; `map_name` is what the scenario calls the map. Of agents without a goal the scenario
/// says that they stay where they are, and of several goals it names the first.
pub fn write(instance: &GridInstance, map_name: &str) -> (String, String) {
    let (width, height) = (instance.width, instance.height);
    let mut map = format!("type octile\nheight {height}\nwidth {width}\nmap\n");
    for row in instance.blocked.chunks(width.max(1) as usize) {
        map.extend(row.iter().map(|blocked| if *blocked { '@' } else { '.' }));
        map.push('\n');
    }
    let mut scenario = "version 1\n".to_owned();
    for agent in &instance.agents {
        let (start, goal) = (agent.start, agent.goals.first().unwrap_or(&agent.start));
        let (dx, dy) = ((start.x - goal.x).abs(), (start.y - goal.y).abs());
        // on empty ground; what the way really takes is the planner's to say
        let length = f64::from(dx.max(dy)) + (2.0_f64.sqrt() - 1.0) * f64::from(dx.min(dy));
        let bucket = (length / 4.0).floor();
        let _ = writeln!(
            scenario,
            "{bucket}\t{map_name}\t{width}\t{height}\t{}\t{}\t{}\t{}\t{length:.8}",
            start.x, start.y, goal.x, goal.y
        );
    }
    (map, scenario)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAP: &str = "type octile\nheight 2\nwidth 3\nmap\n.@.\n..T\n";
    const SCENARIO: &str = "version 1\n0\ta.map\t3\t2\t0\t0\t1\t1\t1.41421356\n0\ta.map\t3\t2\t2\t0\t0\t1\t2.4\n";

    fn map(text: &str) -> Text<'_> {
        Text { name: "a.map", text }
    }

    fn scenario(text: &str) -> Text<'_> {
        Text { name: "a.scen", text }
    }

    #[test]
    fn rows_become_agents() {
        let instance = read(map(MAP), scenario(SCENARIO), None).unwrap();
        assert_eq!((instance.width, instance.height), (3, 2));
        assert_eq!(instance.blocked, [false, true, false, false, false, true]);
        assert_eq!(instance.agents.len(), 2);
        assert_eq!(instance.agents[1].start, Cell { x: 2, y: 0 });
        assert_eq!(instance.agents[1].goals, [Cell { x: 0, y: 1 }]);
        assert_eq!(map_name(SCENARIO), Some("a.map"));
        let first = read(map(MAP), scenario(SCENARIO), Some(1)).unwrap();
        assert_eq!(first.agents.len(), 1);
    }

    #[test]
    fn what_is_written_is_read_again() {
        let instance = read(map(MAP), scenario(SCENARIO), None).unwrap();
        let (map_text, scenario_text) = write(&instance, "a.map");
        assert_eq!(read(map(&map_text), scenario(&scenario_text), None).unwrap(), instance);
    }

    #[test]
    fn errors_name_the_place() {
        let of_map = |text: &str| read(map(text), scenario(SCENARIO), None).unwrap_err().to_string();
        assert_eq!(of_map(""), "a.map:1:1: nothing; expected `type octile`");
        assert_eq!(
            of_map("type octile\nheight x\n"),
            "a.map:2:1: `height x`; expected `height` and a whole number between 1 and 16777216"
        );
        assert_eq!(
            of_map("type octile\nheight 9999999\nwidth 9999999\n"),
            "a.map:2:1: a map of 9999999 × 9999999 has 99999980000001 cells, at most 16777216 are read"
        );
        assert_eq!(of_map(&MAP.replace(".@.", ".@")), "a.map:5:1: a row of 2 cells; expected a row of 3 cells");
        assert_eq!(of_map(&MAP.replace(".@.", ".x.")), "a.map:5:2: `x` stands for nothing in a map");
        assert_eq!(
            of_map("type octile\nheight 2\nwidth 3\nmap\n...\n"),
            "a.map:6:1: nothing; expected a row of 3 cells"
        );
        let of_scenario = |text: &str| read(map(MAP), scenario(text), None).unwrap_err().to_string();
        assert_eq!(of_scenario("0\ta.map"), "a.scen:1:1: `0 a.map`; expected `version 1`");
        assert_eq!(
            of_scenario("version 1\n0\ta.map\t3\t2\t0\tz\t1\t1\t1"),
            "a.scen:2:15: `z`; expected a whole number"
        );
        assert_eq!(
            of_scenario("version 1\n0\ta.map\t8\t8\t0\t0\t1\t1\t1"),
            "a.scen:2:1: the scenario is for a map of 8 × 8, and the map is 3 × 2"
        );
        let few = read(map(MAP), scenario(SCENARIO), Some(5)).unwrap_err().to_string();
        assert_eq!(few, "a.scen:1:1: 5 agents were asked for, and the file has 2");
    }
}
