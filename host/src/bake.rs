//! A plan becomes tables: the bytes that the kernel reads in place from flash.
//!
//! The format is specified with [`isolux::scene`]. Baking the same plan twice
//! gives the same bytes.

use crate::plan::{Band, Plan, SurfacePlan};
use crate::scene::Scene;
use glam::DVec3;
use isolux::form_factor::Outline;
use isolux::scene::records::{Emitter, Header, Loop, Surface, checksum};
use isolux::scene::{MAGIC, VERSION, required_bytes};
use std::f64::consts::PI;
use std::mem::offset_of;
use zerocopy::IntoBytes;

/// Baked tables and the capacities a firmware needs for them.
#[derive(Clone, Debug)]
pub struct Tables {
    /// Whole words, so that the bytes are aligned as the kernel asks.
    words: Vec<u32>,
    /// Samples in all.
    pub samples: usize,
    /// Luminaires and secondary emitters.
    pub emitters: usize,
}

impl Tables {
    /// The tables, aligned to four bytes.
    pub fn bytes(&self) -> &[u8] {
        self.words.as_bytes()
    }
}

/// A scene that the tables cannot hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TooLarge {
    /// What there is too much of.
    pub what: &'static str,
}

impl std::fmt::Display for TooLarge {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "the scene has more {} than the tables can index",
            self.what
        )
    }
}

impl std::error::Error for TooLarge {}

/// Distance within which a place lies on a plane, as a part of the scene's
/// largest coordinate.
const TOLERANCE: f64 = 1e-6;

/// Bakes a planned scene of one channel.
///
/// # Errors
/// [`TooLarge`] where a count does not fit the tables.
pub fn bake(scene: &Scene, plan: &Plan) -> Result<Tables, TooLarge> {
    let mut content = Content::default();
    for (surface, planned) in scene.surfaces.iter().zip(&plan.surfaces) {
        content.surface(surface, planned);
    }
    for (index, surface) in scene.surfaces.iter().enumerate() {
        if surface.radiance[0] > 0.0 {
            content.luminaire(index, surface);
        }
    }
    let mut first_sample = 0;
    for (index, (surface, planned)) in scene.surfaces.iter().zip(&plan.surfaces).enumerate() {
        for band in &planned.bands {
            content.band(index, surface, planned, band, first_sample)?;
        }
        first_sample += planned.samples.len();
    }
    content.into_tables(scene)
}

fn single(v: DVec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

#[derive(Default)]
struct Content {
    surfaces: Vec<Surface>,
    emitters: Vec<Emitter>,
    loops: Vec<Loop>,
    vertices: Vec<[f32; 3]>,
    samples: Vec<[f32; 2]>,
    members: Vec<u16>,
}

impl Content {
    fn surface(&mut self, surface: &crate::scene::Surface, planned: &SurfacePlan) {
        let frame = &planned.frame;
        self.surfaces.push(Surface {
            origin: single(frame.origin),
            axis_u: single(frame.u),
            axis_v: single(frame.v),
            normal: single(frame.normal),
            size: [frame.size_u as f32, frame.size_v as f32],
            reflectance: surface.reflectance[0] as f32,
            filter_radius: planned.filter_radius as f32,
            first_sample: self.samples.len() as u32,
            samples: planned.samples.len() as u32,
        });
        self.samples.extend(
            planned
                .samples
                .iter()
                .map(|sample| sample.place.map(|x| x as f32)),
        );
    }

    fn luminaire(&mut self, index: usize, surface: &crate::scene::Surface) {
        let first_loop = self.loops.len() as u32;
        self.outline(
            surface
                .vertices
                .iter()
                .map(|&vertex| single(vertex))
                .collect(),
        );
        self.emitters.push(Emitter {
            surface: index as u32,
            first_loop,
            loops: 1,
            first_member: self.members.len() as u32,
            members: 0,
            exitance: (PI * surface.radiance[0]) as f32,
            reflectance: 0.0,
            area: surface.area as f32,
        });
    }

    fn band(
        &mut self,
        index: usize,
        surface: &crate::scene::Surface,
        planned: &SurfacePlan,
        band: &Band,
        first_sample: usize,
    ) -> Result<(), TooLarge> {
        let first_loop = self.loops.len() as u32;
        let first_member = self.members.len() as u32;
        for outline in &band.loops {
            let place = |&sample: &usize| {
                let [u, v] = planned.samples[sample].vertex;
                single(planned.frame.to_world(u, v))
            };
            self.outline(outline.iter().map(place).collect());
        }
        for &member in &band.members {
            let member = u16::try_from(first_sample + member);
            self.members
                .push(member.map_err(|_| TooLarge { what: "samples" })?);
        }
        self.emitters.push(Emitter {
            surface: index as u32,
            first_loop,
            loops: band.loops.len() as u32,
            first_member,
            members: band.members.len() as u32,
            exitance: 0.0,
            reflectance: surface.reflectance[0] as f32,
            area: band.area.max(0.0) as f32,
        });
        Ok(())
    }

    fn outline(&mut self, vertices: Vec<[f32; 3]>) {
        self.loops.push(Loop {
            first_vertex: self.vertices.len() as u32,
            vertices: vertices.len() as u32,
            reach_squared: Outline::new(&vertices).reach_squared(),
        });
        self.vertices.extend(vertices);
    }

    fn into_tables(self, scene: &Scene) -> Result<Tables, TooLarge> {
        let count = |n: usize, what| u32::try_from(n).map_err(|_| TooLarge { what });
        let mut header = Header {
            magic: MAGIC,
            version: VERSION,
            bytes: 0,
            checksum: 0,
            surfaces: count(self.surfaces.len(), "surfaces")?,
            emitters: count(self.emitters.len(), "emitters")?,
            loops: count(self.loops.len(), "loops")?,
            vertices: count(self.vertices.len(), "vertices")?,
            samples: count(self.samples.len(), "samples")?,
            members: count(self.members.len(), "members")?,
            tolerance: (TOLERANCE * largest_coordinate(scene)) as f32,
        };
        header.bytes = required_bytes(
            header.surfaces,
            header.emitters,
            header.loops,
            header.vertices,
            header.samples,
            header.members,
        )
        .ok_or(TooLarge { what: "bytes" })?;
        let mut bytes = header.as_bytes().to_vec();
        bytes.extend_from_slice(self.surfaces.as_bytes());
        bytes.extend_from_slice(self.emitters.as_bytes());
        bytes.extend_from_slice(self.loops.as_bytes());
        bytes.extend_from_slice(self.vertices.as_bytes());
        bytes.extend_from_slice(self.samples.as_bytes());
        bytes.extend_from_slice(self.members.as_bytes());
        bytes.resize(header.bytes as usize, 0);
        let field = offset_of!(Header, checksum);
        let sum = checksum(&bytes[field + 4..]);
        bytes[field..field + 4].copy_from_slice(&sum.to_le_bytes());
        let mut words = vec![0_u32; bytes.len() / 4];
        words.as_mut_bytes().copy_from_slice(&bytes);
        Ok(Tables {
            words,
            samples: self.samples.len(),
            emitters: self.emitters.len(),
        })
    }
}

fn largest_coordinate(scene: &Scene) -> f64 {
    let vertices = scene.surfaces.iter().flat_map(|surface| &surface.vertices);
    vertices
        .map(|vertex| vertex.abs().max_element())
        .fold(0.0, f64::max)
}
