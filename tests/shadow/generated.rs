//! Rooms of random convex bodies: nothing fails, and the laws hold.

use crate::any_room::room;
use crate::laws::{Jumps, by_the_kernel, clearance, jumps};
use crate::random::Random;
use crate::{assert_sound, lit, places};
use glam::DVec3;
use isolux_host::plan::shadow::{Class, Mesh, Options, ShadowMap, Tag};

/// Rooms.
const SEEDS: u64 = 200;

fn options() -> Options {
    Options {
        triangles: 800,
        longest: 1.0,
        ..Options::default()
    }
}

#[test]
fn rooms_of_random_bodies_have_sound_meshes() {
    let (mut lines, mut left_out, mut triangles) = (0, 0, 0);
    for seed in 0..SEEDS {
        let scene = room(seed);
        // The floor, a wall, a face of the first body.
        for receiver in [0, 2, 8] {
            let what = format!("seed {seed}, receiver {receiver}");
            let map = ShadowMap::of(&scene, receiver, 6).expect("a map");
            let mesh = Mesh::of(&map.floor, &[&map], &options());
            assert_sound(&mesh, &what);
            assert!(mesh.triangles.len() <= 800, "{what}");
            lines += map.lines.len();
            left_out += mesh.left_out;
            triangles += mesh.triangles.len();
            if receiver == 0 {
                agree(&map, &mesh, &what);
            }
        }
    }
    assert!(
        left_out * 100 <= lines,
        "{left_out} of {lines} lines left out"
    );
    assert!(triangles > 0);
}

/// The lines are all there: V curves anew nowhere else, but for the curved
/// events of three edges where occluders crowd.
#[test]
fn lines_of_random_rooms_are_complete() {
    let mut all = Jumps::default();
    for seed in 0..60 {
        let map = ShadowMap::of(&room(seed), 0, 6).expect("a map");
        let found = jumps(&map, 10, seed);
        assert_eq!(found.missing, 0, "seed {seed}");
        all.add(&found);
    }
    let Jumps { on, curved, .. } = all;
    println!("{on} jumps on lines, {curved} on curves");
    assert!(
        on > 300 && curved * 10 <= on,
        "{on} on lines, {curved} on curves"
    );
}

/// The kernel, which reads closed bodies as silhouettes, sees the same.
#[test]
fn the_kernel_sees_random_rooms_alike() {
    for seed in 0..SEEDS {
        let scene = room(seed);
        let map = ShadowMap::of(&scene, 0, 6).expect("a map");
        let lit = lit::Lit::new(&scene);
        for place in places(&map, 30, seed) {
            if clearance(&map, place) < 1e-3 {
                continue;
            }
            let known = map.fraction(place.x, place.y);
            let other = by_the_kernel(&lit, &map, place);
            let off = known.unwrap_or(0.0) - other.unwrap_or(0.0);
            assert!(off.abs() < 1e-4, "seed {seed} {place}: {known:?} {other:?}");
        }
    }
}

/// Triangles of one tag see one thing, but for what curved events and lines left
/// out hide in them.
fn agree(map: &ShadowMap, mesh: &Mesh, what: &str) {
    let mut wrong = 0;
    for place in places(map, 200, 1) {
        let Some((triangle, _)) = mesh.locate(place.x, place.y) else {
            panic!("{what}: {place} is in no triangle");
        };
        let class = map.class(place.x, place.y);
        let fraction = map.fraction(place.x, place.y);
        let right = match mesh.tags[triangle] {
            Tag::Lit => class == Class::Lit,
            Tag::Umbra => class == Class::Umbra,
            Tag::Behind => class == Class::Behind,
            _ => true,
        };
        assert_eq!(fraction.is_none(), class == Class::Behind);
        wrong += usize::from(!right);
    }
    assert!(wrong <= 2, "{what}: {wrong} of 200 places");
}

/// Dozens of occluders, all in one another's way.
#[test]
fn a_crowd_of_occluders() {
    let mut random = Random(99);
    let mut surfaces = vec![
        crate::square("floor", 3.0, 0.0, true, 0.0),
        crate::square("light", 0.5, 3.0, false, 1.0),
    ];
    for _ in 0..30 {
        let turn = random.turn();
        let place = DVec3::new(
            random.between(-1.5, 1.5),
            random.between(-1.5, 1.5),
            random.between(0.5, 2.5),
        );
        let outline = random.outline(4, 0.3);
        surfaces.push(lit::surface(
            outline.iter().map(|&v| turn * v + place).collect(),
            0.0,
        ));
    }
    let scene = lit::scene(surfaces);
    let map = ShadowMap::of(&scene, 0, 1).expect("a map");
    let mesh = Mesh::of(&map.floor, &[&map], &options());
    let found = assert_sound(&mesh, "a crowd");
    assert!((found - 36.0).abs() < 1e-9, "{found}");
    assert!(mesh.triangles.len() <= 800 && mesh.left_out > 0);
}
