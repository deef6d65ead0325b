//! Reflected light in rooms.

use std::f64::consts::PI;

use glam::{DQuat, DVec3};
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::{Scene, file, shipped};
use serde_json::Value;

use crate::fixtures::{Polygon, number, over_polygon, room, scene, surface, triple, vector};

/// Two meshes, whatever they differ by.
const ROUGHLY: f64 = 1.0;

fn rough(scene: &Scene, reflections: Reflections) -> Reference {
    Reference::to_within(scene, reflections, ROUGHLY, &mut |_| {}).expect("a reference")
}

/// Judged as the files ask: to three standard errors and 0.1 %.
fn totals(source: &str, text: &str, unit: f64) {
    let scene = file::parse("a shipped scene", source).expect("sound");
    let judge = rough(&scene, Reflections::UntilUnshot(1e-5));
    let file: Value = serde_json::from_str(text).expect("a file");
    let points = file["points"].as_array().expect("points");
    let places: Vec<(DVec3, DVec3)> = points
        .iter()
        .map(|point| (vector(&point["p"]), vector(&point["n"])))
        .collect();
    let (mut within, mut squares, mut worst) = (0, 0.0, 0.0_f64);
    for (point, value) in points.iter().zip(judge.light_at(&places)) {
        let (total, sigma) = (triple(&point["E_total"]), triple(&point["u_total"]));
        let error = |c: usize| value[c] / (unit * total[c]) - 1.0;
        let good = |c: usize| error(c).abs() <= 1e-3 + 3.0 * sigma[c] / total[c];
        within += usize::from((0..3).all(good));
        squares += (0..3).map(|c| error(c).powi(2)).sum::<f64>() / 3.0;
        worst = (0..3).map(|c| error(c).abs()).fold(worst, f64::max);
    }
    let rms = (squares / points.len() as f64).sqrt();
    println!(
        "{}: {within} of {} within, rms {:.3} %, worst {:.3} %, meshes differ by {:.3} %",
        file["name"],
        points.len(),
        100.0 * rms,
        100.0 * worst,
        100.0 * judge.accuracy()
    );
    assert!(within + 1 >= points.len() && rms <= 1.5e-3 && worst <= 1e-2);
}

#[test]
fn the_grey_box_has_the_light_of_path_tracing() {
    totals(
        shipped::CORNELL,
        include_str!("../data/references/c_cornell_grey.json"),
        1.0,
    );
}

#[test]
fn the_coloured_box_has_the_light_of_path_tracing() {
    totals(
        shipped::CORNELL_RGB,
        include_str!("../data/references/c_cornell_rgb.json"),
        1.0,
    );
}

/// The file's luminaires have a radiance of 20, ours a luminance of 4000.
#[test]
fn the_office_has_the_light_of_path_tracing() {
    totals(
        shipped::OFFICE,
        include_str!("../data/references/e_office.json"),
        200.0,
    );
}

#[test]
fn the_desk_of_the_office_has_500_lx() {
    let office = file::parse("office.toml", shipped::OFFICE).expect("sound");
    let judge = rough(&office, Reflections::UntilUnshot(1e-3));
    assert_eq!(office.points.len(), 4);
    for point in &office.points {
        let lux = judge.irradiance(point.position, point.normal);
        println!("{}: {lux:.1} lx", point.name);
        assert!(lux > 500.0 && lux < 700.0);
    }
}

/// A room with a panel in its ceiling and a block on its floor.
fn furnished() -> Scene {
    let mut surfaces: Vec<_> = room(DVec3::new(4.0, 3.0, 2.5))
        .iter()
        .enumerate()
        .map(|(index, face)| surface(&format!("wall {index}"), face.clone(), 0.5, 0.0))
        .collect();
    let panel = [[1.0, 1.0], [1.0, 2.0], [2.5, 2.0], [2.5, 1.0]];
    let panel: Polygon = panel.map(|[x, y]| DVec3::new(x, y, 2.5)).to_vec();
    surfaces.push(surface("panel", panel, 0.0, 10.0));
    // The box inside out, turned a little, without its base.
    let turn = DQuat::from_rotation_z(0.4);
    for (index, face) in room(DVec3::new(0.8, 0.9, 1.2)).iter().enumerate().skip(1) {
        let outward = face
            .iter()
            .rev()
            .map(|v| turn * *v + DVec3::new(2.6, 0.7, 0.0));
        surfaces.push(surface(
            &format!("block {index}"),
            outward.collect(),
            0.7,
            0.0,
        ));
    }
    scene(surfaces)
}

/// What the surfaces absorb and what is unshot is what the panel emits. Light
/// that meets the ceiling where the panel covers it meets the black panel.
#[test]
fn a_closed_room_keeps_its_energy() {
    let scene = furnished();
    let fraction = 1e-4;
    let judge = rough(&scene, Reflections::UntilUnshot(fraction));
    let emitted = PI * 10.0 * scene.surfaces[6].area;
    let mut absorbed = 0.0;
    for surface in &scene.surfaces {
        let received = over_polygon(&surface.vertices, 8, &mut |y| {
            judge.irradiance(y, surface.normal)
        });
        // The panel takes what the ceiling behind it is counted to reflect.
        let share = match surface.name.as_str() {
            "panel" => scene.surfaces[1].reflectance[0],
            _ => 1.0 - surface.reflectance[0],
        };
        absorbed += share * received;
    }
    let left = 1.0 - absorbed / emitted;
    println!(
        "left: {left:.1e}, meshes differ by {:.1e}",
        judge.accuracy()
    );
    // The sums over the surfaces, across shadow borders, are good to 1e-3.
    assert!(left.abs() <= 2e-3 + fraction, "{left:e}");
}

