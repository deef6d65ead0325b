//! What a planned scene puts into its tables: surface by surface, then emitter by
//! emitter.

use super::fields::Fields;
use super::{TooLarge, Written};
use crate::occlusion::Occlusion;
use crate::plan::patches::Patch;
use crate::plan::patches::shapes::{convex_pieces, hull, own_frame};
use crate::plan::{self, Band, Plan, SurfacePlan};
use crate::scene::requires::requirements;
use crate::scene::{Point, Scene};
use glam::DVec3;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;
use isolux::form_factor::Outline;
use isolux::scene::records::{Emitter, Loop, Shape, Surface};
use isolux::visibility::records::Blocker;
use std::f64::consts::PI;

fn single(v: DVec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

/// Every section, as it grows.
pub(super) struct Content {
    pub(super) channels: usize,
    pub(super) coefficients: usize,
    pub(super) occlusion: Option<Occlusion>,
    pub(super) blockers: Vec<Blocker>,
    pub(super) surfaces: Vec<Surface>,
    pub(super) reflectances: Vec<f32>,
    pub(super) emitters: Vec<Emitter>,
    pub(super) exitances: Vec<f32>,
    pub(super) shapes: Vec<Shape>,
    pub(super) loops: Vec<Loop>,
    pub(super) vertices: Vec<[f32; 3]>,
    pub(super) corners: Vec<[f32; 2]>,
    pub(super) samples: Vec<[f32; 2]>,
    pub(super) weights: Vec<f32>,
    pub(super) members: Vec<u16>,
    pub(super) written: Written,
    /// Named points: the last of the surfaces.
    pub(super) points: usize,
    pub(super) fields: Fields,
    /// Whether some emitters are points.
    has_points: bool,
}

impl Content {
    pub(super) fn of(
        scene: &Scene,
        plan: &Plan,
        occlusion: Option<Occlusion>,
    ) -> Result<Self, TooLarge> {
        let mut content = Self::new(scene, plan, occlusion);
        for (surface, planned) in scene.surfaces.iter().zip(&plan.surfaces) {
            content.surface(surface, planned)?;
        }
        for point in &scene.points {
            content.named(point);
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
            for point in &planned.points {
                content.point(index, planned, point, first_sample)?;
            }
            first_sample += planned.samples.len();
        }
        Ok(content)
    }

    /// Codes or terms say what the lists of occluders did.
    pub(super) fn replace_occluders(&mut self, written: Written) {
        self.occlusion = None;
        self.blockers.clear();
        for shape in &mut self.shapes {
            (shape.first_blocker, shape.blockers) = (0, 0);
        }
        self.written = written;
    }

    /// Responses say what occluders and all that reflects did: luminaires are left,
    /// and every sample receives all light.
    pub(super) fn replace_transfer(&mut self, written: Written) {
        self.replace_occluders(written);
        self.emitters.truncate(self.exitances.len() / self.channels);
        let last = self.emitters.last();
        let loops = last.map_or(0, |last| last.first_loop + last.loops);
        self.loops.truncate(loops as usize);
        let last = self.loops.last();
        let vertices = last.map_or(0, |last| last.first_vertex + last.vertices);
        self.vertices.truncate(vertices as usize);
        self.shapes.clear();
        self.corners.clear();
        self.members.clear();
        self.weights.clear();
        self.coefficients = 1;
        for surface in &mut self.surfaces {
            (surface.direct, surface.indirect, surface.unshadowed) = (0, 0, 0);
        }
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
            written: Written::default(),
            points: 0,
            fields: Fields::default(),
            has_points: plan.surfaces.iter().any(|s| !s.points.is_empty()),
        }
    }

    fn surface(
        &mut self,
        surface: &crate::scene::Surface,
        planned: &SurfacePlan,
    ) -> Result<(), TooLarge> {
        let frame = &planned.frame;
        let (first_field, fields) = self.fields.surface(planned, self.samples.len())?;
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
            unshadowed: planned.unshadowed() as u32,
            first_field,
            fields,
        });
        let reflectance = surface.reflectance.map(|rho| rho as f32);
        self.reflectances.extend(&reflectance[..self.channels]);
        let places = planned.samples.iter();
        self.samples
            .extend(places.map(|sample| sample.place.map(|x| x as f32)));
        Ok(())
    }

    /// A named point, as a surface of which its one sample's corner alone counts.
    fn named(&mut self, point: &Point) {
        let normal = point.normal.normalize();
        let (axis_u, axis_v) = normal.any_orthonormal_pair();
        let (first_field, fields) = (self.fields.fields.len() as u32, 0);
        self.surfaces.push(Surface {
            origin: single(point.position),
            axis_u: single(axis_u),
            axis_v: single(axis_v),
            normal: single(normal),
            size: [1.0; 2],
            filter_radius: 1.0,
            first_sample: self.samples.len() as u32,
            samples: 1,
            direct: 0,
            indirect: 0,
            unshadowed: 0,
            first_field,
            fields,
        });
        self.samples.push([0.0; 2]);
        self.points += 1;
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
        let weights = band.weights.iter();
        self.weights.extend(weights.map(|&weight| weight as f32));
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

    /// An emitter without loops, at the place of its one sample.
    fn point(
        &mut self,
        index: usize,
        planned: &SurfacePlan,
        point: &plan::Point,
        first_sample: usize,
    ) -> Result<(), TooLarge> {
        let emitter = self.emitter(index, point.area);
        self.member(first_sample + point.sample)?;
        self.shapes.push(Shape {
            center: planned.samples[point.sample].place.map(|x| x as f32),
            scale: 0.0,
            first_blocker: self.blockers.len() as u32,
            blockers: 0,
        });
        self.finish(emitter);
        Ok(())
    }

    /// Whether emitters have coordinates of their own.
    fn has_shapes(&self) -> bool {
        self.coefficients > 1 || self.occlusion.is_some() || self.has_points
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
}

fn in_space(planned: &SurfacePlan, places: &[[f64; 2]]) -> Vec<[f32; 3]> {
    let place = |&[u, v]: &[f64; 2]| single(planned.frame.to_world(u, v));
    places.iter().map(place).collect()
}
