//! What a camera sees, pixel by pixel.

use super::{Answers, Errors, errors_by_scale, exact, mean};
use crate::scene::camera::{Hit, View};
use isolux::Error;

/// The answers at a camera's pixels, rows from the top; irradiance in three
/// channels, which are equal where the scene is grey.
#[derive(Clone, Debug)]
pub struct Seen {
    /// What each pixel sees.
    pub hits: Vec<Option<Hit>>,
    /// Irradiance by the reference; 0 where no front is seen.
    pub reference: Vec<[f64; 3]>,
    /// Irradiance by the kernel, resampled.
    pub structured: Vec<[f64; 3]>,
    /// Irradiance by the kernel, evaluated at each pixel: in rooms.
    pub evaluated: Option<Evaluated>,
    /// Irradiance by the classical method, where it can be had.
    pub baseline: Option<Vec<[f64; 3]>>,
    /// What the kernel's resampled answer errs by, over the pixels that see the
    /// front of a reflecting surface.
    pub errors: Errors,
    /// What the classical method errs by.
    pub baseline_errors: Option<Errors>,
}

/// The kernel's answer from the emitters, without resampling.
#[derive(Clone, Debug)]
pub struct Evaluated {
    /// Irradiance, as in [`Seen`].
    pub values: Vec<[f64; 3]>,
    /// What it errs by.
    pub errors: Errors,
    /// Pixels at which visibility met a bound of the workspace; their value is
    /// the middle of what is possible.
    pub inexact: usize,
}

/// Pixels whose reference or evaluation [`camera`] asks for, at most: two a
/// pixel in rooms, else one.
#[must_use]
pub fn effort(answers: &Answers<'_>, view: &View) -> u64 {
    let pixels = u64::from(view.width()) * u64::from(view.height());
    pixels * if answers.plan.is_linear() { 2 } else { 1 }
}

/// Compares what a camera sees; `full_scale` is each surface's largest
/// reference value, `done` is told how much more of [`effort`] is done.
///
/// # Errors
/// None that a scene and its own plan could cause.
pub fn camera(
    answers: &Answers<'_>,
    view: &View,
    full_scale: &[f64],
    done: &mut dyn FnMut(usize),
) -> Result<Seen, Error> {
    let hits = view.hits(answers.scene);
    let lit = Lit::new(answers, &hits);
    done(hits.len() - lit.pixels.len());
    let reference = lit.spread(exact(answers.reference, &lit.places(), done));
    let structured = lit.spread(lit.resampled()?);
    let evaluated = if answers.plan.is_linear() {
        done(hits.len() - lit.pixels.len());
        let (values, inexact) = lit.evaluated(done)?;
        let values = lit.spread(values);
        Some(Evaluated {
            errors: lit.errors(&values, &reference, full_scale),
            values,
            inexact,
        })
    } else {
        None
    };
    let baseline = lit.classical().map(|values| lit.spread(values));
    let against = |values: &[[f64; 3]]| lit.errors(values, &reference, full_scale);
    Ok(Seen {
        errors: against(&structured),
        baseline_errors: baseline.as_deref().map(against),
        reference,
        structured,
        evaluated,
        baseline,
        hits,
    })
}

/// The pixels that see the front of a reflecting surface.
struct Lit<'a> {
    answers: &'a Answers<'a>,
    pixels: Vec<(usize, Hit)>,
    all: usize,
}

impl<'a> Lit<'a> {
    fn new(answers: &'a Answers<'a>, hits: &[Option<Hit>]) -> Self {
        let reflecting = |hit: &Hit| hit.front && answers.scene.surfaces[hit.surface].reflects();
        let pixels = hits.iter().enumerate();
        Self {
            answers,
            pixels: pixels
                .filter_map(|(pixel, hit)| hit.filter(reflecting).map(|hit| (pixel, hit)))
                .collect(),
            all: hits.len(),
        }
    }

    fn places(&self) -> Vec<(glam::DVec3, glam::DVec3)> {
        let normal = |hit: &Hit| self.answers.scene.surfaces[hit.surface].normal;
        let place = |(_, hit): &(usize, Hit)| (hit.position, normal(hit));
        self.pixels.iter().map(place).collect()
    }

    /// Values of these pixels among all, darkness elsewhere.
    fn spread(&self, values: Vec<[f64; 3]>) -> Vec<[f64; 3]> {
        let mut all = vec![[0.0; 3]; self.all];
        for ((pixel, _), value) in self.pixels.iter().zip(values) {
            all[*pixel] = value;
        }
        all
    }

    fn resampled(&self) -> Result<Vec<[f64; 3]>, Error> {
        let at = |(_, hit): &(usize, Hit)| {
            let frame = &self.answers.plan.surfaces[hit.surface].frame;
            let (u, v) = frame.to_local(hit.position);
            let place = [u as f32, v as f32];
            let value = self.answers.solution.resampled(hit.surface, place)?;
            Ok(value.map_or([0.0; 3], |value| value.map(f64::from)))
        };
        self.pixels.iter().map(at).collect()
    }

    /// The kernel's answers at the pixels, and how many are inexact.
    fn evaluated(&self, done: &mut dyn FnMut(usize)) -> Result<(Vec<[f64; 3]>, usize), Error> {
        let single = |v: glam::DVec3| v.as_vec3().to_array();
        let places = self.places();
        let mut values = Vec::with_capacity(places.len());
        let mut inexact = 0;
        for batch in places.chunks(super::BATCH) {
            let batch = batch.iter().map(|&(p, n)| (single(p), single(n)));
            let answers = self.answers.solution.at(&batch.collect::<Vec<_>>())?;
            inexact += answers.iter().filter(|at| !at.is_exact).count();
            done(answers.len());
            values.extend(answers.iter().map(|at| at.value.map(f64::from)));
        }
        Ok((values, inexact))
    }

    fn classical(&self) -> Option<Vec<[f64; 3]>> {
        let baseline = self.answers.baseline?;
        let at = |(_, hit): &(usize, Hit)| baseline.irradiance_at(hit.surface, hit.position);
        let values = self.pixels.iter().map(at);
        values.map(|value| value.map(|value| [value; 3])).collect()
    }

    fn errors(&self, values: &[[f64; 3]], reference: &[[f64; 3]], full_scale: &[f64]) -> Errors {
        errors_by_scale(self.pixels.iter().map(|&(pixel, hit)| {
            let pair = [values, reference].map(|answers| mean(answers[pixel]));
            (pair[0], pair[1], full_scale[hit.surface])
        }))
    }
}
