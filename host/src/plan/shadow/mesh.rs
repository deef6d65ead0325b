//! Meshes of a receiver that follow its critical lines.

use std::collections::BTreeMap;

use glam::DVec2;
use rayon::prelude::*;
use spade::{Point2, Triangulation};

use super::arrangement::{Arrangement, Segment};
use super::floor::Floor;
use super::locate::{Index, barycentric};
use super::refine::{Delaunay, is_kept, refine};
use super::{Class, Kind, ShadowMap};

/// Which lines a mesh follows beside the surface's own outline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Lines {
    /// The feet of what stands there: what indirect light needs.
    Contacts,
    /// Those, horizons, and the outlines of penumbras, umbras and antumbras.
    Outlines,
    /// All.
    All,
}

/// How a mesh is made.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Which lines are edges.
    pub lines: Lines,
    /// How many of them at the most, the most important first.
    pub most_lines: usize,
    /// No edge is longer, in metres, as far as `triangles` allows.
    pub longest: f64,
    /// The circumradius by the shortest edge is not larger where lines leave the
    /// choice and `triangles` allows it: 1/(2 sin of the least angle), and √2
    /// for 20.7°. Below 1 refinement need not end.
    pub slenderness: f64,
    /// Refinement leaves alone what is shorter than this part of the surface's
    /// longer side.
    pub finest: f64,
    /// A bound on the number of triangles; lines are left out to keep it.
    pub triangles: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            lines: Lines::All,
            most_lines: 256,
            longest: f64::INFINITY,
            slenderness: std::f64::consts::SQRT_2,
            finest: 5e-3,
            triangles: 4096,
        }
    }
}

/// What a triangle sees of all luminaires asked about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Tag {
    /// All of each that it is not behind.
    Lit,
    /// Something of one: V varies.
    Penumbra,
    /// Nothing of any that it is not behind.
    Umbra,
    /// It is behind all.
    Behind,
    /// No luminaire was asked about.
    Untold,
}

/// An edge that lies on a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Border {
    /// Its vertices.
    pub ends: [usize; 2],
    /// The most important of the lines that run there.
    pub kind: Kind,
}

/// A conforming triangulation of a surface without what covers it.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Coordinates in the surface's frame, in metres.
    pub vertices: Vec<[f64; 2]>,
    /// Vertices of triangles, counter-clockwise.
    pub triangles: Vec<[usize; 3]>,
    /// What each triangle sees.
    pub tags: Vec<Tag>,
    /// Whether the triangle has an edge on the foot of something.
    pub contact: Vec<bool>,
    /// The visible fraction where it is known without a sample: 1 where all
    /// luminaires are seen whole, 0 where none is. Unknown on contact lines,
    /// where V jumps, and where there is no light without occluders either.
    pub free: Vec<Option<f64>>,
    /// Edges on lines.
    pub borders: Vec<Border>,
    /// Lines that were left out: too many, or too near to others to be cut.
    pub left_out: usize,
    /// Whether no edge is too long and no angle too small but between lines.
    pub is_refined: bool,
    index: Index,
}

impl Mesh {
    /// A mesh of a surface that follows the lines of all maps, which must be
    /// maps of that surface; none for a mesh that knows contact lines only.
    ///
    /// The same input gives the same mesh. Never fails: where the bound on
    /// triangles is met the weakest lines are left out, and refinement ends
    /// early.
    pub fn of(floor: &Floor, maps: &[&ShadowMap], options: &Options) -> Self {
        let lines = chosen(maps, options.lines);
        let base = base(floor);
        // A triangulation has less than two triangles a vertex.
        let most = (options.triangles / 2).max(3);
        let mut count = lines.len().min(options.most_lines);
        let mut arrangement = Arrangement::new(&base, &lines[..count], floor.resolution());
        while arrangement.places.len() > most && count > 0 {
            count /= 2;
            arrangement = Arrangement::new(&base, &lines[..count], floor.resolution());
        }
        arrangement.halve(options.longest, most);
        let (mut delaunay, refused) = triangulated(&arrangement);
        let is_refined = refine(&mut delaunay, floor, options, most);
        let mut mesh = Self::kept(&delaunay, floor, &arrangement);
        mesh.left_out = lines.len() - count + refused;
        mesh.is_refined = is_refined;
        mesh.mark(maps);
        mesh
    }

