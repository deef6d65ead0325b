//! What a receiver gets from the cells it sees.

use std::f64::consts::PI;

use glam::DVec3;

use super::convex::{self, Loop};
use super::form_factor::form_factor_signed;
use super::polynomial::{Frame, Polynomial, TERMS};
use super::rule::Rule;
use super::tree::{Cell, Role, Tree};
use super::visible::Sight;

/// A piece whose radius exceeds this share of its distance is halved.
const NEAR: f64 = 0.5;

/// Halving ends at this share of the cell's radius: the light of a cell
/// varies little over such a piece.
const FINEST: f64 = 0.01;

/// A piece whose radius exceeds this share of its distance is corrected by
/// its exact form factor.
const CORRECTED: f64 = 0.15;

/// Below this share two nodes in a direction suffice.
const FAR: f64 = 0.08;

/// The rules that a gather uses.
pub(super) struct Rules {
    near: Rule,
    far: Rule,
}

impl Rules {
    pub(super) fn new() -> Self {
        Self {
            near: Rule::new(3),
            far: Rule::new(2),
        }
    }
}

/// A receiver before the cells of a tree.
pub(super) struct Gather<'a> {
    /// The cells.
    pub(super) tree: &'a Tree,
    /// What the receiver sees.
    pub(super) sight: &'a Sight,
    /// How to integrate.
    pub(super) rules: &'a Rules,
}

/// The plane of a surface before the receiver.
struct Plane {
    normal: DVec3,
    axes: [DVec3; 2],
    /// Height of the receiver over it.
    height: f64,
}

impl Gather<'_> {
    /// Calls `give` with each cell that `whole` accepts (or that has no
    /// children in use) and its moments: the irradiance at the receiver if
    /// the radiance of the visible part of the cell were 1, a, b, a², ab, b².
    ///
    /// `whole` is asked of cells of the mesh and below, with a bound on what
    /// the cell gives for unit radiance (infinite where the cell is close).
    pub(super) fn visit(
        &self,
        whole: &dyn Fn(&Cell, f64) -> bool,
        give: &mut dyn FnMut(usize, &Polynomial),
    ) {
        let everything = self.sight.everything();
        for reflector in &self.tree.reflectors {
            let Some(height) = reflector.outline.height(&self.sight.receiver) else {
                continue;
            };
            let plane = Plane {
                normal: reflector.outline.normal,
                axes: reflector.axes,
                height,
            };
            for &root in &reflector.roots {
                self.descend(root, &plane, &everything, whole, give);
            }
        }
    }

    fn descend(
        &self,
        index: usize,
        plane: &Plane,
        among: &[u32],
        whole: &dyn Fn(&Cell, f64) -> bool,
        give: &mut dyn FnMut(usize, &Polynomial),
    ) {
        let cell = &self.tree.cells[index];
        let receiver = &self.sight.receiver;
        let polygon = self.sight.relative(&cell.outline);
        let horizon = receiver.normal;
        if polygon.iter().all(|vertex| horizon.dot(*vertex) <= 0.0) {
            return;
        }
        let Some(blockers) = self.sight.blockers(among, &polygon, plane.normal) else {
            return;
        };
        let children = match cell.children {
            Some(children) if cell.role == Role::Above => Some(children),
            Some(children) => {
                let used = self.tree.cells[children[0]].light.is_some();
                let bound = bound(cell, plane, receiver.position, horizon);
                (used && !whole(cell, bound)).then_some(children)
            }
            None => None,
        };
        if let Some(children) = children {
            for child in children {
                self.descend(child, plane, &blockers, whole, give);
            }
            return;
        }
        let mut sum = [0.0; TERMS];
        self.piece(polygon, plane, &blockers, cell, &mut sum);
        if sum[0] > 0.0 {
            give(index, &sum);
        }
    }

    /// Adds the moments of a piece of a cell, relative to the receiver.
    fn piece(
        &self,
        polygon: Loop,
        plane: &Plane,
        among: &[u32],
        cell: &Cell,
        sum: &mut Polynomial,
    ) {
        let polygon = self.sight.above(&polygon);
        if polygon.len() < 3 {
            return;
        }
        let (centre, radius) = convex::ball(&polygon);
        if radius > NEAR * centre.length() && radius > FINEST * cell.radius {
            for half in convex::halves(&polygon, plane.axes) {
                if half.len() < 3 {
                    continue;
                }
                if let Some(blockers) = self.sight.blockers(among, &half, plane.normal) {
                    self.piece(half, plane, &blockers, cell, sum);
                }
            }
            return;
        }
        if among.is_empty() {
            return self.moments(&polygon, plane, &cell.frame, sum);
        }
        for fragment in self.sight.fragments(polygon, among) {
            self.moments(&fragment, plane, &cell.frame, sum);
        }
    }

    /// Adds the moments of a visible polygon: a product Gauss rule, brought to
    /// the exact form factor where the polygon is near.
    fn moments(&self, polygon: &[DVec3], plane: &Plane, frame: &Frame, sum: &mut Polynomial) {
        let receiver = &self.sight.receiver;
        let offset = receiver.position - frame.origin();
        let (centre, radius) = convex::ball(polygon);
        let apart = centre.length();
        let rule = if radius < FAR * apart {
            &self.rules.far
        } else {
            &self.rules.near
        };
        let mut own = [0.0; TERMS];
        convex::nodes(polygon, rule, |place, area| {
            let square = place.length_squared();
            let kernel =
                area * plane.height * receiver.normal.dot(place).max(0.0) / (square * square);
            let terms = frame.terms(place + offset);
            own.iter_mut()
                .zip(terms)
                .for_each(|(o, t)| *o += kernel * t);
        });
        let mut correction = 1.0;
        if radius > CORRECTED * apart && own[0] > 0.0 {
            let exact = PI * form_factor_signed(DVec3::ZERO, receiver.normal, polygon);
            correction = exact.max(0.0) / own[0];
        }
        sum.iter_mut()
            .zip(own)
            .for_each(|(s, o)| *s += correction * o);
    }
}

/// An upper bound of the irradiance by a cell of unit radiance.
fn bound(cell: &Cell, plane: &Plane, position: DVec3, horizon: DVec3) -> f64 {
    let towards = cell.centre - position;
    let nearest = towards.length() - cell.radius;
    if nearest <= 0.0 {
        return f64::INFINITY;
    }
    let highest = (horizon.dot(towards) + cell.radius).max(0.0);
    cell.area * plane.height * highest / nearest.powi(4)
}
