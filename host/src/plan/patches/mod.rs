//! Patches with linear radiosity: the emitters of rooms.
//!
//! A surface is cut into cells of its bounding rectangle; what a cell has of
//! the surface's exposed part is a patch. Its radiosity is linear in place,
//! fitted to irradiance at places: direct light at its own, reflected light at
//! those of a larger cell that it is a part of, because shadows have edges and
//! reflected light has hardly any. Cells are halved where light is farthest from
//! linear, so that patches gather at the edges of shadows and in corners. Where
//! only direct light is known ([`linear`]), reflected light is taken to vary over
//! the scene's own length; a first solution tells all of it ([`following`]), and
//! then the weights of the places are such that they miss nothing between them.

mod exposed;
mod places;
mod project;
mod refine;
pub(crate) mod shapes;

use super::room::view::Importance;
use super::{Field, Plan, Sample, SurfacePlan, Tag, Unplannable, spacing};
use crate::occlusion::Solids;
use crate::scene::frame::Frame;
use crate::scene::{Budget, Scene};
use exposed::{Cell, Exposed};
use glam::DVec3;
use project::Known;
use refine::{Borders, Guide, Refined, Refinement};

pub use refine::{Light, Split};

/// A part of a surface whose radiosity is linear.
#[derive(Clone, Debug)]
pub struct Patch {
    /// Convex pieces, counter-clockwise, in the surface's frame.
    pub pieces: Vec<Vec<[f64; 2]>>,
    /// The centroid, in the surface's frame: the origin of its coordinates.
    pub center: [f64; 2],
    /// Distance in metres from the centroid to the farthest corner: the unit of
    /// its coordinates.
    pub scale: f64,
    /// Area in m².
    pub area: f64,
    /// Indices into [`SurfacePlan::samples`] with the weights of mean and
    /// gradients.
    pub members: Vec<(usize, [f64; 3])>,
}

/// Patches where the scene sets no budget: at most so many in all, and on the
/// average of the surfaces.
const DEFAULT_PATCHES: usize = 300;
const PATCHES_A_SURFACE: usize = 48;

/// Patches of a first plan: at most so many in all, and on the average of the
/// surfaces; and the part of them in which reflected light is looked at.
const FIRST_PATCHES: usize = 120;
const FIRST_A_SURFACE: usize = 12;
const FIRST_COARSE: f64 = 0.7;

/// The same as [`PLACES`] for a first plan.
const FIRST_PLACES: [[usize; 2]; 2] = [[3, 2], [2, 2]];

/// The part of the patches that is there from the start is one in so many; the
/// others come from halving those that fit worst.
const START: usize = 3;

/// Cells that reflected light is looked at in, as a part of the patches.
const COARSE: f64 = 0.4;

/// Places along each side of a patch for direct light and of a coarse cell for
/// reflected light, best first; the budget decides.
const PLACES: [[usize; 2]; 4] = [[4, 3], [3, 3], [2, 3], [2, 2]];

/// The same where there is no budget and all light is known: then the weights
/// know what lies between the places.
const KNOWN: [[usize; 2]; 1] = [[2, 2]];

/// What patches may miss of the radiosity where the scene sets no budget (root
/// mean square, of what the first solution knows). In the Cornell box and in the
/// office 95 of 100 places are then within 0.5 %.
const ERROR: f64 = 0.0225;

/// What a misfit counts there where other surfaces adjoin: what is near a patch sees all of
/// it, and is often the darker for it. It makes the errors above a tenth half as many.
const FINE_BORDERS: f64 = 4.0;

/// Where all places count alike.
const ALIKE: fn(DVec3) -> f64 = |_| 1.0;

/// Samples for display that a patch is told its radiosity by, about.
const SAMPLES_A_PATCH: usize = 4;

/// The same for a camera: what fewer patches send is made up for where it looks, and their
/// bytes are better spent on meshes there.
const SAMPLES_A_PATCH_FOR_CAMERA: usize = 7;

/// A room with fewer patches than this is better off with more of them than
/// with more places on each.
const ENOUGH: usize = 80;

/// Plans a scene with linear patches.
///
/// `direct` gives direct light: where a straight line does not follow it, at
/// the edge of a shadow, patches are smaller. The samples of
/// [`Budget::samples`] are what direct and reflected light is evaluated at, both
/// counted. Costs some tens of values of `direct` a patch.
///
/// # Errors
/// [`Unplannable`] where the budget is too small, or too large for the tables.
pub fn linear(scene: &Scene, budget: &Budget, direct: &Field<'_>) -> Result<Plan, Unplannable> {
    guided(scene, budget, Guide::Direct(direct))
}

