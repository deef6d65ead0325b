//! Segments made to meet in common vertices only.

use std::collections::BTreeMap;

use glam::DVec2;

use super::Kind;
use crate::scene::polygon::point_to_segment;

/// Segments between vertices, none of which crosses another or passes a
/// vertex.
///
/// Vertices nearer to each other than the resolution are one, which stays where
/// the first of them was; a vertex nearer than that to a segment is on it.
/// What was inserted first keeps its shape: on the outline of the surface and
/// of what covers it (the base) later vertices are moved onto its segments.
#[derive(Clone, Debug)]
pub(super) struct Arrangement {
    pub(super) places: Vec<DVec2>,
    /// Segments by their vertices, the lower first, with the most important
    /// kind of what runs there.
    pub(super) segments: BTreeMap<[usize; 2], Kind>,
    resolution: f64,
    /// Vertices by cell of a grid of twice the resolution.
    grid: BTreeMap<[i64; 2], Vec<usize>>,
    base: Vec<[DVec2; 2]>,
}

/// A segment and what it is.
pub(super) type Segment = (Kind, [DVec2; 2]);

/// A segment by its vertices.
type Piece = (Kind, [usize; 2]);

/// How often segments that were moved by the resolution are cut anew.
const ROUNDS: usize = 4;

impl Arrangement {
    /// The base, which bounds the surface, and other segments.
    pub(super) fn new(base: &[Segment], others: &[Segment], resolution: f64) -> Self {
        let mut arrangement = Self {
            places: Vec::new(),
            segments: BTreeMap::new(),
            resolution,
            grid: BTreeMap::new(),
            base: base.iter().map(|(_, ends)| *ends).collect(),
        };
        let mut pieces: Vec<Piece> = base
            .iter()
            .chain(others)
            .map(|&(kind, ends)| (kind, ends.map(|end| arrangement.vertex(end))))
            .collect();
        for _ in 0..ROUNDS {
            let before = arrangement.places.len();
            arrangement.cross(&pieces);
            pieces = arrangement.cut(&pieces);
            if arrangement.places.len() == before {
                break;
            }
        }
        for (kind, [a, b]) in pieces {
            let piece = arrangement.segments.entry([a.min(b), a.max(b)]);
            let known = piece.or_insert(kind);
            *known = kind.min(*known);
        }
        arrangement
    }

    /// The vertex at a place.
    fn vertex(&mut self, place: DVec2) -> usize {
        if let Some(index) = self.nearest(place) {
            return index;
        }
        let near =
            |side: &&[DVec2; 2]| point_to_segment(place, side[0], side[1]) <= self.resolution;
        let place = match self.base.iter().find(near) {
            Some(&[a, b]) => {
                let along = b - a;
                a + along * ((place - a).dot(along) / along.length_squared()).clamp(0.0, 1.0)
            }
            None => place,
        };
        if let Some(index) = self.nearest(place) {
            return index;
        }
        self.places.push(place);
        let index = self.places.len() - 1;
        self.grid.entry(self.cell(place)).or_default().push(index);
        index
    }

    fn cell(&self, place: DVec2) -> [i64; 2] {
        place
            .to_array()
            .map(|x| (x / (2.0 * self.resolution)).floor() as i64)
    }

    fn nearest(&self, place: DVec2) -> Option<usize> {
        let [x, y] = self.cell(place);
        let around = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [x + i, y + j]));
        let near = around.flat_map(|cell| self.grid.get(&cell).into_iter().flatten());
        near.map(|&index| (self.places[index].distance(place), index))
            .filter(|&(distance, _)| distance <= self.resolution)
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
            .map(|(_, index)| index)
    }

    /// Makes vertices where pieces cross.
    fn cross(&mut self, pieces: &[Piece]) {
        let reach = DVec2::splat(self.resolution);
        let ends = |piece: &Piece, places: &[DVec2]| piece.1.map(|end| places[end]);
        let boxed = |[a, b]: [DVec2; 2]| (a.min(b) - reach, a.max(b) + reach);
        let known = self.places.clone();
        for (i, first) in pieces.iter().enumerate() {
            let one = ends(first, &known);
            let (low, high) = boxed(one);
            for second in &pieces[i + 1..] {
                let other = ends(second, &known);
                let (from, to) = boxed(other);
                if from.cmpgt(high).any() || to.cmplt(low).any() {
                    continue;
                }
                if let Some(place) = crossing(one, other) {
                    self.vertex(place);
                }
            }
        }
    }

    /// The pieces cut at the vertices on them.
    fn cut(&self, pieces: &[Piece]) -> Vec<Piece> {
        let mut cut = Vec::with_capacity(pieces.len());
        for &(kind, [from, to]) in pieces {
            let (a, b) = (self.places[from], self.places[to]);
            let along = b - a;
            let on = |&index: &usize| {
                let place = self.places[index];
                index != from && index != to && point_to_segment(place, a, b) <= self.resolution
            };
            let mut stops: Vec<usize> = (0..self.places.len()).filter(on).collect();
            let order = |index: usize| (self.places[index] - a).dot(along);
            stops.sort_by(|&i, &j| order(i).total_cmp(&order(j)).then(i.cmp(&j)));
            let mut last = from;
            for stop in stops.into_iter().chain([to]) {
                if stop != last {
                    cut.push((kind, [last, stop]));
                }
                last = stop;
            }
        }
        cut.sort_by_key(|&(kind, [a, b])| (kind, a.min(b), a.max(b)));
        cut.dedup();
        cut
    }

    /// What runs through a place.
    pub(super) fn kind_at(&self, place: DVec2) -> Option<Kind> {
        let through = |&([a, b], _): &(&[usize; 2], &Kind)| {
            point_to_segment(place, self.places[*a], self.places[*b]) <= 0.1 * self.resolution
        };
        self.segments
            .iter()
            .filter(through)
            .map(|(_, kind)| *kind)
            .min()
    }

    /// Halves segments until none is longer than `longest`.
    pub(super) fn halve(&mut self, longest: f64, most: usize) {
        let mut waiting: Vec<([usize; 2], Kind)> =
            self.segments.iter().map(|(k, v)| (*k, *v)).collect();
        while let Some((ends, kind)) = waiting.pop() {
            let [a, b] = ends.map(|end| self.places[end]);
            if a.distance(b) <= longest || self.places.len() >= most {
                continue;
            }
            self.segments.remove(&ends);
            self.places.push(a.midpoint(b));
            let middle = self.places.len() - 1;
            for half in ends.map(|end| [end, middle]) {
                self.segments.insert(half, kind);
                waiting.push((half, kind));
            }
        }
    }
}

/// Where two segments cross or touch, but for common ends.
fn crossing([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> Option<DVec2> {
    let (along, side) = (b - a, d - c);
    let turn = along.perp_dot(side);
    if turn.abs() <= 1e-9 * along.length() * side.length() {
        return None;
    }
    let t = (c - a).perp_dot(side) / turn;
    let s = (c - a).perp_dot(along) / turn;
    let inside = (0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&s);
    inside.then(|| a + along * t)
}
