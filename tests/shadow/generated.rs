//! Rooms of random convex bodies: nothing fails, and the laws hold.

use crate::laws::{Jumps, by_the_kernel, clearance, jumps};
use crate::random::{Random, faces_of_box};
use crate::{assert_sound, lit, places, polygon};
use glam::DVec3;
use isolux_host::plan::shadow::{Class, Mesh, Options, ShadowMap, Tag};
use isolux_host::scene::{Scene, Surface};

/// Rooms.
const SEEDS: u64 = 200;

/// A room of 6 x 4 x 3, a luminaire somewhere, bodies and sheets anywhere: on
/// the floor, in the air, through walls and ceiling, in each other.
fn room(seed: u64) -> Scene {
    let mut random = Random(seed);
    let half = DVec3::new(3.0, 2.0, 1.5);
    let mut surfaces: Vec<Surface> = faces_of_box(half.to_array())
        .into_iter()
        .map(|face| face.into_iter().rev().map(|v| v + DVec3::Z * 1.5).collect())
        .map(|corners| lit::surface(corners, 0.0))
        .collect();
    surfaces.push(luminaire(&mut random));
    for _ in 0..1 + random.below(5) {
        surfaces.extend(body(&mut random, half));
    }
    for _ in 0..random.below(4) {
        let corners = 3 + random.below(3);
        let radius = random.between(0.05, 1.0);
        let turn = random.turn();
        let place = place(&mut random, half);
        let outline = random.outline(corners, radius);
        surfaces.push(lit::surface(
            outline.iter().map(|&v| turn * v + place).collect(),
            0.0,
        ));
    }
    for (number, surface) in surfaces.iter_mut().enumerate() {
        surface.name = format!("s{number}");
        surface.reflectance = [0.5; 3];
    }
    lit::scene(surfaces)
}

/// In the ceiling, hanging, on a wall, down to the floor, tilted.
fn luminaire(random: &mut Random) -> Surface {
    let (x, y) = (random.between(-2.0, 2.0), random.between(-1.0, 1.0));
    let (a, b) = (random.between(0.1, 0.9), random.between(0.1, 0.9));
    let down = |z: f64| {
        let corners = [
            [x - a, y + b, z],
            [x + a, y + b, z],
            [x + a, y - b, z],
            [x - a, y - b, z],
        ];
        polygon("light", &corners, 1.0)
    };
    match random.below(5) {
        0 | 1 => down(3.0),
        2 => down(random.between(1.5, 2.9)),
        3 => {
            let z = if random.below(2) == 0 { 0.0 } else { 0.7 };
            let corners = [
                [-3.0, y, z],
                [-3.0, y + b, z],
                [-3.0, y + b, 2.5],
                [-3.0, y, 2.5],
            ];
            polygon("window", &corners, 1.0)
        }
        _ => {
            let turn = random.turn();
            let corners = 3 + random.below(4);
            let outline = random.outline(corners, 0.6);
            let middle = DVec3::new(x / 2.0, y / 2.0, 1.5);
            lit::surface(outline.iter().map(|&v| turn * v + middle).collect(), 1.0)
        }
    }
}

fn place(random: &mut Random, half: DVec3) -> DVec3 {
    DVec3::new(
        random.between(-half.x, half.x),
        random.between(-half.y, half.y),
        random.between(0.0, 2.0 * half.z),
    )
}

/// A box or a tetrahedron; upright on the floor, or turned anyhow.
fn body(random: &mut Random, half: DVec3) -> Vec<Surface> {
    let size = [(); 3].map(|()| random.between(0.05, 0.8));
    let mut faces = faces_of_box(size);
    if random.below(3) == 0 {
        let corner = |k: usize| random_corner(size, k);
        faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
            .map(|face| face.map(corner).to_vec())
            .to_vec();
    }
    let mut middle = place(random, half);
    let turn = if random.below(2) == 0 {
        middle.z = size[2];
        glam::DMat3::from_rotation_z(random.between(0.0, 3.0))
    } else {
        random.turn()
    };
    let face = |face: Vec<DVec3>| face.iter().map(|&v| turn * v + middle).collect();
    faces
        .into_iter()
        .map(|f| lit::surface(face(f), 0.0))
        .collect()
}

/// Corners of a tetrahedron with its base at the foot of a box.
fn random_corner([x, y, z]: [f64; 3], k: usize) -> DVec3 {
    [
        DVec3::new(-x, -y, -z),
        DVec3::new(x, -y, -z),
        DVec3::new(0.0, y, -z),
        DVec3::new(0.1 * x, 0.0, z),
    ][k]
}

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
