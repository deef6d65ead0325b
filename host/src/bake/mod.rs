//! A plan becomes tables: the bytes that the kernel reads in place from flash.
//!
//! The format is specified with [`isolux::scene`]. Baking the same plan twice
//! gives the same bytes.

mod codes;
pub mod integers;
mod survey;

use crate::occlusion::Occlusion;
use crate::plan::patches::Patch;
use crate::plan::patches::shapes::{convex_pieces, first_moment, hull, signed_area};
use crate::plan::{Band, Plan, SurfacePlan};
use crate::scene::Scene;
use crate::scene::requires::requirements;
use glam::{DVec2, DVec3};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;
use isolux::form_factor::Outline;
use isolux::scene::records::{Counts, Emitter, Header, Loop, Shape, Sight, Surface, checksum};
use isolux::scene::{MAGIC, VERSION, required_bytes};
use isolux::visibility::records::{Blocker, Occluders};
use std::f64::consts::PI;
use std::mem::offset_of;
use zerocopy::IntoBytes;

/// Baked tables and the capacities a firmware needs for them.
#[derive(Clone, Debug)]
pub struct Tables {
    /// Whole words, so that the bytes are aligned as the kernel asks.
    words: Vec<u32>,
    /// How many there are of everything.
    pub counts: Counts,
    /// The same scene with its occluders, where these have codes in place of
    /// them: what the host looks with at places that no code was written for.
    computed: Option<Box<Tables>>,
}

impl Tables {
    /// The tables that any place can be looked at with: these, or where these
    /// have codes the same scene with its occluders.
    pub fn computed(&self) -> &Self {
        self.computed.as_deref().unwrap_or(self)
    }

    /// Writes the capacities that visibility was planned for.
    fn set_sight(&mut self, sight: Sight) {
        let field = offset_of!(Header, sight);
        self.words.as_mut_bytes()[field..][..size_of::<Sight>()].copy_from_slice(sight.as_bytes());
        self.seal();
    }