/// Plans a scene with linear patches by what is known of all its light.
///
/// As [`linear`], but patches are halved where neither direct nor reflected light
/// follows a straight line, and the weights of a patch's places make the linear
/// function that fits the light of every luminaire best: what a patch sends is no
/// guess from a few places, however luminaires are dimmed. Costs about a hundred
/// values of all light a patch, and fifty of that of each luminaire.
///
/// # Errors
/// As [`linear`].
pub fn following(scene: &Scene, budget: &Budget, light: &Light<'_>) -> Result<Plan, Unplannable> {
    guided(scene, budget, Guide::All(light))
}

/// Plans few patches, for a first solution that tells [`following`] of the light.
///
/// # Errors
/// As [`linear`].
pub fn first(scene: &Scene, direct: &Field<'_>) -> Result<Plan, Unplannable> {
    let reflecting = scene.surfaces.iter().filter(|s| s.reflects()).count();
    let patches = (FIRST_A_SURFACE * reflecting).min(FIRST_PATCHES);
    let coarse = (patches as f64 * FIRST_COARSE) as usize;
    let division = Division::at_will(patches, coarse, reflecting, &FIRST_PLACES);
    divided(scene, &division, None, Guide::Direct(direct), &ALIKE)
}

/// Patches for a plan that has its samples from elsewhere: as many as a budget of
/// samples can tell the radiosities of, with places of their own that say exactly
/// what these are.
///
/// # Errors
/// As [`linear`].
pub fn draft(
    scene: &Scene,
    budget: &Budget,
    light: &Light<'_>,
    for_camera: bool,
) -> Result<Plan, Unplannable> {
    let reflecting = scene.surfaces.iter().filter(|s| s.reflects()).count();
    let most = (PATCHES_A_SURFACE * reflecting).min(DEFAULT_PATCHES);
    let samples_a_patch = match for_camera {
        true => SAMPLES_A_PATCH_FOR_CAMERA,
        false => SAMPLES_A_PATCH,
    };
    let (patches, error) = match budget.samples {
        Some(samples) => (most.min(samples as usize / samples_a_patch), 0.0),
        None => (most, ERROR),
    };
    let coarse = (patches as f64 * COARSE) as usize;
    let division = Division {
        error,
        ..Division::at_will(patches, coarse, reflecting, &PLACES)
    };
    divided(scene, &division, None, Guide::All(light), &ALIKE)
}

/// So many patches, more than a device shoots from, for a solution that tells what those of
/// a plan miss; closest to each other where surfaces meet, and there the more so the more
/// the place counts.
///
/// # Errors
/// As [`linear`].
pub fn fine(
    scene: &Scene,
    patches: usize,
    light: &Light<'_>,
    importance: &Importance<'_>,
) -> Result<Plan, Unplannable> {
    let reflecting = scene.surfaces.iter().filter(|s| s.reflects()).count();
    let coarse = (patches as f64 * COARSE) as usize;
    let division = Division::at_will(patches, coarse, reflecting, &KNOWN);
    let borders = |place: DVec3| {
        // What adjoins may be seen better than the surface itself.
        let normals = scene.surfaces.iter().map(|surface| surface.normal);
        let counts = normals.map(|normal| importance(place, normal));
        1.0 + (FINE_BORDERS - 1.0) * counts.fold(0.0, f64::max).sqrt()
    };
    divided(scene, &division, None, Guide::All(light), &borders)
}

fn guided(scene: &Scene, budget: &Budget, guide: Guide<'_>) -> Result<Plan, Unplannable> {
    let reflecting = scene.surfaces.iter().filter(|s| s.reflects()).count();
    let division = Division::new(reflecting, budget, guide)?;
    divided(scene, &division, budget.samples, guide, &ALIKE)
}

