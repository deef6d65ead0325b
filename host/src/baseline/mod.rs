//! The classical method that structured sampling is measured against:
//! progressive radiosity with ray-traced form factors.
//!
//! Wallace, Elmquist and Haines 1989 ("A ray tracing algorithm for
//! progressive radiosity") let the vertices of the elements sample the
//! emitter. Each sample is a disc of the area it stands for, and
//!
//! `ΔF = V cos θ_vertex cos θ_sample ΔA / (π r² + ΔA)`
//!
//! is added up over the samples; V is 0 where the ray to the sample meets a
//! surface, else 1. A vertex gets `E = π L Σ ΔF`. Luminaires shoot first, then
//! the patches of every surface with the mean radiosity of their part of the
//! elements: all of them as often as asked, or the one with the most unshot
//! power again and again (Cohen, Chen, Wallace and Greenberg 1988). In between
//! the vertices irradiance is bilinear. Samples and so rays stand on a regular
//! grid; nothing is random. First channel.

mod frame;
mod occluders;
mod parameters;
mod patch;

use std::f64::consts::PI;
use std::fmt;

use glam::DVec3;

use crate::scene::Scene;
use frame::Frame;
use occluders::{Occluders, Span};
pub use parameters::{Parameters, Resolution, Stop};
use patch::Patch;

/// Why the baseline cannot solve a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Error {
    /// A surface that takes part is neither a triangle nor a convex
    /// quadrilateral.
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
                "surface \"{surface}\" is neither a triangle nor a convex quadrilateral; \
                 the baseline divides only these: split the surface into such"
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
    /// 0 for the luminaires, k for light reflected k times; 1 for all
    /// reflected light where patches shoot one by one.
    pub round: usize,
    /// Index of the shooting surface.
    pub emitter: usize,
    /// Index of the receiving surface.
    pub receiver: usize,
    /// Delta form factors evaluated: vertices × samples.
    pub evaluations: u64,
    /// Those that took a ray: both ends face each other.
    pub rays: u64,
}

/// A sample of an emitter.
#[derive(Clone, Copy, Debug)]
struct Sample {
    place: DVec3,
    /// The area it stands for.
    area: f64,
}

/// A surface that receives, with the irradiance of its element vertices.
#[derive(Debug)]
struct Elements {
    frame: Frame,
    resolution: Resolution,
    reflectance: f64,
    /// Where the vertices are evaluated, u fastest.
    places: Vec<DVec3>,
    /// All light so far.
    total: Vec<f64>,
}

/// A solved scene.
#[derive(Debug)]
pub struct Baseline {
    surfaces: Vec<Option<Elements>>,
    occluders: Occluders,
    shots: Vec<Shot>,
    patch_shots: usize,
}

