//! Outlines known by hand, and copies of scenes.

use crate::{area, map, polygon, read, square};
use glam::{DQuat, DVec2, DVec3};
use isolux_host::plan::shadow::{Class, Kind, Line, Lines, Mesh, Options, ShadowMap};
use isolux_host::scene::{Scene, shipped};

fn is_square(ring: &[[f64; 2]], half: f64) -> bool {
    let corner = |&[u, v]: &[f64; 2]| {
        let near = |x: f64| ((x - 4.0).abs() - half).abs() < 1e-9;
        near(u) && near(v)
    };
    ring.len() >= 4 && ring.iter().all(corner) && (area(ring) - 4.0 * half * half).abs() < 1e-9
}

/// A receiver 8 x 8 below a square luminaire at 4 and a square occluder.
fn stacked(light: f64, occluder: f64, height: f64) -> Scene {
    crate::lit::scene(vec![
        square("receiver", 4.0, 0.0, true, 0.0),
        square("light", light, 4.0, false, 1.0),
        square("occluder", occluder, height, true, 0.0),
    ])
}

/// Light 4 x 4 at 4, occluder 1 x 1 at 1.5: an edge at x = 0.5 seen from x = -2
/// throws its shadow to 0.5 + 1.5/2.5 (0.5 + 2) = 2, from x = 2 to -0.4.
#[test]
fn the_outlines_of_the_penumbra_scene() {
    let map = map(&read(shipped::PENUMBRA), "receiver", "light");
    let [shadow] = &map.shadows[..] else {
        panic!("one shadow: {:?}", map.shadows);
    };
    assert!(is_square(&shadow.outer, 2.0), "{:?}", shadow.outer);
    assert!(is_square(&shadow.antumbra, 0.4), "{:?}", shadow.antumbra);
    assert!(shadow.umbra.is_empty());
    let runs = |line: &Line, at: f64| {
        let along = |axis: usize| {
            line.ends
                .iter()
                .all(|end| ((end[axis] - 4.0).abs() - at).abs() < 1e-9)
        };
        along(0) || along(1)
    };
    for line in &map.lines {
        let at = if line.kind == Kind::Outer { 2.0 } else { 0.4 };
        assert!(runs(line, at), "{line:?}");
        assert_ne!(line.kind, Kind::Umbra);
    }
    let mesh = Mesh::of(&map.floor, &[&map], &bare());
    // The crossings of 0.4 with 2 and 0.4, the corners of 2 and of the surface.
    assert_eq!(mesh.vertices.len(), 12 + 4 + 4);
    assert_eq!(mesh.left_out, 0);
    let free = |value: f64| {
        mesh.free
            .iter()
            .filter(|&&free| free == Some(value))
            .count()
    };
    assert_eq!([free(1.0), free(0.0)], [16, 0]);
}

/// No vertex but where lines meet.
fn bare() -> Options {
    Options {
        slenderness: f64::INFINITY,
        ..Options::default()
    }
}

/// An occluder larger than the luminaire: umbra 1 + 0.6 (1 - 0.5), outer 1 + 0.6
/// (1 + 0.5).
#[test]
fn the_umbra_of_a_large_occluder() {
    let map = map(&stacked(0.5, 1.0, 1.5), "receiver", "light");
    let shadow = &map.shadows[0];
    assert!(is_square(&shadow.umbra, 1.3), "{:?}", shadow.umbra);
    assert!(is_square(&shadow.outer, 1.9), "{:?}", shadow.outer);
    assert!(shadow.antumbra.is_empty());
    assert!(map.lines.iter().any(|line| line.kind == Kind::Umbra));
    assert_eq!(map.class(4.0, 4.0), Class::Umbra);
    assert_eq!(map.class(5.29, 4.0), Class::Umbra);
    assert_eq!(map.class(5.31, 4.0), Class::Penumbra);
    assert_eq!(map.class(5.91, 4.0), Class::Lit);
}

/// What lies in the shadow of something larger has no line, and what cannot
/// come between has none.
#[test]
fn hidden_occluders_draw_no_line() {
    let without = stacked(0.5, 1.0, 1.5);
    let mut with = without.clone();
    with.surfaces.push(square("below", 0.3, 0.5, true, 0.0));
    with.surfaces.push(square("above", 0.3, 5.0, true, 0.0));
    with.surfaces.push(square("beneath", 0.3, -1.0, true, 0.0));
    let [without, with] = [without, with].map(|scene| map(&scene, "receiver", "light"));
    // Strengths differ by the rounding of V.
    let lines = |map: &ShadowMap| -> Vec<(Kind, [[f64; 2]; 2])> {
        map.lines
            .iter()
            .map(|line| (line.kind, line.ends))
            .collect()
    };
    let [mut one, mut other] = [lines(&without), lines(&with)];
    one.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    other.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    assert_eq!(one, other);
    assert_eq!(with.shadows.len(), 2);
}