/// Each generation adds something, and from the second on less than the one before.
#[test]
fn generations_add_up() {
    let scene = furnished();
    let place = (DVec3::new(3.9, 2.0, 0.0), DVec3::Z);
    let mut before = 0.0;
    let mut gains = Vec::new();
    for count in 0..6 {
        let judge = rough(&scene, Reflections::AtMost(count));
        assert_eq!(judge.reflections(), count);
        let value = judge.irradiance(place.0, place.1);
        gains.push(value - before);
        before = value;
    }
    println!("{gains:?}");
    for pair in gains[1..].windows(2) {
        assert!(pair[1] > 0.0 && pair[1] < pair[0], "{gains:?}");
    }
}

#[test]
fn a_turned_and_scaled_room_has_the_same_light() {
    let one = furnished();
    let turn = DQuat::from_axis_angle(DVec3::new(-0.5, 0.3, 0.8).normalize(), 2.1);
    let place = |v: DVec3| 30.0 * (turn * v + DVec3::new(1.0, 5.0, -2.0));
    let mut other = one.clone();
    for surface in &mut other.surfaces {
        surface.vertices = surface.vertices.iter().map(|v| place(*v)).collect();
        surface.normal = turn * surface.normal;
        surface.area *= 900.0;
    }
    let straight = rough(&one, Reflections::AtMost(3));
    let turned = rough(&other, Reflections::AtMost(3));
    for surface in &one.surfaces[..6] {
        let corner = surface.vertices[0];
        for (u, v) in [(0.31, 0.47), (0.02, 0.93), (0.77, 0.05)] {
            let (along, across) = (surface.vertices[1] - corner, surface.vertices[3] - corner);
            let p = corner + along * u + across * v;
            let expected = straight.irradiance(p, surface.normal);
            let value = turned.irradiance(place(p), turn * surface.normal);
            // Cells may be halved in another order.
            assert!(
                (value / expected - 1.0).abs() < 2e-3,
                "{p} {value} {expected}"
            );
        }
    }
}

/// A floor and a wall with a screen between them.
fn screened() -> Scene {
    let quad = |corners: [[f64; 3]; 4]| corners.map(DVec3::from).to_vec();
    scene(vec![
        surface(
            "floor",
            quad([[0., 0., 0.], [3., 0., 0.], [3., 2., 0.], [0., 2., 0.]]),
            0.6,
            0.0,
        ),
        surface(
            "wall",
            quad([[0., 0., 0.], [0., 2., 0.], [0., 2., 2.], [0., 0., 2.]]),
            0.4,
            0.0,
        ),
        surface(
            "screen",
            quad([[1., 0.5, 0.], [1., 1.5, 0.], [1., 1.5, 1.], [1., 0.5, 1.]]),
            0.0,
            0.0,
        ),
        surface(
            "light",
            quad([
                [1.5, 0.5, 2.],
                [1.5, 1.5, 2.],
                [2.5, 1.5, 2.],
                [2.5, 0.5, 2.],
            ]),
            0.0,
            5.0,
        ),
    ])
}

#[test]
fn solutions_are_kept_and_damaged_ones_written_anew() {
    let directory = tempfile::tempdir().expect("a directory");
    let scene = screened();
    let points: Vec<(DVec3, DVec3)> = (0..40)
        .map(|k| (DVec3::new(0.07 * f64::from(k) + 0.01, 1.1, 0.0), DVec3::Z))
        .collect();
    let solve = |reflections| {
        let mut told = 0;
        let judge = Reference::kept_in(directory.path(), &scene, reflections, &mut |_| told += 1);
        (judge.expect("a reference").irradiance_at(&points), told)
    };
    let kept = || {
        let files = std::fs::read_dir(directory.path()).expect("a directory");
        let mut files: Vec<_> = files.map(|file| file.expect("a file").path()).collect();
        files.sort();
        files
    };
    assert_eq!(kept().len(), 0);
    let (first, work) = solve(Reflections::AtMost(2));
    let (second, rest) = solve(Reflections::AtMost(2));
    assert_eq!(first, second);
    assert!(
        rest < work,
        "found, not solved: told {rest} times after {work}"
    );
    let [path] = &kept()[..] else {
        panic!("one file: {:?}", kept());
    };
    let whole = std::fs::read(path).expect("a file");
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 1;
    for damaged in [&whole[..whole.len() / 2], &flipped, b"", b"{}\n{}"] {
        std::fs::write(path, damaged).expect("written");
        assert_eq!(solve(Reflections::AtMost(2)).0, first);
        assert_eq!(std::fs::read(path).expect("a file"), whole);
    }
    assert_ne!(solve(Reflections::AtMost(3)).0, first);
    assert_eq!(kept().len(), 2);
}

#[test]
fn dark_scenes_are_dark() {
    let mut scene = furnished();
    scene.surfaces[6].radiance = [0.0; 3];
    let judge = rough(&scene, Reflections::UntilUnshot(1e-3));
    assert_eq!(judge.light(DVec3::new(1.0, 1.0, 0.0), DVec3::Z), [0.0; 3]);
    assert_eq!(judge.reflections(), 0);
    assert_eq!(number(&serde_json::json!(judge.accuracy())), 1e-9);
}
