//! What light does at places of a scene in which nothing hides anything.

use super::super::shadow::Floor;
use super::super::{Seen, Tag};
use crate::scene::Scene;
use crate::scene::frame::Frame;
use glam::DVec3;

/// The tags of places of a surface.
pub(super) fn tags(scene: &Scene, index: usize, frame: &Frame, places: &[[f64; 2]]) -> Vec<Tag> {
    // Of more vertices than a floor takes there are no tables either.
    let floor = Floor::of(scene, index).ok();
    let luminaires = || scene.surfaces.iter().filter(|surface| surface.emits());
    let tag = |&place: &[f64; 2]| {
        let at_foot = floor.as_ref();
        let at_foot = at_foot.is_some_and(|floor| floor.is_at_foot(place.into()));
        let [u, v] = place;
        let at = frame.to_world(u, v);
        let above = |&vertex: &DVec3| (vertex - at).dot(frame.normal) > scene.plane_tolerance();
        let faced = luminaires().filter(|luminaire| {
            let before = (at - luminaire.center()).dot(luminaire.normal);
            before > scene.plane_tolerance() && luminaire.vertices.iter().any(above)
        });
        Tag::of_place(at_foot, faced.map(|_| Seen::Wholly))
    };
    places.iter().map(tag).collect()
}
