//! The classical method that structured sampling is measured against:
//! progressive radiosity with ray-traced form factors.
//!
//! Wallace, Elmquist and Haines 1989 ("A ray tracing algorithm for
//! progressive radiosity") let the vertices of the elements sample the
//! emitter. Each sample is a disc of the area it stands for, and
//!
//! `ΔF = cos θ_vertex cos θ_sample ΔA / (π r² + ΔA)`
//!
//! is added up over the samples; a vertex gets `E = π L Σ ΔF`. Luminaires
//! shoot first, then, as often as asked, the patches of every surface with
//! the mean radiosity of their part of the elements. In between the vertices
//! irradiance is bilinear. Scenes without occlusion, first channel.

mod frame;
mod parameters;

use std::f64::consts::PI;
use std::fmt;

use glam::DVec3;

use crate::scene::Scene;
use frame::Frame;
pub use parameters::{Parameters, Resolution};

/// Why the baseline cannot solve a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Error {
    /// A surface that takes part is no parallelogram.
    Shape {
        /// The surface's name.
        surface: String,
    },
    /// A count of patches, vertices or samples is too small.
    Count {
        /// The surface's name, or none where a count for all is meant.
        surface: Option<String>,
    },
    /// Parameters name a surface that the scene lacks.
    Unknown {
        /// The name.
        surface: String,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Shape { surface } => write!(
                f,
                "surface \"{surface}\" is no parallelogram; the baseline divides \
                 parallelograms only: split the surface into such"
            ),
            Self::Count { surface } => {
                if let Some(surface) = surface {
                    write!(f, "surface \"{surface}\": ")?;
                }
                write!(
                    f,
                    "the baseline needs at least 1 patch, 2 element vertices and 1 sample a side"
                )
            }
            Self::Unknown { surface } => write!(
                f,
                "the baseline's parameters name surface \"{surface}\", which the scene lacks"
            ),
        }
    }
}

impl std::error::Error for Error {}

/// Delta form factors spent on one pair of surfaces in one round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shot {
    /// 0 for the luminaires, k for light reflected k times.
    pub round: usize,
    /// Index of the shooting surface.
    pub emitter: usize,
    /// Index of the receiving surface.
    pub receiver: usize,
    /// Delta form factors evaluated: vertices × samples.
    pub evaluations: u64,
}

/// A surface that receives, with the irradiance of its element vertices.
#[derive(Debug)]
struct Elements {
    frame: Frame,
    resolution: Resolution,
    reflectance: f64,
    /// All light so far, u fastest.
    total: Vec<f64>,
    /// Light of the last round.
    fresh: Vec<f64>,
}

/// A solved scene.
#[derive(Debug)]
pub struct Baseline {
    surfaces: Vec<Option<Elements>>,
    shots: Vec<Shot>,
}

/// Solves a scene. The result is a function of scene and parameters alone:
/// one thread, fixed order.
///
/// Surfaces that reflect receive; others only where `parameters` give them a
/// resolution of their own. A vertex in the shooter's plane or behind it is passed
/// over without cost, and so is a patch with nothing to shoot. Cost: one
/// [`Shot`] entry says how many delta form factors each pair of surfaces took,
/// some nanoseconds each.
///
/// # Errors
///
/// [`Error`] where a surface that emits or receives is no parallelogram, a
/// count is too small, or a name is unknown.
pub fn solve(scene: &Scene, parameters: &Parameters) -> Result<Baseline, Error> {
    parameters.check(scene)?;
    let mut frames = Vec::with_capacity(scene.surfaces.len());
    for surface in &scene.surfaces {
        let takes_part = surface.radiance[0] > 0.0 || parameters.receives(surface);
        frames.push(if takes_part {
            Some(Frame::of(surface)?)
        } else {
            None
        });
    }
    let mut baseline = Baseline {
        surfaces: Vec::with_capacity(frames.len()),
        shots: Vec::new(),
    };
    for (surface, frame) in scene.surfaces.iter().zip(&frames) {
        let frame = frame.filter(|_| parameters.receives(surface));
        baseline.surfaces.push(frame.map(|frame| {
            let resolution = parameters.resolution(&surface.name);
            let vertices = resolution.vertices_a_side * resolution.vertices_a_side;
            Elements {
                frame,
                resolution,
                reflectance: surface.reflectance[0],
                total: vec![0.0; vertices],
                fresh: vec![0.0; vertices],
            }
        }));
    }
    for (index, (surface, frame)) in scene.surfaces.iter().zip(&frames).enumerate() {
        if let Some(frame) = frame.filter(|_| surface.radiance[0] > 0.0) {
            let samples = frame.samples(parameters.source_samples_a_side);
            baseline.shoot(0, index, &samples, surface.radiance[0]);
        }
    }
    for round in 1..=parameters.reflections {
        baseline.reflect(round, parameters.patch_samples_a_side);
    }
    Ok(baseline)
}

