//! Light reflected more than once: the radiance of every reflecting surface,
//! generation by generation, on a mesh that is refined until the answer
//! agrees with itself.
//!
//! Generation k is the irradiance by light reflected k times. On each cell
//! it is the polynomial through the nodes of a product Gauss rule; one
//! generation becomes the next by a matrix whose rows integrate those
//! polynomials against the exact kernel. Cells are graded towards the sides
//! of a surface, where light from a wall that shares the edge varies like
//! `d log d` with the distance d.

use std::f64::consts::PI;

use super::cell::{Cell, FAR, QUARTERS};
use super::form_factor::form_factor;
use super::parallel;
use super::patch::{Exposure, Patch, Receiver};
use super::rule::Rule;
use super::surface::{Outline, Reflector};
use super::{Error, Reflections};

/// Most nodes of a mesh: its matrix then takes 302 MB. A room of six
/// rectangles gets 4 x 4 cells a wall.
const MOST_NODES: usize = 6144;

/// Most generations before the light is said not to die out.
const MOST_GENERATIONS: usize = 10_000;

/// Halvings in a row of the matrix after which a patch is one value.
const DEEPEST: u32 = 24;

/// A patch whose form factor is below this is taken as one value.
const NEGLIGIBLE: f64 = 1e-10;

/// How finely the surfaces are cut: level 0 is one coarse cell a
/// quadrilateral, each further level a finer one.
pub(super) struct Mesh {
    /// The rule of the cells.
    pub(super) rule: Rule,
    /// One list of patches for each reflecting surface.
    patches: Vec<Vec<Patch>>,
}

/// A reflecting surface before its light is known.
pub(super) struct Blank {
    /// Where it is.
    pub(super) outline: Outline,
    /// Reflectance.
    pub(super) reflectance: f64,
    /// Its quadrilaterals.
    pub(super) quadrilaterals: Vec<[glam::DVec3; 4]>,
}

/// What the mesh finds.
pub(super) struct Interreflection {
    /// The rule of the reflectors' cells.
    pub(super) rule: Rule,
    /// Radiance `ρ/π` times the sum of all generations but the first and the last, so
    /// that a gather from it adds light reflected twice and more.
    pub(super) reflectors: Vec<Reflector>,
    /// Reflections that the answer holds.
    pub(super) reflections: usize,
}

impl Mesh {
    /// The mesh of a level; an error if it would hold too many nodes.
    pub(super) fn new(surfaces: &[Blank], level: usize) -> Result<Self, Error> {
        let rule = Rule::new(if level == 0 { 3 } else { 8 });
        let grades = grades(level);
        let cells = (grades.len() - 1) * (grades.len() - 1);
        let quadrilaterals: usize = surfaces.iter().map(|s| s.quadrilaterals.len()).sum();
        let nodes = quadrilaterals * cells * rule.order() * rule.order();
        if nodes > MOST_NODES {
            return Err(Error::TooFine {
                nodes,
                most: MOST_NODES,
            });
        }
        let cut = |surface: &Blank| -> Vec<Patch> {
            let normal = surface.outline.normal;
            let mut patches = Vec::new();
            for corners in &surface.quadrilaterals {
                let whole = Patch::new(*corners, normal, &rule);
                for v in grades.windows(2) {
                    for u in grades.windows(2) {
                        let part = [(u[0], v[0]), (u[1], v[0]), (u[1], v[1]), (u[0], v[1])]
                            .map(|(u, v)| whole.place(u, v));
                        patches.push(Patch::new(part, normal, &rule));
                    }
                }
            }
            patches
        };
        let patches = surfaces.iter().map(cut).collect();
        Ok(Self { rule, patches })
    }

    /// Every node as a receiver, surface by surface.
    pub(super) fn receivers(&self, surfaces: &[Blank]) -> Vec<Receiver> {
        let pairs = surfaces.iter().zip(&self.patches);
        pairs
            .flat_map(|(surface, patches)| {
                let normal = surface.outline.normal;
                let nodes = patches.iter().flat_map(Patch::nodes);
                nodes.map(move |position| Receiver { position, normal })
            })
            .collect()
    }

    /// Runs the generations. `first` is generation 1 at the mesh's nodes,
    /// `power` what the luminaires emit.
    pub(super) fn solve(
        self,
        surfaces: &[Blank],
        first: Vec<f64>,
        reflections: Reflections,
        power: f64,
    ) -> Result<Interreflection, Error> {
        let receivers = self.receivers(surfaces);
        let scale = self.scale(surfaces);
        let mut matrix: Option<Vec<f64>> = None;
        let mut sum = vec![0.0; first.len()];
        let mut generation = first;
        let mut count = 1;
        while !reflections.enough(count, self.unshot(surfaces, &generation), power) {
            if count == MOST_GENERATIONS {
                return Err(Error::DoesNotDieOut { generations: count });
            }
            for (total, value) in sum.iter_mut().zip(&generation) {
                *total += value;
            }
            count += 1;
            if reflections == Reflections::AtMost(count) {
                break;
            }
            let radiance: Vec<f64> = scale.iter().zip(&generation).map(|(s, e)| s * e).collect();
            let rows = matrix.get_or_insert_with(|| self.matrix(surfaces, &receivers));
            generation = rows
                .chunks_exact(radiance.len())
                .map(|row| row.iter().zip(&radiance).map(|(w, l)| w * l).sum())
                .collect();
        }
        let radiance: Vec<f64> = scale.iter().zip(&sum).map(|(s, e)| s * e).collect();
        Ok(self.interpolate(surfaces, &radiance, count))
    }

