//! What surfaces are reconstructed from, as records.

use super::TooLarge;
use crate::plan::SurfacePlan;
use crate::plan::fields::tensor::Tensor;
use crate::plan::fields::{Field, Mesh, Node};
use crate::scene::frame::Frame;
use isolux::scene::fields::{self, NONE, SHARE};

/// The records of all surfaces.
#[derive(Default)]
pub(super) struct Fields {
    pub(super) fields: Vec<fields::Field>,
    pub(super) tensors: Vec<fields::Tensor>,
    pub(super) matrices: Vec<f32>,
    pub(super) meshes: Vec<fields::Mesh>,
    pub(super) nodes: Vec<fields::Node>,
    pub(super) shares: Vec<fields::Share>,
    pub(super) triangles: Vec<[u16; 3]>,
    /// Values that the largest surface's reconstruction needs.
    pub(super) room: usize,
}

impl Fields {
    /// Adds those of a surface whose samples begin at `first_sample`; where they
    /// begin and how many there are.
    pub(super) fn surface(
        &mut self,
        planned: &SurfacePlan,
        first_sample: usize,
    ) -> Result<(u32, u32), TooLarge> {
        let first = self.fields.len() as u32;
        let room = planned.fields.iter().map(Field::room).sum();
        self.room = self.room.max(room);
        for field in &planned.fields {
            let tensor = match &field.tensor {
                Some(tensor) => self.tensor(tensor, first_sample),
                None => NONE,
            };
            let mesh = match &field.mesh {
                Some(mesh) => self.mesh(mesh, &planned.frame, first_sample)?,
                None => NONE,
            };
            self.fields.push(fields::Field { tensor, mesh });
        }
        Ok((first, planned.fields.len() as u32))
    }

    fn tensor(&mut self, tensor: &Tensor, first_sample: usize) -> u32 {
        let matrices = [0, 1].map(|axis| {
            let matrix = tensor.matrix(axis).transpose();
            let numbers: Vec<f32> = matrix.iter().map(|&x| x as f32).collect();
            self.matrix(&numbers)
        });
        self.tensors.push(fields::Tensor {
            first_sample: (first_sample + tensor.first) as u32,
            nodes: [0, 1].map(|axis| tensor.nodes[axis].len() as u32),
            matrices,
            center: tensor.center.map(|x| x as f32),
            inverse: tensor.half.map(|x| (1.0 / x) as f32),
            factor: tensor.factor.unwrap_or([0.0; 3]).map(|x| x as f32),
            transformed: u32::from(tensor.factor.is_some()),
        });
        self.tensors.len() as u32 - 1
    }

    /// Where a matrix stands; one that is there already is not written again.
    fn matrix(&mut self, numbers: &[f32]) -> u32 {
        let there = self.matrices.windows(numbers.len());
        let position = { there }.position(|window| window == numbers);
        position.unwrap_or_else(|| {
            self.matrices.extend(numbers);
            self.matrices.len() - numbers.len()
        }) as u32
    }

    fn mesh(&mut self, mesh: &Mesh, frame: &Frame, first_sample: usize) -> Result<u32, TooLarge> {
        let nodes = |_| TooLarge { what: "nodes" };
        u16::try_from(mesh.nodes.len()).map_err(nodes)?;
        u16::try_from(mesh.samples).map_err(|_| TooLarge { what: "samples" })?;
        self.meshes.push(fields::Mesh {
            first_sample: (first_sample + mesh.first) as u32,
            samples: mesh.samples as u32,
            first_node: self.nodes.len() as u32,
            nodes: mesh.nodes.len() as u32,
            first_triangle: self.triangles.len() as u32,
            triangles: mesh.triangles.len() as u32,
            outside: mesh.outside.map_or(-1.0, |value| value as f32),
        });
        for node in &mesh.nodes {
            self.node(node, frame)?;
        }
        for triangle in &mesh.triangles {
            self.triangles.push(triangle.map(|node| node as u16));
        }
        Ok(self.meshes.len() as u32 - 1)
    }

    fn node(&mut self, node: &Node, frame: &Frame) -> Result<(), TooLarge> {
        let sizes = [frame.size_u, frame.size_v];
        let place = [0, 1].map(|axis| {
            let part = node.place[axis] / sizes[axis] * f64::from(u16::MAX);
            part.round().clamp(0.0, f64::from(u16::MAX)) as u16
        });
        let first_share = self.shares.len() as u32;
        for &(sample, weight) in &node.shares {
            self.shares.push(fields::Share {
                sample: sample as u16,
                weight: units(weight),
            });
        }
        let shares = self.shares.len() as u32 - first_share;
        self.nodes.push(fields::Node {
            place,
            constant: units(node.constant),
            shares: u16::try_from(shares).map_err(|_| TooLarge { what: "shares" })?,
            first_share,
        });
        Ok(())
    }
}

/// A weight in the units of the tables.
fn units(weight: f64) -> i16 {
    let most = f64::from(i16::MAX);
    (weight / f64::from(SHARE)).round().clamp(-most, most) as i16
}
