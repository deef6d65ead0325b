//! Halves the cells that fit worst.

use super::exposed::{Cell, Exposed};
use super::places;
use crate::plan::{Field, Tag};
use crate::scene::Scene;
use glam::{DVec2, DVec3, Vec3Swizzles};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Places along each side of a cell at which direct light is looked at.
const LOOKS: usize = 4;

/// What counts beside the misfit of direct light: reflected light varies as
/// well, over lengths of the scene itself, and by about this part of the mean
/// of direct light. Between 0.1 and 1 the best for rooms is 1.
const REFLECTED: f64 = 1.0;

/// Cells longer than wide by more than this are only halved across.
const SLENDER: f64 = 2.5;

/// The scene as refinement sees it.
pub(super) struct Refinement<'a> {
    scene: &'a Scene,
    exposed: &'a [Option<Exposed>],
    direct: &'a Field<'a>,
    /// The scene's own length in metres: the root of its area.
    length: f64,
}

/// A cell, and what it is a part of.
pub(super) struct Refined {
    pub(super) surface: usize,
    /// Index of the coarse cell.
    pub(super) coarse: usize,
    pub(super) cell: Cell,
}

/// A cell that waits, with what it misses.
struct Waiting {
    misfit: f64,
    refined: Refined,
}

impl PartialEq for Waiting {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Waiting {}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Waiting {
    fn cmp(&self, other: &Self) -> Ordering {
        let place = |waiting: &Self| (waiting.refined.coarse, waiting.refined.cell.bounds);
        self.misfit.total_cmp(&other.misfit).then_with(|| {
            let ((s, a), (t, b)) = (place(self), place(other));
            t.cmp(&s).then_with(|| {
                let flat = |bounds: [[f64; 2]; 2]| bounds.into_iter().flatten();
                let pairs = flat(a).zip(flat(b));
                pairs.fold(Ordering::Equal, |order, (x, y)| order.then(x.total_cmp(&y)))
            })
        })
    }
}

impl<'a> Refinement<'a> {
    pub(super) fn new(
        scene: &'a Scene,
        exposed: &'a [Option<Exposed>],
        direct: &'a Field<'a>,
    ) -> Self {
        let area: f64 = scene.surfaces.iter().map(|surface| surface.area).sum();
        Self {
            scene,
            exposed,
            direct,
            length: area.sqrt(),
        }
    }

    /// Halves the worst cell until there are `patches`.
    pub(super) fn refine(&self, coarse: &[(usize, Cell)], patches: usize) -> Vec<Refined> {
        let looks: Vec<Vec<f64>> = coarse
            .iter()
            .map(|(s, cell)| self.looks(*s, cell))
            .collect();
        let mean = mean_light(coarse, &looks);
        let mut done = Vec::new();
        let mut heap: BinaryHeap<Waiting> = coarse
            .iter()
            .zip(looks)
            .enumerate()
            .map(|(index, ((surface, cell), looks))| {
                let refined = Refined {
                    surface: *surface,
                    coarse: index,
                    cell: cell.clone(),
                };
                self.waiting(refined, &looks, mean)
            })
            .collect();
        while heap.len() + done.len() < patches {
            let Some(worst) = heap.pop() else {
                break;
            };
            match self.halves(&worst, mean) {
                Some(halves) => heap.extend(halves),
                None => done.push(worst.refined),
            }
        }
        let rest = heap.into_sorted_vec().into_iter();
        done.extend(rest.map(|waiting| waiting.refined));
        done
    }

    /// The two halves that fit best; `None` where a half would be nothing.
    fn halves(&self, whole: &Waiting, mean: f64) -> Option<[Waiting; 2]> {
        let Refined {
            surface,
            coarse,
            ref cell,
        } = whole.refined;
        let exposed = self.exposed[surface].as_ref()?;
        let [low, high] = cell.bounds;
        let size = [high[0] - low[0], high[1] - low[1]];
        let slender = |axis: usize| size[axis] > SLENDER * size[1 - axis];
        let axes = (0..2).filter(|&axis| !slender(1 - axis));
        let halved = axes.filter_map(|axis| {
            let middle = 0.5 * (low[axis] + high[axis]);
            let (mut low_end, mut high_start) = (high, low);
            low_end[axis] = middle;
            high_start[axis] = middle;
            let first = exposed.cell(low, low_end)?;
            let second = exposed.cell(high_start, high)?;
            Some([first, second].map(|cell| {
                let looks = self.looks(surface, &cell);
                let refined = Refined {
                    surface,
                    coarse,
                    cell,
                };
                self.waiting(refined, &looks, mean)
            }))
        });
        halved.min_by(|a, b| {
            let sum = |halves: &[Waiting; 2]| halves[0].misfit.hypot(halves[1].misfit);
            sum(a).total_cmp(&sum(b))
        })
    }

    fn waiting(&self, refined: Refined, looks: &[f64], mean: f64) -> Waiting {
        let cell = &refined.cell;
        let reflectance = self.scene.surfaces[refined.surface].reflectance;
        let [r, g, b] = reflectance;
        let varies = REFLECTED * mean * cell.scale / self.length;
        Waiting {
            misfit: (r + g + b) / 3.0 * cell.area.sqrt() * (residual(cell, looks) + varies),
            refined,
        }
    }

    /// Direct light at places spread over a cell.
    fn looks(&self, surface: usize, cell: &Cell) -> Vec<f64> {
        let Some(exposed) = &self.exposed[surface] else {
            return Vec::new();
        };
        let frame = &exposed.frame;
        let places: Vec<(DVec3, DVec3)> = places::of_cell(cell, LOOKS, Tag::Direct)
            .into_iter()
            .map(|([u, v], _)| (frame.to_world(u, v), frame.normal))
            .collect();
        (self.direct)(&places)
    }
}

/// The mean of direct light over the area.
fn mean_light(cells: &[(usize, Cell)], looks: &[Vec<f64>]) -> f64 {
    let (sum, area) = cells
        .iter()
        .zip(looks)
        .fold((0.0, 0.0), |sum, ((_, cell), looks)| {
            let mean = looks.iter().sum::<f64>() / looks.len().max(1) as f64;
            (sum.0 + cell.area * mean, sum.1 + cell.area)
        });
    if area > 0.0 { sum / area } else { 0.0 }
}

/// Root of the mean square by which the linear function that the patch would
/// have misses the values at the places of its cell.
fn residual(cell: &Cell, looks: &[f64]) -> f64 {
    let places = places::of_cell(cell, LOOKS, Tag::Direct);
    let center = DVec2::from(cell.center);
    let pairs = || places.iter().zip(looks);
    let fit: DVec3 = pairs()
        .map(|((_, weights), look)| DVec3::from(*weights) * *look)
        .sum();
    let square = |((place, _), look): (&([f64; 2], [f64; 3]), &f64)| {
        let own = (DVec2::from(*place) - center) / cell.scale;
        (fit.dot(own.extend(1.0).zxy()) - look).powi(2)
    };
    let sum: f64 = pairs().map(square).sum();
    (sum / looks.len().max(1) as f64).sqrt()
}