    /// `ρ/π` at every node.
    fn scale(&self, surfaces: &[Blank]) -> Vec<f64> {
        let pairs = surfaces.iter().zip(&self.patches);
        pairs
            .flat_map(|(surface, patches)| {
                let nodes: usize = patches.iter().map(|patch| patch.area.len()).sum();
                std::iter::repeat_n(surface.reflectance / PI, nodes)
            })
            .collect()
    }

    /// `Σ ρ ∫ E dA` for irradiance at the nodes.
    fn unshot(&self, surfaces: &[Blank], irradiance: &[f64]) -> f64 {
        let areas = self
            .patches
            .iter()
            .flat_map(|patches| patches.iter().flat_map(|patch| &patch.area));
        let scale = self.scale(surfaces);
        areas
            .zip(irradiance)
            .zip(&scale)
            .map(|((area, e), scale)| PI * scale * e * area)
            .sum()
    }

    /// Irradiance at each node for unit radiance at each other, row by row.
    fn matrix(&self, surfaces: &[Blank], receivers: &[Receiver]) -> Vec<f64> {
        let mut matrix = vec![0.0; receivers.len() * receivers.len()];
        parallel::rows(&mut matrix, receivers.len(), |index, row| {
            let mut rest = row;
            for (surface, patches) in surfaces.iter().zip(&self.patches) {
                let nodes = patches.iter().map(|patch| patch.area.len()).sum();
                let (own, others) = rest.split_at_mut(nodes);
                rest = others;
                let Some(height) = surface.outline.height(&receivers[index]) else {
                    continue;
                };
                let normal = surface.outline.normal;
                let pieces = own.chunks_exact_mut(self.rule.order() * self.rule.order());
                for (patch, weights) in patches.iter().zip(pieces) {
                    let gather = Gather {
                        rule: &self.rule,
                        normal,
                        receiver: &receivers[index],
                        height,
                    };
                    gather.weigh(patch, 0, weights);
                }
            }
        });
        matrix
    }

    fn interpolate(
        self,
        surfaces: &[Blank],
        radiance: &[f64],
        reflections: usize,
    ) -> Interreflection {
        let mut values = radiance.chunks_exact(self.rule.order() * self.rule.order());
        let reflectors = surfaces
            .iter()
            .zip(self.patches)
            .map(|(surface, patches)| Reflector {
                outline: surface.outline.clone(),
                reflectance: surface.reflectance,
                cells: patches
                    .into_iter()
                    .zip(&mut values)
                    .map(|(patch, values)| Cell::interpolant(patch, values.to_vec()))
                    .collect(),
            })
            .collect();
        Interreflection {
            rule: self.rule,
            reflectors,
            reflections,
        }
    }
}

/// Where the sides of a quadrilateral are cut: `(i/k)³/2` from either end.
fn grades(level: usize) -> Vec<f64> {
    let steps = level.saturating_sub(1);
    if steps == 0 {
        return vec![0.0, 1.0];
    }
    let half = (0..=steps).map(|index| 0.5 * (index as f64 / steps as f64).powi(3));
    let near: Vec<f64> = half.collect();
    let far = near[..steps].iter().rev().map(|place| 1.0 - place);
    near.iter().copied().chain(far).collect()
}

/// One receiver before one surface.
struct Gather<'a> {
    rule: &'a Rule,
    normal: glam::DVec3,
    receiver: &'a Receiver,
    height: f64,
}

impl Gather<'_> {
    /// Adds to `weights` the irradiance for unit radiance at each node of the
    /// patch, halving the patch towards the receiver.
    fn weigh(&self, patch: &Patch, depth: u32, weights: &mut [f64]) {
        let exposure = patch.exposure(self.receiver);
        if exposure == Exposure::Below {
            return;
        }
        let distance = patch.centre.distance_squared(self.receiver.position);
        if distance >= FAR * FAR * patch.radius * patch.radius {
            if exposure == Exposure::Above {
                patch.weigh(self.receiver, self.height, weights);
            } else {
                let surface = (self.normal, self.rule);
                patch.weigh_crossed(self.receiver, self.height, surface, weights);
            }
            return;
        }
        if depth > 3 {
            let factor = form_factor(self.receiver.position, self.receiver.normal, &patch.corners);
            if depth >= DEEPEST || factor <= NEGLIGIBLE {
                let basis = self.rule.basis(0.5);
                let pairs = basis.iter().flat_map(|v| basis.iter().map(move |u| u * v));
                for (weight, share) in weights.iter_mut().zip(pairs) {
                    *weight += PI * factor * share;
                }
                return;
            }
        }
        for quarter in QUARTERS {
            let part = patch.quarter(quarter, self.normal, self.rule);
            let mut own = vec![0.0; weights.len()];
            self.weigh(&part, depth + 1, &mut own);
            self.rule.restrict(&own, quarter, weights);
        }
    }
}
