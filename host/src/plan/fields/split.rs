//! Finer triangles where linear values err.

use super::counted;
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};

/// How far towards the middle of its triangles a place is looked at: what lies
/// exactly in the plane of an adjoining surface gets nothing from it.
const INSET: f64 = 0.03;

/// The same, as a part of the shortest edge: where the light turns about a corner, and
/// triangles become small, a place must not wander with them.
const NEAREST: f64 = 0.05;

/// A pass splits the edges at which this part of the largest loss is, or more.
const A_PASS: f64 = 0.3;

/// Passes over all edges at the most.
const PASSES: usize = 200;

/// Triangles that are being split.
#[derive(Clone)]
pub struct Split {
    /// The corners.
    pub places: Vec<[f64; 2]>,
    /// The two ends of the edge that a corner was put in the middle of; `None` for
    /// those that were there.
    pub ends: Vec<Option<[usize; 2]>>,
    /// Indices of corners.
    pub triangles: Vec<[usize; 3]>,
    /// How much each corner lessens the loss, in m²; infinite for those that were
    /// there.
    losses: Vec<f64>,
    /// The triangles that were there.
    whole: Vec<[usize; 3]>,
    /// Where each corner is looked at, as it was when it was put there.
    looked: Vec<[f64; 2]>,
    /// How far from corners and middles of edges that is, in metres at the most.
    inset: f64,
}

/// What is looked for at a place: a value, and how much an error of 1 in it counts.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// The value.
    pub value: f64,
    /// What its error is multiplied by.
    pub counts: f64,
    /// What the square of that is multiplied by.
    pub weight: f64,
}

/// What ends the splitting.
#[derive(Clone, Copy, Debug)]
pub struct Fine {
    /// Edges whose middle errs by less, as far as it counts, stay.
    pub tolerance: f64,
    /// No edge becomes shorter, in metres.
    pub shortest: f64,
    /// There are no more corners.
    pub most: usize,
}

