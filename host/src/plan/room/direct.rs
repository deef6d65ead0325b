//! Direct light on a surface: a tensor grid of what would come unhindered, and
//! where shadows fall a mesh of the fraction that does.

use super::super::fields::split::{Fine, Found, Split, split};
use super::super::fields::tensor::{Nodes, Tensor};
use super::super::fields::{Mesh, Node, counted, spline};
use super::super::shadow::{self, Floor, Mesh as Outlined, Options, ShadowMap, Tag};
use super::Known;
use super::around::Around;
use super::ladder::Step;
use super::reflected::{in_space, is_cut, nodes, sums, weighed};
use crate::scene::Scene;
use std::collections::BTreeSet;

/// Nodes along a side of a tensor grid.
const COUNTS: std::ops::RangeInclusive<usize> = 1..=8;

/// Lines that the shadows' mesh follows, and triangles that it begins with: of more, as
/// several luminaires make them, few are worth their bytes.
const LINES: usize = 60;
const TRIANGLES: usize = 300;

/// Edges of the shadows' mesh along the side of a square surface.
const EDGES: f64 = 5.0;

/// Where the mesh is fine enough; lengths are parts of the surface's size.
const FINE: Fine = Fine {
    tolerance: 0.01,
    shortest: 1.0 / 400.0,
    most: 1000,
};

/// The most samples in the penumbras of one surface.
const MOST: usize = 240;

/// What a surface's direct light can be reconstructed from.
pub(super) struct Direct {
    tensors: Vec<Tensor>,
    pub(super) grids: Vec<Step>,
    shadows: Option<Shadows>,
}

/// The shadows on a surface.
struct Shadows {
    floor: Floor,
    steps: Vec<Step>,
    places: Vec<[f64; 2]>,
    split: Split,
    /// Where nodes are looked at, and are made samples.
    inside: Vec<[f64; 2]>,
    /// Values that are known beforehand.
    free: Vec<Option<f64>>,
    /// Nodes in the order in which they become samples.
    order: Vec<usize>,
}

impl Direct {
    /// `None` where no direct light arrives.
    pub(super) fn of(
        scene: &Scene,
        index: usize,
        floor: &Floor,
        known: &Known<'_>,
    ) -> Result<Option<Self>, shadow::Error> {
        let places = Around::places(floor);
        let receivers = in_space(floor, &places);
        let seen = sums(&(known.direct)(&receivers));
        let whole = sums(&(known.unshadowed)(&receivers));
        let reflected = sums(&(known.reflected)(&receivers));
        let total: Vec<f64> = seen.iter().zip(&reflected).map(|(a, b)| a + b).collect();
        let brightest = total.iter().copied().fold(0.0, f64::max);
        if seen.iter().all(|&seen| seen <= 1e-9 * brightest) {
            return Ok(None);
        }
        // An error of U counts as far as it is seen.
        let counts: Vec<f64> = (whole.iter().zip(&seen))
            .zip(&total)
            .map(|((whole, seen), total)| {
                let fraction = if *whole > 0.0 { seen / whole } else { 0.0 };
                fraction / total.max(1e-3 * brightest)
            })
            .collect();
        let each = vec![scene.surfaces[index].area / places.len().max(1) as f64; places.len()];
        let truth = Truth {
            areas: weighed(&each, &receivers, known),
            places,
            whole,
            counts,
        };
        let (tensors, grids) = grids(scene, index, floor, known, &truth);
        let around = Around::of(floor, &reflected);
        let shadows = Shadows::of(scene, index, floor, known, &around)?;
        Ok(Some(Self {
            tensors,
            grids,
            shadows,
        }))
    }

    pub(super) fn shadow_steps(&self) -> &[Step] {
        self.shadows.as_ref().map_or(&[], |shadows| &shadows.steps)
    }

    pub(super) fn tensor(&self, step: usize) -> Tensor {
        self.tensors[step].clone()
    }

