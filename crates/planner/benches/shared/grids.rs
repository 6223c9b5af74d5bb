//! Grids with obstacles and agents from a seed.

#[path = "numbers.rs"]
mod numbers;
use cohaul_planner::instance::{Cell, GridAgent, GridInstance};

/// A square grid of which one fifth is blocked; starts and goals lie in its largest connected part. With `assignment`, every
/// agent may take every goal.
pub fn grid(seed: u64, side: usize, agents: usize, assignment: bool) -> GridInstance {
    let mut numbers = numbers::Numbers(seed);
    let mut blocked = vec![false; side * side];
    for _ in 0..side * side / 5 {
        blocked[numbers.below(side * side)] = true;
    }
    let part = largest_part(&blocked, side);
    let mut draw = || -> Vec<Cell> {
        let mut rest = part.clone();
        (0..agents.min(part.len()))
            .map(|_| {
                let cell = rest.swap_remove(numbers.below(rest.len()));
                Cell { x: (cell % side) as i32, y: (cell / side) as i32 }
            })
            .collect()
    };
    let (starts, goals) = (draw(), draw());
    let agents = starts.iter().zip(&goals).enumerate().map(|(index, (&start, &goal))| GridAgent {
        name: format!("agent{index}"),
        start,
        goals: if assignment { goals.clone() } else { vec![goal] },
    });
    let agents = agents.collect();
    GridInstance { width: side as i32, height: side as i32, blocked, agents, assignment }
}

fn largest_part(blocked: &[bool], side: usize) -> Vec<usize> {
    let mut seen = blocked.to_vec();
    let mut largest = Vec::new();
    for first in 0..blocked.len() {
        if seen[first] {
            continue;
        }
        seen[first] = true;
        let mut part = vec![first];
        let mut at = 0;
        while at < part.len() {
            let (x, y) = (part[at] % side, part[at] / side);
            at += 1;
            for (x, y) in [(x + 1, y), (x.wrapping_sub(1), y), (x, y + 1), (x, y.wrapping_sub(1))] {
                if x < side && y < side && !seen[y * side + x] {
                    seen[y * side + x] = true;
                    part.push(y * side + x);
                }
            }
        }
        if part.len() > largest.len() {
            largest = part;
        }
    }
    largest
}
