//! Scenes in general position: an emitter, and occluders between it and the
//! receivers.

use crate::lit::{Lit, scene, surface};
use glam::{DMat3, DVec3};
use isolux_host::scene::Surface;

/// SplitMix64 (Steele, Lea & Flood 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// Even in [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    pub(crate) fn direction(&mut self) -> DVec3 {
        loop {
            let v = DVec3::from_array([(); 3].map(|()| self.between(-1.0, 1.0)));
            if (0.01..1.0).contains(&v.length()) {
                return v.normalize();
            }
        }
    }

    pub(crate) fn turn(&mut self) -> DMat3 {
        let axis = self.direction();
        DMat3::from_axis_angle(axis, self.between(0.0, 6.3))
    }

    /// A convex polygon about the origin with normal z, inscribed in a circle.
    pub(crate) fn outline(&mut self, corners: usize, radius: f64) -> Vec<DVec3> {
        let step = std::f64::consts::TAU / corners as f64;
        (0..corners)
            .map(|i| {
                let angle = step * (i as f64 + self.between(0.0, 0.7));
                DVec3::new(angle.cos(), angle.sin(), 0.0) * radius
            })
            .collect()
    }

    /// An emitter 4 m up that looks down, more or less.
    pub(crate) fn emitter(&mut self) -> Surface {
        let corners = 3 + self.below(4);
        let radius = self.between(0.2, 2.0);
        let tilt = DMat3::from_axis_angle(self.direction(), self.between(0.0, 0.5));
        let flat = self.outline(corners, radius);
        let vertices = flat.iter().rev().map(|&v| tilt * v + DVec3::Z * 4.0);
        surface(vertices.collect(), 1.0)
    }

    /// A triangle or a quadrilateral somewhere below the emitter.
    pub(crate) fn occluder(&mut self, size: f64) -> Surface {
        let corners = 3 + self.below(2);
        let turn = self.turn();
        let place = self.place_between();
        let outline = self.outline(corners, size);
        surface(outline.iter().map(|&v| turn * v + place).collect(), 0.0)
    }

    pub(crate) fn place_between(&mut self) -> DVec3 {
        DVec3::new(
            self.between(-0.9, 0.9),
            self.between(-0.9, 0.9),
            self.between(0.8, 3.0),
        )
    }

    /// The six faces of a turned box, outwards.
    pub(crate) fn block(&mut self, size: f64) -> Vec<Surface> {
        let half = [(); 3].map(|()| self.between(0.3, 1.0) * size);
        let (turn, place) = (self.turn(), self.place_between());
        faces_of_box(half)
            .into_iter()
            .map(|face| surface(face.iter().map(|&v| turn * v + place).collect(), 0.0))
            .collect()
    }

    /// A place near the origin, and a normal that looks up more or less.
    pub(crate) fn receiver(&mut self) -> (DVec3, DVec3) {
        let place = DVec3::new(
            self.between(-1.5, 1.5),
            self.between(-1.5, 1.5),
            self.between(-0.3, 0.3),
        );
        (place, (DVec3::Z + 0.9 * self.direction()).normalize())
    }

    /// An emitter behind this many occluders.
    pub(crate) fn lit(&mut self, occluders: usize, size: f64) -> Lit {
        let mut surfaces = vec![self.emitter()];
        surfaces.extend((0..occluders).map(|_| self.occluder(size)));
        Lit::new(&scene(surfaces))
    }
}

/// The faces of a box about the origin, outwards.
pub(crate) fn faces_of_box([x, y, z]: [f64; 3]) -> Vec<Vec<DVec3>> {
    let corner = |i: usize| {
        let sign = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        DVec3::new(x * sign(0), y * sign(1), z * sign(2))
    };
    [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ]
    .iter()
    .map(|face| face.iter().map(|&i| corner(i)).collect())
    .collect()
}