    fn seal(&mut self) {
        let field = offset_of!(Header, checksum);
        let sum = checksum(&self.bytes()[field + 4..]);
        self.words[field / 4] = sum;
    }

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

/// Bakes a planned scene, with its occluders where they count.
///
/// # Errors
/// [`TooLarge`] where a count does not fit the tables.
pub fn bake(scene: &Scene, plan: &Plan, occlusion: Option<Occlusion>) -> Result<Tables, TooLarge> {
    Content::of(scene, plan, occlusion)?.surveyed(scene)
}

/// Bakes a planned scene of linear patches with codes in place of its occluders.
///
/// Every sample is looked at once from every emitter: that takes longer than a
/// solve.
///
/// # Errors
/// [`TooLarge`] where a count does not fit the tables.
pub fn bake_coded(
    scene: &Scene,
    plan: &Plan,
    occlusion: Option<Occlusion>,
) -> Result<Tables, TooLarge> {
    let mut content = Content::of(scene, plan, occlusion)?;
    let computed = content.surveyed(scene)?;
    content.replace_occluders(codes::of(&computed));
    let mut tables = content.tables(scene)?;
    tables.computed = Some(Box::new(computed));
    Ok(tables)
}

fn single(v: DVec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

struct Content {
    channels: usize,
    coefficients: usize,
    occlusion: Option<Occlusion>,
    blockers: Vec<Blocker>,
    surfaces: Vec<Surface>,
    reflectances: Vec<f32>,
    emitters: Vec<Emitter>,
    exitances: Vec<f32>,
    shapes: Vec<Shape>,
    loops: Vec<Loop>,
    vertices: Vec<[f32; 3]>,
    corners: Vec<[f32; 2]>,
    samples: Vec<[f32; 2]>,
    weights: Vec<f32>,
    members: Vec<u16>,
    codes: codes::Codes,
}

impl Content {
    fn of(scene: &Scene, plan: &Plan, occlusion: Option<Occlusion>) -> Result<Self, TooLarge> {
        let mut content = Self::new(scene, plan, occlusion);
        for (surface, planned) in scene.surfaces.iter().zip(&plan.surfaces) {
            content.surface(surface, planned);
        }
        for (index, surface) in scene.surfaces.iter().enumerate() {
            if surface.emits() {
                content.luminaire(index, surface, &plan.surfaces[index])?;
            }
        }
        let mut first_sample = 0;
        for (index, planned) in plan.surfaces.iter().enumerate() {
            for band in &planned.bands {
                content.band(index, planned, band, first_sample)?;
            }
            for patch in &planned.patches {
                content.patch(index, planned, patch, first_sample)?;
            }
            first_sample += planned.samples.len();
        }
        Ok(content)
    }

    /// The tables, with what a workspace must hold to look with them.
    fn surveyed(&self, scene: &Scene) -> Result<Tables, TooLarge> {
        let mut tables = self.tables(scene)?;
        if tables.counts.occluders > 0 {
            let sight = survey::sight(&tables, &scene.points);
            tables.set_sight(sight);
        }
        Ok(tables)
    }

    /// Codes say what the lists of occluders did.
    fn replace_occluders(&mut self, codes: codes::Codes) {
        self.occlusion = None;
        self.blockers.clear();
        for shape in &mut self.shapes {
            (shape.first_blocker, shape.blockers) = (0, 0);
        }
        self.codes = codes;
    }

    fn new(scene: &Scene, plan: &Plan, occlusion: Option<Occlusion>) -> Self {
        Self {
            channels: requirements(scene).channels,
            coefficients: if plan.is_linear() { 3 } else { 1 },
            occlusion,
            blockers: Vec::new(),
            surfaces: Vec::new(),
            reflectances: Vec::new(),
            emitters: Vec::new(),
            exitances: Vec::new(),
            shapes: Vec::new(),
            loops: Vec::new(),
            vertices: Vec::new(),
            corners: Vec::new(),
            samples: Vec::new(),
            weights: Vec::new(),
            members: Vec::new(),
            codes: codes::Codes::default(),
        }
    }

    fn surface(&mut self, surface: &crate::scene::Surface, planned: &SurfacePlan) {
        let frame = &planned.frame;
        self.surfaces.push(Surface {
            origin: single(frame.origin),
            axis_u: single(frame.u),
            axis_v: single(frame.v),
            normal: single(frame.normal),
            size: [frame.size_u as f32, frame.size_v as f32],
            filter_radius: planned.filter_radius as f32,
            first_sample: self.samples.len() as u32,
            samples: planned.samples.len() as u32,
            direct: planned.direct() as u32,
            indirect: planned.reflected() as u32,
        });
        let reflectance = surface.reflectance.map(|rho| rho as f32);
        self.reflectances.extend(&reflectance[..self.channels]);
        let places = planned.samples.iter();
        self.samples
            .extend(places.map(|sample| sample.place.map(|x| x as f32)));
    }

    fn luminaire(
        &mut self,
        index: usize,
        surface: &crate::scene::Surface,
        planned: &SurfacePlan,
    ) -> Result<(), TooLarge> {
        let emitter = self.emitter(index, surface.area);
        let exitance = surface.radiance.map(|radiance| (PI * radiance) as f32);
        self.exitances.extend(&exitance[..self.channels]);
        if self.has_shapes() {
            let vertices = planned.frame.vertices.iter();
            let outline: Vec<[f64; 2]> = vertices.map(|&(u, v)| [u, v]).collect();
            return self.pieces(emitter, planned, &convex_pieces(&[vec![outline]]));
        }
        let vertices = surface.vertices.iter();
        self.outline(vertices.map(|&vertex| single(vertex)).collect());
        self.finish(emitter);
        Ok(())
    }

    fn band(
        &mut self,
        index: usize,
        planned: &SurfacePlan,
        band: &Band,
        first_sample: usize,
    ) -> Result<(), TooLarge> {
        let emitter = self.emitter(index, band.area.max(0.0));
        for &member in &band.members {
            self.member(first_sample + member)?;
        }
        let vertex = |&sample: &usize| planned.samples[sample].vertex;
        let loops = band.loops.iter();
        let loops: Vec<Vec<[f64; 2]>> = loops
            .map(|outline| outline.iter().map(vertex).collect())
            .collect();
        if self.has_shapes() {
            // What is hidden is cut from convex pieces.
            let none: [Vec<[f64; 2]>; 0] = [];
            let parts = loops.overlay(&none, OverlayRule::Subject, FillRule::EvenOdd);
            return self.pieces(emitter, planned, &convex_pieces(&parts));
        }
        for places in &loops {
            self.outline(in_space(planned, places));
        }
        self.finish(emitter);
        Ok(())
    }

    fn patch(
        &mut self,
        index: usize,
        planned: &SurfacePlan,
        patch: &Patch,
        first_sample: usize,
    ) -> Result<(), TooLarge> {
        let emitter = self.emitter(index, patch.area);
        for (member, weights) in &patch.members {
            self.member(first_sample + member)?;
            self.weights.extend(weights.map(|weight| weight as f32));
        }
        self.pieces(emitter, planned, &patch.pieces)
    }

    /// Whether emitters have coordinates of their own.
    fn has_shapes(&self) -> bool {
        self.coefficients > 1 || self.occlusion.is_some()
    }

    /// Ends an emitter of convex pieces: its own coordinates, and what can hide
    /// it.
    fn pieces(
        &mut self,
        emitter: Emitter,
        planned: &SurfacePlan,
        pieces: &[Vec<[f64; 2]>],
    ) -> Result<(), TooLarge> {
        let (center, scale) = own_frame(pieces);
        for piece in pieces {
            self.outline(in_space(planned, piece));
            self.corners.extend(piece.iter().map(|&[u, v]| {
                [(u - center[0]) / scale, (v - center[1]) / scale].map(|x| x as f32)
            }));
        }
        let first_blocker = self.blockers.len() as u32;
        if let Some(occlusion) = &mut self.occlusion {
            let all: Vec<[f64; 2]> = pieces.iter().flatten().copied().collect();
            let hull: Vec<DVec3> = hull(all)
                .iter()
                .map(|&[u, v]| planned.frame.to_world(u, v))
                .collect();
            let parts = occlusion
                .emitter(&hull, planned.frame.normal)
                .map_err(|_| TooLarge { what: "occluders" })?;
            for part in parts {
                self.blockers.extend(part.blockers());
            }
        }
        self.shapes.push(Shape {
            center: center.map(|x| x as f32),
            // Rounded up: no corner is farther.
            scale: (scale as f32).next_up(),
            first_blocker,
            blockers: self.blockers.len() as u32 - first_blocker,
        });
        self.finish(emitter);
        Ok(())
    }

    /// An emitter whose loops and members are those that come now.
    fn emitter(&self, surface: usize, area: f64) -> Emitter {
        Emitter {
            surface: surface as u32,
            first_loop: self.loops.len() as u32,
            loops: 0,
            first_member: self.members.len() as u32,
            members: 0,
            area: area as f32,
        }
    }

    fn finish(&mut self, mut emitter: Emitter) {
        emitter.loops = self.loops.len() as u32 - emitter.first_loop;
        emitter.members = self.members.len() as u32 - emitter.first_member;
        self.emitters.push(emitter);
    }

    fn member(&mut self, sample: usize) -> Result<(), TooLarge> {
        let sample = u16::try_from(sample).map_err(|_| TooLarge { what: "samples" })?;
        self.members.push(sample);
        Ok(())
    }

    /// A loop in space.
    fn outline(&mut self, vertices: Vec<[f32; 3]>) {
        self.loops.push(Loop {
            first_vertex: self.vertices.len() as u32,
            vertices: vertices.len() as u32,
            reach_squared: Outline::new(&vertices).reach_squared(),
        });
        self.vertices.extend(vertices);
    }

    fn counts(&self) -> Result<Counts, TooLarge> {
        let count = |n: usize, what| u32::try_from(n).map_err(|_| TooLarge { what });
        let occluders = self.occluders();
        Ok(Counts {
            channels: self.channels as u32,
            coefficients: self.coefficients as u32,
            surfaces: count(self.surfaces.len(), "surfaces")?,
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
            codes: count(self.codes.pairs, "codes")?,
            fractions: count(self.codes.fractions.len(), "codes")?,
        })
    }

    fn occluders(&self) -> Occluders<'_> {
        let occlusion = self.occlusion.as_ref();
        occlusion.map_or_else(Occluders::default, Occlusion::records)
    }

    fn tables(&self, scene: &Scene) -> Result<Tables, TooLarge> {
        let counts = self.counts()?;
        let header = Header {
            magic: MAGIC,
            version: VERSION,
            bytes: required_bytes(&counts).ok_or(TooLarge { what: "bytes" })?,
            checksum: 0,
            counts,
            sight: Sight::default(),
            tolerance: (TOLERANCE * largest_coordinate(scene)) as f32,
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
        bytes.extend_from_slice(self.codes.fractions.as_bytes());
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        bytes.extend_from_slice(self.codes.words.as_bytes());
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

/// Centroid in the surface's frame and unit of length of an emitter's own
/// coordinates: no corner is farther than 1.
fn own_frame(pieces: &[Vec<[f64; 2]>]) -> ([f64; 2], f64) {
    let (moment, area) = pieces.iter().fold((DVec2::ZERO, 0.0), |sum, piece| {
        (sum.0 + first_moment(piece), sum.1 + signed_area(piece))
    });
    let center = moment / area;
    let corners = pieces.iter().flatten();
    let farthest = corners.map(|&corner| DVec2::from(corner).distance(center));
    (center.into(), farthest.fold(0.0, f64::max))
}

fn in_space(planned: &SurfacePlan, places: &[[f64; 2]]) -> Vec<[f32; 3]> {
    let place = |&[u, v]: &[f64; 2]| single(planned.frame.to_world(u, v));
    places.iter().map(place).collect()
}

fn largest_coordinate(scene: &Scene) -> f64 {
    let vertices = scene.surfaces.iter().flat_map(|surface| &surface.vertices);
    vertices
        .map(|vertex| vertex.abs().max_element())
        .fold(0.0, f64::max)
}