/// A wall from the floor to above the luminaire, a sheet across the plane of
/// the receiver: shadows without an end, and feet.
#[test]
fn a_wall_higher_than_the_luminaire() {
    let mut scene = stacked(0.5, 0.1, 8.0);
    let wall = [
        [2.0, -1.0, -0.5],
        [2.0, 1.0, -0.5],
        [2.0, 1.0, 6.0],
        [2.0, -1.0, 6.0],
    ];
    scene.surfaces.push(polygon("wall", &wall, 0.0));
    let map = map(&scene, "receiver", "light");
    // The foot from (2, -1) to (2, 1); behind it the umbra between the lines
    // from (-0.5, ±0.5) ... through its ends.
    let [foot] = &map.floor.contacts[..] else {
        panic!("{:?}", map.floor.contacts);
    };
    let mut ends = foot.ends;
    ends.sort_by(|a, b| a[1].total_cmp(&b[1]));
    for (end, known) in ends.iter().zip([[6.0, 3.0], [6.0, 5.0]]) {
        assert!(DVec2::from(*end).distance(known.into()) < 1e-9, "{foot:?}");
    }
    assert_eq!(map.class(5.9, 4.0), Class::Lit);
    assert_eq!(map.class(6.1, 4.0), Class::Umbra);
    assert_eq!(map.class(7.9, 4.0), Class::Umbra);
    // From (-0.5, -0.5) through (2, 1): 1 + 2 (1.5 / 2.5) at x = 4, outside; from
    // (0.5, -0.5): 1 + 1.9 (1.5 / 1.5) at x = 3.9; from (0.5, 0.5): 1 + 1.9 / 3.
    let least = 4.0 + 1.0 + 1.9 * 0.5 / 2.5;
    let most = 4.0 + 1.0 + 1.9;
    assert_eq!(map.class(7.9, least - 0.01), Class::Umbra);
    assert_eq!(map.class(7.9, least + 0.01), Class::Penumbra);
    assert_eq!(map.class(7.9, most - 0.01), Class::Penumbra);
    assert_eq!(map.class(7.9, most + 0.01), Class::Lit);
    let named = |kind: Kind| map.lines.iter().filter(move |line| line.kind == kind);
    assert!(named(Kind::Umbra).count() >= 2 && named(Kind::Outer).count() >= 2);
}

/// A luminaire that looks sideways: no light behind its plane.
#[test]
fn a_horizon_across_the_receiver() {
    let mut scene = stacked(0.5, 0.1, 8.0);
    let corners = [
        [1.0, -1.0, 1.0],
        [1.0, -1.0, 2.0],
        [1.0, 1.0, 2.0],
        [1.0, 1.0, 1.0],
    ];
    scene.surfaces[1] = polygon("light", &corners, 1.0);
    let map = map(&scene, "receiver", "light");
    assert_eq!(map.class(5.1, 4.0), Class::Behind);
    assert_eq!(map.class(4.9, 4.0), Class::Lit);
    let [horizon] = &map.lines[..] else {
        panic!("{:?}", map.lines);
    };
    assert_eq!(horizon.kind, Kind::Horizon);
    assert!(horizon.ends.iter().all(|end| (end[0] - 5.0).abs() < 1e-9));
}

fn turned(scene: &Scene, turn: DQuat, shift: DVec3) -> Scene {
    let mut scene = scene.clone();
    for surface in &mut scene.surfaces {
        surface.normal = turn * surface.normal;
        for vertex in &mut surface.vertices {
            *vertex = turn * *vertex + shift;
        }
    }
    scene
}

#[test]
fn copies_have_the_same_lines() {
    for (text, receiver) in [
        (shipped::PENUMBRA, "receiver"),
        (shipped::CORNELL, "floor"),
        (shipped::CORNELL, "back"),
    ] {
        let scene = read(text);
        let original = map(&scene, receiver, "light");
        for (axis, angle) in [(DVec3::X, 0.7), (DVec3::new(0.6, 0.0, 0.8), 2.1)] {
            let copy = turned(
                &scene,
                DQuat::from_axis_angle(axis, angle),
                DVec3::new(1.0, -2.0, 0.5),
            );
            let copy = map(&copy, receiver, "light");
            assert_same(&original, &copy);
        }
    }
}

fn assert_same(one: &ShadowMap, other: &ShadowMap) {
    assert_eq!(one.shadows.len(), other.shadows.len());
    for (a, b) in one.shadows.iter().zip(&other.shadows) {
        for (a, b) in [
            (&a.outer, &b.outer),
            (&a.umbra, &b.umbra),
            (&a.antumbra, &b.antumbra),
        ] {
            assert!((area(a) - area(b)).abs() < 1e-6, "{a:?} {b:?}");
        }
    }
    for place in crate::places(one, 500, 3) {
        let [a, b] = [one, other].map(|map| map.fraction(place.x, place.y).expect("light"));
        assert!((a - b).abs() < 1e-6, "{place}: {a} {b}");
    }
    let length = |map: &ShadowMap, kind: Kind| -> f64 {
        let lines = map.lines.iter().filter(|line| line.kind == kind);
        lines
            .map(|line| DVec2::from(line.ends[0]).distance(line.ends[1].into()))
            .sum()
    };
    for kind in [
        Kind::Outer,
        Kind::Umbra,
        Kind::Antumbra,
        Kind::Event,
        Kind::Overlap,
    ] {
        let [a, b] = [one, other].map(|map| length(map, kind));
        assert!((a - b).abs() < 1e-4, "{kind:?}: {a} {b}");
    }
    let tagged = |map: &ShadowMap| {
        let mesh = Mesh::of(
            &map.floor,
            &[map],
            &Options {
                lines: Lines::All,
                ..bare()
            },
        );
        let mut areas = [0.0; 5];
        for (number, &tag) in mesh.tags.iter().enumerate() {
            let [a, b, c] = mesh.corners(number);
            areas[tag as usize] += (b - a).perp_dot(c - a) / 2.0;
        }
        areas
    };
    for (a, b) in tagged(one).into_iter().zip(tagged(other)) {
        assert!((a - b).abs() < 1e-4, "{a} {b}");
    }
}
