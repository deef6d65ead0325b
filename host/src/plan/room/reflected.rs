//! Reflected light on a surface: a mesh, and samples in the order in which they tell
//! most.

use super::super::fields::split::{Fine, Found, Split, split};
use super::super::fields::{Mesh, Node, shares};
use super::super::shadow::{Floor, Lines, Mesh as Outlined, Options};
use super::ladder::Step;
use super::{Known, Places, Tag};
use crate::scene::polygon::point_to_segment;
use glam::{DVec2, DVec3};

/// Edges of the mesh along the longer side of a square surface.
const EDGES: f64 = 3.0;

/// Where the mesh is fine enough; lengths are parts of the surface's size.
const FINE: Fine = Fine {
    tolerance: 0.01,
    shortest: 1.0 / 128.0,
    most: 250,
};

/// The most samples of one surface.
const MOST: usize = 200;

/// A node's reflected light is corrected by no more than this factor.
const CORRECTION: f64 = 2.0;

/// Samples that a node's value is chosen from: the nearest.
const NEAREST: usize = 24;

/// What a surface's reflected light can be reconstructed from.
pub(super) struct Reflected {
    pub(super) steps: Vec<Step>,
    nodes: Vec<[f64; 2]>,
    pub(super) split: Split,
    /// Where nodes are looked at, and are made samples.
    inside: Vec<[f64; 2]>,
    /// What they may receive.
    rows: Vec<Vec<f64>>,
    /// What they receive of many patches.
    settled: Vec<f64>,
    /// The same as a multiple of what they receive of the patches.
    corrections: Vec<f64>,
    /// Nodes in the order in which they become samples.
    order: Vec<usize>,
    /// The same if all places counted alike; none where they do.
    without_camera: Vec<usize>,
    /// Why nodes would be samples, but for the camera.
    tags: Vec<Tag>,
    /// The most samples that a node's value is made of.
    most: usize,
}

/// Where the nodes of the tables go: as the vertices, but those on the surface's own
/// outline a little beyond it, so that what is rounded, and the places on the outline
/// itself, are inside of triangles.
pub(super) fn nodes(floor: &Floor, vertices: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let frame = &floor.frame;
    let size = DVec2::new(frame.size_u, frame.size_v);
    let beyond = 4.0 * size.max_element() / f64::from(u16::MAX);
    let corners: Vec<DVec2> = frame.vertices.iter().map(|&corner| corner.into()).collect();
    let sides = (0..corners.len()).map(|i| [corners[i], corners[(i + 1) % corners.len()]]);
    let sides: Vec<[DVec2; 2]> = sides.collect();
    let node = |&vertex: &[f64; 2]| {
        let at = DVec2::from(vertex);
        let mut moved = at;
        for &[a, b] in &sides {
            if point_to_segment(at, a, b) <= 1e-7 * size.max_element() {
                // The outline runs counter-clockwise.
                moved -= beyond * (b - a).perp().normalize_or_zero();
            }
        }
        moved.clamp(DVec2::ZERO, size).into()
    };
    vertices.iter().map(node).collect()
}

/// Whether the way between two places of a surface crosses the foot of something.
pub(super) fn is_cut(floor: &Floor, from: [f64; 2], to: [f64; 2]) -> bool {
    let (from, to) = (DVec2::from(from), DVec2::from(to));
    floor.contacts.iter().any(|line| {
        let [a, b] = line.ends.map(DVec2::from);
        let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
        side(a, b, from) * side(a, b, to) < 0.0 && side(from, to, a) * side(from, to, b) < 0.0
    })
}

fn nodes_of(order: Vec<(usize, f64)>) -> Vec<usize> {
    order.into_iter().map(|(node, _)| node).collect()
}

/// Places of a surface in space, with its normal.
pub(super) fn in_space(floor: &Floor, places: &[[f64; 2]]) -> Vec<(DVec3, DVec3)> {
    let frame = &floor.frame;
    let place = |&[u, v]: &[f64; 2]| (frame.to_world(u, v), frame.normal);
    places.iter().map(place).collect()
}

