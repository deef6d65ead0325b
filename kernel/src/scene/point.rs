//! Emitters that are points.

use super::{PARALLEL, Scene};
use crate::geometry::{Plane, Receiver, Vector};
use crate::luminance::{Colour, Luminance};
use crate::scene::records::Surface;
use core::f32::consts::FRAC_1_PI;

/// A point that shoots for an area, with what is the same for all that it lights.
pub(crate) struct PointSource {
    place: Vector<f32>,
    /// The plane that it lies in.
    plane: Plane<f32>,
    /// The area it stands for over π, in m².
    share: f32,
    /// Heights over the plane that are none, in metres.
    tolerance: f32,
}

impl Scene<'_> {
    /// The emitter, if it is a point: one without loops.
    #[inline(always)]
    pub(crate) fn point_source(&self, index: usize) -> Option<PointSource> {
        let emitter = self.emitters.get(index).filter(|e| e.loops == 0)?;
        let shape = self.shapes.get(index)?;
        let surface = self.surfaces.get(emitter.surface as usize)?;
        Some(PointSource {
            place: surface.place(shape.center),
            plane: Plane {
                normal: Vector::from(surface.normal),
                point: Vector::from(surface.origin),
            },
            share: emitter.area * FRAC_1_PI,
            tolerance: self.header.tolerance,
        })
    }
}

impl PointSource {
    /// Whether a surface with this normal faces the way the point does.
    #[inline(always)]
    pub(super) fn is_parallel(&self, normal: Vector<f32>) -> bool {
        self.plane.normal.dot(normal) > PARALLEL
    }

    /// What a receiver gets of its radiosity: A cos θ_r cos θ_e / (π r²), A being the area
    /// it stands for; 0 where one does not face the other, and, as of other emitters, in its
    /// own plane. It stands for it where the receiver is farther than the points are from
    /// each other, or where areas were fitted to what the receiver gets.
    #[inline(always)]
    pub(super) fn factor(&self, receiver: &Receiver<f32>, parallel: bool) -> f32 {
        let height = self.plane.height(receiver.position());
        if height <= 0.0 || parallel && height <= self.tolerance {
            return 0.0;
        }
        let to = self.place - receiver.position();
        let ahead = receiver.normal().dot(to);
        if ahead <= 0.0 {
            return 0.0;
        }
        // Twice by the distance: its square could leave the range.
        let inverse = 1.0 / to.norm_squared();
        (self.share * height * inverse) * (ahead * inverse)
    }

    /// Adds what samples at these places of a surface receive.
    ///
    /// By itself, and not by the sample as other emitters: what is the same for all of
    /// them is two thirds of a point's cost. About 55 instructions a sample.
    #[inline(never)]
    pub(crate) fn add<L: Luminance>(
        &self,
        surface: &Surface,
        places: &[[f32; 2]],
        radiosity: L,
        values: &mut [L::Colour],
    ) {
        let normal = Vector::from(surface.normal);
        let parallel = self.is_parallel(normal);
        for (value, &place) in values.iter_mut().zip(places) {
            let receiver = Receiver::of_unit(surface.place(place), normal);
            let factor = self.factor(&receiver, parallel);
            *value = value.plus(radiosity.received(factor, || [0.0; 2]));
        }
    }
}
