//! Reflected light on a surface: a mesh, and samples in the order in which they tell
//! most.

use super::super::fields::{Mesh, Node, shares};
use super::super::shadow::{Floor, Lines, Mesh as Outlined, Options};
use super::Known;
use super::ladder::Step;
use glam::{DVec2, DVec3};

/// Edges of the mesh along the longer side of a square surface.
const EDGES: f64 = 16.0;

/// How far towards the middle of its triangles a node is looked at: what lies
/// exactly in the plane of an adjoining surface gets nothing from it.
pub(super) const INSET: f64 = 0.03;

/// The most samples of one surface.
const MOST: usize = 200;

/// Samples that a node's value is chosen from: the nearest.
const NEAREST: usize = 24;

/// What a surface's reflected light can be reconstructed from.
pub(super) struct Reflected {
    pub(super) steps: Vec<Step>,
    nodes: Vec<[f64; 2]>,
    triangles: Vec<[usize; 3]>,
    /// Where nodes are looked at, and are made samples.
    inside: Vec<[f64; 2]>,
    /// What they may receive.
    rows: Vec<Vec<f64>>,
    /// Nodes in the order in which they become samples.
    order: Vec<usize>,
}

/// Where the vertices of a mesh are looked at, and the area each stands for: a third
/// of its triangles'.
pub(super) fn looked_at(
    vertices: &[[f64; 2]],
    triangles: &[[usize; 3]],
) -> (Vec<[f64; 2]>, Vec<f64>) {
    let mut middles = vec![(DVec2::ZERO, 0.0); vertices.len()];
    let mut areas = vec![0.0; vertices.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|vertex| DVec2::from(vertices[vertex]));
        let area = 0.5 * (b - a).perp_dot(c - a).abs();
        for &vertex in triangle {
            middles[vertex].0 += (a + b + c) / 3.0;
            middles[vertex].1 += 1.0;
            areas[vertex] += area / 3.0;
        }
    }
    let inside = vertices.iter().zip(middles).map(|(&vertex, (sum, count))| {
        let vertex = DVec2::from(vertex);
        match count > 0.0 {
            true => vertex.lerp(sum / count, INSET).into(),
            false => vertex.into(),
        }
    });
    (inside.collect(), areas)
}

/// Places of a surface in space, with its normal.
pub(super) fn in_space(floor: &Floor, places: &[[f64; 2]]) -> Vec<(DVec3, DVec3)> {
    let frame = &floor.frame;
    let place = |&[u, v]: &[f64; 2]| (frame.to_world(u, v), frame.normal);
    places.iter().map(place).collect()
}

pub(super) fn sums(terms: &[Vec<f32>]) -> Vec<f64> {
    let sum = |parts: &Vec<f32>| parts.iter().map(|&part| f64::from(part)).sum();
    terms.iter().map(sum).collect()
}

impl Reflected {
    /// `None` where no reflected light arrives.
    pub(super) fn of(floor: &Floor, area: f64, known: &Known<'_>) -> Option<Self> {
        let options = Options {
            lines: Lines::Contacts,
            longest: area.sqrt() / EDGES * 1.4,
            ..Options::default()
        };
        let Outlined {
            vertices,
            triangles,
            ..
        } = Outlined::of(floor, &[], &options);
        let (inside, areas) = looked_at(&vertices, &triangles);
        let places = in_space(floor, &inside);
        let parts = (known.reflected)(&places);
        let direct = sums(&(known.direct)(&places));
        let rows: Vec<Vec<f64>> = parts
            .iter()
            .map(|parts| {
                let parts: Vec<f64> = parts.iter().map(|&part| f64::from(part)).collect();
                shares::row(&parts)
            })
            .collect();
        let all: Vec<f64> = rows.iter().zip(&direct).map(|(row, direct)| row[0] + direct).collect();
        let brightest = all.iter().copied().fold(0.0, f64::max);
        if rows.iter().all(|row| row[0] <= 1e-9 * brightest) {
            return None;
        }
        let relative: Vec<Vec<f64>> = rows
            .iter()
            .zip(&all)
            .map(|(row, all)| {
                let scale = 1.0 / all.max(1e-3 * brightest);
                row.iter().map(|x| x * scale).collect()
            })
            .collect();
        let found = shares::order(&relative, &areas, MOST);
        let area = areas.iter().sum();
        let steps = found.iter().enumerate().map(|(k, &(_, loss))| Step {
            samples: k + 1,
            loss,
            area,
        });
        Some(Self {
            steps: steps.collect(),
            nodes: vertices,
            triangles,
            inside,
            rows,
            order: found.into_iter().map(|(node, _)| node).collect(),
        })
    }

    /// The samples and the mesh of a step.
    pub(super) fn mesh(&self, step: usize) -> (Vec<[f64; 2]>, Mesh) {
        let samples = &self.order[..(step + 1).min(self.order.len())];
        let places: Vec<[f64; 2]> = samples.iter().map(|&node| self.inside[node]).collect();
        let node = |k: usize| {
            let at = DVec2::from(self.inside[k]);
            let mut near: Vec<usize> = (0..samples.len()).collect();
            let distance = |&s: &usize| DVec2::from(places[s]).distance_squared(at);
            near.sort_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b)));
            near.truncate(NEAREST);
            let offered: Vec<(usize, &[f64])> = near
                .iter()
                .map(|&s| (s, self.rows[samples[s]].as_slice()))
                .collect();
            Node {
                place: self.nodes[k],
                constant: 0.0,
                shares: shares::fit(&self.rows[k], &offered),
            }
        };
        let mesh = Mesh {
            first: 0,
            samples: places.len(),
            nodes: (0..self.nodes.len()).map(node).collect(),
            triangles: self.triangles.clone(),
            outside: None,
        };
        (places, mesh)
    }
}
