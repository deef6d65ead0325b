//! Where a patch is looked at, and how its radiosity is had from there.

use super::super::Tag;
use super::exposed::Cell;
use glam::{DMat3, DVec2, DVec3};

/// Places inside a cell with the weights of (mean, gradient along a, gradient
/// along b): least squares over places that stand for equal shares of the area.
///
/// `side`² of them: on a whole rectangle in rows, else spread evenly over what
/// there is. Reflected light is smooth and gets the nodes of a Gauss rule;
/// direct light has shadow edges and gets the middles of equal rectangles.
pub(super) fn of_cell(cell: &Cell, side: usize, tag: Tag) -> Vec<([f64; 2], [f64; 3])> {
    let places = if cell.whole {
        let [low, high] = cell.bounds.map(DVec2::from);
        let nodes = nodes(side, tag);
        let at = |x: f64, y: f64| low + (high - low) * DVec2::new(x, y);
        let row = |&y: &f64| nodes.iter().map(move |&x| at(x, y)).collect::<Vec<_>>();
        nodes.iter().flat_map(row).collect()
    } else {
        spread(cell, side * side)
    };
    let weights = weights(cell, &places);
    places.into_iter().map(Into::into).zip(weights).collect()
}

/// Nodes on [0, 1].
fn nodes(side: usize, tag: Tag) -> Vec<f64> {
    if tag == Tag::Reflected && side == 2 {
        let offset = 0.5 / 3.0_f64.sqrt();
        return vec![0.5 - offset, 0.5 + offset];
    }
    (0..side).map(|k| (k as f64 + 0.5) / side as f64).collect()
}

/// Candidates along each side of the bounding rectangle.
const CANDIDATES: usize = 24;

/// Rounds of moving places to the middle of what is nearest to them.
const ROUNDS: usize = 12;

/// `count` places that stand for about equal parts of the cell (Lloyd 1982).
fn spread(cell: &Cell, count: usize) -> Vec<DVec2> {
    let [low, high] = cell.bounds.map(DVec2::from);
    let step = (high - low) / CANDIDATES as f64;
    let candidates: Vec<DVec2> = (0..CANDIDATES * CANDIDATES)
        .map(|k| {
            let (i, j) = ((k % CANDIDATES) as f64, (k / CANDIDATES) as f64);
            low + step * DVec2::new(i + 0.5, j + 0.5)
        })
        .filter(|&place| cell.contains(place))
        .collect();
    if candidates.len() < count {
        // Thinner than the candidates' grid: the middles of the pieces, each
        // moved toward its corners.
        return (0..count)
            .map(|k| {
                let piece = &cell.pieces[k % cell.pieces.len()];
                let middle =
                    piece.iter().map(|&c| DVec2::from(c)).sum::<DVec2>() / piece.len() as f64;
                let corner = DVec2::from(piece[(k / cell.pieces.len()) % piece.len()]);
                middle + (corner - middle) * 0.5
            })
            .collect();
    }
    // Each first place is as far as can be from those before (Gonzalez 1985):
    // places that begin in rows would stay in rows, and tell no gradient.
    let mut places: Vec<DVec2> = Vec::with_capacity(count);
    let center = DVec2::from(cell.center);
    while places.len() < count {
        let apart = |candidate: &DVec2| {
            let others = places
                .iter()
                .map(|place| place.distance_squared(*candidate));
            let nearest = others.fold(f64::INFINITY, f64::min);
            nearest.min(candidate.distance_squared(center) + cell.scale.powi(2))
        };
        let farthest = candidates
            .iter()
            .max_by(|a, b| apart(a).total_cmp(&apart(b)))
            .copied();
        places.extend(farthest);
    }
    for _ in 0..ROUNDS {
        let mut sums = vec![(DVec2::ZERO, 0.0); count];
        for &candidate in &candidates {
            let sum = &mut sums[nearest(&places, candidate)];
            *sum = (sum.0 + candidate, sum.1 + 1.0);
        }
        for (place, (sum, number)) in places.iter_mut().zip(sums) {
            // The middle of a part that is not convex may lie outside.
            let middle = sum / number;
            if number > 0.0 && cell.contains(middle) {
                *place = middle;
            }
        }
    }
    places
}

fn nearest(places: &[DVec2], to: DVec2) -> usize {
    let distance = |index: &usize| places[*index].distance_squared(to);
    (0..places.len())
        .min_by(|i, j| distance(i).total_cmp(&distance(j)))
        .unwrap_or(0)
}

/// Least squares of m + g_a a + g_b b over the places; across a patch too thin
/// for it, no gradient.
fn weights(cell: &Cell, places: &[DVec2]) -> Vec<[f64; 3]> {
    let center = DVec2::from(cell.center);
    let own: Vec<DVec2> = places.iter().map(|&p| (p - center) / cell.scale).collect();
    let rows = || own.iter().map(|own| DVec3::new(1.0, own.x, own.y));
    let outer = |row: DVec3| DMat3::from_cols(row * row.x, row * row.y, row * row.z);
    let normal = rows().map(outer).fold(DMat3::ZERO, |sum, one| sum + one);
    let count = places.len() as f64;
    if normal.determinant() > THIN * count.powi(3) {
        let inverse = normal.inverse();
        let weights: Vec<[f64; 3]> = rows().map(|row| (inverse * row).to_array()).collect();
        if weights.iter().flatten().all(|w| w.abs() <= STEEPEST) {
            return weights;
        }
    }
    let mean = own.iter().sum::<DVec2>() / count;
    let spread = own.iter().map(|&own| (own - mean).powf(2.0)).sum::<DVec2>();
    let along_a = spread.x >= spread.y;
    let largest = if along_a { spread.x } else { spread.y };
    own.iter()
        .map(|&own| {
            let off = if along_a {
                own.x - mean.x
            } else {
                own.y - mean.y
            };
            let gradient = if largest > THIN { off / largest } else { 0.0 };
            // The mean is at the centroid, which the places' own may miss.
            let middle = if along_a { mean.x } else { mean.y };
            let at_center = 1.0 / count - middle * gradient;
            match along_a {
                true => [at_center, gradient, 0.0],
                false => [at_center, 0.0, gradient],
            }
        })
        .collect()
}

/// The variances' product, in a patch's own units, below which its places lie on
/// a line: about a hundredth as wide as long.
const THIN: f64 = 2e-6;

/// The largest weight of a fit: where places lie so close to a line that more
/// would be needed, there is no gradient across. Those of a part of the cell
/// then stay below what tables hold, 64.
const STEEPEST: f64 = 16.0;