fn divided(
    scene: &Scene,
    division: &Division,
    allowed: Option<u64>,
    guide: Guide<'_>,
    borders: &Borders<'_>,
) -> Result<Plan, Unplannable> {
    let solids = Solids::of(scene);
    let exposed: Vec<Option<Exposed>> = (0..scene.surfaces.len())
        .map(|index| {
            let surface = &scene.surfaces[index];
            surface
                .reflects()
                .then(|| Exposed::new(scene, &solids, index))
        })
        .collect();
    let density = density(&exposed, division.patches / START);
    let cut = |(index, exposed): (usize, &Option<Exposed>)| {
        let cells = exposed.as_ref().map(|e| e.cut(e.cells(density)));
        cells.into_iter().flatten().map(move |cell| (index, cell))
    };
    let start: Vec<(usize, Cell)> = exposed.iter().enumerate().flat_map(cut).collect();
    let refinement = Refinement::new(scene, &exposed, guide, borders);
    let coarse = refinement.refine(&start, division.coarse, division.error);
    let coarse = coarse.into_iter();
    let coarse: Vec<(usize, Cell)> = coarse.map(|r| (r.surface, r.cell)).collect();
    let mut fine: Vec<Vec<Refined>> = exposed.iter().map(|_| Vec::new()).collect();
    for refined in refinement.refine(&coarse, division.patches, division.error) {
        fine[refined.surface].push(refined);
    }
    let surfaces = (scene.surfaces.iter().zip(&exposed))
        .zip(fine)
        .map(|((surface, exposed), fine)| match exposed {
            Some(exposed) => of_surface(exposed, &coarse, fine, division, &refinement),
            None => SurfacePlan::without_samples(Frame::new(surface)),
        })
        .collect();
    let plan = Plan {
        surfaces,
        repaint: false,
    };
    let needed = plan.samples() as u64;
    match allowed {
        Some(allowed) if needed > allowed => Err(Unplannable::Samples { allowed, needed }),
        _ if needed > super::MOST_SAMPLES => Err(Unplannable::TooMany {
            asked: needed,
            most: super::MOST_SAMPLES,
        }),
        _ => Ok(plan),
    }
}

/// How a budget is divided.
struct Division {
    /// Cells that reflected light is looked at in, at the most.
    coarse: usize,
    /// Patches, cells and their halves, at the most.
    patches: usize,
    /// Places along each side of a patch for direct light.
    direct: usize,
    /// Places along each side of a coarse cell for reflected light.
    reflected: usize,
    /// What patches may miss of the radiosity: no more of them than that takes.
    error: f64,
}

impl Division {
    /// So many patches without a budget, with the first of these places that the
    /// host solves.
    fn at_will(patches: usize, coarse: usize, reflecting: usize, places: &[[usize; 2]]) -> Self {
        let (patches, coarse) = (patches.max(reflecting), coarse.max(reflecting));
        let samples = |[direct, reflected]: [usize; 2]| {
            (patches * direct * direct + coarse * reflected * reflected) as u64
        };
        let mut rising = places.iter().copied();
        let fitting = rising.find(|&places| samples(places) <= super::MOST_SAMPLES);
        let [direct, reflected] = fitting.unwrap_or([2, 2]);
        Self {
            coarse,
            patches,
            direct,
            reflected,
            error: 0.0,
        }
    }

    fn new(reflecting: usize, budget: &Budget, guide: Guide<'_>) -> Result<Self, Unplannable> {
        let of = |patches: usize, [direct, reflected]: [usize; 2]| Self {
            coarse: ((patches as f64 * COARSE) as usize).max(reflecting),
            patches: patches.max(reflecting),
            direct,
            reflected,
            error: 0.0,
        };
        let Some(allowed) = budget.samples else {
            let patches = (PATCHES_A_SURFACE * reflecting).min(DEFAULT_PATCHES);
            let coarse = (patches as f64 * COARSE) as usize;
            let (places, error) = match guide {
                Guide::Direct(_) => (&PLACES[..], 0.0),
                Guide::All(_) => (&KNOWN[..], ERROR),
            };
            return Ok(Self {
                error,
                ..Self::at_will(patches, coarse, reflecting, places)
            });
        };
        if allowed > super::MOST_SAMPLES {
            return Err(Unplannable::TooMany {
                asked: allowed,
                most: super::MOST_SAMPLES,
            });
        }
        let allowed = allowed as usize;
        let patches = |[direct, reflected]: [usize; 2]| {
            let (of_direct, of_coarse) = ((direct * direct) as f64, reflected * reflected);
            let each = of_direct + COARSE * of_coarse as f64;
            let least = allowed.saturating_sub(of_coarse * reflecting);
            (allowed as f64 / each).min(least as f64 / of_direct) as usize
        };
        let places = PLACES
            .into_iter()
            .find(|&places| patches(places) >= ENOUGH.max(reflecting))
            .unwrap_or(PLACES[PLACES.len() - 1]);
        Ok(of(patches(places), places))
    }
}

