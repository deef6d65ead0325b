//! The light that a reflecting surface sends out, held on a quadtree that
//! refines itself where a receiver asks for it.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;

use super::form_factor::form_factor;
use super::patch::{Exposure, Patch, Receiver};
use super::rule::Rule;

/// A patch is integrated as a whole from this many radii away: 10 nodes in a
/// direction then leave about 1e-12 of the kernel unresolved.
pub(super) const FAR: f64 = 2.0;

/// Halvings after which a patch is taken as one value times its form factor.
const DEEPEST: u32 = 44;

/// Patches kept for the next receiver (at most 80 MB); beyond that they are made anew each
/// time, with the same values.
const KEPT: usize = 16_384;

/// A cell whose interpolant matches the exact radiance this closely
/// (relative to its largest value) is refined by interpolation.
const INTERPOLATES: f64 = 1e-11;

/// The quarters of a square, in the order of a cell's children.
pub(super) const QUARTERS: [(usize, usize); 4] = [(0, 0), (1, 0), (0, 1), (1, 1)];

/// Radiance on one patch.
pub(super) struct Cell {
    patch: Patch,
    values: Vec<f64>,
    /// Radiance times area at each node.
    weighted: Vec<f64>,
    lowest: f64,
    highest: f64,
    depth: u32,
    /// Whether the polynomial through the nodes is the radiance.
    exact: bool,
    children: OnceLock<Box<Children>>,
}

struct Children {
    cells: [Cell; 4],
    /// Relative error of integrating over the parent instead.
    error: f64,
    /// Whether the parent's polynomial gives the children's values.
    smooth: bool,
}

/// A surface of which radiance is known, and how to learn more of it.
pub(super) struct Field<'a> {
    /// The rule of its cells.
    pub(super) rule: &'a Rule,
    /// Unit normal of the surface.
    pub(super) normal: DVec3,
    /// Radiance at a point of the surface.
    pub(super) radiance: &'a (dyn Fn(DVec3) -> f64 + Sync),
    /// Rounding of that radiance, absolute.
    pub(super) noise: f64,
    /// Cells kept so far.
    pub(super) kept: &'a AtomicUsize,
}

impl Cell {
    /// A cell whose radiance is evaluated at the nodes.
    pub(super) fn evaluate(corners: [DVec3; 4], field: &Field<'_>) -> Self {
        let patch = Patch::new(corners, field.normal, field.rule);
        let values = patch.nodes().map(field.radiance).collect();
        Self::of(patch, values, 0, false)
    }

    fn of(patch: Patch, values: Vec<f64>, depth: u32, exact: bool) -> Self {
        Self {
            weighted: values.iter().zip(&patch.area).map(|(l, a)| l * a).collect(),
            lowest: values.iter().copied().fold(f64::INFINITY, f64::min),
            highest: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            patch,
            values,
            depth,
            exact,
            children: OnceLock::new(),
        }
    }

    /// Integral of the radiance over the patch, by its own rule.
    pub(super) fn flux(&self) -> f64 {
        self.weighted.iter().sum()
    }

    /// Area by the patch's rule.
    pub(super) fn area(&self) -> f64 {
        self.patch.area.iter().sum()
    }

    /// Irradiance at a receiver `height` over the surface's plane, to within
    /// about `tolerance`.
    pub(super) fn receive(
        &self,
        field: &Field<'_>,
        receiver: &Receiver,
        height: f64,
        tolerance: f64,
    ) -> f64 {
        let exposure = self.patch.exposure(receiver);
        if exposure == Exposure::Below || (self.exact && self.lowest == 0.0 && self.highest == 0.0)
        {
            return 0.0;
        }
        let distance = self.patch.centre.distance_squared(receiver.position);
        let is_far = distance >= FAR * FAR * self.patch.radius * self.patch.radius;
        let flat = std::f64::consts::PI * (self.highest - self.lowest) <= tolerance;
        if self.depth >= DEEPEST || (flat && self.exact && !is_far) {
            return self.constant(receiver);
        }
        if is_far && self.exact {
            return self.whole(field, receiver, height, exposure);
        }
        self.with_children(field, |children| {
            if is_far && (exposure == Exposure::Above || children.smooth) {
                let value = self.whole(field, receiver, height, exposure);
                if children.error * value.abs() <= tolerance {
                    return value;
                }
            }
            if flat && children.smooth {
                return self.constant(receiver);
            }
            let parts = children.cells.iter();
            parts
                .map(|cell| cell.receive(field, receiver, height, tolerance))
                .sum()
        })
    }

