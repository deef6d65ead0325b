//! Isolux outlines of a surface, and the samples and emitters they give.

use super::outline::{self, signed_area};
use super::pool::{Pool, Step};
use super::share::Demand;
use super::spacing::filter_radius;
use super::{Band, Field, Sample, SurfacePlan};
use crate::scene::Surface;
use crate::scene::frame::Frame;
use contour::ContourBuilder;
use glam::DVec3;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;
use isolux::form_factor::{Best, Outline, of_loops};
use isolux::geometry::{Plane, Receiver, Vector};
use isolux::number::SoftRoot;
use std::f64::consts::PI;

/// Cells along each side of the grid the field is looked at on; one more on
/// each side lies beyond the bounding rectangle, so that outlines reach the
/// edge with the field's own slope.
const CELLS: usize = 96;

/// Emitters on the brightest surfaces: the paper's number.
const MOST_BANDS: usize = 4;

/// Vertices that an outline needs to be worth one.
const VERTICES_PER_OUTLINE: usize = 5;

/// Probes that get less than this part of what the brightest one gets say
/// nothing about an emitter.
const FAINT: f64 = 0.05;

/// An error of what the probes get that counts as none, as a part of all light
/// that is emitted.
const WELL: f64 = 0.005;

/// Largest shift of the levels, in steps between them.
const LARGEST_SHIFT: f64 = 0.75;

/// Shifts that are tried on either side of none.
const SHIFTS: i32 = 15;

/// Levels start at this fraction of the largest irradiance at the lowest:
/// below it nothing is worth an emitter of its own.
const DARKEST: f64 = 1e-3;

/// A field whose largest and smallest values are this close has one level.
const FLAT: f64 = 1.001;

/// Loops that enclose less than this fraction of the surface are left out.
const SPECK: f64 = 1e-3;

/// Places closer together than this part of the surface's width are one.
const WELD: f64 = 1e-6;

/// Points on each edge of the polygon that may become vertices.
const POINTS_PER_EDGE: usize = 60;

/// The irradiance of a surface on a grid.
pub(super) struct Map {
    frame: Frame,
    area: f64,
    /// (CELLS + 2)² values, row by row.
    values: Vec<f64>,
    lowest: f64,
    highest: f64,
    peak: [f64; 2],
    power: f64,
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

    /// Power received, W (lm).
    pub(super) fn power(&self) -> f64 {
        self.power
    }

    pub(super) fn demand(&self) -> Demand {
        Demand {
            power: self.power,
            least: self.frame.vertices.len() + 1,
        }
    }