    /// The triangles on the surface.
    fn kept(delaunay: &Delaunay, floor: &Floor, arrangement: &Arrangement) -> Self {
        let mut number = vec![None; delaunay.num_vertices()];
        let mut vertices: Vec<[f64; 2]> = Vec::new();
        let mut triangles = Vec::new();
        let mut borders = BTreeMap::new();
        for face in delaunay.inner_faces() {
            let corners = face.positions().map(|p| DVec2::new(p.x, p.y));
            if !is_kept(corners, floor) {
                continue;
            }
            let triangle = face.vertices().map(|vertex| {
                *number[vertex.index()].get_or_insert_with(|| {
                    let place = vertex.position();
                    vertices.push([place.x, place.y]);
                    vertices.len() - 1
                })
            });
            triangles.push(triangle);
            for (k, edge) in face.adjacent_edges().iter().enumerate() {
                // The edge k runs from the vertex k to the next one.
                let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
                let middle = corners[k].midpoint(corners[(k + 1) % 3]);
                if edge.is_constraint_edge()
                    && let Some(kind) = arrangement.kind_at(middle)
                {
                    borders.insert([a.min(b), a.max(b)], kind);
                }
            }
        }
        let corners = |t: &[usize; 3]| t.map(|vertex| DVec2::from(vertices[vertex]));
        let index = Index::new(triangles.iter().map(corners).collect());
        let borders = borders
            .into_iter()
            .map(|(ends, kind)| Border { ends, kind });
        Self {
            tags: Vec::new(),
            contact: Vec::new(),
            free: Vec::new(),
            borders: borders.collect(),
            left_out: 0,
            is_refined: false,
            index,
            vertices,
            triangles,
        }
    }

