//! What meshes promise.

use crate::{area, assert_sound, cornell, is_constant, map, places, read, square};
use glam::DVec2;
use isolux_host::plan::shadow::{Floor, Kind, Lines, Mesh, Options, ShadowMap, Tag};
use isolux_host::scene::{Scene, shipped};

fn options(longest: f64) -> [Options; 4] {
    let of = |lines: Lines, slenderness: f64, longest: f64| Options {
        lines,
        slenderness,
        longest,
        ..Options::default()
    };
    [
        of(Lines::All, f64::INFINITY, f64::INFINITY),
        of(Lines::All, Options::default().slenderness, f64::INFINITY),
        of(Lines::Outlines, Options::default().slenderness, longest),
        of(Lines::Contacts, Options::default().slenderness, longest),
    ]
}

/// What is left of a surface without the feet of bodies, from the scene file.
fn exposed(scene: &Scene, receiver: &str, feet: &[&str]) -> f64 {
    let named = |name: &str| &scene.surfaces[scene.surface_named(name).expect("a surface")];
    feet.iter()
        .fold(named(receiver).area, |left, foot| left - named(foot).area)
}

#[test]
fn areas_are_those_of_the_surfaces_without_feet() {
    let blocks = ["short_top", "tall_top"];
    for (text, receiver, luminaire, feet) in [
        (shipped::PENUMBRA, "receiver", "light", &[][..]),
        (shipped::CORNELL, "floor", "light", &blocks[..]),
        (shipped::CORNELL, "back", "light", &[][..]),
        (shipped::CORNELL, "left1", "light", &[][..]),
        (
            shipped::OFFICE,
            "floor",
            "lum01",
            &["legL_top", "legR_top"][..],
        ),
    ] {
        let scene = read(text);
        let map = map(&scene, receiver, luminaire);
        let known = exposed(&scene, receiver, feet);
        for options in options(map.floor.frame.size_u / 9.0) {
            let mesh = Mesh::of(&map.floor, &[&map], &options);
            let found = assert_sound(&mesh, receiver);
            assert!((found - known).abs() < 1e-9, "{receiver}: {found} {known}");
            assert!(mesh.triangles.len() <= options.triangles);
            assert_eq!(mesh.left_out, 0, "{receiver}");
            assert!(mesh.is_refined, "{receiver}");
            for number in 0..mesh.triangles.len() {
                let [a, b, c] = mesh.corners(number);
                let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
                assert!(longest <= options.longest, "{receiver}: {longest}");
            }
        }
    }
}

/// Whether a segment has more than a touch in common with a triangle.
fn enters([p, q]: [DVec2; 2], corners: [DVec2; 3]) -> bool {
    let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
    let [a, b, c] = corners.map(|corner| centre.lerp(corner, 1.0 - 1e-3));
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for [a, b] in [[a, b], [b, c], [c, a]] {
        let [start, end] = [p, q].map(|end| (b - a).perp_dot(end - a));
        if start <= 0.0 && end <= 0.0 {
            return false;
        }
        if start < 0.0 {
            from = from.max(start / (start - end));
        } else if end < 0.0 {
            to = to.min(start / (start - end));
        }
    }
    from < to
}

#[test]
fn no_triangle_crosses_a_line() {
    for (text, receiver, luminaire) in [
        (shipped::PENUMBRA, "receiver", "light"),
        (shipped::CORNELL, "floor", "light"),
        (shipped::CORNELL, "back", "light"),
        (shipped::OFFICE, "floor", "lum10"),
    ] {
        let map = map(&read(text), receiver, luminaire);
        for options in options(map.floor.frame.size_u / 7.0) {
            let mesh = Mesh::of(&map.floor, &[&map], &options);
            let followed = |kind: Kind| match options.lines {
                Lines::Contacts => kind == Kind::Contact,
                Lines::Outlines => kind <= Kind::Antumbra,
                Lines::All => true,
            };
            let lines = map.lines.iter().chain(&map.floor.contacts);
            for line in lines.filter(|line| followed(line.kind)) {
                let ends = line.ends.map(DVec2::from);
                // The last millionth of an end may have been moved.
                let ends = [ends[0].lerp(ends[1], 1e-3), ends[1].lerp(ends[0], 1e-3)];
                for number in 0..mesh.triangles.len() {
                    let corners = mesh.corners(number);
                    assert!(!enters(ends, corners), "{receiver}: {line:?} {corners:?}");
                }
            }
        }
    }
}

