//! The irradiance of one surface as the planner sees it, and its outlines.

use super::Field;
use super::outline::{Outline, distance_to_segment, signed_area};
use super::share::Demand;
use crate::scene::Surface;
use crate::scene::frame::Frame;
use contour::ContourBuilder;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;

/// Cells along each side of the grid the field is looked at on; one more on
/// each side lies beyond the bounding rectangle, so that outlines reach the
/// edge with the field's own slope.
pub(super) const CELLS: usize = 96;

/// Levels start at this fraction of the largest irradiance at the lowest:
/// below it nothing is worth an emitter of its own.
const DARKEST: f64 = 1e-3;

/// A field whose largest and smallest values are this close has one level.
const FLAT: f64 = 1.001;

/// Loops that enclose less than this fraction of the surface are left out.
const SPECK: f64 = 1e-3;

/// Places closer to the outline than this part of the surface's width are on it.
const ON_OUTLINE: f64 = 1e-6;

/// Points on each edge of the polygon that may become vertices.
const POINTS_PER_EDGE: usize = 60;

/// The irradiance of a surface on a grid.
pub(super) struct Map {
    pub(super) frame: Frame,
    pub(super) area: f64,
    /// (CELLS + 2)² values, row by row.
    pub(super) values: Vec<f64>,
    lowest: f64,
    highest: f64,
    pub(super) peak: [f64; 2],
    /// Power received, W (lm).
    pub(super) power: f64,
}

impl Map {
    pub(super) fn new(surface: &Surface, field: &Field<'_>) -> Self {
        let frame = Frame::new(surface);
        let cells = (CELLS + 2) * (CELLS + 2);
        let places: Vec<[f64; 2]> = (0..cells).map(|k| cell_center(&frame, k)).collect();
        let asked: Vec<_> = places
            .iter()
            .map(|&[u, v]| (frame.to_world(u, v), surface.normal))
            .collect();
        let values = field(&asked);
        let inside: Vec<usize> = (0..values.len())
            .filter(|&k| frame.contains(places[k][0], places[k][1]))
            .collect();
        let brightest = inside
            .iter()
            .copied()
            .max_by(|&a, &b| values[a].total_cmp(&values[b]));
        let lowest = inside
            .iter()
            .map(|&k| values[k])
            .fold(f64::INFINITY, f64::min);
        let mean = inside.iter().map(|&k| values[k]).sum::<f64>() / inside.len().max(1) as f64;
        Self {
            area: surface.area,
            lowest: if lowest.is_finite() { lowest } else { 0.0 },
            highest: brightest.map_or(0.0, |k| values[k]),
            peak: brightest.map_or([0.0; 2], |k| places[k]),
            power: mean * surface.area,
            frame,
            values,
        }
    }

    /// What the surface asks of the sample budget.
    pub(super) fn demand(&self) -> Demand {
        Demand {
            power: self.power,
            least: self.frame.vertices.len() + 1,
        }
    }

    /// Log-spaced levels between the darkest and the brightest place, all moved
    /// by `shift` of their common distance.
    pub(super) fn levels(&self, bands: usize, shift: f64) -> Vec<f64> {
        let lowest = self.lowest.max(DARKEST * self.highest);
        if self.highest <= lowest * FLAT {
            return Vec::new();
        }
        let ratio = self.highest / lowest;
        (1..bands)
            .map(|k| lowest * ratio.powf((k as f64 + shift) / bands as f64))
            .collect()
    }

    /// The surface's part at or above a level: shapes of an outer loop and
    /// holes, as dense curves.
    fn region(&self, level: f64) -> Vec<Vec<Vec<[f64; 2]>>> {
        let side = CELLS + 2;
        let (step_u, step_v) = (
            self.frame.size_u / CELLS as f64,
            self.frame.size_v / CELLS as f64,
        );
        let builder = ContourBuilder::new(side, side, true)
            .x_origin(-step_u)
            .y_origin(-step_v)
            .x_step(step_u)
            .y_step(step_v);
        let Ok(contours) = builder.contours(&self.values, &[level]) else {
            return Vec::new();
        };
        let rings: Vec<Vec<[f64; 2]>> = contours
            .iter()
            .flat_map(|contour| contour.geometry().iter())
            .flat_map(|polygon| std::iter::once(polygon.exterior()).chain(polygon.interiors()))
            .map(|ring| ring.coords().skip(1).map(|c| [c.x, c.y]).collect())
            .collect();
        rings.overlay(&self.corners(), OverlayRule::Intersect, FillRule::EvenOdd)
    }

