//! Finer meshes: cells are halved where the polynomials miss most.

use std::collections::BinaryHeap;

use super::tree::Tree;

/// What halving a cell is taken to leave of its error, for each half.
const HALVED: f64 = 0.2;

/// A cell that could be halved, by what that gains.
#[derive(PartialEq)]
struct Candidate {
    error: f64,
    cell: usize,
}

impl Eq for Candidate {}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let by_error = self.error.total_cmp(&other.error);
        by_error.then(other.cell.cmp(&self.cell))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Tree {
    /// The mesh with the cells halved that miss most, up to `target` cells.
    pub(super) fn finer(&mut self, errors: &[f64], target: usize) -> Vec<usize> {
        let pairs = self.base.iter().zip(errors);
        let mut heap: BinaryHeap<Candidate> = pairs
            .map(|(&cell, &error)| Candidate { error, cell })
            .collect();
        let mut done = Vec::new();
        while done.len() + heap.len() < target
            && let Some(Candidate { error, cell }) = heap.pop()
        {
            match self.halve(cell) {
                Some(halves) => heap.extend(halves.map(|cell| Candidate {
                    error: HALVED * error,
                    cell,
                })),
                None => done.push(cell),
            }
        }
        done.extend(heap.into_iter().map(|candidate| candidate.cell));
        done.sort_unstable();
        done
    }
}
