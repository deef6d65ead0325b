//! Halves the cells that fit worst.

use super::exposed::{Cell, Exposed};
use super::{places, project};
use crate::plan::{Field, Tag};
use crate::scene::Scene;
use glam::{DVec2, DVec3, Vec3Swizzles};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Places along each side of a cell at which direct light is looked at.
const LOOKS: usize = 4;

/// Places along each side of a cell at which light is fitted all over it.
const DENSE: usize = 6;

/// What counts beside the misfit of direct light: reflected light varies as
/// well, over lengths of the scene itself, and by about this part of the mean
/// of direct light. Between 0.1 and 1 the best for rooms is 1.
const REFLECTED: f64 = 1.0;

/// The same where reflected light is known by few patches: what these miss.
const UNKNOWN: f64 = 0.1;

/// Cells longer than wide by more than this are only halved across.
const SLENDER: f64 = 2.5;

/// Direct and reflected light at many places with their normals.
pub type Split<'a> = dyn Fn(&[(DVec3, DVec3)]) -> Vec<[f64; 2]> + 'a;

/// What the misfit of a cell counts where other surfaces adjoin, by its place.
pub(super) type Borders<'a> = dyn Fn(DVec3) -> f64 + 'a;

/// All light, and that of each luminaire.
pub struct Light<'a> {
    /// With every luminaire on.
    pub all: &'a Split<'a>,
    /// With one of them on, or some, each in one of these.
    pub each: &'a [&'a Split<'a>],
}

/// What is known of the light.
#[derive(Clone, Copy)]
pub(super) enum Guide<'a> {
    Direct(&'a Field<'a>),
    All(&'a Light<'a>),
}

/// The scene as refinement sees it.
pub(super) struct Refinement<'a> {
    scene: &'a Scene,
    exposed: &'a [Option<Exposed>],
    guide: Guide<'a>,
    borders: &'a Borders<'a>,
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

