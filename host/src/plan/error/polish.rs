//! Nodes of a tensor grid moved to where they err least.

use super::super::fields::tensor::{Nodes, Tensor};
use super::{Candidate, Judge};

/// Steps, of half the interval, in which nodes are drawn out and moved.
const STEPS: [f64; 4] = [0.08, 0.04, 0.02, 0.01];

/// How far apart nodes stay, of half the interval: the polynomials through closer ones
/// are large elsewhere.
const APART: f64 = 0.02;

/// Nodes of an axis up to which each is moved by itself; among more no single one matters.
const FEW: usize = 8;

impl Judge<'_> {
    /// The same grid with other nodes: of every kind along either axis, then moved as
    /// a whole, drawn out or together, and moved alone or in pairs that mirror each other,
    /// as far as that lessens the error.
    pub(super) fn polished(&self, candidate: &Candidate) -> Candidate {
        let mut best = candidate.clone();
        let counts = [0, 1].map(|axis| candidate.tensor.nodes[axis].len());
        for along_u in Nodes::ALL {
            for along_v in Nodes::ALL {
                let nodes = [along_u.of(counts[0]), along_v.of(counts[1])];
                let tensor = candidate.tensor.clone();
                self.try_grid(Tensor { nodes, ..tensor }, &mut best);
            }
        }
        for step in STEPS {
            for (axis, &count) in counts.iter().enumerate() {
                for moved in moves(count, step) {
                    let mut grid = best.tensor.clone();
                    for (k, t) in grid.nodes[axis].iter_mut().enumerate() {
                        *t = moved.of(k, *t).clamp(-1.0, 1.0);
                    }
                    self.try_grid(grid, &mut best);
                }
            }
        }
        best
    }

    /// Takes a grid in place of the best one where it errs less.
    fn try_grid(&self, grid: Tensor, best: &mut Candidate) {
        let distinct = |nodes: &Vec<f64>| nodes.windows(2).all(|pair| pair[1] - pair[0] >= APART);
        if !grid.nodes.iter().all(distinct) {
            return;
        }
        for found in self.candidates(&grid, &[grid.factor]) {
            if found.error < best.error {
                *best = found;
            }
        }
    }
}

/// How the nodes of an axis are moved.
#[derive(Clone, Copy)]
enum Move {
    /// Drawn out from the middle by this part.
    Stretch(f64),
    /// All by so much.
    Shift(f64),
    /// One of them by so much.
    One(usize, f64),
    /// Two of them, by so much in opposite directions.
    Pair([usize; 2], f64),
}

impl Move {
    /// Where the node of this number, which was there, is put.
    fn of(self, number: usize, t: f64) -> f64 {
        match self {
            Self::Stretch(by) => t * (1.0 + by),
            Self::Shift(by) => t + by,
            Self::One(one, by) if one == number => t + by,
            Self::Pair([one, _], by) if one == number => t + by,
            Self::Pair([_, other], by) if other == number => t - by,
            _ => t,
        }
    }
}

/// The moves that are tried in turn of so many nodes with a step.
fn moves(count: usize, step: f64) -> Vec<Move> {
    let both = |of: &dyn Fn(f64) -> Move| [of(step), of(-step)];
    let mut all = Vec::from(both(&Move::Stretch));
    all.extend(both(&Move::Shift));
    if count <= FEW {
        let pairs = (0..count / 2).map(|k| [k, count - 1 - k]);
        all.extend(pairs.flat_map(|pair| both(&|by| Move::Pair(pair, by))));
        all.extend((0..count).flat_map(|k| both(&|by| Move::One(k, by))));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_moves_apart_and_the_others_stay() {
        let nodes = [-0.8, -0.2, 0.2, 0.8];
        let pair = Move::Pair([1, 2], -0.1);
        let moved: Vec<f64> = (0..4).map(|k| pair.of(k, nodes[k])).collect();
        assert_eq!(
            moved,
            [-0.8, -0.30000000000000004, 0.30000000000000004, 0.8]
        );
        assert_eq!(moves(4, 0.1).len(), 4 + 4 + 8);
        assert_eq!(moves(12, 0.1).len(), 4, "of many none by itself");
    }
}