    pub(super) fn mesh(&self, step: usize) -> Option<(Vec<[f64; 2]>, Mesh, &Split)> {
        let shadows = self.shadows.as_ref()?;
        let (places, mesh) = shadows.mesh(step);
        Some((places, mesh, &shadows.split))
    }
}

/// What a tensor grid is measured by.
struct Truth {
    places: Vec<[f64; 2]>,
    whole: Vec<f64>,
    /// What an error of 1 W m⁻² of U is of all light.
    counts: Vec<f64>,
    /// The area each stands for, in m².
    areas: Vec<f64>,
}

/// The tensor grids that no other beats with as few samples.
fn grids(
    scene: &Scene,
    index: usize,
    floor: &Floor,
    known: &Known<'_>,
    truth: &Truth,
) -> (Vec<Tensor>, Vec<Step>) {
    let frame = &floor.frame;
    let factors = super::super::error::factors(scene, index, frame);
    let mut all = Vec::new();
    for nodes in [Nodes::Chebyshev, Nodes::Expanded] {
        for along_u in COUNTS {
            for along_v in COUNTS {
                let grid = Tensor::over(frame, nodes, [along_u, along_v], None);
                let values = sums(&(known.unshadowed)(&in_space(floor, &grid.places())));
                for &factor in &factors {
                    let tensor = Tensor {
                        factor,
                        ..grid.clone()
                    };
                    let Some(through) = tensor.through(&values) else {
                        continue;
                    };
                    let errors = truth.places.iter().enumerate().map(|(k, &place)| {
                        let error = (through.at(place) - truth.whole[k]) * truth.counts[k];
                        counted(error) * truth.areas[k]
                    });
                    let loss = errors.sum::<f64>();
                    all.push((tensor, loss));
                }
            }
        }
    }
    all.sort_by(|(a, loss_a), (b, loss_b)| {
        let samples = a.samples().cmp(&b.samples());
        samples.then(loss_a.total_cmp(loss_b))
    });
    let (mut tensors, mut steps): (Vec<Tensor>, Vec<Step>) = (Vec::new(), Vec::new());
    for (tensor, loss) in all {
        if steps.last().is_none_or(|last| loss < last.loss) {
            steps.push(Step {
                samples: tensor.samples(),
                loss,
                area: truth.areas.iter().sum(),
            });
            tensors.push(tensor);
        }
    }
    (tensors, steps)
}

impl Shadows {
    /// `None` where nothing hides a luminaire from any place.
    fn of(
        scene: &Scene,
        index: usize,
        floor: &Floor,
        known: &Known<'_>,
        around: &Around<'_>,
    ) -> Result<Option<Self>, shadow::Error> {
        let luminaires =
            (0..scene.surfaces.len()).filter(|&k| scene.surfaces[k].emits() && k != index);
        let maps: Vec<ShadowMap> = luminaires
            .map(|luminaire| ShadowMap::of(scene, index, luminaire))
            .collect::<Result<_, _>>()?;
        if maps.iter().all(|map| map.shadows.is_empty()) {
            return Ok(None);
        }
        let maps: Vec<&ShadowMap> = maps.iter().collect();
        let options = Options {
            most_lines: LINES,
            triangles: TRIANGLES,
            longest: scene.surfaces[index].area.sqrt() / EDGES * 1.4,
            ..Options::default()
        };
        let outlined = Outlined::of(floor, &maps, &options);
        let kept = |&k: &usize| matches!(outlined.tags[k], Tag::Penumbra | Tag::Umbra);
        let kept: Vec<usize> = (0..outlined.triangles.len()).filter(kept).collect();
        if kept.is_empty() {
            return Ok(None);
        }
        Ok(Some(Self::placed(floor, known, around, &outlined, &kept)))
    }