/// Solves a scene. The result is a function of scene and parameters alone:
/// one thread, fixed order.
///
/// Surfaces that reflect receive; others only where `parameters` give them a
/// resolution of their own; all occlude. A vertex in the shooter's plane or
/// behind it is passed over without cost, and so is a patch with nothing to
/// shoot. Cost: one [`Shot`] entry says how many delta form factors each pair
/// of surfaces took, some nanoseconds each, and some more for each surface whose
/// plane parts a vertex from the emitter.
///
/// # Errors
///
/// [`Error`] where a surface that emits or receives is neither a triangle nor a
/// convex quadrilateral, a count is too small, or a name is unknown.
pub fn solve(scene: &Scene, parameters: &Parameters) -> Result<Baseline, Error> {
    parameters.check(scene)?;
    let mut baseline = Baseline {
        surfaces: Vec::with_capacity(scene.surfaces.len()),
        occluders: Occluders::of(scene),
        shots: Vec::new(),
        patch_shots: 0,
    };
    let mut luminaires = Vec::new();
    let mut emitted = 0.0;
    for (index, surface) in scene.surfaces.iter().enumerate() {
        let (emits, receives) = (surface.radiance[0] > 0.0, parameters.receives(surface));
        if emits {
            let frame = Frame::of(surface)?;
            let count = [parameters.source_samples_a_side; 2];
            let samples = frame.samples([0.0; 2], [1.0; 2], count);
            let span = baseline.occluders.span(&surface.vertices);
            luminaires.push((index, frame.normal, samples, span, PI * surface.radiance[0]));
            emitted += PI * surface.radiance[0] * surface.area;
        }
        baseline.surfaces.push(if receives {
            let frame = Frame::of(surface)?;
            let resolution = parameters.resolution(&surface.name);
            let places = vertices(&frame, resolution.vertices, parameters.inset);
            Some(Elements {
                frame,
                resolution,
                reflectance: surface.reflectance[0],
                total: vec![0.0; places.len()],
                places,
            })
        } else {
            None
        });
    }
    for (index, normal, samples, span, exitance) in luminaires {
        baseline.shoot((0, index, normal), &samples, &span, exitance);
    }
    let mut patches = baseline.patches(parameters.patch_samples_a_side);
    match parameters.stop {
        Stop::Reflections(times) => {
            for round in 1..=times {
                baseline.reflect(round, &mut patches);
            }
        }
        Stop::Unshot(fraction) => baseline.progress(fraction * emitted, &mut patches),
    }
    Ok(baseline)
}

/// The places of element vertices, u fastest.
fn vertices(frame: &Frame, count: [usize; 2], inset: f64) -> Vec<DVec3> {
    let at = |axis: usize, index: usize| {
        let spans = (count[axis] - 1) as f64;
        match index {
            0 => inset / spans,
            last if last + 1 == count[axis] => 1.0 - inset / spans,
            index => index as f64 / spans,
        }
    };
    (0..count[0] * count[1])
        .map(|k| frame.place(at(0, k % count[0]), at(1, k / count[0])))
        .collect()
}

impl Baseline {
    /// The patches of all surfaces.
    fn patches(&self, samples_a_side: usize) -> Vec<Patch> {
        let mut patches = Vec::new();
        for (index, surface) in self.surfaces.iter().enumerate() {
            if let Some(elements) = surface {
                patches.extend(Patch::of(index, elements, samples_a_side, &self.occluders));
            }
        }
        patches
    }

    /// Radiosity of a patch that it has not shot yet.
    fn unshot(&self, patch: &Patch) -> f64 {
        let elements = self.surfaces[patch.surface].as_ref();
        let radiosity = elements.map_or(0.0, |e| e.reflectance * patch.mean(&e.total));
        (radiosity - patch.shot).max(0.0)
    }

    /// Every patch shoots what its elements received in the last round.
    fn reflect(&mut self, round: usize, patches: &mut [Patch]) {
        let pending: Vec<f64> = patches.iter().map(|patch| self.unshot(patch)).collect();
        for (patch, radiosity) in patches.iter_mut().zip(pending) {
            self.send(round, patch, radiosity);
        }
    }

    /// The patch with the most unshot power shoots, until less than `enough`
    /// watts are unshot; no more than a hundred shots a patch.
    fn progress(&mut self, enough: f64, patches: &mut [Patch]) {
        for _ in 0..100 * patches.len() {
            let powers = patches
                .iter()
                .map(|patch| self.unshot(patch) * patch.area)
                .enumerate();
            let (mut unshot, mut most) = (0.0, (0, 0.0));
            for (index, power) in powers {
                unshot += power;
                if power > most.1 {
                    most = (index, power);
                }
            }
            let above = unshot > enough && most.1 > 0.0;
            let Some(patch) = patches.get_mut(most.0).filter(|_| above) else {
                return;
            };
            let radiosity = self.unshot(patch);
            self.send(1, patch, radiosity);
        }
    }

    /// A patch shoots this much radiosity.
    fn send(&mut self, round: usize, patch: &mut Patch, radiosity: f64) {
        let Some(elements) = self.surfaces[patch.surface].as_ref() else {
            return;
        };
        if radiosity > 0.0 {
            let shooter = (round, patch.surface, elements.frame.normal);
            self.shoot(shooter, &patch.samples, &patch.span, radiosity);
            patch.shot += radiosity;
            self.patch_shots += 1;
        }
    }

