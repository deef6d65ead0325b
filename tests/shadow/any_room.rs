//! Rooms of random convex bodies, sheets and a luminaire.

use crate::random::{Random, faces_of_box};
use crate::{lit, polygon};
use glam::DVec3;
use isolux_host::scene::{Scene, Surface};

/// A room of 6 x 4 x 3, a luminaire somewhere, bodies and sheets anywhere: on
/// the floor, in the air, through walls and ceiling, in each other.
pub(crate) fn room(seed: u64) -> Scene {
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
