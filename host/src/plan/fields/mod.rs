//! Fields: what a surface's irradiance is reconstructed from.
//!
//! The sum of terms, each a tensor grid, a mesh, or the product of both; see
//! [`isolux::resample`]. Here they are data, in f64, as the planner decides on
//! them; [`crate::bake`] turns them into records.

pub mod shares;
pub mod spline;
pub mod split;
pub mod tensor;

use isolux::scene::fields as records;
use tensor::Tensor;

/// A relative error from which on a place is simply wrong: larger ones count no
/// more, so that a few places in the dark do not take all samples.
const WRONG: f64 = 0.25;

/// The square of a relative error, as far as it counts.
pub fn counted(error: f64) -> f64 {
    let error = error.abs().min(WRONG);
    error * error
}

/// A term of a surface's irradiance.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Polynomials through samples.
    pub tensor: Option<Tensor>,
    /// Values on triangles; where there is a tensor as well, the fraction of its
    /// value that is seen.
    pub mesh: Option<Mesh>,
}

impl Field {
    /// Values that its reconstruction needs room for, as
    /// [`isolux::scene::fields::Fields::room`] has it.
    pub fn room(&self) -> usize {
        let grid = self
            .tensor
            .as_ref()
            .map_or(0, |tensor| tensor.samples() + 1);
        let of_mesh = |mesh: &Mesh| match self.tensor {
            Some(_) => mesh.samples + mesh.nodes.len(),
            None => mesh.nodes.len(),
        };
        grid + self.mesh.as_ref().map_or(0, of_mesh)
    }
}

/// Triangles with linear values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The first of the samples its nodes are made of, among the surface's own.
    pub first: usize,
    /// How many they are.
    pub samples: usize,
    /// The corners of triangles.
    pub nodes: Vec<Node>,
    /// Indices of nodes.
    pub triangles: Vec<[usize; 3]>,
    /// The value where no triangle is; `None`: that of the nearest.
    pub outside: Option<f64>,
}

/// A corner of triangles: its value is a constant and a sum of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// (u, v) in the surface's frame, in metres.
    pub place: [f64; 2],
    /// What it has without any sample.
    pub constant: f64,
    /// Samples, counted from the mesh's first, and their weights.
    pub shares: Vec<(usize, f64)>,
}

impl Node {
    /// What it takes of the tables, with the two triangles that a corner more in a
    /// mesh makes.
    pub fn bytes(&self) -> usize {
        size_of::<records::Node>()
            + self.shares.len() * size_of::<records::Share>()
            + 2 * size_of::<[u16; 3]>()
    }
}