/// Samples of an emitter: places, and the area each stands for.
struct Samples {
    places: Vec<DVec3>,
    normal: DVec3,
    area: f64,
}

impl Samples {
    /// `Σ ΔF` of a vertex.
    fn form_factor(&self, position: DVec3, normal: DVec3) -> f64 {
        let mut sum = 0.0;
        for place in &self.places {
            let towards = *place - position;
            let square = towards.length_squared();
            let (here, there) = (normal.dot(towards), -self.normal.dot(towards));
            if here > 0.0 && there > 0.0 {
                sum += here * there / square * self.area / (PI * square + self.area);
            }
        }
        sum
    }
}

impl Baseline {
    /// Every patch shoots what its elements received in the last round.
    fn reflect(&mut self, round: usize, samples_a_side: usize) {
        let mut patches: Vec<(usize, Samples, f64)> = Vec::new();
        for (index, surface) in self.surfaces.iter_mut().enumerate() {
            let Some(elements) = surface else { continue };
            let side = elements.resolution.patches_a_side;
            for row in 0..side {
                for column in 0..side {
                    let irradiance = elements.patch_mean(column, row);
                    let radiance = elements.reflectance * irradiance / PI;
                    if radiance > 0.0 {
                        let part = elements.frame.part((column, row), side);
                        patches.push((index, part.samples(samples_a_side), radiance));
                    }
                }
            }
            elements.fresh.fill(0.0);
        }
        for (index, samples, radiance) in patches {
            self.shoot(round, index, &samples, radiance);
        }
    }

    /// One emitter shoots to the vertices of all other surfaces.
    fn shoot(&mut self, round: usize, emitter: usize, samples: &Samples, radiance: f64) {
        for (receiver, surface) in self.surfaces.iter_mut().enumerate() {
            let Some(elements) = surface else { continue };
            if receiver == emitter {
                continue;
            }
            let mut evaluations = 0;
            let side = elements.resolution.vertices_a_side;
            for index in 0..elements.total.len() {
                let position = elements.frame.vertex((index % side, index / side), side);
                let height = samples.normal.dot(position - samples.places[0]);
                if height <= elements.frame.rounding() {
                    continue;
                }
                let factor = samples.form_factor(position, elements.frame.normal);
                evaluations += samples.places.len() as u64;
                elements.total[index] += PI * radiance * factor;
                elements.fresh[index] += PI * radiance * factor;
            }
            if evaluations > 0 {
                let shot = Shot {
                    round,
                    emitter,
                    receiver,
                    evaluations,
                };
                record(&mut self.shots, shot);
            }
        }
    }

    /// Irradiance at (`u`, `v`), each 0 to 1 and clamped to it, of surface
    /// number `surface`: u runs from the first vertex to the second, v from
    /// the first to the last. `None` for a surface that does not receive.
    #[must_use]
    pub fn irradiance(&self, surface: usize, u: f64, v: f64) -> Option<f64> {
        let elements = self.surfaces.get(surface)?.as_ref()?;
        Some(elements.interpolate(u, v))
    }

