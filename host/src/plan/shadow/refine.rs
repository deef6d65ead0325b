//! Triangles made smaller and less slender where a surface is exposed.
//!
//! Delaunay refinement (Chew 1989; Ruppert 1995): the circumcentre of a bad
//! triangle becomes a vertex, or, where a segment is in its way, the middle of
//! that segment. Own code because what covers the surface, and what lies
//! between it and its convex hull, must stay coarse.

use glam::DVec2;
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use super::floor::Floor;
use super::mesh::Options;

/// A constrained Delaunay triangulation.
pub(super) type Delaunay = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// Rounds after which refinement ends in any case.
const ROUNDS: usize = 64;

/// A triangle that is too large or too slender.
struct Bad {
    centre: DVec2,
    circumcentre: DVec2,
    radius: f64,
}

/// A constrained edge.
#[derive(Clone, Copy)]
struct Segment {
    handles: [FixedVertexHandle; 2],
    ends: [DVec2; 2],
}

/// Refines until no exposed triangle is bad, or there are `most` vertices; says
/// whether the former is so.
pub(super) fn refine(
    delaunay: &mut Delaunay,
    floor: &Floor,
    options: &Options,
    most: usize,
) -> bool {
    let finest = options.finest * floor.frame.size_u.max(floor.frame.size_v);
    for _ in 0..ROUNDS {
        let mut bad = bad(delaunay, floor, options, finest);
        if bad.is_empty() {
            return true;
        }
        bad.sort_by(|a, b| {
            let place = |bad: &Bad| bad.circumcentre.to_array();
            let ([ax, ay], [bx, by]) = (place(a), place(b));
            let by_radius = b.radius.total_cmp(&a.radius);
            by_radius.then(ax.total_cmp(&bx)).then(ay.total_cmp(&by))
        });
        let segments = segments(delaunay);
        let mut halved = vec![false; segments.len()];
        let mut added: Vec<(DVec2, f64)> = Vec::new();
        let mut idle = true;
        for triangle in &bad {
            if delaunay.num_vertices() >= most {
                return false;
            }
            let way = in_the_way(&segments, triangle);
            let free = way.is_empty();
            for number in way {
                if !halved[number] && segments[number].length() >= 2.0 * finest {
                    halved[number] = true;
                    idle &= !segments[number].halve(delaunay);
                }
            }
            let place = triangle.circumcentre;
            let apart = |&(other, radius): &(DVec2, f64)| other.distance(place) >= radius;
            if free && added.iter().all(apart) && floor.is_exposed(place) {
                added.push((place, 0.7 * triangle.radius));
                idle &= delaunay.insert(Point2::new(place.x, place.y)).is_err();
            }
        }
        if idle {
            // What is still bad lies between segments that are as short as may be.
            return true;
        }
    }
    false
}

/// Whether a triangle is of the mesh: exposed, and no sliver between vertices
/// on the outline that rounding put beside its convex hull.
pub(super) fn is_kept([a, b, c]: [DVec2; 3], floor: &Floor) -> bool {
    let longest = [a.distance(b), b.distance(c), c.distance(a)];
    let longest = longest.into_iter().fold(0.0, f64::max);
    let is_sliver = (b - a).perp_dot(c - a) <= 1e-3 * floor.resolution() * longest;
    !is_sliver && floor.is_exposed((a + b + c) / 3.0)
}

/// The exposed triangles that are bad and larger than the finest ones.
fn bad(delaunay: &Delaunay, floor: &Floor, options: &Options, finest: f64) -> Vec<Bad> {
    let triangle = |face: spade::handles::FaceHandle<'_, _, _, _, _, _>| {
        let corners = face.positions().map(|p: Point2<f64>| DVec2::new(p.x, p.y));
        if !is_kept(corners, floor) {
            return None;
        }
        let [a, b, c] = corners;
        let lengths = [a.distance(b), b.distance(c), c.distance(a)];
        let shortest = lengths.iter().copied().fold(f64::INFINITY, f64::min);
        let longest = lengths.iter().copied().fold(0.0, f64::max);
        let centre = (a + b + c) / 3.0;
        let p = face.circumcenter();
        let circumcentre = DVec2::new(p.x, p.y);
        let radius = circumcentre.distance(a);
        let slender = radius > options.slenderness * shortest && shortest > finest;
        (slender || longest > options.longest).then_some(Bad {
            centre,
            circumcentre,
            radius,
        })
    };
    let all = delaunay.inner_faces().filter_map(triangle);
    all.collect()
}

fn segments(delaunay: &Delaunay) -> Vec<Segment> {
    let constrained = delaunay
        .undirected_edges()
        .filter(|edge| edge.is_constraint_edge());
    constrained
        .map(|edge| Segment {
            handles: edge.vertices().map(|vertex| vertex.fix()),
            ends: edge.positions().map(|p| DVec2::new(p.x, p.y)),
        })
        .collect()
}

/// The first segment between a triangle and its circumcentre, else all that
/// have the latter in the circle over them.
fn in_the_way(segments: &[Segment], bad: &Bad) -> Vec<usize> {
    let crossings = segments.iter().enumerate().filter_map(|(number, segment)| {
        let t = segment.crosses(bad)?;
        Some((t, number))
    });
    if let Some((_, first)) = crossings.min_by(|a, b| a.0.total_cmp(&b.0)) {
        return vec![first];
    }
    let encroached = |&number: &usize| segments[number].is_encroached(bad.circumcentre);
    (0..segments.len()).filter(encroached).collect()
}

impl Segment {
    fn length(&self) -> f64 {
        self.ends[0].distance(self.ends[1])
    }

    /// Where it crosses the way from a triangle to its circumcentre, as a
    /// parameter.
    fn crosses(&self, bad: &Bad) -> Option<f64> {
        let [a, b] = self.ends.map(|end| end - bad.centre);
        let way = bad.circumcentre - bad.centre;
        let (left, right) = (way.perp_dot(a), way.perp_dot(b));
        if (left > 0.0) == (right > 0.0) {
            return None;
        }
        let place = a.lerp(b, left / (left - right));
        let t = place.dot(way) / way.length_squared();
        (0.0..=1.0).contains(&t).then_some(t)
    }

    /// Whether the place lies in the circle over it.
    fn is_encroached(&self, place: DVec2) -> bool {
        let [a, b] = self.ends;
        (a - place).dot(b - place) < 0.0
    }

    /// Makes its middle a vertex, and two segments of it.
    fn halve(&self, delaunay: &mut Delaunay) -> bool {
        let [from, to] = self.handles;
        let Some(edge) = delaunay.get_edge_from_neighbors(from, to) else {
            return false;
        };
        let edge = edge.as_undirected().fix();
        let middle = self.ends[0].midpoint(self.ends[1]);
        delaunay.remove_constraint_edge(edge);
        match delaunay.insert(Point2::new(middle.x, middle.y)) {
            Ok(middle) => {
                delaunay.try_add_constraint(from, middle);
                delaunay.try_add_constraint(middle, to);
                true
            }
            Err(_) => {
                delaunay.try_add_constraint(from, to);
                false
            }
        }
    }
}
