//! Scenes lit directly through the kernel's visibility.

use glam::DVec3;
use isolux::form_factor::{Best, Outline, of_loops};
use isolux::geometry::{Plane, Receiver};
use isolux::number::{Floating, Root, SoftRoot};
use isolux::visibility::{Bracket, Exact, Visibility};
use isolux_host::occlusion::{Emitter, Occlusion};
use isolux_host::scene::{Budget, Quantity, Rungs, Scene, Surface};
use std::f64::consts::PI;

/// A workspace that holds every test scene.
pub(crate) type Roomy<N = f32> = Exact<24, 48, 256, 64, N>;

/// What every shipped scene fits.
pub(crate) type Small<N = f32> = Exact<8, 4, 24, 6, N>;

pub(crate) fn surface(vertices: Vec<DVec3>, radiance: f64) -> Surface {
    let measured = isolux_host::scene::polygon::measure(&vertices).expect("a sound polygon");
    Surface {
        name: String::new(),
        normal: measured.normal,
        area: measured.area,
        vertices,
        reflectance: [0.0; 3],
        radiance: [radiance; 3],
    }
}

pub(crate) fn scene(surfaces: Vec<Surface>) -> Scene {
    Scene {
        name: "test".to_owned(),
        quantity: Quantity::Radiometric,
        surfaces,
        bodies: Vec::new(),
        points: Vec::new(),
        rungs: Rungs::default(),
        camera: None,
        budget: Budget::default(),
    }
}

/// A scene's luminaires, with what hides them.
pub(crate) struct Lit {
    pub(crate) occlusion: Occlusion,
    pub(crate) emitters: Vec<(f64, Emitter)>,
}

pub(crate) fn receiver<N: Floating>(place: DVec3, normal: DVec3) -> Receiver<N>
where
    SoftRoot: Root<N>,
{
    let number = |v: DVec3| v.to_array().map(|x| N::of(f64::from(x as f32)));
    Receiver::new::<SoftRoot>(number(place), number(normal)).expect("a receiver")
}

/// The vertices of a target by its own frame.
pub(crate) fn vertices<N: Floating>(emitter: &Emitter) -> Vec<[N; 3]> {
    let target = emitter.target();
    let number = |x: f32| N::of(f64::from(x));
    let [first, second] = target.axes;
    let corner = |&[a, b]: &[f32; 2]| {
        std::array::from_fn(|i| {
            number(target.origin[i]) + number(first[i]) * number(a) + number(second[i]) * number(b)
        })
    };
    target.corners.iter().map(corner).collect()
}

/// The unoccluded form factor of a target; 0 for places on its own plane.
pub(crate) fn unoccluded<N: Floating>(receiver: &Receiver<N>, emitter: &Emitter) -> N
where
    SoftRoot: Root<N>,
{
    let number = |x: f32| N::of(f64::from(x));
    let target = emitter.target();
    let plane = Plane {
        normal: target.normal.map(number).into(),
        point: target.origin.map(number).into(),
    };
    let vertices = vertices(emitter);
    of_loops::<Best<SoftRoot>, N>(receiver, &plane, std::iter::once(Outline::new(&vertices)))
}

impl Lit {
    pub(crate) fn new(scene: &Scene) -> Self {
        let mut occlusion = Occlusion::of(scene).expect("room");
        let mut emitters = Vec::new();
        for surface in &scene.surfaces {
            if surface.emits() {
                for part in occlusion
                    .emitter(&surface.vertices, surface.normal)
                    .expect("room")
                {
                    emitters.push((surface.radiance[0], part));
                }
            }
        }
        Self {
            occlusion,
            emitters,
        }
    }

    /// The form factor of an emitter.
    pub(crate) fn form_factor<N: Floating>(
        &self,
        visibility: &mut impl Visibility<N>,
        receiver: &Receiver<N>,
        emitter: &Emitter,
    ) -> Bracket<N>
    where
        SoftRoot: Root<N>,
    {
        visibility.form_factor::<SoftRoot>(
            receiver,
            &emitter.target(),
            &self.occlusion.records(),
            emitter.blockers().iter().copied(),
            || unoccluded(receiver, emitter),
        )
    }

    /// Direct irradiance.
    pub(crate) fn irradiance<N: Floating + Into<f64>>(
        &self,
        visibility: &mut impl Visibility<N>,
        place: DVec3,
        normal: DVec3,
    ) -> f64
    where
        SoftRoot: Root<N>,
    {
        let receiver = receiver::<N>(place, normal);
        let seen = |(radiance, emitter): &(f64, Emitter)| {
            let bracket = self.form_factor(visibility, &receiver, emitter);
            assert!(bracket.is_exact(), "{bracket:?}");
            PI * radiance * bracket.low.into()
        };
        self.emitters.iter().map(seen).sum()
    }
}
