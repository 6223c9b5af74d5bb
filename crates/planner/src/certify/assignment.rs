//! Whether an assignment takes as many goals as possible, and what the cheapest one costs.
//!
//! # Source
//! Berge's theorem: a matching is a maximum one when no alternating path leads from a free agent to a free goal. The
//! cheapest assignment by shortest augmenting paths with potentials, as in Jonker and Volgenant, Computing 38 (1987).
//!
//! # Deviations
//! Every agent has a goal of its own in addition that costs more than any real assignment, so that the cheapest perfect
//! assignment takes as many real goals as possible.

use std::collections::VecDeque;

use super::agents::Taker;

/// An agent without a goal for which another assignment would have one without taking anybody's away.
pub(super) fn could_take_more(takers: &[Taker], owner: &[Option<usize>]) -> Option<usize> {
    let mut seen = vec![false; owner.len()];
    // whom to move, and for whom
    let mut open: VecDeque<(usize, usize)> =
        takers.iter().enumerate().filter(|(_, taker)| taker.taken.is_none()).map(|(agent, _)| (agent, agent)).collect();
    while let Some((agent, root)) = open.pop_front() {
        for goal in &takers[agent].options {
            if std::mem::replace(&mut seen[*goal], true) {
                continue;
            }
            match owner[*goal] {
                None => return Some(root),
                Some(next) => open.push_back((next, root)),
            }
        }
    }
    None
}

/// Least sum of costs of an assignment that takes as many goals as possible, row per agent, column per goal; nothing where a
/// goal cannot be taken. Costs must be finite and not negative.
pub(super) fn cheapest(costs: &[Vec<Option<f64>>]) -> f64 {
    let rows = costs.len();
    let goals = costs.iter().map(Vec::len).max().unwrap_or(0);
    let columns = goals + rows;
    // more than all real costs together
    let without =
        1.0 + costs.iter().map(|row| row.iter().flatten().fold(0.0, |most: f64, cost| most.max(*cost))).sum::<f64>();
    let cost = |row: usize, column: usize| {
        if column >= goals {
            without
        } else {
            // no goal of its own must look better than one that cannot be taken
            costs[row].get(column).copied().flatten().unwrap_or(2.0 * without)
        }
    };
    let mut row_potential = vec![0.0; rows];
    let mut column_potential = vec![0.0; columns];
    let mut row_of: Vec<Option<usize>> = vec![None; columns];
    let mut distance = vec![0.0; columns];
    let mut previous: Vec<Option<usize>> = vec![None; columns];
    let mut done = vec![false; columns];
    for start in 0..rows {
        distance.fill(f64::INFINITY);
        previous.fill(None);
        done.fill(false);
        let (mut row, mut from, mut reached) = (start, None, 0.0);
        let end = loop {
            let mut nearest: Option<usize> = None;
            for column in 0..columns {
                if done[column] {
                    continue;
                }
                let through = reached + cost(row, column) - row_potential[row] - column_potential[column];
                if through < distance[column] {
                    distance[column] = through;
                    previous[column] = from;
                }
                if nearest.is_none_or(|best| distance[column] < distance[best]) {
                    nearest = Some(column);
                }
            }
            // there are more columns than rows, so one is always left
            let Some(column) = nearest else { return 0.0 };
            reached = distance[column];
            done[column] = true;
            match row_of[column] {
                None => break column,
                Some(next) => {
                    row = next;
                    from = Some(column);
                }
            }
        };
        row_potential[start] += reached;
        for column in 0..columns {
            if done[column] && column != end {
                let slack = reached - distance[column];
                column_potential[column] -= slack;
                if let Some(row) = row_of[column] {
                    row_potential[row] += slack;
                }
            }
        }
        let mut column = end;
        while let Some(before) = previous[column] {
            row_of[column] = row_of[before];
            column = before;
        }
        row_of[column] = Some(start);
    }
    row_of[..goals]
        .iter()
        .enumerate()
        .filter_map(|(column, row)| row.and_then(|row| costs[row].get(column).copied().flatten()))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::cheapest;

    /// (goals taken, cost) of the best assignment by trying all.
    fn best(costs: &[Vec<Option<f64>>], row: usize, used: u32) -> (usize, f64) {
        if row == costs.len() {
            return (0, 0.0);
        }
        let mut best_so_far = best(costs, row + 1, used);
        for (column, cost) in costs[row].iter().enumerate() {
            if let Some(cost) = cost
                && used >> column & 1 == 0
            {
                let (taken, rest) = best(costs, row + 1, used | 1 << column);
                let this = (taken + 1, rest + cost);
                if this.0 > best_so_far.0 || (this.0 == best_so_far.0 && this.1 < best_so_far.1) {
                    best_so_far = this;
                }
            }
        }
        best_so_far
    }

    /// 2,000 random tables of up to 5 × 5 from one seed, a third of the entries missing; small integers, so sums are exact.
    #[test]
    fn the_cheapest_assignment_is_the_best_of_all() {
        let mut state = 7_u64;
        let mut random = |below: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % below
        };
        for _ in 0..2000 {
            let (rows, columns) = (random(5) as usize + 1, random(6) as usize);
            let costs: Vec<Vec<Option<f64>>> =
                (0..rows).map(|_| (0..columns).map(|_| (random(3) > 0).then(|| random(20) as f64)).collect()).collect();
            assert_eq!(cheapest(&costs), best(&costs, 0, 0).1, "{costs:?}");
        }
    }
}
