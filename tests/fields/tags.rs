//! Why samples are where they are.

use crate::for_camera::planned;
use crate::{reference, room, shipped_scene};
use glam::DVec2;
use isolux_host::plan::shadow::Floor;
use isolux_host::plan::{Plan, Tag, file};
use isolux_host::reference::Reference;
use isolux_host::scene::{Rungs, Scene};

fn count(plan: &Plan, tag: Tag) -> usize {
    let samples = plan.surfaces.iter().flat_map(|surface| &surface.samples);
    samples.filter(|sample| sample.tag == tag).count()
}

/// What a tag says of a sample's place holds there.
fn tags_hold(scene: &Scene, plan: &Plan, direct: &Reference) {
    for (index, planned) in plan.surfaces.iter().enumerate() {
        let frame = &planned.frame;
        let floor = Floor::of(scene, index).expect("a floor");
        for sample in &planned.samples {
            let [u, v] = sample.place;
            let name = &scene.surfaces[index].name;
            let light = || direct.irradiance_at(&[(frame.to_world(u, v), frame.normal)])[0];
            let near_foot = || {
                let at = DVec2::new(u, v);
                let to_line = |[a, b]: [DVec2; 2]| {
                    let along = ((at - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
                    at.distance(a.lerp(b, along))
                };
                let distances = floor
                    .contacts
                    .iter()
                    .map(|l| to_line(l.ends.map(DVec2::from)));
                distances.fold(f64::INFINITY, f64::min) / scene.surfaces[index].area.sqrt()
            };
            match sample.tag {
                Tag::Umbra => assert!(light() < 1e-9, "{name} {u} {v} is lit"),
                Tag::Contact => assert!(near_foot() < 0.051, "{name} {u} {v} is at no foot"),
                _ => {}
            }
        }
    }
}

#[test]
fn samples_say_why_they_are_there() {
    let mut scene = shipped_scene("cornell.toml");
    scene.budget.samples = Some(300);
    let direct = reference(&scene, 0);
    let (plan, _) = room(&scene);
    tags_hold(&scene, &plan, &direct);
    for tag in [
        Tag::Lit,
        Tag::Penumbra,
        Tag::Reflected,
        Tag::Contact,
        Tag::Umbra,
    ] {
        assert!(count(&plan, tag) > 0, "no sample is tagged {}", tag.name());
    }
    assert_eq!(count(&plan, Tag::View), 0, "no camera was asked for");
    let of_camera = planned(&scene, true);
    tags_hold(&scene, &of_camera, &direct);
    assert!(
        count(&of_camera, Tag::View) > 0,
        "none is there for the camera"
    );
    let written = file::text(&scene, &Rungs::default(), &of_camera);
    let read = file::parse("a.plan", &written, &scene).unwrap_or_else(|error| panic!("{error}"));
    for tag in Tag::ALL {
        assert_eq!(
            count(&of_camera, tag),
            count(&read.plan, tag),
            "{}",
            tag.name()
        );
        assert_eq!(Tag::named(tag.name()), Some(tag));
    }
}
