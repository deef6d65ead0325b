//! What a scene requires.

use glam::{DQuat, DVec3};
use isolux_host::scene::camera::Caster;
use isolux_host::scene::frame::Frame;
use isolux_host::scene::requires::{Blocked, Receiver, requirements};
use isolux_host::scene::{Scene, shipped};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use serde_json::Value;

use crate::{HEAD, Polygon, accepted, faces, place, reference_text, scene_of, star};

fn polygon(name: &str, vertices: &[[f64; 3]], rho: f64, radiance: f64) -> Polygon {
    let vertices = vertices.iter().map(|&v| v.into()).collect();
    (name.to_owned(), vertices, rho, radiance)
}

/// A horizontal square of half width `half` about (x, y) at height z.
fn square(name: &str, [x, y, z]: [f64; 3], half: f64, up: bool, radiance: f64) -> Polygon {
    let mut vertices = vec![
        [x - half, y - half, z],
        [x + half, y - half, z],
        [x + half, y + half, z],
        [x - half, y + half, z],
    ];
    if !up {
        vertices.reverse();
    }
    polygon(name, &vertices, 0.5, radiance)
}

fn reference(name: &str) -> Scene {
    let json: Value = serde_json::from_str(&reference_text(name)).expect("JSON");
    let mut text = HEAD.to_owned();
    for polygon in json["polygons"].as_array().expect("polygons") {
        text += &format!(
            "[[surface]]\nname = {}\nvertices = {}\nreflectance = {}\nradiance = {}\n",
            polygon["name"], polygon["vertices"], polygon["reflectance"], polygon["emission"]
        );
    }
    accepted(&text)
}

/// The names of a blocked pair and of what comes between.
fn blocked_names(scene: &Scene) -> Option<[&str; 3]> {
    let name = |index: usize| scene.surfaces[index].name.as_str();
    requirements(scene)
        .visibility
        .map(|Blocked { from, to, by }| {
            let to = match to {
                Receiver::Surface(index) => name(index),
                Receiver::Point(index) => &scene.points[index].name,
            };
            [name(from), to, name(by)]
        })
}

#[test]
fn paper_scenes_and_convex_rooms_need_no_visibility() {
    for (name, text) in [
        ("paper", shipped::PAPER),
        ("paper-aspect", shipped::PAPER_ASPECT),
    ] {
        let scene = accepted(text);
        let requirements = requirements(&scene);
        assert_eq!(requirements.visibility, None, "{name}");
        assert_eq!(requirements.channels, 1);
        assert_eq!(requirements.channels_because, None);
        assert_eq!(requirements.luminaires, [1]);
        assert_eq!(requirements.reflectors, [0, 2]);
        assert!(requirements.concave.is_empty());
        let needs = requirements.needs(&scene);
        let what: Vec<&str> = needs.iter().map(|need| need.what.as_str()).collect();
        assert_eq!(what, ["direct light", "reflected light"]);
        assert!(needs[1].why.contains("`A` and `B`"), "{needs:?}");
    }
    let (low, high) = (DVec3::new(-1.0, 2.0, 0.5), DVec3::new(4.0, 5.0, 3.0));
    for turn in [
        DQuat::IDENTITY,
        DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.7),
    ] {
        let room = scene_of(&faces("room", low, high, true, turn), "");
        assert_eq!(blocked_names(&room), None);
    }
}

#[test]
fn shipped_rooms_need_visibility_and_only_the_coloured_one_three_channels() {
    for (text, channels, bodies, luminaires) in [
        (shipped::PENUMBRA, 1, 0, 1),
        (shipped::CORNELL, 1, 2, 1),
        (shipped::CORNELL_RGB, 3, 2, 1),
        (shipped::OFFICE, 1, 3, 4),
    ] {
        let scene = accepted(text);
        let requirements = requirements(&scene);
        assert!(requirements.visibility.is_some(), "{}", scene.name);
        assert_eq!(requirements.channels, channels, "{}", scene.name);
        assert_eq!(requirements.bodies, bodies, "{}", scene.name);
        assert_eq!(requirements.luminaires.len(), luminaires, "{}", scene.name);
        assert!(requirements.concave.is_empty(), "{}", scene.name);
    }
}

#[test]
fn reference_scenes_with_occluders_need_visibility() {
    for name in [
        "d_penumbra_h0.5",
        "d_penumbra_h1",
        "d_penumbra_h1.5",
        "d_penumbra_h2",
    ] {
        let scene = reference(name);
        assert_eq!(
            blocked_names(&scene),
            Some(["light", "receiver", "occluder"]),
            "{name}"
        );
    }
    for name in ["c_cornell_grey", "c_cornell_rgb", "e_office"] {
        let scene = reference(name);
        let requirements = requirements(&scene);
        assert!(requirements.visibility.is_some(), "{name}");
        let rgb = name == "c_cornell_rgb";
        assert_eq!(requirements.channels, if rgb { 3 } else { 1 });
        assert_eq!(requirements.channels_because, rgb.then_some(0));
    }
    for name in ["b_simple_3x3", "b_simple_4.4497x2.0226"] {
        assert_eq!(blocked_names(&reference(name)), None, "{name}");
    }
}