/// Tags are what places in the triangles see.
#[test]
fn triangles_see_what_their_tags_say() {
    let map = map(&cornell(), "floor", "light");
    let mesh = Mesh::of(&map.floor, &[&map], &Options::default());
    let mut constant = 0;
    for place in places(&map, 5000, 21) {
        let (triangle, shares) = mesh.locate(place.x, place.y).expect("a triangle");
        let corners = mesh.corners(triangle);
        let back: DVec2 = (0..3).map(|k| corners[k] * shares[k]).sum();
        assert!(back.distance(place) < 1e-9);
        let fraction = map.fraction(place.x, place.y);
        match mesh.tags[triangle] {
            Tag::Lit => assert_eq!(fraction, Some(1.0), "{place}"),
            Tag::Umbra => assert_eq!(fraction, Some(0.0), "{place}"),
            Tag::Behind => assert_eq!(fraction, None, "{place}"),
            _ => {}
        }
        constant += usize::from(is_constant(mesh.tags[triangle]));
    }
    assert!(constant > 1000, "{constant}");
    assert_eq!(mesh.locate(-1.0, 2.0), None);
    assert_eq!(mesh.locate(2.0, 50.0), None);
}

#[test]
fn the_same_scene_has_the_same_mesh() {
    let mesh = || {
        let map = map(&cornell(), "floor", "light");
        let mesh = Mesh::of(&map.floor, &[&map], &Options::default());
        format!(
            "{:?}",
            (
                map.lines,
                mesh.vertices,
                mesh.triangles,
                mesh.tags,
                mesh.free
            )
        )
    };
    assert_eq!(mesh(), mesh());
}

/// Several luminaires: a mesh of all, and one of contact lines alone.
#[test]
fn luminaires_together() {
    let scene = read(shipped::OFFICE);
    let maps = ["lum00", "lum01", "lum10", "lum11"].map(|name| map(&scene, "floor", name));
    let floor = scene.surface_named("floor").expect("a floor");
    let floor = Floor::of(&scene, floor).expect("a floor");
    let all: Vec<&ShadowMap> = maps.iter().collect();
    let mesh = Mesh::of(&floor, &all, &Options::default());
    let whole = assert_sound(&mesh, "all");
    let bare = Mesh::of(&floor, &[], &Options::default());
    assert!((whole - assert_sound(&bare, "none")).abs() < 1e-9);
    assert!(bare.tags.iter().all(|&tag| tag == Tag::Untold));
    assert!(bare.free.iter().all(Option::is_none));
    for place in places(&maps[0], 2000, 2) {
        let (triangle, _) = mesh.locate(place.x, place.y).expect("a triangle");
        let mut fractions = maps.iter().filter_map(|map| map.fraction(place.x, place.y));
        match mesh.tags[triangle] {
            Tag::Lit => assert!(fractions.all(|v| v == 1.0), "{place}"),
            Tag::Umbra => assert!(fractions.all(|v| v == 0.0), "{place}"),
            _ => {}
        }
    }
}

/// Bounds are kept by leaving out lines and refinement, never the surface.
#[test]
fn small_bounds_are_kept() {
    let map = map(&cornell(), "floor", "light");
    for triangles in [20, 60, 100, 400] {
        let options = Options {
            triangles,
            longest: 0.2,
            ..Options::default()
        };
        let mesh = Mesh::of(&map.floor, &[&map], &options);
        assert!(mesh.triangles.len() <= triangles.max(40), "{triangles}");
        assert!(!mesh.is_refined || mesh.left_out > 0);
        assert_sound(&mesh, "bounded");
    }
    let options = Options {
        most_lines: 5,
        ..Options::default()
    };
    let mesh = Mesh::of(&map.floor, &[&map], &options);
    assert_eq!(mesh.left_out, map.lines.len() - 5);
}

/// A luminaire in a hole of a ceiling that is one polygon covers its place.
#[test]
fn what_is_set_into_a_surface_covers_it() {
    let mut scene = crate::lit::scene(vec![
        square("ceiling", 2.0, 3.0, false, 0.0),
        square("light", 0.5, 3.0, false, 1.0),
        square("lid", 1.0, 0.0, true, 0.0),
    ]);
    scene.surfaces[0].reflectance = [0.5; 3];
    let map = map(&scene, "ceiling", "light");
    let mesh = Mesh::of(&map.floor, &[&map], &Options::default());
    let found = assert_sound(&mesh, "ceiling");
    assert!((found - 15.0).abs() < 1e-9, "{found}");
    assert!(mesh.tags.iter().all(|&tag| tag == Tag::Behind));
    assert!((area(&map.floor.covers[0]) - 1.0).abs() < 1e-9);
}
