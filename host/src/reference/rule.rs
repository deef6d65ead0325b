//! One-dimensional Gauss-Legendre rules on `[0, 1]` and interpolation through
//! their nodes.

use std::num::NonZeroUsize;

use gauss_quad::legendre::GaussLegendre;

/// A Gauss-Legendre rule, with the matrices that carry nodal values to the
/// nodes of either half of the interval.
pub(super) struct Rule {
    /// Nodes in ascending order.
    pub(super) nodes: Vec<f64>,
    /// Weights, summing to 1.
    pub(super) weights: Vec<f64>,
    /// `halves[h][i * order + j]` is the value at node `i` of half `h` of the
    /// polynomial that is 1 at node `j` and 0 at the others.
    halves: [Vec<f64>; 2],
    barycentric: Vec<f64>,
}

impl Rule {
    /// The rule of `order` nodes, exact for polynomials of degree `2 order - 1`.
    pub(super) fn new(order: usize) -> Self {
        let degree = NonZeroUsize::new(order).unwrap_or(NonZeroUsize::MIN);
        let mut pairs: Vec<(f64, f64)> = GaussLegendre::new(degree)
            .iter()
            .map(|&(node, weight)| (0.5 * (node + 1.0), 0.5 * weight))
            .collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let nodes: Vec<f64> = pairs.iter().map(|pair| pair.0).collect();
        let barycentric = nodes
            .iter()
            .enumerate()
            .map(|(index, node)| {
                let others = nodes
                    .iter()
                    .enumerate()
                    .filter(|(other, _)| *other != index);
                // The factor 4 keeps the products of differences near 1.
                1.0 / others
                    .map(|(_, other)| 4.0 * (node - other))
                    .product::<f64>()
            })
            .collect();
        let mut rule = Self {
            weights: pairs.iter().map(|pair| pair.1).collect(),
            halves: [Vec::new(), Vec::new()],
            nodes,
            barycentric,
        };
        rule.halves = [0.0, 0.5].map(|start| {
            let at_nodes = rule.nodes.iter().map(|node| start + 0.5 * node);
            at_nodes.flat_map(|place| rule.basis(place)).collect()
        });
        rule
    }

    /// Nodes in one direction.
    pub(super) fn order(&self) -> usize {
        self.nodes.len()
    }

    /// The Lagrange polynomials of the nodes at `place`, by the barycentric
    /// formula.
    pub(super) fn basis(&self, place: f64) -> Vec<f64> {
        if let Some(hit) = self.nodes.iter().position(|node| *node == place) {
            let mut unit = vec![0.0; self.order()];
            unit[hit] = 1.0;
            return unit;
        }
        let mut values: Vec<f64> = self
            .nodes
            .iter()
            .zip(&self.barycentric)
            .map(|(node, weight)| weight / (place - node))
            .collect();
        let sum: f64 = values.iter().sum();
        values.iter_mut().for_each(|value| *value /= sum);
        values
    }

    /// Nodal values of a square, carried to the nodes of its quarter at
    /// (`half_u`, `half_v`). Values run with u fastest.
    pub(super) fn refine(&self, values: &[f64], (half_u, half_v): (usize, usize)) -> Vec<f64> {
        let n = self.order();
        let (along_u, along_v) = (&self.halves[half_u], &self.halves[half_v]);
        let mut rows = vec![0.0; n * n];
        for (row, out) in values.chunks_exact(n).zip(rows.chunks_exact_mut(n)) {
            for (value, weights) in out.iter_mut().zip(along_u.chunks_exact(n)) {
                *value = weights.iter().zip(row).map(|(w, x)| w * x).sum();
            }
        }
        let mut refined = vec![0.0; n * n];
        for (out, weights) in refined.chunks_exact_mut(n).zip(along_v.chunks_exact(n)) {
            for (row, weight) in rows.chunks_exact(n).zip(weights) {
                for (value, x) in out.iter_mut().zip(row) {
                    *value += weight * x;
                }
            }
        }
        refined
    }
}

#[cfg(test)]
mod tests {
    use super::Rule;

    #[test]
    fn polynomials_are_carried_to_quarters() {
        let rule = Rule::new(6);
        let f = |u: f64, v: f64| u.powi(5) - 3.0 * u * v.powi(4) + v - 0.25;
        let sample = |u0: f64, v0: f64, scale: f64| -> Vec<f64> {
            let at = |v: &f64| {
                let v = v0 + scale * v;
                rule.nodes
                    .iter()
                    .map(move |u| (u0 + scale * u, v))
                    .collect::<Vec<_>>()
            };
            rule.nodes
                .iter()
                .flat_map(at)
                .map(|(u, v)| f(u, v))
                .collect()
        };
        let whole = sample(0.0, 0.0, 1.0);
        for quarter in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let exact = sample(0.5 * quarter.0 as f64, 0.5 * quarter.1 as f64, 0.5);
            let carried = rule.refine(&whole, quarter);
            for (a, b) in exact.iter().zip(&carried) {
                assert!((a - b).abs() < 1e-14, "{a} {b}");
            }
        }
    }
}
