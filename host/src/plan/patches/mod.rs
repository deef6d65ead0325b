//! Patches with linear radiosity: the emitters of rooms.
//!
//! A surface is cut into cells of its bounding rectangle; what a cell has of
//! the surface's exposed part is a patch. Its radiosity is linear in place,
//! fitted to irradiance at places: direct light at its own, reflected light at
//! those of a larger cell that it is a part of, because shadows have edges and
//! reflected light has hardly any. Cells are halved where direct light is
//! farthest from linear, so that patches gather at the edges of shadows.

mod exposed;
mod places;
mod refine;
pub(crate) mod shapes;

use super::{Field, Plan, Sample, SurfacePlan, Tag, Unplannable, spacing};
use crate::scene::frame::Frame;
use crate::scene::{Budget, Scene};
use exposed::{Cell, Exposed};
use refine::{Refined, Refinement};

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

/// The part of the patches that is there from the start is one in so many; the
/// others come from halving those that fit worst.
const START: usize = 3;

/// Cells that reflected light is looked at in, as a part of the patches: where
/// samples are short, and where they are not. In the Cornell box 687 samples
/// err least with half, and 300 patches lose little with 0.7.
const COARSE: f64 = 0.5;
const COARSE_AT_WILL: f64 = 0.7;

/// Places along each side of a patch for direct light, best first; the budget
/// decides.
const DIRECT: [usize; 3] = [4, 3, 2];

/// Places along each side of a coarse cell for reflected light.
const REFLECTED: usize = 2;

/// Samples for display that a patch is told its radiosity by, about.
const SAMPLES_A_PATCH: usize = 3;

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
    let reflecting = scene.surfaces.iter().filter(|surface| surface.reflects());
    let division = Division::new(reflecting.count(), budget)?;
    let plan = divided(scene, &division, direct);
    let needed = plan.samples() as u64;
    match budget.samples {
        Some(allowed) if needed > allowed => Err(Unplannable::Samples { allowed, needed }),
        _ if needed > super::MOST_SAMPLES => Err(Unplannable::TooMany {
            asked: needed,
            most: super::MOST_SAMPLES,
        }),
        _ => Ok(plan),
    }
}

/// Patches for a plan that has its samples from elsewhere: as many as a budget of
/// samples can tell the radiosities of, with places of their own that say exactly
/// what these are.
pub fn draft(scene: &Scene, budget: &Budget, direct: &Field<'_>) -> Plan {
    let reflecting = scene.surfaces.iter().filter(|surface| surface.reflects());
    let reflecting = reflecting.count();
    let most = (PATCHES_A_SURFACE * reflecting).min(DEFAULT_PATCHES);
    let patches = match budget.samples {
        Some(samples) => most.min(samples as usize / SAMPLES_A_PATCH),
        None => most,
    };
    let division = Division {
        coarse: ((patches as f64 * COARSE_AT_WILL) as usize).max(reflecting),
        patches: patches.max(reflecting),
        direct: DIRECT[0],
    };
    divided(scene, &division, direct)
}

/// Cells and their halves, as a division says.
fn divided(scene: &Scene, division: &Division, direct: &Field<'_>) -> Plan {
    let exposed: Vec<Option<Exposed>> = (0..scene.surfaces.len())
        .map(|index| {
            let surface = &scene.surfaces[index];
            surface.reflects().then(|| Exposed::new(scene, index))
        })
        .collect();
    let density = density(&exposed, division.patches / START);
    let cut = |(index, exposed): (usize, &Option<Exposed>)| {
        let cells = exposed.as_ref().map(|e| e.cut(e.cells(density)));
        cells.into_iter().flatten().map(move |cell| (index, cell))
    };
    let start: Vec<(usize, Cell)> = exposed.iter().enumerate().flat_map(cut).collect();
    let refinement = Refinement::new(scene, &exposed, direct);
    let coarse = refinement.refine(&start, division.coarse).into_iter();
    let coarse: Vec<(usize, Cell)> = coarse.map(|r| (r.surface, r.cell)).collect();
    let mut fine: Vec<Vec<Refined>> = exposed.iter().map(|_| Vec::new()).collect();
    for refined in refinement.refine(&coarse, division.patches) {
        fine[refined.surface].push(refined);
    }
    let surfaces = (scene.surfaces.iter().zip(&exposed))
        .zip(fine)
        .map(|((surface, exposed), fine)| match exposed {
            Some(exposed) => of_surface(exposed, &coarse, fine, division),
            None => SurfacePlan::without_samples(Frame::new(surface)),
        })
        .collect();
    Plan { surfaces }
}

