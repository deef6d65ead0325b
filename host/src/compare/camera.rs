//! What a camera sees, pixel by pixel.

use super::{Answers, Errors, errors_by_scale};
use crate::scene::camera::{Hit, View};
use isolux::Error;

/// The three answers at a camera's pixels, rows from the top.
#[derive(Clone, Debug)]
pub struct Seen {
    /// What each pixel sees.
    pub hits: Vec<Option<Hit>>,
    /// Irradiance by the reference; 0 where no front is seen.
    pub reference: Vec<f64>,
    /// Irradiance by the kernel, resampled.
    pub structured: Vec<f64>,
    /// Irradiance by the classical method.
    pub baseline: Option<Vec<f64>>,
    /// What the kernel errs by, over the pixels that see the front of a
    /// reflecting surface.
    pub errors: Errors,
    /// What the classical method errs by.
    pub baseline_errors: Option<Errors>,
}

/// Compares what a camera sees; `full_scale` is each surface's largest
/// reference value.
///
/// # Errors
/// None that a scene and its own plan could cause.
pub fn camera(answers: &Answers<'_>, view: &View, full_scale: &[f64]) -> Result<Seen, Error> {
    let hits = view.hits(answers.scene);
    let lit: Vec<(usize, Hit)> = hits
        .iter()
        .enumerate()
        .filter_map(|(pixel, hit)| hit.filter(|hit| hit.front).map(|hit| (pixel, hit)))
        .filter(|(_, hit)| answers.scene.surfaces[hit.surface].reflectance[0] > 0.0)
        .collect();
    let place = |hit: &Hit| {
        answers.plan.surfaces[hit.surface]
            .frame
            .to_local(hit.position)
    };
    let asked: Vec<_> = lit
        .iter()
        .map(|(_, hit)| (hit.position, answers.scene.surfaces[hit.surface].normal))
        .collect();
    let spread = |values: Vec<f64>| {
        let mut all = vec![0.0; hits.len()];
        for ((pixel, _), value) in lit.iter().zip(values) {
            all[*pixel] = value;
        }
        all
    };
    let reference = spread(answers.reference.irradiance_at(&asked));
    let structured = lit
        .iter()
        .map(|(_, hit)| {
            let (u, v) = place(hit);
            let value = answers
                .solution
                .resampled(hit.surface, [u as f32, v as f32])?;
            Ok(value.map_or(0.0, super::mean))
        })
        .collect::<Result<Vec<f64>, Error>>()?;
    let structured = spread(structured);
    let baseline = answers.baseline.and_then(|baseline| {
        let at = |(_, hit): &(usize, Hit)| baseline.irradiance_at(hit.surface, hit.position);
        lit.iter().map(at).collect::<Option<Vec<f64>>>().map(spread)
    });
    let against = |values: &[f64]| {
        let triple = |&(pixel, hit): &(usize, Hit)| {
            (values[pixel], reference[pixel], full_scale[hit.surface])
        };
        errors_by_scale(lit.iter().map(triple))
    };
    Ok(Seen {
        errors: against(&structured),
        baseline_errors: baseline.as_deref().map(against),
        hits,
        reference,
        structured,
        baseline,
    })
}