    /// Log-spaced levels between the darkest and the brightest place, all moved
    /// by `shift` of their common distance.
    fn levels(&self, bands: usize, shift: f64) -> Vec<f64> {
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
    fn outlines(&self, level: f64) -> Vec<outline::Outline> {
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
            .map(outline::Outline::new)
            .collect()
    }

    /// The surface's own outline, every edge offering places in between.
    fn edge(&self) -> outline::Outline {
        let corners = self.corners();
        let points = corners.iter().enumerate().flat_map(|(k, &a)| {
            let b = corners[(k + 1) % corners.len()];
            (0..POINTS_PER_EDGE).map(move |step| {
                let t = step as f64 / POINTS_PER_EDGE as f64;
                [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
            })
        });
        let chosen = (0..corners.len()).map(|k| k * POINTS_PER_EDGE).collect();
        outline::Outline::with_corners(points.collect(), chosen)
    }

    /// The brightest place, unless it lies at the surface's own outline, whose
    /// vertices stand for it then.
    fn inner_peak(&self) -> Option<[f64; 2]> {
        let [u, v] = self.peak;
        let (du, dv) = (
            2.0 * self.frame.size_u / CELLS as f64,
            2.0 * self.frame.size_v / CELLS as f64,
        );
        let around = [[u + du, v], [u - du, v], [u, v + dv], [u, v - dv]];
        around
            .iter()
            .all(|&[u, v]| self.frame.contains(u, v))
            .then_some(self.peak)
    }

    /// The polygon in the frame's coordinates.
    fn corners(&self) -> Vec<[f64; 2]> {
        self.frame.vertices.iter().map(|&(u, v)| [u, v]).collect()
    }

    /// Irradiance at a place, bilinear between the grid's values.
    fn value(&self, [u, v]: [f64; 2]) -> f64 {
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

    /// Places samples and makes emitters of them.
    ///
    /// A polygon inscribed in an outline encloses less than the outline, and the
    /// mean of two levels is not the mean between them: where the levels lie
    /// decides which of the two errors wins. So the log-spaced levels are moved
    /// as a whole, by the least part of their distance with which the emitters
    /// light the `probes` well enough ([`WELL`]), or else as well as can be.
    /// `weight` is the power the surface reflects as a part of all that is
    /// emitted.
    pub(super) fn place(self, samples: usize, probes: &[Probe], weight: f64) -> SurfacePlan {
        let lit = self.light(probes);
        let mut shifts: Vec<i32> = (-SHIFTS..=SHIFTS).collect();
        shifts.sort_by_key(|shift| shift.abs());
        let mut best: Option<Placed> = None;
        for shift in shifts {
            let shift = f64::from(shift) / f64::from(SHIFTS) * LARGEST_SHIFT;
            let placed = self.place_at(samples, shift, &lit);
            let well = placed.loss * weight <= WELL;
            if best.as_ref().is_none_or(|best| placed.loss < best.loss) {
                best = Some(placed);
            }
            if well {
                break;
            }
        }
        let (samples, bands) = best
            .map(|placed| (placed.samples, placed.bands))
            .unwrap_or_default();
        SurfacePlan {
            filter_radius: filter_radius(self.area, samples.len()),
            frame: self.frame,
            samples,
            bands,
        }
    }

    fn place_at(&self, samples: usize, shift: f64, lit: &[Lit]) -> Placed {
        let count = (samples / VERTICES_PER_OUTLINE).clamp(1, MOST_BANDS);
        let mut steps = vec![Step {
            level: 0.0,
            loops: vec![self.edge()],
        }];
        for level in self.levels(count, shift) {
            let loops = self.outlines(level);
            if !loops.is_empty() {
                steps.push(Step { level, loops });
            }
        }
        let weld = WELD * self.area.sqrt();
        let pool = Pool::fill(&mut steps, samples, self.inner_peak(), weld);
        let bands = pool.bands(&steps, |place| self.value(place));
        let samples = pool.into_samples();
        let values: Vec<f64> = samples
            .iter()
            .map(|sample| self.value(sample.place))
            .collect();
        let radiosities: Vec<f64> = bands
            .iter()
            .map(|band| {
                let sum: f64 = band.members.iter().map(|&member| values[member]).sum();
                sum / band.members.len().max(1) as f64
            })
            .collect();
        let loss = self.loss(&samples, &bands, &radiosities, lit);
        Placed {
            samples,
            bands,
            loss,
        }
    }
}

/// A place elsewhere, with its normal, that a surface's light may reach.
pub(super) type Probe = (DVec3, DVec3);

/// A probe and the light that truly reaches it from a surface, per unit of
/// reflectance.
struct Lit {
    receiver: Receiver<f64>,
    irradiance: f64,
}

impl Map {
    /// The light that reaches the probes from the surface, by the midpoint rule
    /// over the grid; probes that get next to nothing are left out.
    fn light(&self, probes: &[Probe]) -> Vec<Lit> {
        let cell = self.frame.size_u * self.frame.size_v / (CELLS * CELLS) as f64;
        let mut lit: Vec<Lit> = probes
            .iter()
            .filter_map(|&(place, normal)| {
                let receiver = Receiver::new::<SoftRoot>(place.into(), normal.into()).ok()?;
                let mut irradiance = 0.0;
                for (k, &value) in self.values.iter().enumerate() {
                    let [u, v] = cell_center(&self.frame, k);
                    if self.frame.contains(u, v) {
                        let ray = self.frame.to_world(u, v) - place;
                        let (out, at) = (-ray.dot(self.frame.normal), ray.dot(normal));
                        let squared = ray.length_squared();
                        if out > 0.0 && at > 0.0 {
                            irradiance += value * cell * out * at / (PI * squared * squared);
                        }
                    }
                }
                Some(Lit {
                    receiver,
                    irradiance,
                })
            })
            .collect();
        let most = lit.iter().map(|lit| lit.irradiance).fold(0.0, f64::max);
        lit.retain(|lit| lit.irradiance > FAINT * most);
        lit
    }

    /// The largest relative error of the light that these emitters send to the
    /// probes; without probes, the relative error of their power.
    fn loss(&self, samples: &[Sample], bands: &[Band], radiosities: &[f64], lit: &[Lit]) -> f64 {
        if lit.is_empty() {
            let carried: f64 = bands.iter().zip(radiosities).map(|(b, r)| b.area * r).sum();
            return if self.power > 0.0 {
                (carried / self.power - 1.0).abs()
            } else {
                0.0
            };
        }
        let polygons: Vec<Vec<Vec<[f64; 3]>>> = bands
            .iter()
            .map(|band| {
                let place = |&sample: &usize| {
                    let [u, v] = samples[sample].place;
                    <[f64; 3]>::from(self.frame.to_world(u, v))
                };
                band.loops
                    .iter()
                    .map(|l| l.iter().map(place).collect())
                    .collect()
            })
            .collect();
        let plane = Plane {
            normal: Vector::from(<[f64; 3]>::from(self.frame.normal)),
            point: Vector::from(<[f64; 3]>::from(self.frame.origin)),
        };
        let error = |lit: &Lit| {
            let sent: f64 = polygons
                .iter()
                .zip(radiosities)
                .map(|(loops, radiosity)| {
                    let loops = loops.iter().map(|vertices| Outline::new(vertices));
                    radiosity * of_loops::<Best, f64>(&lit.receiver, &plane, loops)
                })
                .sum();
            (sent / lit.irradiance - 1.0).abs()
        };
        lit.iter().map(error).fold(0.0, f64::max)
    }
}

/// The centre of a cell of the grid, which begins one cell outside of the
/// bounding rectangle.
fn cell_center(frame: &Frame, index: usize) -> [f64; 2] {
    let side = CELLS + 2;
    let center = |index: usize, size: f64| (index as f64 - 0.5) / CELLS as f64 * size;
    [
        center(index % side, frame.size_u),
        center(index / side, frame.size_v),
    ]
}

/// One way to place a surface's samples.
struct Placed {
    samples: Vec<Sample>,
    bands: Vec<Band>,
    /// What it errs by, to be compared with other ways.
    loss: f64,
}