/// How a budget is divided.
struct Division {
    /// Cells that reflected light is looked at in.
    coarse: usize,
    /// Patches: cells and their halves.
    patches: usize,
    /// Places along each side of a patch for direct light.
    direct: usize,
}

impl Division {
    fn new(reflecting: usize, budget: &Budget) -> Result<Self, Unplannable> {
        let of = |patches: usize, part: f64, direct| Self {
            coarse: ((patches as f64 * part) as usize).max(reflecting),
            patches: patches.max(reflecting),
            direct,
        };
        let Some(allowed) = budget.samples else {
            let patches = (PATCHES_A_SURFACE * reflecting).min(DEFAULT_PATCHES);
            return Ok(of(patches, COARSE_AT_WILL, DIRECT[0]));
        };
        if allowed > super::MOST_SAMPLES {
            return Err(Unplannable::TooMany {
                asked: allowed,
                most: super::MOST_SAMPLES,
            });
        }
        let allowed = allowed as usize;
        let patches = |direct: usize| {
            let of_direct = (direct * direct) as f64;
            let each = of_direct + COARSE * (REFLECTED * REFLECTED) as f64;
            let least = allowed.saturating_sub(REFLECTED * REFLECTED * reflecting);
            (allowed as f64 / each).min(least as f64 / of_direct) as usize
        };
        let direct = DIRECT
            .into_iter()
            .find(|&direct| patches(direct) >= ENOUGH.max(reflecting))
            .unwrap_or(DIRECT[DIRECT.len() - 1]);
        Ok(of(patches(direct), COARSE, direct))
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
    for refined in &fine {
        let found = places::of_cell(&refined.cell, division.direct, Tag::Direct);
        let first = samples.len();
        let members = (first..).zip(found.iter().map(|(_, weights)| *weights));
        patches.push(Patch {
            pieces: refined.cell.pieces.clone(),
            center: refined.cell.center,
            scale: refined.cell.scale,
            area: refined.cell.area,
            members: members.collect(),
        });
        let places = found.into_iter().map(|(place, _)| place);
        samples.extend(places.map(sample(Tag::Direct)));
    }
    let of_direct = samples.len();
    let mut begun: Option<(usize, usize, Vec<[f64; 3]>)> = None;
    let mut order: Vec<usize> = (0..fine.len()).collect();
    order.sort_by_key(|&k| fine[k].coarse);
    for k in order {
        let whole = fine[k].coarse;
        if begun.as_ref().is_none_or(|(index, ..)| *index != whole) {
            let found = places::of_cell(&coarse[whole].1, REFLECTED, Tag::Reflected);
            let (places, weights): (Vec<_>, Vec<_>) = found.into_iter().unzip();
            begun = Some((whole, samples.len(), weights));
            samples.extend(places.into_iter().map(sample(Tag::Reflected)));
        }
        let Some((_, first, weights)) = &begun else {
            continue;
        };
        let part = |weights: &[f64; 3]| of_part(*weights, &coarse[whole].1, &fine[k].cell);
        let members = (*first..).zip(weights.iter().map(part));
        patches[k].members.extend(members);
    }
    let area: f64 = patches.iter().map(|patch| patch.area).sum();
    SurfacePlan {
        filter_radius: spacing::filter_radius(area, samples.len() - of_direct),
        samples,
        patches,
        ..SurfacePlan::without_samples(exposed.frame.clone())
    }
}

/// The weights of a cell's linear function, as that of a part of it.
fn of_part([mean, a, b]: [f64; 3], whole: &Cell, part: &Cell) -> [f64; 3] {
    let off = [0, 1].map(|axis| (part.center[axis] - whole.center[axis]) / whole.scale);
    let scale = part.scale / whole.scale;
    [mean + off[0] * a + off[1] * b, scale * a, scale * b]
}
