//! Error-driven placement in rooms: shadows, and light to and fro.
//!
//! What a surface receives is the sum of two fields. Direct light is U V: U, what
//! would come if nothing hid anything, through a tensor grid of samples that look
//! past the occluders; V, the fraction of it that is seen, on a mesh that follows
//! the shadows' outlines, from samples in the penumbras. Reflected light is on a
//! mesh that follows the feet of what stands there, from samples placed where they
//! tell most of what the patches may send. What the patches themselves miss, which is
//! most where surfaces meet, is in its weights: a correction of each node, right for the
//! light that the scene states.
//!
//! Every term of every surface has a ladder of plans, the samples rising and the
//! predicted error falling; the budget goes where a sample lessens the scene's error
//! most. A draft of the patches ([`super::patches`]) is what the planner knows the
//! light from. In the end the same samples also tell the patches what to shoot:
//! nothing is evaluated twice.

mod around;
mod direct;
mod ladder;
mod reflected;
mod transfer;
pub mod view;

use super::fields::split::Split;
use super::fields::{Field as Term, Mesh};
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

/// What all emitters of a kind give to places.
pub type Sums<'a> = dyn Fn(&Places) -> Vec<f64> + Sync + 'a;

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
    /// The same of all patches, as many more of them would send it.
    pub settled: &'a Sums<'a>,
    /// How much the error of a place counts.
    pub importance: &'a view::Importance<'a>,
    /// The most samples that contribute to one value.
    pub shares: usize,
}

impl Known<'_> {
    /// How many patches each surface has, in the order of what is reflected.
    fn patches(&self) -> Vec<usize> {
        let surfaces = self.draft.surfaces.iter();
        surfaces.map(|surface| surface.patches.len()).collect()
    }
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

impl From<shadow::Error> for Error {
    fn from(error: shadow::Error) -> Self {
        Self::Shadow(error)
    }
}

/// The predicted error of every term, the root of the mean square over its surface,
/// with which it needs no more samples where the scene sets no budget.
const WELL: f64 = 0.004;

/// What a surface's terms can be.
struct Surface {
    direct: Option<Direct>,
    reflected: Option<Reflected>,
}

/// A room that has been looked at: what its plans are chosen from.
pub struct Room<'a> {
    scene: &'a Scene,
    known: &'a Known<'a>,
    surfaces: Vec<Option<Surface>>,
}

/// Looks at a room.
///
/// # Errors
/// [`Error`] where a shadow cannot be found.
pub fn look<'a>(scene: &'a Scene, known: &'a Known<'a>) -> Result<Room<'a>, Error> {
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
    Ok(Room {
        scene,
        known,
        surfaces,
    })
}

impl Room<'_> {
    /// Where the nodes of a surface's reflected light are looked at, with its normal; those
    /// that were put there first come first.
    pub fn looked_at(&self, surface: usize) -> Vec<(DVec3, DVec3)> {
        let looked = self.surfaces.get(surface).and_then(Option::as_ref);
        let reflected = looked.and_then(|surface| surface.reflected.as_ref());
        let frame = Frame::new(&self.scene.surfaces[surface]);
        let places = reflected.map_or(Vec::new(), |reflected| reflected.split.inside());
        let in_space = |[u, v]: [f64; 2]| (frame.to_world(u, v), frame.normal);
        places.into_iter().map(in_space).collect()
    }

    /// Plans it with so many bytes of meshes in flash at the most, or a little more
    /// where the coarsest ones take more.
    ///
    /// # Errors
    /// [`Error`] where the budget of samples is too small or too large.
    pub fn plan(&self, budget: &Budget, bytes: Option<usize>) -> Result<Plan, Error> {
        let ladders: Vec<&[Step]> = self.surfaces.iter().flat_map(Surface::ladders).collect();
        let chosen = ladder::divide(&ladders, budget.samples, WELL).map_err(Error::Samples)?;
        let mut predicted = ladders.chunks(3).zip(chosen.chunks(3)).map(predicted);
        let mut chosen = chosen.chunks(3);
        let mut splits = Vec::new();
        let planned: Vec<SurfacePlan> = (self.surfaces.iter().enumerate())
            .map(|(index, surface)| {
                let steps = chosen.next().unwrap_or(&[0; 3]);
                let frame = Frame::new(&self.scene.surfaces[index]);
                let predicted = predicted.next().unwrap_or_default();
                match surface {
                    Some(surface) => {
                        let (plan, of_meshes) = surface.plan(frame, [steps[0], steps[1], steps[2]]);
                        splits.extend(of_meshes);
                        SurfacePlan { predicted, ..plan }
                    }
                    None => SurfacePlan::without_samples(frame),
                }
            })
            .collect();
        let mut plan = Plan::from(planned);
        if let Some(bytes) = bytes {
            thin(&mut plan, &splits, bytes);
        }
        transfer::shoot_from_samples(&mut plan, self.known);
        Ok(plan)
    }
}

