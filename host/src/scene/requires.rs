//! What a scene requires, so that nothing else is modelled.

use glam::DVec3;
use serde::Serialize;

use super::document::listed;
use super::section::section_overlap;
use super::{Scene, Surface};

/// What must be modelled to light a scene, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Requirements {
    /// Why visibility is needed: the first surface found between two others;
    /// `None` where no surface can come between any two.
    pub visibility: Option<Blocked>,
    /// 1 where all light is grey, else 3.
    pub channels: usize,
    /// The first surface with different channels.
    pub channels_because: Option<usize>,
    /// The surfaces that emit.
    pub luminaires: Vec<usize>,
    /// The surfaces that reflect.
    pub reflectors: Vec<usize>,
    /// The surfaces that are not convex.
    pub concave: Vec<usize>,
    /// The surface with the most vertices.
    pub largest_polygon: Option<usize>,
    /// Bodies that the scene names.
    pub bodies: usize,
}

/// A surface that can come between two others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blocked {
    /// The surface that sends light.
    pub from: usize,
    /// What receives it.
    pub to: Receiver,
    /// The surface between.
    pub by: usize,
}

/// What receives light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Receiver {
    /// An index in [`Scene::surfaces`].
    Surface(usize),
    /// An index in [`Scene::points`].
    Point(usize),
}

/// One thing a scene requires, for people and for `check --json`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Need {
    /// What is required.
    pub what: String,
    /// Which part of the scene asks for it.
    pub why: String,
}

/// What `scene` requires.
///
/// Visibility: a surface o can come between e and r where it meets the inside
/// of the convex hull of (the part of e in front of r) and (the part of r in
/// front of e). For convex e and r that hull is the union of their lines of
/// sight, so the answer is exact; for concave ones it may ask for visibility
/// without need, never the reverse. Only surfaces that emit or reflect send
/// light; every surface and named point receives it. Costs the cube of the
/// number of surfaces in table look-ups at worst, and stops at the first
/// surface found.
pub fn requirements(scene: &Scene) -> Requirements {
    let surfaces = &scene.surfaces;
    let which = |test: &dyn Fn(&Surface) -> bool| -> Vec<usize> {
        (0..surfaces.len())
            .filter(|&i| test(&surfaces[i]))
            .collect()
    };
    let channels_because = surfaces
        .iter()
        .position(|s| !is_grey(s.reflectance) || !is_grey(s.radiance));
    Requirements {
        visibility: Sight::new(scene).first_blocked(),
        channels: if channels_because.is_some() { 3 } else { 1 },
        channels_because,
        luminaires: which(&Surface::emits),
        reflectors: which(&Surface::reflects),
        concave: which(&|surface| !is_convex(surface)),
        largest_polygon: (0..surfaces.len())
            .rev()
            .max_by_key(|&i| surfaces[i].vertices.len()),
        bodies: scene.bodies.len(),
    }
}

impl Requirements {
    /// The requirements as what and why, the cheapest scene having the fewest.
    pub fn needs(&self, scene: &Scene) -> Vec<Need> {
        let mut needs = Vec::new();
        let mut need = |what: &str, why: String| {
            needs.push(Need {
                what: what.to_owned(),
                why,
            });
        };
        let clause = |indices: &[usize], one: &str, many: &str| {
            let verb = if indices.len() == 1 { one } else { many };
            format!("{} {verb}", names(scene, indices))
        };
        if !self.luminaires.is_empty() {
            need(
                "direct light",
                format!("{} light", clause(&self.luminaires, "emits", "emit")),
            );
        }
        if !self.reflectors.is_empty() && !self.luminaires.is_empty() {
            need(
                "reflected light",
                format!("{} light", clause(&self.reflectors, "reflects", "reflect")),
            );
        }
        if let Some(blocked) = &self.visibility {
            need("visibility", blocked.explain(scene));
        }
        if let Some(colour) = self.channels_because {
            let why = format!("`{}` is not grey", scene.surfaces[colour].name);
            need("three channels", why);
        }
        if !self.concave.is_empty() {
            need(
                "concave polygons",
                clause(&self.concave, "is concave", "are concave"),
            );
        }
        needs
    }
}

impl Blocked {
    /// A sentence that names the three.
    pub fn explain(&self, scene: &Scene) -> String {
        let to = match self.to {
            Receiver::Surface(index) => &scene.surfaces[index].name,
            Receiver::Point(index) => &scene.points[index].name,
        };
        format!(
            "`{}` can come between `{}` and `{to}`",
            scene.surfaces[self.by].name, scene.surfaces[self.from].name
        )
    }
}

/// Up to six names, then how many more.
fn names(scene: &Scene, indices: &[usize]) -> String {
    let name = |&index: &usize| scene.surfaces[index].name.as_str();
    if indices.len() <= 6 {
        return listed(&indices.iter().map(name).collect::<Vec<_>>());
    }
    let first: Vec<String> = indices[..5]
        .iter()
        .map(|i| format!("`{}`", name(i)))
        .collect();
    format!("{} and {} more", first.join(", "), indices.len() - 5)
}

fn is_grey([r, g, b]: [f64; 3]) -> bool {
    r == g && g == b
}