/// Splits edges in the middle, always where the loss is greatest, until all is `fine`.
///
/// The loss is the square of what the mean of both ends errs by in the middle, as far
/// as it counts and [`counted`], over the triangles at the edge. The same input gives the same
/// triangles. Both triangles at an edge are split with it: no corner ever lies on an
/// edge.
pub fn split(
    places: Vec<[f64; 2]>,
    triangles: Vec<[usize; 3]>,
    look: &dyn Fn(&[[f64; 2]]) -> Vec<Found>,
    fine: Fine,
) -> Split {
    let mut split = Split {
        ends: vec![None; places.len()],
        losses: vec![f64::INFINITY; places.len()],
        places,
        whole: triangles.clone(),
        triangles,
        looked: Vec::new(),
        inset: NEAREST * fine.shortest,
    };
    split.looked = split.beside();
    let mut values: Vec<f64> = look(&split.looked)
        .iter()
        .map(|found| found.value)
        .collect();
    // What was found in the middles of edges, and how much it errs.
    let mut known: BTreeMap<[usize; 2], (f64, f64, f64)> = BTreeMap::new();
    for _ in 0..PASSES {
        let edges = split.edges();
        let long = |edge: &&[usize; 2]| split.length(**edge) > 2.0 * fine.shortest;
        let long_enough: Vec<[usize; 2]> = edges.keys().filter(long).copied().collect();
        let new: Vec<[usize; 2]> = (long_enough.iter().copied())
            .filter(|edge| !known.contains_key(edge))
            .collect();
        let middles = new.iter().map(|edge| split.middle(*edge, &edges[edge]));
        for (&edge, found) in new.iter().zip(look(&middles.collect::<Vec<_>>())) {
            let mean = (values[edge[0]] + values[edge[1]]) / 2.0;
            let error = (found.value - mean).abs() * found.counts;
            known.insert(edge, (found.value, error, found.weight));
        }
        let wrong = long_enough
            .iter()
            .filter(|edge| known[*edge].1 > fine.tolerance);
        let mut wrong: Vec<(f64, [usize; 2])> = wrong
            .map(|&edge| {
                let (_, error, weight) = known[&edge];
                (counted(error) * weight * split.area(&edges[&edge]), edge)
            })
            .collect();
        wrong.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let Some(&(greatest, _)) = wrong.first() else {
            break;
        };
        let mut touched = BTreeSet::new();
        for (loss, edge) in wrong {
            if split.places.len() >= fine.most {
                return split;
            }
            if loss < A_PASS * greatest {
                break;
            }
            let around = &edges[&edge];
            if around.iter().all(|triangle| !touched.contains(triangle)) {
                touched.extend(around.iter().copied());
                let looked = split.middle(edge, around);
                split.at(edge, around, loss, looked);
                values.push(known[&edge].0);
            }
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

    /// Of triangles, in m².
    fn area(&self, triangles: &[usize]) -> f64 {
        let area = |&triangle: &usize| {
            let [a, b, c] = self.triangles[triangle].map(|k| DVec2::from(self.places[k]));
            0.5 * (b - a).perp_dot(c - a).abs()
        };
        triangles.iter().map(area).sum()
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
        self.inset(a.midpoint(b), sum / around.len() as f64).into()
    }

    /// A little from a place towards another.
    fn inset(&self, place: DVec2, towards: DVec2) -> DVec2 {
        let way = (towards - place) * INSET;
        place + way.clamp_length_max(self.inset)
    }

    /// Puts a corner in the middle of an edge, which lessens the loss by so much.
    fn at(&mut self, edge: [usize; 2], around: &[usize], loss: f64, looked: [f64; 2]) {
        let [a, b] = edge.map(|k| DVec2::from(self.places[k]));
        let middle = self.places.len();
        self.places.push(a.midpoint(b).into());
        self.ends.push(Some(edge));
        self.losses.push(loss);
        self.looked.push(looked);
        for &triangle in around {
            let corners = self.triangles[triangle];
            let with = |old: usize| corners.map(|k| if k == old { middle } else { k });
            self.triangles[triangle] = with(edge[0]);
            self.triangles.push(with(edge[1]));
        }
    }

    /// What each corner is worth, in m², when corners are taken in their order: one
    /// without which a more valuable one cannot be had is worth the mean of both
    /// (isotonic regression, by pooling adjacent violators). Infinite for those that
    /// were there.
    pub fn worth(&self) -> Vec<f64> {
        let mut pools: Vec<(f64, usize)> = Vec::new();
        for &loss in &self.losses {
            let mut pool = (loss, 1);
            while let Some(&(before, count)) = pools.last() {
                if before >= pool.0 {
                    break;
                }
                let sum = before * count as f64 + pool.0 * pool.1 as f64;
                pool = (sum / (count + pool.1) as f64, count + pool.1);
                pools.pop();
            }
            pools.push(pool);
        }
        let worth = pools
            .into_iter()
            .flat_map(|(mean, count)| std::iter::repeat_n(mean, count));
        worth.collect()
    }

    /// The triangles of the first `corners` alone, or of those that were there, if
    /// these are more: edges are split in the order of the corners.
    pub fn coarser(&self, corners: usize) -> Vec<[usize; 3]> {
        let mut triangles = self.whole.clone();
        for (middle, ends) in self.ends.iter().enumerate().take(corners) {
            let &Some(ends) = ends else { continue };
            for k in 0..triangles.len() {
                if ends.iter().all(|end| triangles[k].contains(end)) {
                    let with = |old: usize| triangles[k].map(|c| if c == old { middle } else { c });
                    let [one, other] = ends.map(with);
                    triangles[k] = one;
                    triangles.push(other);
                }
            }
        }
        triangles
    }

    /// Where the corners are looked at: always where their values were taken when they were
    /// put there. At a corner of what stands on a surface the light turns about it.
    pub fn inside(&self) -> Vec<[f64; 2]> {
        self.looked.clone()
    }

    /// A little from every corner towards the middle of its triangles.
    fn beside(&self) -> Vec<[f64; 2]> {
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
                true => self.inset(place, sum / count).into(),
                false => place.into(),
            }
        });
        inside.collect()
    }

    /// The area in m² that every corner stands for: a third of its triangles'.
    pub fn areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.places.len()];
        for (k, triangle) in self.triangles.iter().enumerate() {
            for &corner in triangle {
                areas[corner] += self.area(&[k]) / 3.0;
            }
        }
        areas
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(triangles: &[[usize; 3]]) -> Vec<[usize; 3]> {
        let mut sorted = triangles.to_vec();
        for triangle in &mut sorted {
            triangle.sort_unstable();
        }
        sorted.sort_unstable();
        sorted
    }

    #[test]
    fn a_bend_is_followed_and_nothing_else() {
        let places = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let triangles = vec![[0, 1, 2], [0, 2, 3]];
        let bend = |places: &[[f64; 2]]| -> Vec<Found> {
            let value = |&[u, _]: &[f64; 2]| (u - 0.6_f64).max(0.0);
            let found = |place| Found {
                value: value(place),
                counts: 1.0,
                weight: 1.0,
            };
            places.iter().map(found).collect()
        };
        let fine = Fine {
            tolerance: 0.01,
            shortest: 0.01,
            most: 400,
        };
        let split = split(places, triangles, &bend, fine);
        let area: f64 = split.areas().iter().sum();
        assert!((area - 1.0).abs() < 1e-12, "all of the square, once");
        assert!(split.places.len() < 400, "{} corners", split.places.len());
        let all = split.coarser(split.places.len());
        assert_eq!(sorted(&all), sorted(&split.triangles));
        let few = Split {
            triangles: split.coarser(20),
            places: split.places[..20].to_vec(),
            looked: split.looked[..20].to_vec(),
            ..split.clone()
        };
        assert!((few.areas().iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert_eq!(split.coarser(0).len(), 2);
        let worth = split.worth();
        assert_eq!(worth.len(), split.places.len());
        assert!(
            worth.is_sorted_by(|a, b| a >= b) && worth[3].is_infinite() && worth[4].is_finite()
        );
        let near = |place: &&[f64; 2]| (place[0] - 0.6).abs() < 0.15;
        let of_bend = split.places.iter().filter(near).count();
        assert!(
            2 * of_bend > split.places.len(),
            "{of_bend} corners at the bend"
        );
    }
}