    /// Loops of the surface's part at or above a level, ready to be thinned.
    pub(super) fn outlines(&self, level: f64) -> Vec<Outline> {
        let oriented = |mut points: Vec<[f64; 2]>, hole: bool| {
            if (signed_area(&points) < 0.0) != hole {
                points.reverse();
            }
            points
        };
        self.region(level)
            .into_iter()
            .flat_map(|shape| {
                shape
                    .into_iter()
                    .enumerate()
                    .map(move |(k, points)| oriented(points, k > 0))
            })
            .filter(|points| signed_area(points).abs() > SPECK * self.area)
            .map(|points| Outline::new(points, |place| self.value(place)))
            .collect()
    }

    /// The surface's own outline, every edge offering places in between.
    pub(super) fn edge(&self) -> Outline {
        let corners = self.corners();
        let points = corners.iter().enumerate().flat_map(|(k, &a)| {
            let b = corners[(k + 1) % corners.len()];
            (0..POINTS_PER_EDGE).map(move |step| {
                let t = step as f64 / POINTS_PER_EDGE as f64;
                [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
            })
        });
        let chosen = (0..corners.len()).map(|k| k * POINTS_PER_EDGE).collect();
        Outline::with_corners(points.collect(), chosen, |place| self.value(place))
    }

    /// A place on the surface's outline moved `inset` metres inside; any other
    /// place as it is.
    pub(super) fn inside(&self, [u, v]: [f64; 2], inset: f64) -> [f64; 2] {
        let corners = self.corners();
        let near = ON_OUTLINE * self.area.sqrt();
        let mut inward = [0.0, 0.0];
        for (k, a) in corners.iter().enumerate() {
            let b = corners[(k + 1) % corners.len()];
            if distance_to_segment([u, v], *a, b) <= near {
                let length = (b[0] - a[0]).hypot(b[1] - a[1]);
                inward[0] -= (b[1] - a[1]) / length;
                inward[1] += (b[0] - a[0]) / length;
            }
        }
        let length = f64::hypot(inward[0], inward[1]);
        if length > 0.0 {
            [
                u + inset * inward[0] / length,
                v + inset * inward[1] / length,
            ]
        } else {
            [u, v]
        }
    }

    /// Whether the brightest place lies well inside of the surface's outline.
    pub(super) fn peaks_inside(&self) -> bool {
        let [u, v] = self.peak;
        let reach = |size: f64| 2.0 * size / CELLS as f64;
        let (du, dv) = (reach(self.frame.size_u), reach(self.frame.size_v));
        let around = [[u + du, v], [u - du, v], [u, v + dv], [u, v - dv]];
        around.iter().all(|&[u, v]| self.frame.contains(u, v))
    }

    /// The polygon in the frame's coordinates.
    fn corners(&self) -> Vec<[f64; 2]> {
        self.frame.vertices.iter().map(|&(u, v)| [u, v]).collect()
    }

    /// Irradiance at a place, bilinear between the grid's values.
    pub(super) fn value(&self, [u, v]: [f64; 2]) -> f64 {
        let side = CELLS + 2;
        let cell = |x: f64, size: f64| {
            let at = (x / size * CELLS as f64 + 0.5).clamp(0.0, side as f64 - 1.001);
            (at as usize, at.fract())
        };
        let ((column, s), (row, t)) = (cell(u, self.frame.size_u), cell(v, self.frame.size_v));
        let along = |row: usize| {
            let at = row * side + column;
            self.values[at] * (1.0 - s) + self.values[at + 1] * s
        };
        along(row) * (1.0 - t) + along(row + 1) * t
    }
}

/// The centre of a cell of the grid, which begins one cell outside of the
/// bounding rectangle.
pub(super) fn cell_center(frame: &Frame, index: usize) -> [f64; 2] {
    let side = CELLS + 2;
    let center = |index: usize, size: f64| (index as f64 - 0.5) / CELLS as f64 * size;
    [
        center(index % side, frame.size_u),
        center(index / side, frame.size_v),
    ]
}
