//! The records that a surface is reconstructed from, and what is demanded of
//! them.
//!
//! What is made of them is said with [`resample`](crate::resample).

use super::check::{all, inside, numbers, ranges};
use super::records::Surface;
use super::{Scene, slice};
use crate::Error;
use crate::error::What;
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

/// The most nodes along a side of a tensor grid.
pub const MOST_NODES: usize = 16;

/// In place of an index: there is none.
pub const NONE: u32 = u32::MAX;

/// A term of a surface's irradiance: what a tensor grid says, or what a mesh
/// says, or with both their product.
#[derive(Clone, Copy, Debug, PartialEq, Eq, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Field {
    /// Index of its tensor grid, or [`NONE`].
    pub tensor: u32,
    /// Index of its mesh, or [`NONE`].
    pub mesh: u32,
}

/// A grid of samples that a product of polynomials goes through.
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Tensor {
    /// Where its samples begin among all, those of the lowest v first.
    pub first_sample: u32,
    /// How many there are along u and along v, 1 to [`MOST_NODES`].
    pub nodes: [u32; 2],
    /// Where the matrices begin that make Chebyshev coefficients of the values
    /// along u and along v, row by row.
    pub matrices: [u32; 2],
    /// The place, in metres, where both polynomials' variables are 0, ...
    pub center: [f32; 2],
    /// ... and what they grow by for a metre.
    pub inverse: [f32; 2],
    /// s = s_0 + s_1 u + s_2 v.
    pub factor: [f32; 3],
    /// 1 where the polynomials are of g = √(s/E), 0 where they are of E.
    pub transformed: u32,
}

/// Triangles over a part of a surface, with values at their corners.
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Mesh {
    /// Where the samples begin, among all, that its nodes are made of.
    pub first_sample: u32,
    /// How many they are.
    pub samples: u32,
    /// Where its nodes begin.
    pub first_node: u32,
    /// How many it has.
    pub nodes: u32,
    /// Where its triangles begin.
    pub first_triangle: u32,
    /// How many it has.
    pub triangles: u32,
    /// Its value where there is no triangle; below 0: that of the nearest.
    pub outside: f32,
}

/// A corner of triangles: its value is c + Σ w_k E_k.
#[derive(Clone, Copy, Debug, PartialEq, Eq, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Node {
    /// Its place, in 65 535ths of the surface's width and height.
    pub place: [u16; 2],
    /// c in units of [`SHARE`].
    pub constant: i16,
    /// How many samples have a share in it.
    pub shares: u16,
    /// Where their shares begin.
    pub first_share: u32,
}

/// What one sample contributes to a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Share {
    /// The sample, counted from the mesh's first.
    pub sample: u16,
    /// w in units of [`SHARE`].
    pub weight: i16,
}

/// The unit of weights and constants: 2⁻¹³, so that none is beyond ±4.
pub const SHARE: f32 = 1.0 / 8192.0;

/// All of them, borrowed from the tables.
#[derive(Clone, Copy, Debug)]
pub struct Fields<'t> {
    pub(super) fields: &'t [Field],
    pub(super) tensors: &'t [Tensor],
    pub(super) matrices: &'t [f32],
    pub(super) meshes: &'t [Mesh],
    pub(super) nodes: &'t [Node],
    pub(super) shares: &'t [Share],
    pub(super) triangles: &'t [[u16; 3]],
}

impl<'t> Fields<'t> {
    pub(super) const NONE: Self = Self {
        fields: &[],
        tensors: &[],
        matrices: &[],
        meshes: &[],
        nodes: &[],
        shares: &[],
        triangles: &[],
    };

    /// The fields of a surface, each with its tensor grid and its mesh.
    pub fn of(
        self,
        surface: &Surface,
    ) -> impl Iterator<Item = (Option<&'t Tensor>, Option<&'t Mesh>)> + Clone {
        slice(self.fields, surface.first_field, surface.fields)
            .iter()
            .map(move |field| {
                let tensor = self.tensors.get(field.tensor as usize);
                (tensor, self.meshes.get(field.mesh as usize))
            })
    }