    /// The nodes of the triangles that are not lit, and the order of samples.
    fn placed(
        floor: &Floor,
        known: &Known<'_>,
        around: &Around<'_>,
        outlined: &Outlined,
        kept: &[usize],
    ) -> Self {
        let mut number = vec![usize::MAX; outlined.vertices.len()];
        let (mut places, mut free) = (Vec::new(), Vec::new());
        let mut in_penumbra = Vec::new();
        let mut triangles = Vec::new();
        for &k in kept {
            let penumbra = outlined.tags[k] == Tag::Penumbra;
            triangles.push(outlined.triangles[k].map(|vertex| {
                if number[vertex] == usize::MAX {
                    number[vertex] = places.len();
                    places.push(outlined.vertices[vertex]);
                    free.push(outlined.free[vertex]);
                    in_penumbra.push(false);
                }
                in_penumbra[number[vertex]] |= penumbra;
                number[vertex]
            }));
        }
        for (free, penumbra) in free.iter_mut().zip(in_penumbra) {
            if !penumbra {
                *free = Some(0.0);
            }
        }
        let look = |places: &[[f64; 2]]| -> Vec<Found> {
            let reflected: Vec<f64> = places.iter().map(|&place| around.at(place)).collect();
            let places = in_space(floor, places);
            let seen = sums(&(known.direct)(&places));
            let whole = sums(&(known.unshadowed)(&places));
            let weight = |(place, normal)| (known.importance)(place, normal);
            let found = (0..places.len()).map(|k| Found {
                weight: weight(places[k]),
                value: if whole[k] > 0.0 {
                    seen[k] / whole[k]
                } else {
                    0.0
                },
                counts: whole[k] / (seen[k] + reflected[k]).max(f64::MIN_POSITIVE),
            });
            found.collect()
        };
        let fine = Fine {
            shortest: FINE.shortest * (floor.frame.size_u * floor.frame.size_v).sqrt(),
            ..FINE
        };
        let split = split(places, triangles, &look, fine);
        let inside = split.inside();
        let areas = weighed(&split.areas(), &in_space(floor, &inside), known);
        // In the middle of an edge whose ends see all, or nothing, the same is seen: it
        // lies along an outline.
        for (ends, place) in split.ends.iter().zip(&inside).skip(free.len()) {
            let of_ends = ends.map(|ends| ends.map(|k| free[k]));
            let same = match of_ends {
                Some([Some(a), Some(b)]) if a == b => Some(a),
                _ => None,
            };
            let there = |value: &f64| (look(&[*place])[0].value - value).abs() < 1e-6;
            free.push(same.filter(there));
        }
        let receivers = in_space(floor, &inside);
        let seen = sums(&(known.direct)(&receivers));
        let whole = sums(&(known.unshadowed)(&receivers));
        let reflected: Vec<f64> = inside.iter().map(|&place| around.at(place)).collect();
        let brightest = seen
            .iter()
            .zip(&reflected)
            .map(|(a, b)| a + b)
            .fold(0.0, f64::max);
        let truth = NodeTruth {
            fractions: whole
                .iter()
                .zip(&seen)
                .map(|(whole, seen)| if *whole > 0.0 { seen / whole } else { 0.0 })
                .collect(),
            counts: (0..inside.len())
                .map(|k| whole[k] / (seen[k] + reflected[k]).max(1e-3 * brightest))
                .collect(),
            areas,
        };
        let mut shadows = Self {
            floor: floor.clone(),
            steps: Vec::new(),
            places: nodes(floor, &split.places),
            split,
            inside,
            free,
            order: Vec::new(),
        };
        shadows.climb(&truth);
        shadows
    }

