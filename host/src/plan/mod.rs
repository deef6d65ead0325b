//! Decides where a scene is sampled and what shoots its reflected light.
//!
//! The isolux mode is the paper's, made automatic: the irradiance each surface
//! receives is known from the reference; its isolux outlines become the
//! polygons that shoot reflected light, either what lies between two of them or
//! what each encloses, and their vertices, with the peak, are the
//! samples. In a room, where light goes to and fro, [`patches`] with linear
//! radiosity do the same with a tenth of the emitters. Error-driven placement
//! puts samples where they lessen the error most, in open scenes at the nodes of
//! tensor grids, in rooms ([`room`]) along the edges of shadows, which [`shadow`]
//! knows. A planned scene is data: [`crate::bake`] turns it into tables.

mod error;
pub mod fields;
pub mod file;
mod isolux;
mod layers;
mod map;
mod outline;
pub mod patches;
mod pool;
mod predicted;
pub mod room;
pub mod shadow;
mod share;
mod spacing;
mod tag;

use crate::scene::frame::Frame;
use crate::scene::{Budget, Scene, Surface};
pub use error::{error_driven, error_driven_with_few_points};
use fields::Field as Term;
use glam::DVec3;
use patches::Patch;
pub use predicted::{Part, Predicted, PredictedAt};
use std::f64::consts::PI;
pub use tag::{Receives, Seen, Tag};

/// Where the samples of a scene are, and which polygons shoot.
#[derive(Clone, Debug)]
pub struct Plan {
    /// One entry for each surface of the scene, in its order.
    pub surfaces: Vec<SurfacePlan>,
    /// Whether the device keeps reflectances of its own, so that they may change there.
    pub repaint: bool,
}

impl From<Vec<SurfacePlan>> for Plan {
    /// Of reflectances that stay as they are baked.
    fn from(surfaces: Vec<SurfacePlan>) -> Self {
        Self {
            surfaces,
            repaint: false,
        }
    }
}

/// The samples and secondary emitters of one surface.
#[derive(Clone, Debug)]
pub struct SurfacePlan {
    /// The surface's own coordinates.
    pub frame: Frame,
    /// The samples; none where nothing is reflected.
    pub samples: Vec<Sample>,
    /// The secondary emitters, darkest first.
    pub bands: Vec<Band>,
    /// The secondary emitters whose radiosity is linear; a plan has either these
    /// or bands.
    pub patches: Vec<Patch>,
    /// The secondary emitters that are points.
    pub points: Vec<Point>,
    /// What its irradiance is the sum of; none where the cone filter spreads the
    /// samples.
    pub fields: Vec<Term>,
    /// Radius of the cone filter in metres; 0 where there are no samples.
    pub filter_radius: f64,
    /// What it is predicted to err by; nothing where the planner made no prediction.
    pub predicted: Vec<Predicted>,
    /// The same by what light does at a place; tags without a place are left out.
    pub predicted_by_tag: Vec<PredictedAt>,
}

/// A sample that shoots what reaches it: a secondary emitter for receivers that
/// are farther off than its neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Index into [`SurfacePlan::samples`].
    pub sample: usize,
    /// The area in m² that it stands for.
    pub area: f64,
}

impl SurfacePlan {
    /// A surface that is not looked at.
    fn without_samples(frame: Frame) -> Self {
        Self {
            frame,
            samples: Vec::new(),
            bands: Vec::new(),
            patches: Vec::new(),
            points: Vec::new(),
            fields: Vec::new(),
            filter_radius: 0.0,
            predicted: Vec::new(),
            predicted_by_tag: Vec::new(),
        }
    }

    /// How many samples receive light from luminaires alone.
    pub fn direct(&self) -> usize {
        self.receiving(Receives::Unshadowed) + self.receiving(Receives::Direct)
    }

    /// How many of these look past what occludes.
    pub fn unshadowed(&self) -> usize {
        self.receiving(Receives::Unshadowed)
    }

    /// How many samples receive reflected light alone.
    pub fn reflected(&self) -> usize {
        self.receiving(Receives::Reflected)
    }

    /// The loops of each secondary emitter, in the order of the tables: a place in
    /// an odd number of them belongs to it.
    pub fn outlines(&self) -> Vec<Vec<Vec<[f64; 2]>>> {
        let vertex = |&sample: &usize| self.samples[sample].vertex;
        let bands = self.bands.iter().map(|band| {
            let outline = |indices: &Vec<usize>| indices.iter().map(vertex).collect();
            band.loops.iter().map(outline).collect()
        });
        let patches = self.patches.iter().map(|patch| patch.pieces.clone());
        let points = self.points.iter().map(|_| Vec::new());
        bands.chain(patches).chain(points).collect()
    }

