//! Classification by dense rays, which shares no code with the maps.

use crate::{cornell, map, places, read};
use glam::DVec3;
use isolux_host::plan::shadow::{Class, Lines, Mesh, Options, ShadowMap, Tag};
use isolux_host::scene::{Scene, Surface, shipped};

/// Rays along each side of a quadrilateral luminaire.
const SIDE: usize = 24;

/// Whether a segment crosses a polygon strictly between its ends.
fn crosses(from: DVec3, to: DVec3, surface: &Surface, flat: f64) -> bool {
    let anchor = surface.vertices[0];
    let [a, b] = [from, to].map(|end| (end - anchor).dot(surface.normal));
    if a.abs() <= flat || b.abs() <= flat || (a > 0.0) == (b > 0.0) {
        return false;
    }
    let place = from + (to - from) * (a / (a - b));
    // Winding about the place.
    let count = surface.vertices.len();
    let turn = |k: usize| {
        let [p, q] = [k, (k + 1) % count].map(|i| surface.vertices[i] - place);
        p.cross(q).dot(surface.normal).atan2(p.dot(q))
    };
    (0..count).map(turn).sum::<f64>().abs() > 3.0
}

/// How many of the rays to a quadrilateral reach it, as a fraction; `None` where
/// the place is behind it or it is behind the receiver.
fn share(scene: &Scene, luminaire: usize, place: DVec3, normal: DVec3) -> Option<f64> {
    let light = &scene.surfaces[luminaire];
    let flat = 1e-6 * scene.largest_coordinate();
    if (place - light.vertices[0]).dot(light.normal) <= flat {
        return None;
    }
    let [a, b, c, d] = light.vertices[..] else {
        panic!("a quadrilateral");
    };
    let (mut seen, mut all) = (0, 0);
    for k in 0..SIDE * SIDE {
        let [s, t] = [k % SIDE, k / SIDE].map(|i| (i as f64 + 0.5) / SIDE as f64);
        let end = a.lerp(b, s).lerp(d.lerp(c, s), t);
        if (end - place).dot(normal) <= 0.0 {
            continue;
        }
        let others = scene.surfaces.iter().enumerate();
        let hidden = others
            .filter(|&(index, _)| index != luminaire)
            .any(|(_, surface)| crosses(place, end, surface, flat));
        all += 1;
        seen += usize::from(!hidden);
    }
    (all > 0).then(|| f64::from(seen as u32) / f64::from(all as u32))
}

/// A share of the luminaire that rays may miss: a strip one ray wide along two
/// sides, and more where it is seen under a slant.
const MISSED: f64 = 0.12;

fn agree(map: &ShadowMap, scene: &Scene, luminaire: usize, count: usize) {
    let options = Options {
        lines: Lines::All,
        ..Options::default()
    };
    let mesh = Mesh::of(&map.floor, &[map], &options);
    let frame = &map.floor.frame;
    let mut met = [0; 4];
    for place in places(map, count, 7) {
        let class = map.class(place.x, place.y);
        let share = share(
            scene,
            luminaire,
            frame.to_world(place.x, place.y),
            frame.normal,
        );
        let fraction = map.fraction(place.x, place.y);
        let (triangle, _) = mesh.locate(place.x, place.y).expect("a triangle");
        let tag = mesh.tags[triangle];
        let told = format!("{place}: {class:?} V {fraction:?}, rays {share:?}, {tag:?}");
        met[class as usize] += 1;
        match (share, fraction) {
            (None, None) => assert_eq!((class, tag), (Class::Behind, Tag::Behind), "{told}"),
            (Some(share), Some(fraction)) => {
                if share > 0.0 && share < 1.0 {
                    assert_eq!((class, tag), (Class::Penumbra, Tag::Penumbra), "{told}");
                }
                match class {
                    Class::Lit => assert_eq!(share, 1.0, "{told}"),
                    Class::Umbra => assert_eq!(share, 0.0, "{told}"),
                    Class::Penumbra => {
                        assert!((share - fraction).abs() < MISSED, "{told}");
                        assert_eq!(tag, Tag::Penumbra, "{told}");
                    }
                    Class::Behind => panic!("{told}"),
                }
            }
            _ => panic!("{told}"),
        }
    }
    let [lit, penumbra, ..] = met;
    assert!(lit > 0 && penumbra > 0, "{met:?}");
}

#[test]
fn ten_thousand_places_of_the_cornell_floor_agree_with_rays() {
    let scene = cornell();
    let luminaire = scene.surface_named("light").expect("a luminaire");
    agree(&map(&scene, "floor", "light"), &scene, luminaire, 10_000);
}

#[test]
fn walls_and_lids_agree_with_rays() {
    let scene = cornell();
    let luminaire = scene.surface_named("light").expect("a luminaire");
    for receiver in ["back", "right", "left0", "short_top", "short_s3", "tall_s1"] {
        let map = map(&scene, receiver, "light");
        if map.lines.is_empty() {
            continue;
        }
        agree(&map, &scene, luminaire, 1_000);
    }
}

#[test]
fn the_office_agrees_with_rays() {
    let scene = read(shipped::OFFICE);
    for luminaire in ["lum00", "lum11"] {
        let index = scene.surface_named(luminaire).expect("a luminaire");
        agree(&map(&scene, "floor", luminaire), &scene, index, 2_000);
    }
}