    /// [`Baseline::irradiance`] at a point of the surface, in metres.
    #[must_use]
    pub fn irradiance_at(&self, surface: usize, position: DVec3) -> Option<f64> {
        let elements = self.surfaces.get(surface)?.as_ref()?;
        let (u, v) = elements.frame.locate(position);
        Some(elements.interpolate(u, v))
    }

    /// What was spent, pair by pair, in the order of the rounds.
    #[must_use]
    pub fn shots(&self) -> &[Shot] {
        &self.shots
    }

    /// All delta form factors together.
    #[must_use]
    pub fn evaluations(&self) -> u64 {
        self.shots.iter().map(|shot| shot.evaluations).sum()
    }

    /// Element vertices of a surface; `None` where it does not receive.
    #[must_use]
    pub fn vertices(&self, surface: usize) -> Option<usize> {
        Some(self.surfaces.get(surface)?.as_ref()?.total.len())
    }
}

/// Adds a shot to the account of its round and pair of surfaces.
fn record(shots: &mut Vec<Shot>, shot: Shot) {
    let pair = |shot: &Shot| (shot.round, shot.emitter, shot.receiver);
    match shots.iter_mut().find(|known| pair(known) == pair(&shot)) {
        Some(known) => known.evaluations += shot.evaluations,
        None => shots.push(shot),
    }
}

impl Elements {
    /// Bilinear interpolation between the four vertices around a place.
    fn interpolate(&self, u: f64, v: f64) -> f64 {
        let side = self.resolution.vertices_a_side;
        let place = |t: f64| {
            let t = t.clamp(0.0, 1.0) * (side - 1) as f64;
            let low = (t.floor() as usize).min(side - 2);
            (low, t - low as f64)
        };
        let ((i, s), (j, t)) = (place(u), place(v));
        let at = |i: usize, j: usize| self.total[j * side + i];
        let low = at(i, j) * (1.0 - s) + at(i + 1, j) * s;
        let high = at(i, j + 1) * (1.0 - s) + at(i + 1, j + 1) * s;
        low * (1.0 - t) + high * t
    }

    /// Mean over a patch of the bilinear irradiance of the last round.
    fn patch_mean(&self, column: usize, row: usize) -> f64 {
        let side = self.resolution.vertices_a_side;
        let patches = self.resolution.patches_a_side as f64;
        let weights = |index: usize| hat_means(index as f64 / patches, 1.0 / patches, side);
        let (along_u, along_v) = (weights(column), weights(row));
        self.fresh
            .chunks_exact(side)
            .zip(&along_v)
            .map(|(line, wv)| wv * line.iter().zip(&along_u).map(|(e, wu)| e * wu).sum::<f64>())
            .sum()
    }
}

/// Means over `[start, start + width]` of the `count` hat functions on
/// equally spaced vertices of `[0, 1]`.
fn hat_means(start: f64, width: f64, count: usize) -> Vec<f64> {
    let spans = (count - 1) as f64;
    // Integral of a hat of half width 1 from its foot to `t`.
    let integral = |t: f64| match t.clamp(-1.0, 1.0) {
        t if t <= 0.0 => 0.5 * (t + 1.0) * (t + 1.0),
        t => 1.0 - 0.5 * (1.0 - t) * (1.0 - t),
    };
    (0..count)
        .map(|index| {
            let at = |place: f64| integral(place * spans - index as f64);
            (at(start + width) - at(start)) / (width * spans)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::hat_means;

    #[test]
    fn means_of_hats_are_those_of_lines() {
        for (start, width, count) in [
            (0.0, 0.5, 10),
            (0.5, 0.5, 8),
            (0.25, 0.25, 2),
            (0.0, 1.0, 3),
        ] {
            let means = hat_means(start, width, count);
            let sum: f64 = means.iter().sum();
            assert!((sum - 1.0).abs() < 1e-14);
            // A line equals its interpolant, so its mean is its middle value.
            let line = |place: f64| 3.0 * place - 0.7;
            let vertices = means.iter().enumerate();
            let mean: f64 = vertices
                .map(|(i, w)| w * line(i as f64 / (count - 1) as f64))
                .sum();
            assert!((mean - line(start + 0.5 * width)).abs() < 1e-14);
        }
    }
}
