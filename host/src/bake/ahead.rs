//! Whether emitters may shoot ahead of light that is still to come.

use super::content::Content;
use crate::reference::form_factor;
use crate::scene::Scene;
use glam::DVec3;

/// The part of the ambient light that is sent ahead. From 0.6 to 0.95 the shipped rooms
/// take about as many shots until 0.1 % is unshot, 173 to 191 (cornell) and 222 to 199
/// (office), where they take 358 and 400 with nothing ahead.
const AHEAD: f64 = 0.8;

/// How much of what leaves its surfaces a scene must hold together at least.
const CLOSED: f64 = 0.5;

impl Content {
    /// [`ahead`](isolux::scene::records::Header::ahead): what a room can send ahead, or 0
    /// where most light leaves, which ambient light knows nothing of.
    ///
    /// What a patch's centre sees of all other surfaces, were nothing in the way and no
    /// more than all, says how much of its light stays; by reflected power the mean counts.
    pub(super) fn ahead(&self, scene: &Scene) -> f64 {
        let mut sums = [0.0; 2];
        for (emitter, shape) in self.emitters.iter().zip(&self.shapes) {
            if emitter.members == 0 {
                continue;
            }
            let own = &scene.surfaces[emitter.surface as usize];
            let record = &self.surfaces[emitter.surface as usize];
            let [origin, u, v, normal] =
                [record.origin, record.axis_u, record.axis_v, record.normal].map(wide);
            let [along_u, along_v] = shape.center.map(f64::from);
            let center = origin + along_u * u + along_v * v;
            let seen: f64 = (scene.surfaces.iter())
                .filter(|other| !std::ptr::eq(*other, own))
                .map(|other| form_factor(center, normal, &other.vertices))
                .sum();
            let weight = own.reflectance.iter().sum::<f64>() * f64::from(emitter.area);
            sums = [sums[0] + weight, sums[1] + weight * seen.min(1.0)];
        }
        match sums {
            [all, held] if held > CLOSED * all => AHEAD,
            _ => 0.0,
        }
    }
}

fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}