    /// The triangle in which a place lies, and its barycentric coordinates
    /// there; the lowest index on common edges, `None` outside.
    pub fn locate(&self, u: f64, v: f64) -> Option<(usize, [f64; 3])> {
        let place = DVec2::new(u, v);
        let mut candidates = self.index.near(place).iter();
        candidates.find_map(|&triangle| {
            let shares = barycentric(self.corners(triangle), place);
            let inside = shares.iter().all(|&share| share >= -1e-9);
            inside.then_some((triangle, shares))
        })
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [DVec2; 3] {
        self.triangles[triangle].map(|vertex| DVec2::from(self.vertices[vertex]))
    }

    /// The area of all triangles in m².
    pub fn area(&self) -> f64 {
        let area = |k: usize| {
            let [a, b, c] = self.corners(k);
            (b - a).perp_dot(c - a) / 2.0
        };
        (0..self.triangles.len()).map(area).sum()
    }

    /// Tags, free values, contact.
    fn mark(&mut self, maps: &[&ShadowMap]) {
        let tag = |k: usize| tag(self.corners(k), maps);
        self.tags = (0..self.triangles.len()).into_par_iter().map(tag).collect();
        let mut on_contact = vec![false; self.vertices.len()];
        let mut sides: BTreeMap<[usize; 2], Kind> = BTreeMap::new();
        for border in &self.borders {
            if border.kind == Kind::Contact {
                border.ends.iter().for_each(|&end| on_contact[end] = true);
            }
            sides.insert(border.ends, border.kind);
        }
        let free = |(vertex, &[u, v]): (usize, &[f64; 2])| {
            (!on_contact[vertex]).then(|| free(maps, u, v)).flatten()
        };
        self.free = self.vertices.par_iter().enumerate().map(free).collect();
        let touches = |&[a, b, c]: &[usize; 3]| {
            let side = |from: usize, to: usize| sides.get(&[from.min(to), from.max(to)]);
            [(a, b), (b, c), (c, a)]
                .iter()
                .any(|&(from, to)| side(from, to) == Some(&Kind::Contact))
        };
        self.contact = self.triangles.iter().map(touches).collect();
    }
}

/// The outline of the surface, and what stands on it.
fn base(floor: &Floor) -> Vec<Segment> {
    let sides = floor.sides().map(|ends| (Kind::Boundary, ends));
    let contacts = floor.contacts.iter();
    let contacts = contacts.map(|line| (line.kind, line.ends.map(DVec2::from)));
    sides.chain(contacts).collect()
}

/// The lines of all maps that are asked for, the most important first.
fn chosen(maps: &[&ShadowMap], lines: Lines) -> Vec<Segment> {
    let asked = |kind: Kind| match lines {
        Lines::Contacts => false,
        Lines::Outlines => kind <= Kind::Antumbra,
        Lines::All => true,
    };
    let all = maps.iter().flat_map(|map| &map.lines);
    let mut chosen: Vec<_> = all.filter(|line| asked(line.kind)).collect();
    chosen.sort_by(|a, b| {
        let by_kind = a.kind.cmp(&b.kind);
        by_kind.then(b.weight().total_cmp(&a.weight()))
    });
    let segment = |line: &&super::Line| (line.kind, line.ends.map(DVec2::from));
    chosen.iter().map(segment).collect()
}

/// The constrained Delaunay triangulation, and how many segments are not edges
/// of it because they cross others by rounding.
fn triangulated(arrangement: &Arrangement) -> (Delaunay, usize) {
    let mut delaunay = Delaunay::new();
    let tame = |x: f64| if x.abs() < 1e-30 { 0.0 } else { x };
    let handles: Vec<_> = arrangement
        .places
        .iter()
        .map(|place| {
            delaunay
                .insert(Point2::new(tame(place.x), tame(place.y)))
                .ok()
        })
        .collect();
    let mut segments: Vec<_> = arrangement.segments.iter().collect();
    segments.sort_by_key(|&(ends, kind)| (kind, ends));
    let mut refused = 0;
    for (&[a, b], _) in segments {
        let added = match (handles[a], handles[b]) {
            (Some(from), Some(to)) if from != to => {
                !delaunay.try_add_constraint(from, to).is_empty()
            }
            _ => false,
        };
        refused += usize::from(!added);
    }
    (delaunay, refused)
}

/// What a triangle sees: what its middle and three places near its corners see,
/// or a part where they do not agree.
fn tag([a, b, c]: [DVec2; 3], maps: &[&ShadowMap]) -> Tag {
    let centre = (a + b + c) / 3.0;
    let places = [
        centre,
        a.lerp(centre, 0.1),
        b.lerp(centre, 0.1),
        c.lerp(centre, 0.1),
    ];
    let [first, others @ ..] = places.map(|place| tag_at(place, maps));
    if others.iter().all(|&other| other == first) {
        first
    } else {
        Tag::Penumbra
    }
}

fn tag_at(place: DVec2, maps: &[&ShadowMap]) -> Tag {
    let classes = maps.iter().map(|map| map.class(place.x, place.y));
    let tags = classes.map(|class| match class {
        Class::Lit => Tag::Lit,
        Class::Penumbra => Tag::Penumbra,
        Class::Umbra => Tag::Umbra,
        Class::Behind => Tag::Behind,
    });
    tags.fold(Tag::Untold, |known, tag| match (known, tag) {
        (Tag::Untold | Tag::Behind, tag) => tag,
        (known, Tag::Behind) => known,
        (known, tag) if known == tag => known,
        _ => Tag::Penumbra,
    })
}

/// The visible fraction of all luminaires where it is 0 or 1.
fn free(maps: &[&ShadowMap], u: f64, v: f64) -> Option<f64> {
    match tag_at(DVec2::new(u, v), maps) {
        Tag::Lit => Some(1.0),
        Tag::Umbra => Some(0.0),
        Tag::Penumbra | Tag::Behind | Tag::Untold => None,
    }
}
