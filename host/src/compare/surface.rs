//! One surface, on a grid over its bounding rectangle.

use super::{Answers, Errors, errors, exact, mean};
use crate::occlusion::Solids;
use isolux::Error;

/// The three answers on a grid, row by row from v = 0, and what they differ by.
#[derive(Clone, Debug)]
pub struct Compared {
    /// Index of the surface in the scene.
    pub surface: usize,
    /// Cells along each side.
    pub resolution: usize,
    /// Which cells' centres lie in the polygon and are not hidden by a body that
    /// stands there.
    pub inside: Vec<bool>,
    /// Irradiance by the reference, the mean of its channels; 0 outside.
    pub reference: Vec<f64>,
    /// Irradiance by the kernel, resampled, the mean of its channels.
    pub structured: Vec<f64>,
    /// Irradiance by the classical method.
    pub baseline: Option<Vec<f64>>,
    /// The largest reference value.
    pub full_scale: f64,
    /// What the kernel errs by.
    pub errors: Errors,
    /// What the classical method errs by.
    pub baseline_errors: Option<Errors>,
    /// Cells that had no sample within the filter's radius.
    pub out_of_reach: u32,
}

/// Compares a surface on `resolution` × `resolution` cells, without those that
/// `solids` hide; `done` is told how many more cells of all have been looked at.
///
/// # Errors
/// [`Error::Unknown`] where there is no such surface.
pub fn surface(
    answers: &Answers<'_>,
    solids: &Solids,
    index: usize,
    resolution: usize,
    done: &mut dyn FnMut(usize),
) -> Result<Compared, Error> {
    let grid = answers.solution.resample(index, resolution as u32)?;
    let frame = &answers.plan.surfaces[index].frame;
    let places: Vec<(f64, f64)> = (0..resolution * resolution)
        .map(|k| frame.cell_center(k % resolution, k / resolution, resolution, resolution))
        .collect();
    let seen = |&(u, v): &(f64, f64)| {
        frame.contains(u, v) && !solids.hide(index, frame.to_world(u, v), frame.normal)
    };
    let inside: Vec<bool> = places.iter().map(seen).collect();
    let cells: Vec<usize> = (0..places.len()).filter(|&k| inside[k]).collect();
    let asked: Vec<_> = cells
        .iter()
        .map(|&k| (frame.to_world(places[k].0, places[k].1), frame.normal))
        .collect();
    let mut reference = vec![0.0; places.len()];
    done(places.len() - cells.len());
    for (&k, value) in cells.iter().zip(exact(answers.reference, &asked, done)) {
        reference[k] = mean(value);
    }
    let values = grid.values.into_iter();
    let structured: Vec<f64> = values.map(|value| mean(value.map(f64::from))).collect();
    let baseline = answers.baseline.and_then(|baseline| {
        let at = |&(u, v): &(f64, f64)| baseline.irradiance_at(index, frame.to_world(u, v));
        places.iter().map(at).collect::<Option<Vec<f64>>>()
    });
    let full_scale = reference.iter().copied().fold(0.0, f64::max);
    let against =
        |values: &[f64]| errors(cells.iter().map(|&k| (values[k], reference[k])), full_scale);
    Ok(Compared {
        surface: index,
        resolution,
        errors: against(&structured),
        baseline_errors: baseline.as_deref().map(against),
        inside,
        reference,
        structured,
        baseline,
        full_scale,
        out_of_reach: grid.out_of_reach,
    })
}