#[test]
fn only_what_lies_between_requires_visibility() {
    let light = || square("light", [0.0, 0.0, 3.0], 1.0, false, 5.0);
    let floor = || square("floor", [0.0, 0.0, 0.0], 2.0, true, 0.0);
    let with = |other| {
        blocked_names(&scene_of(&[light(), floor(), other], "")).map(|names| names[2].to_owned())
    };
    let black = |z: f64, x: f64| {
        let (name, vertices, _, _) = square("other", [x, 0.0, z], 0.25, true, 0.0);
        (name, vertices, 0.0, 0.0)
    };
    assert_eq!(with(black(1.0, 0.0)).as_deref(), Some("other"));
    assert_eq!(with(black(4.0, 0.0)), None, "behind the light");
    assert_eq!(with(black(3.0, 1.25)), None, "in the light's plane");
    assert_eq!(with(black(0.0, 1.0)), None, "lying on the floor");
    assert_eq!(
        with(black(2e-6, 1.0)),
        None,
        "lying on the floor but for rounding"
    );
    let mut under = black(-1.0, 0.0);
    assert_eq!(
        with(under.clone()).as_deref(),
        Some("floor"),
        "the floor shades it"
    );
    under.1.reverse();
    assert_eq!(with(under), None, "under the floor, looking down");
    assert_eq!(with(black(1.5, 3.0)), None, "beside every line of sight");
    assert_eq!(
        with(black(1.5, 1.74)).as_deref(),
        Some("other"),
        "just inside of them"
    );
    assert_eq!(with(black(1.5, 1.75)), None, "just touching them");
    let wall = polygon(
        "other",
        &[
            [2.0, -2.0, 0.0],
            [2.0, 2.0, 0.0],
            [2.0, 2.0, 3.0],
            [2.0, -2.0, 3.0],
        ],
        0.0,
        0.0,
    );
    assert_eq!(with(wall), None, "a wall at the floor's end");
    // Nothing sends light to where the blocker is.
    let dark = [
        floor(),
        square("shelf", [0.0, 0.0, 1.0], 1.0, false, 0.0),
        black(0.5, 0.0),
    ];
    let dark = dark.map(|(name, vertices, _, _)| (name, vertices, 0.0, 0.0));
    assert_eq!(blocked_names(&scene_of(&dark, "")), None);
}

