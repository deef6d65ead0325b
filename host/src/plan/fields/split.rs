//! Finer triangles where linear values err.

use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};

/// How far towards the middle of its triangles a place is looked at: what lies
/// exactly in the plane of an adjoining surface gets nothing from it.
pub const INSET: f64 = 0.03;

/// Passes over all edges at the most.
const PASSES: usize = 16;

/// Triangles that are being split.
pub struct Split {
    /// The corners.
    pub places: Vec<[f64; 2]>,
    /// The two ends of the edge that a corner was put in the middle of; `None` for
    /// those that were there.
    pub ends: Vec<Option<[usize; 2]>>,
    /// Indices of corners.
    pub triangles: Vec<[usize; 3]>,
    /// Which of the triangles that were there each is a part of.
    pub of: Vec<usize>,
}

/// What is looked for at a place: a value, and how much an error of 1 in it counts.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// The value.
    pub value: f64,
    /// What its error is multiplied by.
    pub counts: f64,
}

/// Splits edges in the middle until the value there is within `tolerance` of the mean
/// of both ends, as far as it counts, no edge is longer than `shortest`, or there are
/// `most` corners.
///
/// The same input gives the same triangles. Both triangles at an edge are split with
/// it: no corner ever lies on an edge.
pub fn split(
    places: Vec<[f64; 2]>,
    triangles: Vec<[usize; 3]>,
    look: &dyn Fn(&[[f64; 2]]) -> Vec<Found>,
    (tolerance, shortest, most): (f64, f64, usize),
) -> Split {
    let mut split = Split {
        ends: vec![None; places.len()],
        of: (0..triangles.len()).collect(),
        places,
        triangles,
    };
    let inside = split.inside();
    let mut values: Vec<f64> = look(&inside).iter().map(|found| found.value).collect();
    let mut fine = BTreeSet::new();
    for _ in 0..PASSES {
        let edges = split.edges();
        let new: Vec<[usize; 2]> = edges
            .keys()
            .filter(|edge| !fine.contains(*edge) && split.length(**edge) > 2.0 * shortest)
            .copied()
            .collect();
        let middles: Vec<[f64; 2]> = new
            .iter()
            .map(|edge| split.middle(*edge, &edges[edge]))
            .collect();
        let mut wrong: Vec<(f64, [usize; 2], f64)> = Vec::new();
        for (&edge, found) in new.iter().zip(look(&middles)) {
            let mean = (values[edge[0]] + values[edge[1]]) / 2.0;
            let error = (found.value - mean).abs() * found.counts;
            match error > tolerance {
                true => wrong.push((error, edge, found.value)),
                false => {
                    fine.insert(edge);
                }
            }
        }
        wrong.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut touched = BTreeSet::new();
        let mut any = false;
        for (_, edge, value) in wrong {
            let around = &edges[&edge];
            if split.places.len() >= most {
                return split;
            }
            if around.iter().all(|triangle| !touched.contains(triangle)) {
                touched.extend(around.iter().copied());
                split.at(edge, around);
                values.push(value);
                any = true;
            }
        }
        if !any {
            break;
        }
    }
    split
}

impl Split {
    /// Every edge with the triangles at it.
    fn edges(&self) -> BTreeMap<[usize; 2], Vec<usize>> {
        let mut edges: BTreeMap<[usize; 2], Vec<usize>> = BTreeMap::new();
        for (k, &[a, b, c]) in self.triangles.iter().enumerate() {
            for [a, b] in [[a, b], [b, c], [c, a]] {
                edges.entry([a.min(b), a.max(b)]).or_default().push(k);
            }
        }
        edges
    }

    fn length(&self, edge: [usize; 2]) -> f64 {
        let [a, b] = edge.map(|k| DVec2::from(self.places[k]));
        a.distance(b)
    }

    fn centre(&self, triangle: usize) -> DVec2 {
        let corners = self.triangles[triangle].map(|k| DVec2::from(self.places[k]));
        (corners[0] + corners[1] + corners[2]) / 3.0
    }

    /// Where the middle of an edge is looked at.
    fn middle(&self, edge: [usize; 2], around: &[usize]) -> [f64; 2] {
        let [a, b] = edge.map(|k| DVec2::from(self.places[k]));
        let sum: DVec2 = around.iter().map(|&triangle| self.centre(triangle)).sum();
        a.midpoint(b).lerp(sum / around.len() as f64, INSET).into()
    }

    /// Puts a corner in the middle of an edge.
    fn at(&mut self, edge: [usize; 2], around: &[usize]) {
        let [a, b] = edge.map(|k| DVec2::from(self.places[k]));
        let middle = self.places.len();
        self.places.push(a.midpoint(b).into());
        self.ends.push(Some(edge));
        for &triangle in around {
            let corners = self.triangles[triangle];
            let with = |old: usize| corners.map(|k| if k == old { middle } else { k });
            self.triangles[triangle] = with(edge[0]);
            self.triangles.push(with(edge[1]));
            self.of.push(self.of[triangle]);
        }
    }

    /// Where the corners are looked at.
    pub fn inside(&self) -> Vec<[f64; 2]> {
        let mut sums = vec![(DVec2::ZERO, 0.0); self.places.len()];
        for (k, triangle) in self.triangles.iter().enumerate() {
            let centre = self.centre(k);
            for &corner in triangle {
                sums[corner].0 += centre;
                sums[corner].1 += 1.0;
            }
        }
        let inside = self.places.iter().zip(sums).map(|(&place, (sum, count))| {
            let place = DVec2::from(place);
            match count > 0.0 {
                true => place.lerp(sum / count, INSET).into(),
                false => place.into(),
            }
        });
        inside.collect()
    }

    /// The area in m² that every corner stands for: a third of its triangles'.
    pub fn areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.places.len()];
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|k| DVec2::from(self.places[k]));
            let area = 0.5 * (b - a).perp_dot(c - a).abs();
            for &corner in triangle {
                areas[corner] += area / 3.0;
            }
        }
        areas
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bend_is_followed_and_nothing_else() {
        let places = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let triangles = vec![[0, 1, 2], [0, 2, 3]];
        let bend = |places: &[[f64; 2]]| -> Vec<Found> {
            let value = |&[u, _]: &[f64; 2]| (u - 0.6_f64).max(0.0);
            let found = |place| Found {
                value: value(place),
                counts: 1.0,
            };
            places.iter().map(found).collect()
        };
        let split = split(places, triangles, &bend, (0.01, 0.01, 400));
        let area: f64 = split.areas().iter().sum();
        assert!((area - 1.0).abs() < 1e-12, "all of the square, once");
        assert!(split.places.len() < 400, "{} corners", split.places.len());
        let near = |place: &&[f64; 2]| (place[0] - 0.6).abs() < 0.15;
        let of_bend = split.places.iter().filter(near).count();
        assert!(
            2 * of_bend > split.places.len(),
            "{of_bend} corners at the bend"
        );
    }
}
