//! Error-driven placement in rooms: shadows, and light to and fro.
//!
//! What a surface receives is the sum of two fields. Direct light is U V: U, what
//! would come if nothing hid anything, through a tensor grid of samples that look
//! past the occluders; V, the fraction of it that is seen, on a mesh that follows
//! the shadows' outlines, from samples in the penumbras. Reflected light is on a
//! mesh that follows the feet of what stands there, from samples placed where they
//! tell most of what the patches may send.
//!
//! Every term of every surface has a ladder of plans, the samples rising and the
//! predicted error falling; the budget goes where a sample lessens the scene's error
//! most. A draft of the patches ([`super::patches`]) is what the planner knows the
//! light from. In the end the same samples also tell the patches what to shoot:
//! nothing is evaluated twice.

mod direct;
mod ladder;
mod reflected;
mod transfer;

use super::fields::Field as Term;
use super::shadow;
use super::{Part, Plan, Predicted, Sample, SurfacePlan, Tag, Unplannable};
use crate::scene::frame::Frame;
use crate::scene::{Budget, Scene};
use direct::Direct;
use glam::DVec3;
use ladder::Step;
use rayon::prelude::*;
use reflected::Reflected;

/// Places with their normals.
pub type Places = [(DVec3, DVec3)];

/// What every emitter gives to places: by place, then by emitter.
pub type Terms<'a> = dyn Fn(&Places) -> Vec<Vec<f32>> + Sync + 'a;

/// The light of a draft, as far as planning needs it.
pub struct Known<'a> {
    /// Its patches and their samples.
    pub draft: &'a Plan,
    /// From luminaires, past what occludes.
    pub unshadowed: &'a Terms<'a>,
    /// From luminaires.
    pub direct: &'a Terms<'a>,
    /// From patches.
    pub reflected: &'a Terms<'a>,
}

/// Why a room could not be planned.
#[derive(Clone, Debug)]
pub enum Error {
    /// The budget.
    Samples(Unplannable),
    /// A shadow.
    Shadow(shadow::Error),
}

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Samples(error) => error.fmt(f),
            Self::Shadow(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for Error {}

/// The predicted error of every term, the root of the mean square over its surface,
/// with which it needs no more samples where the scene sets no budget.
const WELL: f64 = 0.004;

/// What a surface's terms can be.
struct Surface {
    direct: Option<Direct>,
    reflected: Option<Reflected>,
}

/// Plans a room.
///
/// # Errors
/// [`Error`] where the budget is too small or too large, or a shadow cannot be
/// found.
pub fn plan(scene: &Scene, budget: &Budget, known: &Known<'_>) -> Result<Plan, Error> {
    let of_surface = |index: usize| -> Result<Option<Surface>, Error> {
        let surface = &scene.surfaces[index];
        if !surface.reflects() {
            return Ok(None);
        }
        let floor = shadow::Floor::of(scene, index).map_err(Error::Shadow)?;
        let reflected = Reflected::of(&floor, surface.area, known);
        let direct = Direct::of(scene, index, &floor, known).map_err(Error::Shadow)?;
        Ok(Some(Surface { direct, reflected }))
    };
    let surfaces: Vec<Option<Surface>> = (0..scene.surfaces.len())
        .into_par_iter()
        .map(of_surface)
        .collect::<Result<_, Error>>()?;
    let ladders: Vec<&[Step]> = surfaces.iter().flat_map(Surface::ladders).collect();
    let chosen = ladder::divide(&ladders, budget.samples, WELL).map_err(Error::Samples)?;
    let mut predicted = ladders.chunks(3).zip(chosen.chunks(3)).map(predicted);
    let mut chosen = chosen.chunks(3);
    let planned: Vec<SurfacePlan> = (surfaces.iter().enumerate())
        .map(|(index, surface)| {
            let steps = chosen.next().unwrap_or(&[0; 3]);
            let frame = Frame::new(&scene.surfaces[index]);
            let predicted = predicted.next().unwrap_or_default();
            match surface {
                Some(surface) => SurfacePlan {
                    predicted,
                    ..surface.plan(frame, [steps[0], steps[1], steps[2]])
                },
                None => SurfacePlan::without_samples(frame),
            }
        })
        .collect();
    let mut plan = Plan { surfaces: planned };
    transfer::shoot_from_samples(&mut plan, known);
    Ok(plan)
}

/// What a surface errs by with these steps of its ladders.
fn predicted((ladders, steps): (&[&[Step]], &[usize])) -> Vec<Predicted> {
    let parts = [Part::Unshadowed, Part::Shadows, Part::Reflected];
    let chosen = parts.into_iter().zip(ladders).zip(steps);
    let of_part = |((part, ladder), &step): ((Part, &&[Step]), &usize)| {
        let step = ladder.get(step)?;
        Some(Predicted {
            part,
            rms: step.error(),
            area: step.area,
        })
    };
    chosen.filter_map(of_part).collect()
}

impl Surface {
    /// Of the tensor, of the shadows, of reflected light.
    fn ladders(surface: &Option<Self>) -> [&[Step]; 3] {
        let direct = surface.as_ref().and_then(|surface| surface.direct.as_ref());
        let reflected = surface
            .as_ref()
            .and_then(|surface| surface.reflected.as_ref());
        [
            direct.map_or(&[], |direct| &direct.grids),
            direct.map_or(&[], |direct| direct.shadow_steps()),
            reflected.map_or(&[], |reflected| &reflected.steps),
        ]
    }

    /// With these steps of its ladders.
    fn plan(&self, frame: Frame, [grid, shadow, reflected]: [usize; 3]) -> SurfacePlan {
        let mut samples: Vec<Sample> = Vec::new();
        let mut fields: Vec<Term> = Vec::new();
        let mut add = |places: &[[f64; 2]], tag| {
            let first = samples.len();
            samples.extend(places.iter().map(|&place| Sample {
                place,
                vertex: place,
                tag,
            }));
            first
        };
        if let Some(direct) = &self.direct {
            let mut tensor = direct.tensor(grid);
            tensor.first = add(&tensor.places(), Tag::Lit);
            let mesh = direct.mesh(shadow).map(|(places, mut mesh)| {
                mesh.first = add(&places, Tag::Penumbra);
                mesh
            });
            fields.push(Term {
                tensor: Some(tensor),
                mesh,
            });
        }
        if let Some(of_patches) = &self.reflected {
            let (places, mut mesh) = of_patches.mesh(reflected);
            mesh.first = add(&places, Tag::Reflected);
            fields.push(Term {
                tensor: None,
                mesh: Some(mesh),
            });
        }
        SurfacePlan {
            samples,
            fields,
            ..SurfacePlan::without_samples(frame)
        }
    }
}
