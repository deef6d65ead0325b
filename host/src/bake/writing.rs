//! The bytes of the tables, section by section.

use super::content::Content;
use super::{TOLERANCE, Tables, TooLarge, largest_coordinate, survey};
use crate::occlusion::Occlusion;
use crate::scene::Scene;
use isolux::scene::records::{Counts, Header, Sight};
use isolux::scene::{MAGIC, VERSION, required_bytes};
use isolux::visibility::records::Occluders;
use zerocopy::IntoBytes;

impl Content {
    /// The tables, with what a workspace must hold to look with them.
    pub(super) fn surveyed(&self, scene: &Scene) -> Result<Tables, TooLarge> {
        let mut tables = self.tables(scene)?;
        if tables.counts.occluders > 0 {
            let sight = survey::sight(&tables, &scene.points);
            tables.set_sight(sight);
        }
        Ok(tables)
    }

    fn counts(&self) -> Result<Counts, TooLarge> {
        let count = |n: usize, what| u32::try_from(n).map_err(|_| TooLarge { what });
        let occluders = self.occluders();
        Ok(Counts {
            channels: self.channels as u32,
            coefficients: self.coefficients as u32,
            surfaces: count(self.surfaces.len() - self.points, "surfaces")?,
            luminaires: count(self.exitances.len() / self.channels, "luminaires")?,
            emitters: count(self.emitters.len(), "emitters")?,
            shapes: count(self.shapes.len(), "shapes")?,
            loops: count(self.loops.len(), "loops")?,
            vertices: count(self.vertices.len(), "vertices")?,
            corners: count(self.corners.len(), "corners")?,
            occluders: count(occluders.occluders.len(), "occluders")?,
            faces: count(occluders.faces.len(), "occluders")?,
            edges: count(occluders.edges.len(), "occluders")?,
            places: count(occluders.vertices.len(), "occluders")?,
            blockers: count(self.blockers.len(), "occluders")?,
            samples: count(self.samples.len(), "samples")?,
            members: count(self.members.len(), "members")?,
            weights: count(self.weights.len(), "weights")?,
            codes: count(self.written.codes, "codes")?,
            fractions: count(self.written.fractions.len(), "codes")?,
            fields: count(self.fields.fields.len(), "fields")?,
            tensors: count(self.fields.tensors.len(), "fields")?,
            matrices: count(self.fields.matrices.len(), "fields")?,
            meshes: count(self.fields.meshes.len(), "fields")?,
            nodes: count(self.fields.nodes.len(), "nodes")?,
            triangles: count(self.fields.triangles.len(), "nodes")?,
            shares: count(self.fields.shares.len(), "shares")?,
            room: count(self.fields.room, "nodes")?,
            points: count(self.points, "points")?,
            terms: count(self.written.terms, "terms")?,
            bits: self.written.bits,
            responses: count(self.written.responses.len(), "responses")?,
        })
    }

    fn occluders(&self) -> Occluders<'_> {
        let occlusion = self.occlusion.as_ref();
        occlusion.map_or_else(Occluders::default, Occlusion::records)
    }

    pub(super) fn tables(&self, scene: &Scene) -> Result<Tables, TooLarge> {
        let counts = self.counts()?;
        let header = Header {
            magic: MAGIC,
            version: VERSION,
            bytes: required_bytes(&counts).ok_or(TooLarge { what: "bytes" })?,
            checksum: 0,
            counts,
            sight: Sight::default(),
            tolerance: (TOLERANCE * largest_coordinate(scene)) as f32,
            ahead: self.ahead(scene) as f32,
        };
        let mut bytes = header.as_bytes().to_vec();
        bytes.extend_from_slice(self.surfaces.as_bytes());
        bytes.extend_from_slice(self.reflectances.as_bytes());
        bytes.extend_from_slice(self.emitters.as_bytes());
        bytes.extend_from_slice(self.exitances.as_bytes());
        bytes.extend_from_slice(self.shapes.as_bytes());
        bytes.extend_from_slice(self.loops.as_bytes());
        bytes.extend_from_slice(self.vertices.as_bytes());
        bytes.extend_from_slice(self.corners.as_bytes());
        let occluders = self.occluders();
        bytes.extend_from_slice(occluders.occluders.as_bytes());
        bytes.extend_from_slice(occluders.faces.as_bytes());
        bytes.extend_from_slice(occluders.edges.as_bytes());
        bytes.extend_from_slice(occluders.vertices.as_bytes());
        bytes.extend_from_slice(self.blockers.as_bytes());
        bytes.extend_from_slice(self.samples.as_bytes());
        bytes.extend_from_slice(self.weights.as_bytes());
        bytes.extend_from_slice(self.members.as_bytes());
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        bytes.extend_from_slice(self.written.scales.as_bytes());
        bytes.extend_from_slice(self.written.fractions.as_bytes());
        bytes.extend_from_slice(self.written.responses.as_bytes());
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        bytes.extend_from_slice(&self.written.bytes);
        bytes.extend_from_slice(self.fields.fields.as_bytes());
        bytes.extend_from_slice(self.fields.tensors.as_bytes());
        bytes.extend_from_slice(self.fields.matrices.as_bytes());
        bytes.extend_from_slice(self.fields.meshes.as_bytes());
        bytes.extend_from_slice(self.fields.nodes.as_bytes());
        bytes.extend_from_slice(self.fields.shares.as_bytes());
        bytes.extend_from_slice(self.fields.triangles.as_bytes());
        bytes.resize(header.bytes as usize, 0);
        let mut words = vec![0_u32; bytes.len() / 4];
        words.as_mut_bytes().copy_from_slice(&bytes);
        let mut tables = Tables {
            words,
            counts,
            computed: None,
        };
        tables.seal();
        Ok(tables)
    }
}