    /// The area of each secondary emitter in m².
    pub fn areas(&self) -> Vec<f64> {
        let bands = self.bands.iter().map(|band| band.area);
        let patches = self.patches.iter().map(|patch| patch.area);
        let points = self.points.iter().map(|point| point.area);
        bands.chain(patches).chain(points).collect()
    }

    /// What the mean irradiance of each secondary emitter is had from: indices
    /// into [`samples`](Self::samples) and their shares.
    pub fn shares(&self) -> Vec<Vec<(usize, f64)>> {
        let bands = self.bands.iter().map(|band| band.shares().collect());
        let patches = self.patches.iter().map(|patch| {
            let members = patch.members.iter();
            members
                .map(|&(member, [mean, ..])| (member, mean))
                .collect()
        });
        let points = self.points.iter().map(|point| vec![(point.sample, 1.0)]);
        bands.chain(patches).chain(points).collect()
    }

    /// Values on the outlines of shadows, and behind them, that are known without a
    /// sample.
    pub fn free_samples(&self) -> usize {
        let shadows = self.fields.iter().filter(|field| field.tensor.is_some());
        let nodes = shadows
            .flat_map(|field| &field.mesh)
            .flat_map(|mesh| &mesh.nodes);
        nodes.filter(|node| node.shares.is_empty()).count()
    }

    fn receiving(&self, kind: Receives) -> usize {
        let samples = self.samples.iter();
        samples.filter(|s| s.tag.receives() == kind).count()
    }
}

/// A place where irradiance is evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Coordinates (u, v) in the surface's frame, in metres: where irradiance is
    /// evaluated.
    pub place: [f64; 2],
    /// The vertex of emitters that the sample stands for. It is the place, but
    /// on the surface's own outline, where the place is a little inside: what
    /// lies exactly in the plane of an adjoining surface gets nothing from it.
    pub vertex: [f64; 2],
    /// Why it is there.
    pub tag: Tag,
}

/// What shoots the light that a surface reflects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shooters {
    /// What lies between consecutive isolux outlines: the paper's.
    Bands,
    /// What each isolux outline encloses, by the step of radiosity there: fewer
    /// edges, and the power is conserved.
    Layers,
}

/// The part of a surface between two isolux outlines, or all that is inside of
/// one: a secondary emitter.
#[derive(Clone, Debug)]
pub struct Band {
    /// Indices into [`SurfacePlan::samples`]: outer loops counter-clockwise,
    /// inner ones clockwise.
    pub loops: Vec<Vec<usize>>,
    /// The samples whose mean irradiance the band reflects; one that counts
    /// more than once stands here as often.
    pub members: Vec<usize>,
    /// What each member counts for, where it is not the plain mean: of a layer,
    /// by which it is brighter than what is outside.
    pub weights: Vec<f64>,
    /// Area in m².
    pub area: f64,
}

impl Band {
    /// Its members and what each counts for.
    fn shares(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let equal = 1.0 / self.members.len().max(1) as f64;
        let weights = self.weights.iter().copied();
        let shares = weights.chain(std::iter::repeat(equal));
        self.members.iter().copied().zip(shares)
    }
}

/// Why a scene could not be planned.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unplannable {
    /// The sample budget is below what the surfaces need at least.
    Samples {
        /// Samples allowed.
        allowed: u64,
        /// Samples needed at least.
        needed: u64,
    },
    /// More samples than the host solves.
    TooMany {
        /// Samples asked for.
        asked: u64,
        /// Samples the host solves.
        most: u64,
    },
}

impl std::fmt::Display for Unplannable {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Samples { allowed, needed } => write!(
                f,
                "the budget allows {allowed} samples; the reflecting surfaces of this scene need at least {needed}"
            ),
            Self::TooMany { asked, most } => {
                write!(f, "{asked} samples asked for; {most} are the most")
            }
        }
    }
}

impl std::error::Error for Unplannable {}

/// Samples per reflecting surface where the scene sets no budget.
const DEFAULT_SAMPLES: u64 = 32;

/// The largest number of samples that the host solves; their indices fit the
/// tables.
const MOST_SAMPLES: u64 = 1 << 14;

/// Places along each side of a surface at which another one's emitters are
/// judged.
const PROBES: usize = 6;

/// The irradiance at many places with their normals: what the planner looks at.
pub type Field<'a> = dyn Fn(&[(DVec3, DVec3)]) -> Vec<f64> + 'a;

