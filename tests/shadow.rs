//! Shadow outlines and the meshes that follow them: known outlines, brute
//! force, laws, generated rooms.

#[path = "shadow/any_room.rs"]
mod any_room;
#[path = "shadow/brute.rs"]
mod brute;
#[path = "shadow/generated.rs"]
mod generated;
#[path = "shadow/known.rs"]
mod known;
#[path = "shadow/laws.rs"]
mod laws;
#[path = "visibility/lit.rs"]
#[allow(dead_code, reason = "the tests of visibility use the rest")]
mod lit;
#[path = "shadow/meshes.rs"]
mod meshes;
#[path = "visibility/random.rs"]
#[allow(dead_code, reason = "the tests of visibility use the rest")]
mod random;

use glam::{DVec2, DVec3};
use isolux_host::plan::shadow::{Kind, Mesh, ShadowMap, Tag};
use isolux_host::scene::{Scene, Surface, file, shipped};
use std::collections::BTreeMap;

/// A shipped scene.
pub(crate) fn read(text: &str) -> Scene {
    file::parse("scene.toml", text).expect("a sound scene")
}

pub(crate) fn cornell() -> Scene {
    read(shipped::CORNELL)
}

/// The map of a named surface for a named luminaire.
pub(crate) fn map(scene: &Scene, receiver: &str, luminaire: &str) -> ShadowMap {
    let [receiver, luminaire] =
        [receiver, luminaire].map(|name| scene.surface_named(name).expect("a surface"));
    ShadowMap::of(scene, receiver, luminaire).expect("a map")
}

/// A polygon through these corners.
pub(crate) fn polygon(name: &str, corners: &[[f64; 3]], radiance: f64) -> Surface {
    let corners = corners.iter().map(|&corner| DVec3::from(corner)).collect();
    Surface {
        name: name.to_owned(),
        ..lit::surface(corners, radiance)
    }
}

/// A square about (0, 0), facing up or down.
pub(crate) fn square(name: &str, half: f64, z: f64, up: bool, radiance: f64) -> Surface {
    let mut corners = [
        [-half, -half, z],
        [half, -half, z],
        [half, half, z],
        [-half, half, z],
    ];
    if !up {
        corners.reverse();
    }
    polygon(name, &corners, radiance)
}

/// Places spread over a map's surface where it is exposed.
pub(crate) fn places(map: &ShadowMap, count: usize, seed: u64) -> Vec<DVec2> {
    let frame = &map.floor.frame;
    let mut random = random::Random(seed);
    let mut places = Vec::with_capacity(count);
    while places.len() < count {
        let place = DVec2::new(random.unit() * frame.size_u, random.unit() * frame.size_v);
        if frame.contains(place.x, place.y) && !map.floor.covers.iter().any(|c| encloses(c, place))
        {
            places.push(place);
        }
    }
    places
}

/// Whether a ring contains a place, by its winding.
pub(crate) fn encloses(ring: &[[f64; 2]], place: DVec2) -> bool {
    let offset = |k: usize| DVec2::from(ring[k % ring.len()]) - place;
    let turn = |k: usize| offset(k).angle_to(offset(k + 1));
    (0..ring.len()).map(turn).sum::<f64>().abs() > 3.0
}

/// The area of a ring.
pub(crate) fn area(ring: &[[f64; 2]]) -> f64 {
    let term = |k: usize| {
        let ([a, b], [c, d]) = (ring[k], ring[(k + 1) % ring.len()]);
        a * d - b * c
    };
    (0..ring.len()).map(term).sum::<f64>() / 2.0
}

/// Holds a mesh to what every mesh promises; says what area it has.
pub(crate) fn assert_sound(mesh: &Mesh, what: &str) -> f64 {
    let count = mesh.triangles.len();
    assert_eq!([mesh.tags.len(), mesh.contact.len()], [count; 2], "{what}");
    assert_eq!(mesh.free.len(), mesh.vertices.len(), "{what}");
    let mut sides = BTreeMap::new();
    for (number, &[a, b, c]) in mesh.triangles.iter().enumerate() {
        let [p, q, r] = mesh.corners(number);
        assert!(
            (q - p).perp_dot(r - p) > 0.0,
            "{what}: triangle {number} is turned"
        );
        for side in [[a, b], [b, c], [c, a]] {
            let twice = sides.insert(side, number);
            assert_eq!(
                twice, None,
                "{what}: side {side:?} has two triangles on its left"
            );
        }
    }
    for border in &mesh.borders {
        let [a, b] = border.ends;
        let beside = [[a, b], [b, a]].map(|side| sides.contains_key(&side));
        assert!(beside[0] || beside[1], "{what}: a border of no triangle");
    }
    let bordering: BTreeMap<[usize; 2], Kind> = mesh
        .borders
        .iter()
        .map(|border| (border.ends, border.kind))
        .collect();
    for &[a, b] in sides.keys() {
        if !sides.contains_key(&[b, a]) {
            let kind = bordering.get(&[a.min(b), a.max(b)]);
            let outside = matches!(kind, Some(Kind::Boundary | Kind::Contact));
            assert!(
                outside,
                "{what}: side {a} {b} has nothing beyond and is {kind:?}"
            );
        }
    }
    mesh.area()
}

/// Whether a tag says that V is the same all over the triangle.
pub(crate) fn is_constant(tag: Tag) -> bool {
    matches!(tag, Tag::Lit | Tag::Umbra | Tag::Behind)
}
