//! What every cell of a mesh gives to every other, as a matrix.

use rayon::prelude::*;

use super::polynomial::{Polynomial, TERMS};

/// Coefficients of irradiance for coefficients of radiance. Single precision:
/// its 6e-8 is far below what the mesh leaves open.
pub(super) struct Transfer {
    cells: usize,
    entries: Vec<f32>,
}

/// The rows of one receiving cell.
pub(super) struct Rows {
    cells: usize,
    entries: Vec<f64>,
}

impl Rows {
    /// Adds a node's `moments` of the cell at `column`; `share` is what an
    /// irradiance of 1 at the node adds to the receiving cell's coefficients.
    pub(super) fn add(&mut self, column: usize, share: &Polynomial, moments: &Polynomial) {
        let rows = self.entries.chunks_exact_mut(self.cells * TERMS);
        for (row, share) in rows.zip(share) {
            let entries = &mut row[column * TERMS..][..TERMS];
            entries
                .iter_mut()
                .zip(moments)
                .for_each(|(e, m)| *e += share * m);
        }
    }
}

impl Transfer {
    /// The matrix of `cells`, each one's rows filled by `fill`; `tell` hears
    /// the done share after every `batch` of cells.
    pub(super) fn new(
        cells: usize,
        batch: usize,
        fill: impl Fn(usize, &mut Rows) + Sync,
        tell: &mut dyn FnMut(f64),
    ) -> Self {
        let size = cells * TERMS * TERMS;
        let mut entries = vec![0.0_f32; cells * size];
        for first in (0..cells).step_by(batch) {
            let end = cells.min(first + batch);
            let rows = entries[first * size..end * size].par_chunks_exact_mut(size);
            rows.zip(first..end).for_each(|(out, cell)| {
                let mut rows = Rows {
                    cells,
                    entries: vec![0.0; size],
                };
                fill(cell, &mut rows);
                let pairs = out.iter_mut().zip(rows.entries);
                pairs.for_each(|(out, entry)| *out = entry as f32);
            });
            tell(end as f64 / cells as f64);
        }
        Self { cells, entries }
    }

    /// Irradiance on every cell by the radiance of all, channel by channel.
    pub(super) fn next(&self, radiance: &[Vec<Polynomial>]) -> Vec<Vec<Polynomial>> {
        let channels = radiance.first().map_or(0, Vec::len);
        let rows = self
            .entries
            .par_chunks_exact((self.cells * TERMS * TERMS).max(1));
        rows.map(|rows| {
            let mut found = vec![[0.0; TERMS]; channels];
            for (term, row) in rows.chunks_exact(self.cells * TERMS).enumerate() {
                for (entries, cell) in row.chunks_exact(TERMS).zip(radiance) {
                    for (found, polynomial) in found.iter_mut().zip(cell) {
                        let pairs = entries.iter().zip(polynomial);
                        found[term] += pairs.map(|(e, c)| f64::from(*e) * c).sum::<f64>();
                    }
                }
            }
            found
        })
        .collect()
    }
}