/// Whether no corner turns clockwise by more than rounding.
fn is_convex(surface: &Surface) -> bool {
    let vertices = &surface.vertices;
    let count = vertices.len();
    (0..count).all(|i| {
        let before = vertices[(i + 1) % count] - vertices[i];
        let after = vertices[(i + 2) % count] - vertices[(i + 1) % count];
        before.cross(after).dot(surface.normal) >= -1e-9 * before.length() * after.length()
    })
}

/// Lowest and highest distance of a surface's vertices from a plane.
#[derive(Clone, Copy)]
struct Heights {
    low: f64,
    high: f64,
}

/// Looks for surfaces between others.
struct Sight<'s> {
    scene: &'s Scene,
    flat: f64,
    /// `heights[plane * count + surface]`.
    heights: Vec<Heights>,
}

impl<'s> Sight<'s> {
    fn new(scene: &'s Scene) -> Self {
        let mut heights = Vec::with_capacity(scene.surfaces.len().pow(2));
        for plane in &scene.surfaces {
            let center = plane.center();
            heights.extend(
                scene.surfaces.iter().map(|surface| {
                    heights_of(&surface.vertices, |v| (v - center).dot(plane.normal))
                }),
            );
        }
        Self {
            scene,
            flat: scene.plane_tolerance(),
            heights,
        }
    }

    /// Heights of `surface` over the plane of `plane`.
    fn heights(&self, surface: usize, plane: usize) -> Heights {
        self.heights[plane * self.scene.surfaces.len() + surface]
    }

    /// The first triple in the order: luminaires before mere reflectors, then
    /// the file's order.
    fn first_blocked(&self) -> Option<Blocked> {
        let surfaces = &self.scene.surfaces;
        let emitting = (0..surfaces.len()).filter(|&i| surfaces[i].emits());
        let reflecting =
            (0..surfaces.len()).filter(|&i| !surfaces[i].emits() && surfaces[i].reflects());
        let senders: Vec<usize> = emitting.chain(reflecting).collect();
        let mut done = vec![false; surfaces.len()];
        for &from in &senders {
            done[from] = true;
            for to in (0..surfaces.len()).filter(|&to| !done[to]) {
                if let Some(by) = self.between_surfaces(from, to) {
                    let to = Receiver::Surface(to);
                    return Some(Blocked { from, to, by });
                }
            }
            for to in 0..self.scene.points.len() {
                if let Some(by) = self.between_point(from, to) {
                    let to = Receiver::Point(to);
                    return Some(Blocked { from, to, by });
                }
            }
        }
        None
    }

    fn between_surfaces(&self, from: usize, to: usize) -> Option<usize> {
        let faces_each_other =
            self.heights(to, from).high > self.flat && self.heights(from, to).high > self.flat;
        if !faces_each_other {
            return None;
        }
        let surfaces = &self.scene.surfaces;
        let mut hull: Option<Vec<DVec3>> = None;
        (0..surfaces.len()).find(|&by| {
            let by_over_from = self.heights(by, from);
            let by_over_to = self.heights(by, to);
            // Behind or on the plane of either: no line of sight gets there.
            if by == from
                || by == to
                || by_over_from.high <= self.flat
                || by_over_to.high <= self.flat
            {
                return false;
            }
            let (a, b) = (self.heights(from, by), self.heights(to, by));
            if a.low.min(b.low) >= -self.flat || a.high.max(b.high) <= self.flat {
                return false;
            }
            let hull = hull.get_or_insert_with(|| {
                let mut hull = in_front(&surfaces[from], &surfaces[to]);
                hull.extend(in_front(&surfaces[to], &surfaces[from]));
                hull
            });
            section_overlap(hull, &surfaces[by], self.flat)
        })
    }

    fn between_point(&self, from: usize, to: usize) -> Option<usize> {
        let point = &self.scene.points[to];
        let sender = &self.scene.surfaces[from];
        let above = |v: DVec3| (v - point.position).dot(point.normal);
        let seen = clip(&sender.vertices, above);
        if sender.height_of(point.position) <= self.flat
            || heights_of(&seen, above).high <= self.flat
        {
            return None;
        }
        let mut hull = seen;
        hull.push(point.position);
        (0..self.scene.surfaces.len()).find(|&by| {
            let blocker = &self.scene.surfaces[by];
            by != from
                && blocker.height_of(point.position).abs() > self.flat
                && section_overlap(&hull, blocker, self.flat)
        })
    }
}

fn heights_of(vertices: &[DVec3], height: impl Fn(DVec3) -> f64) -> Heights {
    let none = Heights {
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
    };
    vertices.iter().fold(none, |range, &vertex| {
        let height = height(vertex);
        Heights {
            low: range.low.min(height),
            high: range.high.max(height),
        }
    })
}

/// The vertices of the part of `surface` in front of the plane of `other`.
fn in_front(surface: &Surface, other: &Surface) -> Vec<DVec3> {
    let center = other.center();
    clip(&surface.vertices, |v| (v - center).dot(other.normal))
}

/// The vertices of the part of a polygon at heights of 0 and above: those of
/// its convex hull at least, which is all that is asked of them.
fn clip(vertices: &[DVec3], height: impl Fn(DVec3) -> f64) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(vertices.len() + 2);
    for (i, &from) in vertices.iter().enumerate() {
        let to = vertices[(i + 1) % vertices.len()];
        let (a, b) = (height(from), height(to));
        if a >= 0.0 {
            kept.push(from);
        }
        if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
            kept.push(from + (to - from) * (a / (a - b)));
        }
    }
    kept
}