    /// The patch as one value times its form factor.
    fn constant(&self, receiver: &Receiver) -> f64 {
        let factor = form_factor(receiver.position, receiver.normal, &self.patch.corners);
        std::f64::consts::PI * factor * 0.5 * (self.lowest + self.highest)
    }

    /// The patch by its own rule.
    fn whole(
        &self,
        field: &Field<'_>,
        receiver: &Receiver,
        height: f64,
        exposure: Exposure,
    ) -> f64 {
        if exposure == Exposure::Above {
            return self.patch.receive(receiver, height, &self.weighted);
        }
        let mut weights = vec![0.0; self.values.len()];
        let surface = (field.normal, field.rule);
        self.patch
            .weigh_crossed(receiver, height, surface, &mut weights);
        weights.iter().zip(&self.values).map(|(w, l)| w * l).sum()
    }

    fn with_children<T>(&self, field: &Field<'_>, use_them: impl FnOnce(&Children) -> T) -> T {
        if let Some(children) = self.children.get() {
            return use_them(children);
        }
        if field.kept.load(Ordering::Relaxed) < KEPT {
            return use_them(self.children.get_or_init(|| {
                field.kept.fetch_add(QUARTERS.len(), Ordering::Relaxed);
                Box::new(self.split(field))
            }));
        }
        use_them(&self.split(field))
    }

    fn split(&self, field: &Field<'_>) -> Children {
        let mut smooth = true;
        let cells = QUARTERS.map(|quarter| {
            let patch = self.patch.quarter(quarter, field.normal, field.rule);
            let carried = field.rule.refine(&self.values, quarter);
            if self.exact {
                return Self::of(patch, carried, self.depth + 1, true);
            }
            let values: Vec<f64> = patch.nodes().map(field.radiance).collect();
            let allowed = INTERPOLATES * self.highest.abs() + 8.0 * field.noise;
            smooth &= values
                .iter()
                .zip(&carried)
                .all(|(a, b)| (a - b).abs() <= allowed);
            Self::of(patch, values, self.depth + 1, false)
        });
        let mut children = Children {
            cells,
            error: 0.0,
            smooth,
        };
        if smooth {
            children.cells.iter_mut().for_each(|cell| cell.exact = true);
        }
        if !self.exact {
            children.error = self.error(&children.cells, field);
        }
        children
    }

    /// The largest relative difference between the cell and its children, as
    /// receivers see it that are as near as a whole cell is ever used.
    fn error(&self, children: &[Self; 4], field: &Field<'_>) -> f64 {
        let along = (self.patch.corners[1] - self.patch.corners[0]).normalize_or_zero();
        let across = field.normal.cross(along);
        let diagonal = (along + across) * std::f64::consts::FRAC_1_SQRT_2;
        let mut worst = 0.0_f64;
        for lean in [DVec3::ZERO, along, across, diagonal, -diagonal] {
            let direction = (field.normal * 0.35 + lean).normalize_or_zero();
            let offset = direction * (FAR * self.patch.radius);
            let probe = Receiver {
                position: self.patch.centre + offset,
                normal: -direction,
            };
            let height = field.normal.dot(offset);
            let whole = self.patch.receive(&probe, height, &self.weighted);
            let parts: f64 = children
                .iter()
                .map(|cell| cell.patch.receive(&probe, height, &cell.weighted))
                .sum();
            if whole != parts {
                worst = worst.max((whole - parts).abs() / whole.abs().max(parts.abs()));
            }
        }
        // What rounding alone makes of it is no reason to refine.
        let mean = self.flux() / self.area();
        (worst - 4.0 * field.noise / mean.abs().max(f64::MIN_POSITIVE)).max(0.0)
    }
}