/// Plans a scene in isolux mode: what lies between two outlines shoots.
///
/// `field` gives the irradiance after the reflections that are to be planned
/// for. The samples of [`Budget::samples`] are divided among the reflecting
/// surfaces by the power they receive; surfaces that reflect nothing get none.
///
/// # Errors
/// [`Unplannable`] where the budget is too small, or too large for the tables.
pub fn isolux(scene: &Scene, budget: &Budget, field: &Field<'_>) -> Result<Plan, Unplannable> {
    outlined(scene, budget, Shooters::Bands, field)
}

/// Plans a scene as [`isolux`] does, with nested emitters: what each outline
/// encloses shoots, by the step of radiosity there.
///
/// # Errors
/// As [`isolux`].
pub fn layer_cake(scene: &Scene, budget: &Budget, field: &Field<'_>) -> Result<Plan, Unplannable> {
    outlined(scene, budget, Shooters::Layers, field)
}

fn outlined(
    scene: &Scene,
    budget: &Budget,
    shooters: Shooters,
    field: &Field<'_>,
) -> Result<Plan, Unplannable> {
    let maps: Vec<Option<map::Map>> = scene
        .surfaces
        .iter()
        .map(|surface| surface.reflects().then(|| map::Map::new(surface, field)))
        .collect();
    let reflecting = maps.iter().flatten().count() as u64;
    let budget = budget.samples.unwrap_or(DEFAULT_SAMPLES * reflecting);
    if budget > MOST_SAMPLES {
        return Err(Unplannable::TooMany {
            asked: budget,
            most: MOST_SAMPLES,
        });
    }
    let demands: Vec<Option<share::Demand>> = maps
        .iter()
        .map(|map| map.as_ref().map(map::Map::demand))
        .collect();
    let shares = share::samples(&demands, budget)?;
    let emitted: f64 = scene
        .surfaces
        .iter()
        .map(|s| PI * mean(s.radiance) * s.area)
        .sum();
    let surfaces: Vec<SurfacePlan> = scene
        .surfaces
        .iter()
        .zip(maps)
        .zip(shares)
        .map(|((surface, map), samples)| match map {
            Some(map) => {
                let weight = mean(surface.reflectance) * map.power / emitted;
                map.place(samples, shooters, &probes(scene, surface), weight)
            }
            None => SurfacePlan::without_samples(Frame::new(surface)),
        })
        .collect();
    Ok(Plan::from(surfaces))
}

/// The mean of the channels: what counts where one number has to.
fn mean([r, g, b]: [f64; 3]) -> f64 {
    (r + g + b) / 3.0
}

/// Places on every other surface that reflects, [`PROBES`] × [`PROBES`] each.
fn probes(scene: &Scene, surface: &Surface) -> Vec<(DVec3, DVec3)> {
    let others = scene
        .surfaces
        .iter()
        .filter(|other| !std::ptr::eq(*other, surface) && other.reflects());
    others
        .flat_map(|other| {
            let frame = Frame::new(other);
            (0..PROBES * PROBES).filter_map(move |k| {
                let (u, v) = frame.cell_center(k % PROBES, k / PROBES, PROBES, PROBES);
                frame
                    .contains(u, v)
                    .then(|| (frame.to_world(u, v), frame.normal))
            })
        })
        .collect()
}

impl Plan {
    /// How many samples there are.
    pub fn samples(&self) -> usize {
        self.surfaces
            .iter()
            .map(|surface| surface.samples.len())
            .sum()
    }

    /// Whether emitters are nested, each with an increment of radiosity.
    pub fn is_layered(&self) -> bool {
        let mut bands = self.surfaces.iter().flat_map(|s| &s.bands);
        bands.any(|band| !band.weights.is_empty())
    }

    /// Values on the outlines of shadows, and behind them, that are known without a
    /// sample.
    pub fn free_samples(&self) -> usize {
        self.surfaces.iter().map(SurfacePlan::free_samples).sum()
    }

    /// Bytes of flash that the nodes and triangles of its meshes take, about.
    pub fn mesh_bytes(&self) -> usize {
        let fields = self.surfaces.iter().flat_map(|surface| &surface.fields);
        let nodes = fields
            .filter_map(|field| field.mesh.as_ref())
            .flat_map(|mesh| &mesh.nodes);
        nodes.map(fields::Node::bytes).sum()
    }

    /// Whether radiosities are linear.
    pub fn is_linear(&self) -> bool {
        self.surfaces.iter().any(|s| !s.patches.is_empty())
    }
}
