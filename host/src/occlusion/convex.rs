//! Concave polygons as convex parts.

use earcut::Earcut;
use glam::{DVec2, DVec3};

/// The convex parts of a simple polygon, counter-clockwise seen from the side
/// of `normal`: itself where it is convex, else triangles joined as long as
/// they stay convex. Parts meet in common vertices.
pub(super) fn parts(vertices: &[DVec3], normal: DVec3) -> Vec<Vec<DVec3>> {
    let (u, v) = normal.any_orthonormal_pair();
    let flat: Vec<DVec2> = vertices
        .iter()
        .map(|&vertex| vertex - vertices[0])
        .map(|offset| DVec2::new(offset.dot(u), offset.dot(v)))
        .collect();
    let all: Vec<usize> = (0..vertices.len()).collect();
    let indices = if is_convex(&flat, &all) {
        vec![all]
    } else {
        joined(&flat)
    };
    let places = |part: Vec<usize>| part.into_iter().map(|i| vertices[i]).collect();
    indices.into_iter().map(places).collect()
}

/// Whether no corner turns clockwise by more than rounding.
fn is_convex(flat: &[DVec2], part: &[usize]) -> bool {
    let count = part.len();
    (0..count).all(|i| {
        let [a, b, c] = [0, 1, 2].map(|step| flat[part[(i + step) % count]]);
        let (along, next) = (b - a, c - b);
        along.perp_dot(next) >= -1e-9 * along.length() * next.length()
    })
}

/// Triangles, joined over common edges as long as the result is convex.
fn joined(flat: &[DVec2]) -> Vec<Vec<usize>> {
    let mut indices: Vec<usize> = Vec::new();
    let coordinates = flat.iter().map(|place| [place.x, place.y]);
    Earcut::new().earcut(coordinates, &[] as &[usize], &mut indices);
    let mut parts: Vec<Vec<usize>> = indices.chunks_exact(3).map(<[usize]>::to_vec).collect();
    for part in &mut parts {
        let [a, b, c] = [0, 1, 2].map(|i| flat[part[i]]);
        if (b - a).perp_dot(c - b) < 0.0 {
            part.reverse();
        }
    }
    while let Some((i, j, union)) = first_union(flat, &parts) {
        parts[i] = union;
        parts.swap_remove(j);
    }
    parts
}

/// Two parts whose union is convex.
fn first_union(flat: &[DVec2], parts: &[Vec<usize>]) -> Option<(usize, usize, Vec<usize>)> {
    for (i, first) in parts.iter().enumerate() {
        for (j, second) in parts.iter().enumerate().skip(i + 1) {
            if let Some(union) = union(first, second).filter(|union| is_convex(flat, union)) {
                return Some((i, j, union));
            }
        }
    }
    None
}

/// The union of two parts with a common edge.
fn union(first: &[usize], second: &[usize]) -> Option<Vec<usize>> {
    let (n, m) = (first.len(), second.len());
    for i in 0..n {
        let (from, to) = (first[i], first[(i + 1) % n]);
        if let Some(j) = (0..m).find(|&j| second[j] == to && second[(j + 1) % m] == from) {
            // From `to` round the first back to `from`, then round the second.
            let mut union: Vec<usize> = (1..=n).map(|step| first[(i + step) % n]).collect();
            union.extend((2..m).map(|step| second[(j + step) % m]));
            return Some(union);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::polygon::measure;

    fn area(parts: &[Vec<DVec3>]) -> f64 {
        parts
            .iter()
            .map(|part| measure(part).map_or(f64::NAN, |measured| measured.area))
            .sum()
    }

    fn flat(places: &[[f64; 2]]) -> Vec<DVec3> {
        places.iter().map(|&[x, y]| DVec3::new(x, y, 2.0)).collect()
    }

    #[test]
    fn a_convex_polygon_is_one_part() {
        let square = flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(parts(&square, DVec3::Z), vec![square.clone()]);
    }

    #[test]
    fn an_l_is_two_parts_of_its_area() {
        let l = [[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]];
        let parts = parts(&flat(&l), DVec3::Z);
        assert!(parts.len() <= 3, "{parts:?}");
        assert!((area(&parts) - 3.0).abs() < 1e-12);
    }

    #[test]
    fn a_polygon_seen_from_behind_is_split_alike() {
        let mut u = flat(&[
            [0., 0.],
            [3., 0.],
            [3., 2.],
            [2., 2.],
            [2., 1.],
            [1., 1.],
            [1., 2.],
            [0., 2.],
        ]);
        u.reverse();
        let parts = parts(&u, DVec3::NEG_Z);
        assert!((area(&parts) - 5.0).abs() < 1e-12);
        for part in &parts {
            assert!(measure(part).is_ok_and(|measured| measured.normal.z < 0.0));
        }
    }
}