/// The density of cells at which there are as many as asked for, or hardly
/// fewer.
fn density(exposed: &[Option<Exposed>], patches: usize) -> f64 {
    let count = |density: f64| -> usize {
        let cells = exposed.iter().flatten().map(|e| e.cells(density));
        cells.map(|[along, across]| along * across).sum()
    };
    // √(cells) per √metre: the scene's own size brackets it.
    let largest = exposed
        .iter()
        .flatten()
        .map(Exposed::longest)
        .fold(f64::MIN_POSITIVE, f64::max);
    let (mut low, mut high) = (0.0, patches as f64 / largest.sqrt() + 1.0 / largest.sqrt());
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if count(middle) <= patches {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// The patches of one surface with their samples: direct light is looked at in
/// every one, reflected light, which is smooth, in the coarse cells they are
/// parts of.
fn of_surface(
    exposed: &Exposed,
    coarse: &[(usize, Cell)],
    fine: Vec<Refined>,
    division: &Division,
    refinement: &Refinement<'_>,
) -> SurfacePlan {
    let sample = |tag| {
        move |place| Sample {
            place,
            vertex: place,
            tag,
        }
    };
    let mut samples = Vec::new();
    let mut patches = Vec::new();
    let mut wanted = Vec::new();
    for refined in &fine {
        let cell = &refined.cell;
        let found = places::of_cell(cell, division.direct, Tag::Direct);
        let (places, mut weights): (Vec<_>, Vec<_>) = found.into_iter().unzip();
        let fits = refinement.fits(exposed, cell);
        let values = refinement.values(exposed, &places);
        project::correct(&mut weights, &known(0, &values, &fits));
        wanted.push(fits);
        patches.push(Patch {
            pieces: cell.pieces.clone(),
            center: cell.center,
            scale: cell.scale,
            area: cell.area,
            members: (samples.len()..).zip(weights).collect(),
        });
        samples.extend(places.into_iter().map(sample(Tag::Direct)));
    }
    let of_direct = samples.len();
    let mut begun: Option<Begun> = None;
    let mut order: Vec<usize> = (0..fine.len()).collect();
    order.sort_by_key(|&k| fine[k].coarse);
    for k in order {
        let index = fine[k].coarse;
        let whole = &coarse[index].1;
        if begun.as_ref().is_none_or(|begun| begun.index != index) {
            let found = places::of_cell(whole, division.reflected, Tag::Reflected);
            let (places, weights): (Vec<_>, Vec<_>) = found.into_iter().unzip();
            begun = Some(Begun {
                index,
                first: samples.len(),
                weights,
                values: refinement.values(exposed, &places),
            });
            samples.extend(places.into_iter().map(sample(Tag::Reflected)));
        }
        let Some(begun) = &begun else {
            continue;
        };
        let part = |weights: &[f64; 3]| of_part(*weights, whole, &fine[k].cell);
        let mut weights: Vec<[f64; 3]> = begun.weights.iter().map(part).collect();
        project::correct(&mut weights, &known(1, &begun.values, &wanted[k]));
        patches[k].members.extend((begun.first..).zip(weights));
    }
    let area: f64 = patches.iter().map(|patch| patch.area).sum();
    SurfacePlan {
        filter_radius: spacing::filter_radius(area, samples.len() - of_direct),
        samples,
        patches,
        ..SurfacePlan::without_samples(exposed.frame.clone())
    }
}

/// A coarse cell whose places are samples already.
struct Begun {
    index: usize,
    /// The first of its samples.
    first: usize,
    weights: Vec<[f64; 3]>,
    /// Direct and reflected light of every luminaire at its places, where that is
    /// known.
    values: Vec<[Vec<f64>; 2]>,
}

/// Of every luminaire one kind of light: 0 direct, 1 reflected.
fn known(kind: usize, values: &[[Vec<f64>; 2]], fits: &[[[f64; 3]; 2]]) -> Vec<Known> {
    let pairs = values.iter().zip(fits);
    let of_one = |(values, wanted): (&[Vec<f64>; 2], &[[f64; 3]; 2])| Known {
        values: values[kind].clone(),
        wanted: wanted[kind],
    };
    pairs.map(of_one).collect()
}

/// The weights of a cell's linear function, as that of a part of it.
fn of_part([mean, a, b]: [f64; 3], whole: &Cell, part: &Cell) -> [f64; 3] {
    let off = [0, 1].map(|axis| (part.center[axis] - whole.center[axis]) / whole.scale);
    let scale = part.scale / whole.scale;
    [mean + off[0] * a + off[1] * b, scale * a, scale * b]
}