/// Takes corners of meshes away, which lessen the loss least, until all meshes have
/// so many bytes. `splits` are how they came about, in the order of the plan.
fn thin(plan: &mut Plan, splits: &[&Split], bytes: usize) {
    let fields = plan.surfaces.iter_mut().flat_map(|s| &mut s.fields);
    let mut meshes: Vec<&mut Mesh> = fields.filter_map(|field| field.mesh.as_mut()).collect();
    // Of each corner its worth, its mesh, its bytes.
    let mut corners: Vec<(f64, usize, usize)> = Vec::new();
    for (k, (mesh, split)) in meshes.iter().zip(splits).enumerate() {
        let nodes = mesh.nodes.iter().map(|node| (k, node.bytes()));
        let of_mesh = split.worth().into_iter().zip(nodes);
        corners.extend(of_mesh.map(|(worth, (k, bytes))| (worth, k, bytes)));
    }
    corners.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut kept = vec![0; meshes.len()];
    let mut used = 0;
    for (worth, mesh, of_one) in corners {
        used += of_one;
        if worth.is_finite() && used > bytes {
            break;
        }
        kept[mesh] += 1;
    }
    for ((mesh, split), kept) in meshes.iter_mut().zip(splits).zip(kept) {
        mesh.nodes.truncate(kept);
        mesh.triangles = split.coarser(kept);
    }
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

    /// With these steps of its ladders; and how its meshes came about.
    fn plan(
        &self,
        frame: Frame,
        [grid, shadow, reflected]: [usize; 3],
    ) -> (SurfacePlan, Vec<&Split>) {
        let mut splits = Vec::new();
        let mut samples: Vec<Sample> = Vec::new();
        let mut fields: Vec<Term> = Vec::new();
        let mut add = |places: &[[f64; 2]], tag: &dyn Fn(usize) -> Tag| {
            let first = samples.len();
            let tagged = places.iter().enumerate();
            samples.extend(tagged.map(|(k, &place)| Sample {
                place,
                vertex: place,
                tag: tag(k),
            }));
            first
        };
        if let Some(direct) = &self.direct {
            let mut tensor = direct.tensor(grid);
            tensor.first = add(&tensor.places(), &|_| Tag::Lit);
            let mesh = direct.mesh(shadow).map(|(places, mut mesh, split)| {
                splits.push(split);
                mesh.first = add(&places, &|_| Tag::Penumbra);
                mesh
            });
            fields.push(Term {
                tensor: Some(tensor),
                mesh,
            });
        }
        if let Some(of_patches) = &self.reflected {
            let (places, mut mesh) = of_patches.mesh(reflected);
            mesh.first = add(&places, &|k| of_patches.tag(k, places.len()));
            splits.push(&of_patches.split);
            fields.push(Term {
                tensor: None,
                mesh: Some(mesh),
            });
        }
        let plan = SurfacePlan {
            samples,
            fields,
            ..SurfacePlan::without_samples(frame)
        };
        (plan, splits)
    }
}