    /// A matrix of `n` × `n`, row by row.
    #[inline(always)]
    pub fn matrix(self, first: u32, n: u32) -> &'t [f32] {
        slice(self.matrices, first, n.saturating_mul(n))
    }

    /// The nodes of a mesh.
    #[inline(always)]
    pub fn nodes(self, mesh: &Mesh) -> &'t [Node] {
        slice(self.nodes, mesh.first_node, mesh.nodes)
    }

    /// The shares in a node.
    #[inline(always)]
    pub fn shares(self, node: &Node) -> &'t [Share] {
        slice(self.shares, node.first_share, u32::from(node.shares))
    }

    /// The triangles of a mesh.
    #[inline(always)]
    pub fn triangles(self, mesh: &Mesh) -> &'t [[u16; 3]] {
        slice(self.triangles, mesh.first_triangle, mesh.triangles)
    }

    /// How many values a reconstruction of a surface needs room for: those of its
    /// tensor grids and one more each, of its meshes' nodes, and where a mesh's
    /// values are fractions of a tensor's also of its samples.
    pub fn room(self, surface: &Surface) -> usize {
        let of_field = |(tensor, mesh): (Option<&Tensor>, Option<&Mesh>)| {
            let grid = tensor.map_or(0, |tensor| tensor.values().saturating_add(1));
            let samples = match tensor {
                Some(_) => mesh.map_or(0, |mesh| mesh.samples as usize),
                None => 0,
            };
            let nodes = mesh.map_or(0, |mesh| mesh.nodes as usize);
            grid.saturating_add(samples).saturating_add(nodes)
        };
        self.of(surface)
            .map(of_field)
            .fold(0, usize::saturating_add)
    }
}

impl Tensor {
    /// How many samples it has.
    #[inline(always)]
    pub fn values(&self) -> usize {
        let [along_u, along_v] = self.nodes;
        along_u.saturating_mul(along_v) as usize
    }
}

/// The largest number in a matrix: interpolation at Chebyshev's or Gauss's
/// nodes has none above 2.
const STEEPEST: f32 = 64.0;

/// The largest coefficient of s, and of the polynomials' variables.
const LARGEST: f32 = 1e16;

/// Every record: its numbers finite and in their domain, its ranges inside.
#[cfg_attr(feature = "small", inline(always))]
pub(super) fn check(scene: &Scene<'_>) -> Result<(), Error> {
    let counts = &scene.header.counts;
    let fields = scene.fields;
    for (index, surface) in (0..).zip(scene.surfaces) {
        let sound = fields.room(surface) <= counts.room as usize;
        ranges(What::Fields, index, sound)?;
    }
    for (index, field) in (0..).zip(fields.fields) {
        let there = |index: u32, count: u32| index == NONE || index < count;
        let sound = there(field.tensor, counts.tensors)
            && there(field.mesh, counts.meshes)
            && (field.tensor != NONE || field.mesh != NONE);
        ranges(What::Fields, index, sound)?;
    }
    all(What::Matrices, fields.matrices, |x| {
        (-STEEPEST..=STEEPEST).contains(x)
    })?;
    for (index, tensor) in (0..).zip(fields.tensors) {
        let bounded = |all: &[f32]| all.iter().all(|x| (-LARGEST..=LARGEST).contains(x));
        let sound = bounded(&tensor.center) && bounded(&tensor.inverse) && bounded(&tensor.factor);
        numbers(What::Tensors, index, sound)?;
        let sides = tensor.nodes.iter().zip(tensor.matrices);
        let sound = tensor
            .nodes
            .iter()
            .all(|n| (1..=MOST_NODES as u32).contains(n))
            && inside(tensor.first_sample, tensor.values() as u32, counts.samples)
            && { sides }.all(|(n, first)| inside(first, n.saturating_mul(*n), counts.matrices));
        ranges(What::Tensors, index, sound)?;
    }
    for (index, mesh) in (0..).zip(fields.meshes) {
        numbers(What::Meshes, index, (-1.0..=1.0).contains(&mesh.outside))?;
        let sound = inside(mesh.first_sample, mesh.samples, counts.samples)
            && inside(mesh.first_node, mesh.nodes, counts.nodes)
            && inside(mesh.first_triangle, mesh.triangles, counts.triangles);
        ranges(What::Meshes, index, sound)?;
        for (index, node) in (mesh.first_node..).zip(fields.nodes(mesh)) {
            let sound = inside(node.first_share, u32::from(node.shares), counts.shares);
            ranges(What::Nodes, index, sound)?;
            for (index, share) in (node.first_share..).zip(fields.shares(node)) {
                ranges(What::Shares, index, u32::from(share.sample) < mesh.samples)?;
            }
        }
        for (index, triangle) in (mesh.first_triangle..).zip(fields.triangles(mesh)) {
            let sound = triangle.iter().all(|&node| u32::from(node) < mesh.nodes);
            ranges(What::Triangles, index, sound)?;
        }
    }
    Ok(())
}