    /// Adds samples, some at a time, where V is farthest off.
    fn climb(&mut self, truth: &NodeTruth) {
        let area = truth.areas.iter().sum();
        let unknown: Vec<usize> = (0..self.places.len())
            .filter(|&k| self.free[k].is_none())
            .collect();
        loop {
            let values = self.values(&truth.fractions, &unknown);
            let error = |k: usize| (values[k] - truth.fractions[k]) * truth.counts[k];
            let loss = unknown
                .iter()
                .map(|&k| counted(error(k)) * truth.areas[k])
                .sum();
            self.steps.push(Step {
                samples: self.order.len(),
                loss,
                area,
            });
            let used: BTreeSet<usize> = self.order.iter().copied().collect();
            let mut worst: Vec<usize> = unknown
                .iter()
                .copied()
                .filter(|k| !used.contains(k))
                .collect();
            if worst.is_empty() || self.order.len() >= MOST {
                break;
            }
            let value = |k: usize| counted(error(k)) * truth.areas[k];
            worst.sort_by(|&a, &b| value(b).total_cmp(&value(a)).then(a.cmp(&b)));
            let batch = 1 + self.order.len() / 8;
            let apart = 0.4 * (area / (self.order.len() + batch) as f64).sqrt();
            let mut added: Vec<usize> = Vec::new();
            for k in worst {
                let far = |&other: &usize| {
                    let [a, b] = [self.inside[k], self.inside[other]];
                    (a[0] - b[0]).hypot(a[1] - b[1]) >= apart
                };
                if added.iter().all(far) {
                    added.push(k);
                }
                if added.len() == batch {
                    break;
                }
            }
            self.order.extend(added);
        }
    }

    /// V at all nodes, from what is free and from the samples so far.
    fn values(&self, fractions: &[f64], unknown: &[usize]) -> Vec<f64> {
        let mut values: Vec<f64> = self.free.iter().map(|free| free.unwrap_or(0.0)).collect();
        let from = self.from(&self.order);
        let places: Vec<[f64; 2]> = from.iter().map(|&k| self.inside[k]).collect();
        for &k in unknown {
            let weights = self.weights(&places, k);
            let value: f64 = weights
                .iter()
                .map(|&(i, weight)| weight * self.free[from[i]].unwrap_or(fractions[from[i]]))
                .sum();
            values[k] = value.clamp(0.0, 1.0);
        }
        values
    }

    /// The weights of places in the value of a node, from which they are not cut off
    /// by the foot of something.
    fn weights(&self, places: &[[f64; 2]], node: usize) -> Vec<(usize, f64)> {
        let at = self.inside[node];
        let sides = (0..places.len()).filter(|&i| !is_cut(&self.floor, places[i], at));
        let near: Vec<usize> = sides.collect();
        let those: Vec<[f64; 2]> = near.iter().map(|&i| places[i]).collect();
        let weights = spline::weights(&those, at).into_iter();
        weights.map(|(i, weight)| (near[i], weight)).collect()
    }

    /// What values are made of: samples, and nodes that are known beforehand.
    fn from(&self, samples: &[usize]) -> Vec<usize> {
        let known = (0..self.places.len()).filter(|&k| self.free[k].is_some());
        samples.iter().copied().chain(known).collect()
    }

    fn mesh(&self, step: usize) -> (Vec<[f64; 2]>, Mesh) {
        let count = self.steps.get(step).map_or(0, |step| step.samples);
        let samples = &self.order[..count];
        let from = self.from(samples);
        let places: Vec<[f64; 2]> = from.iter().map(|&k| self.inside[k]).collect();
        let node = |k: usize| {
            let mut node = Node {
                place: self.places[k],
                constant: self.free[k].unwrap_or(0.0),
                shares: Vec::new(),
            };
            if self.free[k].is_none() {
                for (i, weight) in self.weights(&places, k) {
                    match self.free[from[i]] {
                        Some(value) => node.constant += weight * value,
                        None => node.shares.push((i, weight)),
                    }
                }
            }
            node
        };
        let mesh = Mesh {
            first: 0,
            samples: count,
            nodes: (0..self.places.len()).map(node).collect(),
            triangles: self.split.triangles.clone(),
            outside: Some(1.0),
        };
        (places[..count].to_vec(), mesh)
    }
}

/// What nodes in shadow are measured by.
struct NodeTruth {
    /// V.
    fractions: Vec<f64>,
    /// What an error of 1 in V is of all light.
    counts: Vec<f64>,
    /// The area each stands for, in m².
    areas: Vec<f64>,
}
