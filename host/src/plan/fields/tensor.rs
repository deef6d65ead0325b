//! Tensor grids: products of polynomials through samples, in f64.

use crate::scene::frame::Frame;
use gauss_quad::legendre::GaussLegendre;
use nalgebra::DMatrix;
use std::f64::consts::PI;
use std::num::NonZeroUsize;

/// Polynomials in u and v through samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Tensor {
    /// The first of its samples among the surface's own; then one after the other,
    /// those of the lowest v first.
    pub first: usize,
    /// Nodes along u and along v, of variables between -1 and 1.
    pub nodes: [Vec<f64>; 2],
    /// Where both variables are 0, in metres.
    pub center: [f64; 2],
    /// From there to where they are 1.
    pub half: [f64; 2],
    /// s = s_0 + s_1 u + s_2 v where the polynomials are of g = √(s/E); `None`
    /// where they are of E itself.
    pub factor: Option<[f64; 3]>,
}

/// Where the nodes of an axis lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Nodes {
    /// Gauss and Legendre's: their sums are integrals to degree 2 n − 1.
    Gauss,
    /// Chebyshev's: what interpolation through them errs by is the same in all of
    /// the interval, as far as can be.
    Chebyshev,
    /// Chebyshev's, half-way to those of [`Expanded`](Self::Expanded).
    Between,
    /// Chebyshev's, drawn out until the outermost are the interval's ends: where a
    /// function is steep there, they err less.
    Expanded,
}

impl Nodes {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Gauss, Self::Chebyshev, Self::Between, Self::Expanded];

    /// `count` of them in ascending order.
    pub fn of(self, count: usize) -> Vec<f64> {
        let degree = NonZeroUsize::new(count).unwrap_or(NonZeroUsize::MIN);
        let outermost = (PI / (2 * count.max(2)) as f64).cos();
        let chebyshev = |stretch: f64| -> Vec<f64> {
            (0..count)
                .map(|k| -((2 * k + 1) as f64 * PI / (2 * count) as f64).cos() * stretch)
                .collect()
        };
        let mut nodes: Vec<f64> = match self {
            Self::Gauss => GaussLegendre::new(degree)
                .iter()
                .map(|pair| pair.0)
                .collect(),
            Self::Chebyshev => chebyshev(1.0),
            Self::Between => chebyshev(0.5 + 0.5 / outermost),
            Self::Expanded => chebyshev(1.0 / outermost),
        };
        nodes.sort_by(f64::total_cmp);
        nodes
    }
}

impl Tensor {
    /// Over the bounding rectangle of a surface.
    pub fn over(frame: &Frame, nodes: Nodes, counts: [usize; 2], factor: Option<[f64; 3]>) -> Self {
        let half = [frame.size_u / 2.0, frame.size_v / 2.0];
        Self {
            first: 0,
            nodes: counts.map(|count| nodes.of(count)),
            center: half,
            half,
            factor,
        }
    }

    /// How many samples it has.
    pub fn samples(&self) -> usize {
        self.nodes[0].len() * self.nodes[1].len()
    }

    /// Where they are, in metres in the surface's frame.
    pub fn places(&self) -> Vec<[f64; 2]> {
        let place = |t: [f64; 2]| [0, 1].map(|axis| self.center[axis] + t[axis] * self.half[axis]);
        let rows = self.nodes[1].iter();
        rows.flat_map(|&v| self.nodes[0].iter().map(move |&u| place([u, v])))
            .collect()
    }

    /// The area in m² that each sample stands for: the integral of its own
    /// polynomial.
    pub fn areas(&self) -> Vec<f64> {
        let [along_u, along_v] = [0, 1].map(|axis| self.integrals(axis));
        let rows = along_v.iter();
        rows.flat_map(|&v| along_u.iter().map(move |&u| u * v))
            .collect()
    }

    /// The integral in metres, along an axis, of the polynomial that is 1 at one
    /// node and 0 at the others.
    fn integrals(&self, axis: usize) -> Vec<f64> {
        // ∫ T_k = 2/(1 − k²) for even k, else 0.
        let matrix = self.matrix(axis);
        let n = self.nodes[axis].len();
        (0..n)
            .map(|node| {
                let even = (0..n).step_by(2);
                let sum: f64 = even
                    .map(|k| matrix[(k, node)] * 2.0 / (1.0 - (k * k) as f64))
                    .sum();
                sum * self.half[axis]
            })
            .collect()
    }

    /// What makes the coefficients of Chebyshev polynomials of the values at the
    /// nodes of an axis.
    pub fn matrix(&self, axis: usize) -> DMatrix<f64> {
        let nodes = &self.nodes[axis];
        let values = DMatrix::from_fn(nodes.len(), nodes.len(), |row, k| {
            (k as f64 * nodes[row].clamp(-1.0, 1.0).acos()).cos()
        });
        // Distinct nodes: it has an inverse.
        let identity = || DMatrix::identity(nodes.len(), nodes.len());
        values.try_inverse().unwrap_or_else(identity)
    }

    /// s at a place.
    pub fn factor_at(&self, [u, v]: [f64; 2]) -> Option<f64> {
        self.factor
            .map(|[s, along_u, along_v]| s + along_u * u + along_v * v)
    }

    /// The polynomials through these values of its samples, or `None` where one of
    /// them has no g.
    pub fn through(&self, values: &[f64]) -> Option<Through<'_>> {
        let [n_u, n_v] = [0, 1].map(|axis| self.nodes[axis].len());
        let mut of_nodes = Vec::with_capacity(values.len());
        for (place, &value) in self.places().into_iter().zip(values) {
            of_nodes.push(match self.factor_at(place) {
                None => value,
                Some(s) if s > 0.0 && value > 0.0 => (s / value).sqrt(),
                Some(_) => return None,
            });
        }
        let grid = DMatrix::from_fn(n_u, n_v, |i, j| of_nodes[j * n_u + i]);
        Some(Through {
            tensor: self,
            coefficients: self.matrix(0) * grid * self.matrix(1).transpose(),
        })
    }
}

/// Polynomials with their coefficients.
pub struct Through<'a> {
    tensor: &'a Tensor,
    coefficients: DMatrix<f64>,
}

impl Through<'_> {
    /// The irradiance at a place.
    pub fn at(&self, place: [f64; 2]) -> f64 {
        let tensor = self.tensor;
        let [of_u, of_v] = [0, 1].map(|axis| {
            let t = (place[axis] - tensor.center[axis]) / tensor.half[axis];
            let angle = t.clamp(-1.0, 1.0).acos();
            let count = tensor.nodes[axis].len();
            (0..count)
                .map(|k| (k as f64 * angle).cos())
                .collect::<Vec<f64>>()
        });
        let mut sum = 0.0;
        for (j, v) in of_v.iter().enumerate() {
            for (i, u) in of_u.iter().enumerate() {
                sum += self.coefficients[(i, j)] * u * v;
            }
        }
        match tensor.factor_at(place) {
            None => sum.max(0.0),
            Some(s) if s > 0.0 && sum > 0.0 => s / (sum * sum),
            Some(_) => 0.0,
        }
    }
}
