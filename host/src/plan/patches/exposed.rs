//! What light can reach of a surface, cut into cells.

use super::shapes::{Ring, bounds, convex_pieces, edges, first_moment, hull, signed_area};
use crate::occlusion::Solids;
use crate::scene::frame::Frame;
use crate::scene::polygon::point_to_segment;
use crate::scene::{Scene, Surface};
use glam::{DVec2, DVec3};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;

/// A surface without what lies on it: the bases of bodies that stand on it,
/// polygons back to back with it, luminaires set into it.
pub(super) struct Exposed {
    pub(super) frame: Frame,
    /// Polygons with their holes: the first ring is the outline.
    shapes: Vec<Vec<Ring>>,
}

/// What one cell has of the exposed part.
#[derive(Clone)]
pub(super) struct Cell {
    /// Convex pieces, counter-clockwise.
    pub(super) pieces: Vec<Ring>,
    pub(super) center: [f64; 2],
    pub(super) scale: f64,
    pub(super) area: f64,
    /// Whether it is the whole rectangle of its cell.
    pub(super) whole: bool,
    /// The bounding rectangle: lower left and upper right corner.
    pub(super) bounds: [[f64; 2]; 2],
}

/// A piece smaller than this part of its cell is dropped: rounding's.
const SLIVER: f64 = 1e-9;

impl Exposed {
    /// What is exposed of surface `index`, among the solids of the scene.
    pub(super) fn new(scene: &Scene, solids: &Solids, index: usize) -> Self {
        let surface = &scene.surfaces[index];
        let frame = Frame::new(surface);
        let outline: Ring = frame.vertices.iter().map(|&(u, v)| [u, v]).collect();
        let covers = covers(scene, solids, index, &frame);
        let shapes = if covers.is_empty() {
            vec![vec![outline]]
        } else {
            outline.overlay(&covers, OverlayRule::Difference, FillRule::NonZero)
        };
        Self { frame, shapes }
    }

    /// The longer side of the bounding rectangle, in metres.
    pub(super) fn longest(&self) -> f64 {
        self.frame.size_u.max(self.frame.size_v)
    }

    /// Whether a cell reaches the outline of the exposed part: there other surfaces adjoin.
    pub(super) fn borders(&self, cell: &Cell) -> bool {
        let flat = 1e-6 * self.longest();
        let near = |&vertex: &[f64; 2]| {
            let mut rings = self.shapes.iter().flatten();
            rings.any(|ring| {
                let side = |i: usize| {
                    let [a, b] = [ring[i], ring[(i + 1) % ring.len()]].map(DVec2::from);
                    point_to_segment(vertex.into(), a, b) <= flat
                };
                (0..ring.len()).any(side)
            })
        };
        cell.pieces.iter().flatten().any(near)
    }

    /// Cells along u and v: as many as `density` times the root of the length,
    /// so that a small surface has relatively smaller cells. A block in a room is
    /// seen from near by.
    pub(super) fn cells(&self, density: f64) -> [usize; 2] {
        [self.frame.size_u, self.frame.size_v]
            .map(|length| ((density * length.sqrt()).round() as usize).max(1))
    }

    /// Cuts into `along` x `across` cells, those that have nothing left out.
    pub(super) fn cut(&self, [along, across]: [usize; 2]) -> Vec<Cell> {
        let line = |length: f64, k: usize, n: usize| length * k as f64 / n as f64;
        let (width, height) = (self.frame.size_u, self.frame.size_v);
        (0..along * across)
            .filter_map(|k| {
                let (i, j) = (k % along, k / along);
                let low = [line(width, i, along), line(height, j, across)];
                let high = [line(width, i + 1, along), line(height, j + 1, across)];
                self.cell(low, high)
            })
            .collect()
    }

    pub(super) fn cell(&self, low: [f64; 2], high: [f64; 2]) -> Option<Cell> {
        let rectangle: Ring = vec![low, [high[0], low[1]], high, [low[0], high[1]]];
        let whole = (high[0] - low[0]) * (high[1] - low[1]);
        let parts: Vec<Vec<Ring>> =
            self.shapes
                .overlay(&rectangle, OverlayRule::Intersect, FillRule::NonZero);
        let mut pieces = convex_pieces(&parts);
        pieces.retain(|piece| signed_area(piece) > SLIVER * whole);
        let area: f64 = pieces.iter().map(|piece| signed_area(piece)).sum();
        if pieces.is_empty() {
            return None;
        }
        let is_whole = (area - whole).abs() <= 1e-7 * whole;
        let area = if is_whole {
            // The rectangle itself, without the overlay's rounding.
            pieces = vec![rectangle];
            whole
        } else {
            area
        };
        let moment: DVec2 = pieces.iter().map(|piece| first_moment(piece)).sum();
        let center = moment / area;
        let scale = pieces
            .iter()
            .flatten()
            .map(|&corner| DVec2::from(corner).distance(center))
            .fold(0.0, f64::max);
        Some(Cell {
            bounds: bounds(&pieces),
            pieces,
            center: center.into(),
            scale,
            area,
            whole: is_whole,
        })
    }
}

impl Cell {
    /// Whether a place is inside.
    pub(super) fn contains(&self, place: DVec2) -> bool {
        self.pieces
            .iter()
            .any(|piece| edges(piece).all(|(from, to)| (to - from).perp_dot(place - from) >= 0.0))
    }
}

/// The outlines on a surface's plane of what covers it.
fn covers(scene: &Scene, solids: &Solids, index: usize, frame: &Frame) -> Vec<Ring> {
    let flat = scene.plane_tolerance();
    let on_plane = |place: &DVec3| (*place - frame.origin).dot(frame.normal).abs() <= flat;
    let local = |place: &DVec3| <[f64; 2]>::from(frame.to_local(*place));
    let hides = |other: &Surface| {
        let back_to_back = other.normal.dot(frame.normal) < 0.0;
        (back_to_back || other.emits()) && other.vertices.iter().all(on_plane)
    };
    let polygons = (scene.surfaces.iter().enumerate())
        .filter(|&(other, surface)| other != index && hides(surface))
        .map(|(_, surface)| surface.vertices.iter().map(local).collect());
    let bases = solids.surfaces().filter_map(|surfaces| {
        let own = surfaces.contains(&index);
        let touching: Vec<[f64; 2]> = (surfaces.iter())
            .flat_map(|&face| &scene.surfaces[face].vertices)
            .filter(|vertex| on_plane(vertex))
            .map(local)
            .collect();
        (!own && touching.len() >= 3).then(|| hull(touching))
    });
    polygons
        .chain(bases)
        .map(|mut ring: Ring| {
            if signed_area(&ring) < 0.0 {
                ring.reverse();
            }
            ring
        })
        .filter(|ring| ring.len() >= 3)
        .collect()
}