    /// One emitter, a surface's part with its normal, shoots to the vertices
    /// of all other surfaces.
    fn shoot(
        &mut self,
        (round, emitter, normal): (usize, usize, DVec3),
        samples: &[Sample],
        span: &Span,
        radiosity: f64,
    ) {
        let mut between = Vec::new();
        for (receiver, surface) in self.surfaces.iter_mut().enumerate() {
            let Some(elements) = surface.as_mut().filter(|_| receiver != emitter) else {
                continue;
            };
            let (mut evaluations, mut rays) = (0, 0);
            for (position, total) in elements.places.iter().zip(&mut elements.total) {
                let height = normal.dot(*position - samples[0].place);
                if height <= elements.frame.rounding() {
                    continue;
                }
                self.occluders.between(*position, span, &mut between);
                let mut sum = 0.0;
                for sample in samples {
                    let Some(delta) = delta(*position, elements.frame.normal, sample, normal)
                    else {
                        continue;
                    };
                    rays += 1;
                    if !self.occluders.hide(*position, sample.place, &between) {
                        sum += delta;
                    }
                }
                evaluations += samples.len() as u64;
                *total += radiosity * sum;
            }
            if evaluations > 0 {
                let shot = Shot {
                    round,
                    emitter,
                    receiver,
                    evaluations,
                    rays,
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

    /// How often a patch shot.
    #[must_use]
    pub fn patch_shots(&self) -> usize {
        self.patch_shots
    }

    /// All delta form factors together.
    #[must_use]
    pub fn evaluations(&self) -> u64 {
        self.shots.iter().map(|shot| shot.evaluations).sum()
    }

    /// All rays together.
    #[must_use]
    pub fn rays(&self) -> u64 {
        self.shots.iter().map(|shot| shot.rays).sum()
    }

    /// Element vertices of a surface; `None` where it does not receive.
    #[must_use]
    pub fn vertices(&self, surface: usize) -> Option<usize> {
        Some(self.surfaces.get(surface)?.as_ref()?.total.len())
    }
}

/// ΔF of a sample that faces a vertex, if nothing is between them.
fn delta(position: DVec3, normal: DVec3, sample: &Sample, facing: DVec3) -> Option<f64> {
    let towards = sample.place - position;
    let square = towards.length_squared();
    let (here, there) = (normal.dot(towards), -facing.dot(towards));
    (here > 0.0 && there > 0.0)
        .then(|| here * there / square * sample.area / (PI * square + sample.area))
}

/// Adds a shot to the account of its round and pair of surfaces.
fn record(shots: &mut Vec<Shot>, shot: Shot) {
    let pair = |shot: &Shot| (shot.round, shot.emitter, shot.receiver);
    match shots.iter_mut().find(|known| pair(known) == pair(&shot)) {
        Some(known) => {
            known.evaluations += shot.evaluations;
            known.rays += shot.rays;
        }
        None => shots.push(shot),
    }
}

impl Elements {
    /// Bilinear interpolation between the four vertices around a place.
    fn interpolate(&self, u: f64, v: f64) -> f64 {
        let [along_u, along_v] = self.resolution.vertices;
        let place = |t: f64, count: usize| {
            let t = t.clamp(0.0, 1.0) * (count - 1) as f64;
            let low = (t.floor() as usize).min(count - 2);
            (low, t - low as f64)
        };
        let ((i, s), (j, t)) = (place(u, along_u), place(v, along_v));
        let at = |i: usize, j: usize| self.total[j * along_u + i];
        let low = at(i, j) * (1.0 - s) + at(i + 1, j) * s;
        let high = at(i, j + 1) * (1.0 - s) + at(i + 1, j + 1) * s;
        low * (1.0 - t) + high * t
    }
}