#[test]
fn rooms_that_are_not_convex_need_visibility() {
    let whole = DQuat::IDENTITY;
    let mut room = faces("room", DVec3::ZERO, DVec3::splat(3.0), true, whole);
    room.extend(
        faces(
            "block",
            DVec3::new(1.0, 1.0, 0.0),
            DVec3::new(2.0, 2.0, 1.0),
            false,
            whole,
        )
        .into_iter()
        .skip(1),
    );
    assert!(blocked_names(&scene_of(&room, "")).expect("a block")[2].starts_with("block"));
    // An L-shaped room: its inner corner hides one wing from the other.
    let outline = [
        [0.0, 0.0],
        [2.0, 0.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [0.0, 2.0],
    ];
    let at = |z: f64| outline.map(|[x, y]| [x, y, z]);
    let mut ceiling = at(1.0);
    ceiling.reverse();
    let mut room = vec![
        polygon("floor", &at(0.0), 0.5, 0.0),
        polygon("ceiling", &ceiling, 0.5, 1.0),
    ];
    for i in 0..6 {
        let ([a, b], [c, d]) = (outline[i], outline[(i + 1) % 6]);
        let wall = [[c, d, 0.0], [a, b, 0.0], [a, b, 1.0], [c, d, 1.0]];
        room.push(polygon(&format!("wall-{i}"), &wall, 0.5, 0.0));
    }
    let scene = scene_of(&room, "");
    let by = blocked_names(&scene).expect("an inner corner")[2];
    assert!(by == "wall-2" || by == "wall-3", "{by}");
    assert_eq!(requirements(&scene).concave, [0, 1]);
}

#[test]
fn named_points_receive_light_too() {
    let light = square("light", [0.0, 0.0, 3.0], 1.0, false, 5.0);
    let shelf = polygon(
        "shelf",
        &[
            [-0.2, -0.2, 1.0],
            [0.2, -0.2, 1.0],
            [0.2, 0.2, 1.0],
            [-0.2, 0.2, 1.0],
        ],
        0.0,
        0.0,
    );
    let point = |z: f64, up: f64| {
        format!("[[point]]\nname = \"desk\"\nposition = [0, 0, {z}]\nnormal = [0, 0, {up}]\n")
    };
    let names = |more: &str| {
        let scene = scene_of(&[light.clone(), shelf.clone()], more);
        blocked_names(&scene).map(|names| names.map(str::to_owned))
    };
    assert_eq!(names(""), None);
    assert_eq!(
        names(&point(0.5, 1.0)),
        Some(["light", "desk", "shelf"].map(str::to_owned))
    );
    assert_eq!(names(&point(0.5, -1.0)), None, "it faces away");
    assert_eq!(names(&point(1.0, 1.0)), None, "it lies on the shelf");
    assert_eq!(names(&point(2.0, 1.0)), None, "it hangs above the shelf");
}

#[test]
fn a_hundred_surfaces_are_judged_in_time() {
    // A convex room of 100 walls: no surface found, so no early exit.
    let corner = |i: usize, z: f64| {
        let angle = i as f64 * std::f64::consts::TAU / 98.0;
        [5.0 * angle.cos(), 5.0 * angle.sin(), z]
    };
    let mut room: Vec<_> = (0..98)
        .map(|i| {
            let wall = [
                corner(i + 1, 0.0),
                corner(i, 0.0),
                corner(i, 3.0),
                corner(i + 1, 3.0),
            ];
            polygon(&format!("wall-{i}"), &wall, 0.5, 0.0)
        })
        .collect();
    let floor: Vec<_> = (0..98).map(|i| corner(i, 0.0)).collect();
    let ceiling: Vec<_> = (0..98).rev().map(|i| corner(i, 3.0)).collect();
    room.push(polygon("floor", &floor, 0.5, 0.0));
    room.push(polygon("ceiling", &ceiling, 0.5, 1.0));
    let scene = scene_of(&room, "");
    let start = std::time::Instant::now();
    assert_eq!(blocked_names(&scene), None);
    assert!(start.elapsed().as_secs_f64() < 2.0, "{:?}", start.elapsed());
}

/// Whether a line of sight between grids of 12 x 12 places on `from` and
/// another surface meets the third on its way.
fn sampled_block(scene: &Scene) -> bool {
    let caster = Caster::new(scene);
    let grid = |surface: usize| -> Vec<DVec3> {
        let frame = Frame::new(&scene.surfaces[surface]);
        (0..144)
            .map(|i| frame.cell_center(i % 12, i / 12, 12, 12))
            .filter(|&(u, v)| frame.contains(u, v))
            .map(|(u, v)| frame.to_world(u, v))
            .collect()
    };
    let sees = |to: usize, by: usize, p: DVec3, q: DVec3| {
        let faces = scene.surfaces[0].height_of(q) > 1e-3 && scene.surfaces[to].height_of(p) > 1e-3;
        faces
            && caster.nearest(p, (q - p).normalize()).is_some_and(|hit| {
                hit.surface == by && hit.position.distance(p) < q.distance(p) - 1e-3
            })
    };
    [(1, 2), (2, 1)].into_iter().any(|(to, by)| {
        let (places, origins) = (grid(to), grid(0));
        places
            .iter()
            .any(|&q| origins.iter().any(|&p| sees(to, by, p, q)))
    })
}

/// A light, a black receiver and a black third polygon near each other.
fn three(stars: [Vec<DVec3>; 3], shift: DVec3) -> Scene {
    let near = |vertices: &[DVec3], shift: DVec3| -> Vec<DVec3> {
        let middle = vertices.iter().sum::<DVec3>() / vertices.len() as f64;
        vertices.iter().map(|v| *v - middle + shift).collect()
    };
    let polygons = [
        (
            "from".to_owned(),
            near(&stars[0], DVec3::new(0.0, 0.0, 2.0)),
            0.0,
            1.0,
        ),
        (
            "to".to_owned(),
            near(&stars[1], DVec3::new(0.0, 0.0, -2.0)),
            0.0,
            0.0,
        ),
        ("by".to_owned(), near(&stars[2], shift), 0.0, 0.0),
    ];
    scene_of(&polygons, "")
}

#[test]
fn visibility_is_required_where_a_line_of_sight_is_blocked() {
    let mut runner = TestRunner::deterministic();
    let scenes = ([star(), star(), star()], place(1.0));
    let (mut sampled, mut required) = (0, 0);
    for index in 0..600 {
        let tree = scenes.new_tree(&mut runner).expect("a scene");
        let (mut stars, shift) = tree.current();
        let convex = index % 2 == 0;
        if convex {
            // The parallelograms on their first corners.
            for star in &mut stars {
                star.truncate(3);
                star.push(star[0] + star[2] - star[1]);
            }
        }
        let scene = three(stars, shift);
        let blocked = requirements(&scene).visibility;
        let found = sampled_block(&scene);
        assert!(!found || blocked.is_some(), "{scene:?}");
        if convex {
            sampled += usize::from(found);
            required += usize::from(blocked.is_some());
        }
    }
    // For convex polygons the answer is exact; the 144 x 144 lines miss a few.
    assert!(
        sampled > 30 && required - sampled <= required / 5,
        "{sampled} of {required}"
    );
}