/// Areas, each by how much the place that it is around counts.
pub(super) fn weighed(areas: &[f64], places: &Places, known: &Known<'_>) -> Vec<f64> {
    let of_place = areas.iter().zip(places);
    let weighed = of_place.map(|(area, &(place, normal))| area * (known.importance)(place, normal));
    weighed.collect()
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
        let look = |places: &[[f64; 2]]| -> Vec<Found> {
            let places = in_space(floor, places);
            let reflected = (known.settled)(&places);
            let direct = sums(&(known.direct)(&places));
            let found = reflected.iter().zip(direct).zip(&places);
            let found = found.map(|((&value, direct), &(place, normal))| Found {
                value,
                counts: 1.0 / (value + direct).max(f64::MIN_POSITIVE),
                weight: (known.importance)(place, normal),
            });
            found.collect()
        };
        let fine = Fine {
            shortest: FINE.shortest * area.sqrt(),
            ..FINE
        };
        let split = split(vertices, triangles, &look, fine);
        let inside = split.inside();
        let places = in_space(floor, &inside);
        let alike = split.areas();
        let areas = weighed(&alike, &places, known);
        let parts = (known.reflected)(&places);
        let direct = sums(&(known.direct)(&places));
        let whole = sums(&(known.unshadowed)(&places));
        let patches = known.patches();
        let rows: Vec<Vec<f64>> = parts
            .iter()
            .map(|parts| {
                let parts: Vec<f64> = parts.iter().map(|&part| f64::from(part)).collect();
                shares::row(&parts, &patches)
            })
            .collect();
        let settled = (known.settled)(&places);
        let corrections = settled
            .iter()
            .zip(&rows)
            .map(|(settled, row)| match row[0] > 0.0 {
                true => (settled / row[0]).clamp(1.0 / CORRECTION, CORRECTION),
                false => 1.0,
            });
        let corrections: Vec<f64> = corrections.collect();
        let all: Vec<f64> = rows
            .iter()
            .zip(&direct)
            .map(|(row, direct)| row[0] + direct)
            .collect();
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
        let without_camera = match areas == alike {
            true => Vec::new(),
            false => nodes_of(shares::order(&relative, &alike, MOST)),
        };
        let tags = (0..inside.len()).map(|k| match () {
            () if floor.is_at_foot(inside[k].into()) => Tag::Contact,
            () if whole[k] > 1e-9 * brightest && direct[k] <= 1e-9 * whole[k] => Tag::Umbra,
            () => Tag::Reflected,
        });
        let tags = tags.collect();
        let area = areas.iter().sum();
        let steps = found.iter().enumerate().map(|(k, &(_, loss))| Step {
            samples: k + 1,
            loss,
            area,
        });
        Some(Self {
            steps: steps.collect(),
            nodes: nodes(floor, &split.places),
            split,
            inside,
            rows,
            settled,
            corrections,
            order: nodes_of(found),
            without_camera,
            tags,
            most: known.shares,
        })
    }

    /// Why one of the first `count` samples is there.
    pub(super) fn tag(&self, sample: usize, count: usize) -> Tag {
        let Some(&node) = self.order.get(sample) else {
            return Tag::Reflected;
        };
        let before = &self.without_camera[..count.min(self.without_camera.len())];
        match self.without_camera.is_empty() || before.contains(&node) {
            true => self.tags[node],
            false => Tag::View,
        }
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
            let correction = self.corrections[k];
            let wanted: Vec<f64> = self.rows[k].iter().map(|x| x * correction).collect();
            let mut shares = shares::fit(&wanted, &offered, self.most);
            // No patch of the draft sends anything there, but there is light.
            if let (true, Some((sample, row))) = (shares.is_empty(), offered.first())
                && row[0] > 0.0
            {
                shares.push((*sample, (self.settled[k] / row[0]).min(CORRECTION)));
            }
            Node {
                place: self.nodes[k],
                constant: 0.0,
                shares,
            }
        };
        let mesh = Mesh {
            first: 0,
            samples: places.len(),
            nodes: (0..self.nodes.len()).map(node).collect(),
            triangles: self.split.triangles.clone(),
            outside: None,
        };
        (places, mesh)
    }
}