impl Waiting {
    fn square(&self) -> f64 {
        self.misfit * self.misfit
    }
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
        guide: Guide<'a>,
        borders: &'a Borders<'a>,
    ) -> Self {
        let area: f64 = scene.surfaces.iter().map(|surface| surface.area).sum();
        Self {
            scene,
            exposed,
            guide,
            borders,
            length: area.sqrt(),
        }
    }

    /// Halves the worst cell until there are `patches`, or until what is known of
    /// the light is followed to within `error`: the root mean square of what
    /// patches miss of the radiosity, as a part of that of the radiosity.
    pub(super) fn refine(
        &self,
        coarse: &[(usize, Cell)],
        patches: usize,
        error: f64,
    ) -> Vec<Refined> {
        let looks: Vec<Vec<[f64; 2]>> = coarse
            .iter()
            .map(|(s, cell)| self.looks(*s, cell))
            .collect();
        let mean = mean_light(coarse, &looks);
        let most = error * error * self.square(coarse, &looks);
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
        let mut missed: f64 = heap.iter().map(Waiting::square).sum();
        while heap.len() + done.len() < patches && missed > most {
            let Some(worst) = heap.pop() else {
                break;
            };
            match self.halves(&worst, mean) {
                Some(halves) => {
                    missed += halves.iter().map(Waiting::square).sum::<f64>() - worst.square();
                    heap.extend(halves);
                }
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

    fn waiting(&self, refined: Refined, looks: &[[f64; 2]], mean: f64) -> Waiting {
        let cell = &refined.cell;
        let unknown = match self.guide {
            Guide::Direct(_) => REFLECTED,
            Guide::All(_) => UNKNOWN,
        };
        let varies = unknown * mean * cell.scale / self.length;
        let exposed = self.exposed[refined.surface].as_ref();
        let near = match exposed.filter(|exposed| exposed.borders(cell)) {
            Some(exposed) => {
                let [u, v] = cell.center;
                (self.borders)(exposed.frame.to_world(u, v))
            }
            None => 1.0,
        };
        let weight = near * self.reflectance(refined.surface) * cell.area.sqrt();
        Waiting {
            misfit: weight * (residual(cell, looks) + varies),
            refined,
        }
    }

    /// The mean of a surface's channels.
    fn reflectance(&self, surface: usize) -> f64 {
        let [r, g, b] = self.scene.surfaces[surface].reflectance;
        (r + g + b) / 3.0
    }

    /// The square of the radiosity over the area.
    fn square(&self, cells: &[(usize, Cell)], looks: &[Vec<[f64; 2]>]) -> f64 {
        let of = |((surface, cell), looks): (&(usize, Cell), &Vec<[f64; 2]>)| {
            let total: f64 = looks.iter().flatten().sum();
            let mean = total / looks.len().max(1) as f64;
            cell.area * (self.reflectance(*surface) * mean).powi(2)
        };
        cells.iter().zip(looks).map(of).sum()
    }

    /// Direct and reflected light at places spread over a cell; without reflected
    /// light where it is not known.
    fn looks(&self, surface: usize, cell: &Cell) -> Vec<[f64; 2]> {
        let Some(exposed) = &self.exposed[surface] else {
            return Vec::new();
        };
        let places = places::of_cell(cell, LOOKS, Tag::Direct);
        let places: Vec<[f64; 2]> = places.into_iter().map(|(place, _)| place).collect();
        self.light(exposed, &places)
    }

    fn light(&self, exposed: &Exposed, places: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let places = in_space(exposed, places);
        match self.guide {
            Guide::Direct(direct) => direct(&places).into_iter().map(|e| [e, 0.0]).collect(),
            Guide::All(light) => (light.all)(&places),
        }
    }

    /// Direct and reflected light of every luminaire at places of a surface; none
    /// where only direct light is known.
    pub(super) fn values(&self, exposed: &Exposed, places: &[[f64; 2]]) -> Vec<[Vec<f64>; 2]> {
        let Guide::All(light) = self.guide else {
            return Vec::new();
        };
        let places = in_space(exposed, places);
        let of_one = |one: &&Split<'_>| {
            let values = one(&places);
            [0, 1].map(|kind| values.iter().map(|values| values[kind]).collect())
        };
        light.each.iter().map(of_one).collect()
    }

    /// The linear functions that direct and reflected light of every luminaire are
    /// best fitted by all over a cell.
    pub(super) fn fits(&self, exposed: &Exposed, cell: &Cell) -> Vec<[[f64; 3]; 2]> {
        let dense = places::of_cell(cell, DENSE, Tag::Direct);
        let (places, weights): (Vec<[f64; 2]>, Vec<[f64; 3]>) = dense.into_iter().unzip();
        let light = self.values(exposed, &places).into_iter();
        let fit = |values: [Vec<f64>; 2]| values.map(|values| project::made(&weights, &values));
        light.map(fit).collect()
    }
}

/// Places of a surface with its normal.
fn in_space(exposed: &Exposed, places: &[[f64; 2]]) -> Vec<(DVec3, DVec3)> {
    let frame = &exposed.frame;
    let places = places.iter();
    places
        .map(|&[u, v]| (frame.to_world(u, v), frame.normal))
        .collect()
}

/// The mean of direct light over the area.
fn mean_light(cells: &[(usize, Cell)], looks: &[Vec<[f64; 2]>]) -> f64 {
    let (sum, area) = cells
        .iter()
        .zip(looks)
        .fold((0.0, 0.0), |sum, ((_, cell), looks)| {
            let total: f64 = looks.iter().map(|[direct, _]| direct).sum();
            let mean = total / looks.len().max(1) as f64;
            (sum.0 + cell.area * mean, sum.1 + cell.area)
        });
    if area > 0.0 { sum / area } else { 0.0 }
}

/// Root of the mean square by which the linear function that the patch would
/// have misses the values at the places of its cell.
fn residual(cell: &Cell, looks: &[[f64; 2]]) -> f64 {
    let looks: Vec<f64> = looks
        .iter()
        .map(|[direct, reflected]| direct + reflected)
        .collect();
    let places = places::of_cell(cell, LOOKS, Tag::Direct);
    let center = DVec2::from(cell.center);
    let pairs = || places.iter().zip(&looks);
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
