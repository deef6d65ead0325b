//! Patches with linear radiosity: the emitters of rooms.
//!
//! A surface is cut into cells of its bounding rectangle; what a cell has of
//! the surface's exposed part is a patch. Its radiosity is linear in place,
//! fitted to irradiance at places of its own: direct light at one set of them,
//! reflected light at another, smaller one, because shadows have edges and
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
use refine::Refinement;

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
const COARSE: usize = 3;

/// Places along each side of a cell, for direct and for reflected light, best
/// first; the budget decides.
const PLACES: [[usize; 2]; 3] = [[4, 2], [3, 2], [2, 2]];

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
    let exposed: Vec<Option<Exposed>> = (0..scene.surfaces.len())
        .map(|index| {
            let surface = &scene.surfaces[index];
            surface.reflects().then(|| Exposed::new(scene, index))
        })
        .collect();
    let reflecting = exposed.iter().flatten().count();
    let (patches, places) = division(reflecting, budget)?;
    let density = density(&exposed, patches / COARSE);
    let cut = |(index, exposed): (usize, &Option<Exposed>)| {
        let cells = exposed.as_ref().map(|e| e.cut(e.cells(density)));
        cells.into_iter().flatten().map(move |cell| (index, cell))
    };
    let coarse: Vec<(usize, Cell)> = exposed.iter().enumerate().flat_map(cut).collect();
    let mut cells: Vec<Vec<Cell>> = exposed.iter().map(|_| Vec::new()).collect();
    for (index, cell) in Refinement::new(scene, &exposed, direct).refine(coarse, patches) {
        cells[index].push(cell);
    }
    let surfaces = (scene.surfaces.iter().zip(&exposed))
        .zip(cells)
        .map(|((surface, exposed), cells)| match exposed {
            Some(exposed) => of_surface(exposed, cells, places),
            None => SurfacePlan::without_samples(Frame::new(surface)),
        })
        .collect();
    let plan = Plan { surfaces };
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

/// How many patches, and how many places along each side of one.
fn division(reflecting: usize, budget: &Budget) -> Result<(usize, [usize; 2]), Unplannable> {
    let each = |[direct, reflected]: [usize; 2]| direct * direct + reflected * reflected;
    let Some(allowed) = budget.samples else {
        let patches = (PATCHES_A_SURFACE * reflecting).min(DEFAULT_PATCHES);
        return Ok((patches.max(reflecting), PLACES[0]));
    };
    if allowed > super::MOST_SAMPLES {
        return Err(Unplannable::TooMany {
            asked: allowed,
            most: super::MOST_SAMPLES,
        });
    }
    let enough = ENOUGH.max(reflecting);
    let places = PLACES
        .into_iter()
        .find(|&places| allowed as usize / each(places) >= enough)
        .unwrap_or(PLACES[PLACES.len() - 1]);
    Ok((allowed as usize / each(places), places))
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

fn of_surface(exposed: &Exposed, cells: Vec<Cell>, [direct, reflected]: [usize; 2]) -> SurfacePlan {
    let mut patches = Vec::new();
    let mut samples: [Vec<Sample>; 2] = [Vec::new(), Vec::new()];
    let mut members = Vec::new();
    for cell in cells {
        let mut own = [Vec::new(), Vec::new()];
        for (kind, (side, tag)) in [(direct, Tag::Direct), (reflected, Tag::Reflected)]
            .into_iter()
            .enumerate()
        {
            for (place, weights) in places::of_cell(&cell, side, tag) {
                own[kind].push((samples[kind].len(), weights));
                samples[kind].push(Sample {
                    place,
                    vertex: place,
                    tag,
                });
            }
        }
        members.push(own);
        patches.push(Patch {
            pieces: cell.pieces,
            center: cell.center,
            scale: cell.scale,
            area: cell.area,
            members: Vec::new(),
        });
    }
    // Those for direct light come first.
    let [of_direct, of_reflected] = samples;
    for (patch, [own_direct, own_reflected]) in patches.iter_mut().zip(members) {
        let shifted = own_reflected
            .into_iter()
            .map(|(index, weights)| (of_direct.len() + index, weights));
        patch.members = own_direct.into_iter().chain(shifted).collect();
    }
    let area: f64 = patches.iter().map(|patch| patch.area).sum();
    SurfacePlan {
        filter_radius: spacing::filter_radius(area, of_reflected.len()),
        samples: of_direct.into_iter().chain(of_reflected).collect(),
        patches,
        ..SurfacePlan::without_samples(exposed.frame.clone())
    }
}
