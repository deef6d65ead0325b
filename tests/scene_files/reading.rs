//! What is read, and that nothing makes the reader panic.

use glam::DVec3;
use isolux_host::scene::file::parse;
use isolux_host::scene::points::parse_points;
use isolux_host::scene::{Budget, Quantity, shipped};
use proptest::prelude::*;
use serde_json::Value;

use crate::{SQUARE, accepted, cube_without, reference_text, with_extra, with_vertices};

#[test]
fn every_simple_planar_polygon_is_accepted() {
    for vertices in [
        SQUARE,
        // concave, an L
        "[[0,0,0],[2,0,0],[2,1,0],[1,1,0],[1,2,0],[0,2,0]]",
        // a zigzag star
        "[[0,0,0],[4,0,0],[1,1,0],[4,2,0],[0,2,0],[0.5,1,0]]",
        // a vertex in the middle of an edge
        "[[0,0,0],[0.5,0,0],[1,0,0],[1,1,0]]",
        // 1 m by 10 micrometres
        "[[0,0,0],[1,0,0],[1,1e-5,0],[0,1e-5,0]]",
        // off its plane by less than 1e-4 of its diameter
        "[[0,0,0],[1,0,0],[1,1,0.0002],[0,1,0]]",
        // the limit of coordinates, whole numbers, other radices
        "[[0,0,0],[1_000_000,0,0],[0,0xf4240,0]]",
    ] {
        let scene = accepted(&with_vertices(vertices));
        assert!(
            (scene.surfaces[0].normal.length() - 1.0).abs() < 1e-15,
            "{vertices}"
        );
    }
    let scene = accepted(&with_vertices(
        "[[0,0,0],[2,0,0],[2,1,0],[1,1,0],[1,2,0],[0,2,0]]",
    ));
    assert_eq!(scene.surfaces[0].area, 3.0);
    assert_eq!(scene.surfaces[0].normal.to_array(), [0.0, 0.0, 1.0]);
}

#[test]
fn bodies_may_lack_faces_in_one_plane() {
    assert_eq!(accepted(&cube_without(&[])).bodies[0].surfaces.len(), 6);
    for face in ["bottom", "top", "south", "north", "west", "east"] {
        assert_eq!(accepted(&cube_without(&[face])).bodies[0].surfaces.len(), 5);
    }
    // A side in two pieces: its neighbours' edges meet two edges each.
    let whole = cube_without(&["south"]);
    let (surfaces, body) = whole.split_once("[[body]]").expect("a body");
    let halves = "[[surface]]\nname = \"s0\"\nvertices = [[0,0,0],[1,0,0],[1,0,0.5],[0,0,0.5]]\n\
                  [[surface]]\nname = \"s1\"\nvertices = [[0,0,0.5],[1,0,0.5],[1,0,1],[0,0,1]]\n";
    let body = body.replace("\"bottom\"", "\"bottom\", \"s0\", \"s1\"");
    accepted(&format!("{surfaces}{halves}[[body]]{body}"));
    // A sheet of a tenth of a millimetre.
    accepted(&cube_without(&[]).replace(",1]", ",1e-4]"));
}

#[test]
fn scalars_triples_and_integers_mix() {
    let scene = accepted(&with_extra("reflectance = [0.1, 0, 0.3]\nradiance = 12"));
    assert_eq!(scene.surfaces[0].reflectance, [0.1, 0.0, 0.3]);
    assert_eq!(scene.surfaces[0].radiance, [12.0; 3]);
    assert_eq!(scene.quantity, Quantity::Radiometric);
    let scene = accepted(&with_extra("radiance = -0.0").replace("radiometric", "photometric"));
    assert!(
        scene.surfaces[0]
            .radiance
            .iter()
            .all(|r| r.is_sign_positive())
    );
    assert_eq!(scene.quantity, Quantity::Photometric);
    assert_eq!(scene.budget, Budget::default());
}

#[test]
fn budgets_read_kib_as_1024_and_kb_as_1000() {
    for (text, bytes) in [
        ("\"16 KiB\"", 16 * 1024),
        ("\"16KiB\"", 16 * 1024),
        ("\"128 kB\"", 128_000),
        ("\"1.5 MiB\"", 3 << 19),
        ("\"512\"", 512),
        ("4096", 4096),
    ] {
        let scene = accepted(&with_extra(&format!("[budget]\nram = {text}")));
        assert_eq!(scene.budget.ram, Some(bytes), "{text}");
        assert_eq!(scene.budget.flash, None);
    }
}

#[test]
fn rungs_and_points_are_kept() {
    let scene = accepted(&with_extra(
        "[rungs]\narithmetic = \"q29\"\nreconstruction = \"cone\"\n\
         [[point]]\nname = \"p\"\nposition = [1, 2, 3]\nnormal = [0, 3e-200, 4e-200]",
    ));
    assert_eq!(scene.rungs.arithmetic.as_deref(), Some("q29"));
    assert_eq!(scene.rungs.reconstruction.as_deref(), Some("cone"));
    assert_eq!(scene.rungs.visibility, None);
    let normal = scene.points[0].normal;
    assert!((normal - DVec3::new(0.0, 0.6, 0.8)).length() < 1e-15);
}

#[test]
fn shipped_scenes_have_the_geometry_of_the_references() {
    for (text, reference) in [
        (shipped::PAPER, "b_simple_3x3"),
        (shipped::PAPER_ASPECT, "b_simple_4.4497x2.0226"),
    ] {
        let json: Value = serde_json::from_str(&reference_text(reference)).expect("JSON");
        let polygons = json["polygons"].as_array().expect("polygons");
        let scene = accepted(text);
        assert_eq!(scene.surfaces.len(), polygons.len());
        for (surface, polygon) in scene.surfaces.iter().zip(polygons) {
            assert_eq!(polygon["name"], surface.name);
            let close = |got: &[f64], wanted: &Value| {
                let wanted = wanted.as_array().expect("a list");
                assert_eq!(got.len(), wanted.len());
                got.iter()
                    .zip(wanted)
                    .all(|(a, b)| (a - b.as_f64().expect("a number")).abs() <= 1e-15)
            };
            assert!(close(&surface.normal.to_array(), &polygon["normal"]));
            assert!(close(
                &surface.reflectance[..1],
                &Value::from(vec![polygon["reflectance"].clone()])
            ));
            assert!(close(
                &surface.radiance[..1],
                &Value::from(vec![polygon["emission"].clone()])
            ));
            let vertices = polygon["vertices"].as_array().expect("vertices");
            assert_eq!(surface.vertices.len(), vertices.len());
            for (vertex, wanted) in surface.vertices.iter().zip(vertices) {
                assert!(
                    close(&vertex.to_array(), wanted),
                    "{} {vertex} {wanted}",
                    surface.name
                );
            }
        }
        let budget = Budget {
            ram: Some(16 << 10),
            flash: Some(128 << 10),
            samples: Some(59),
        };
        assert_eq!(scene.budget, budget);
    }
}

/// In rooms the office's radiances are scaled, and names are those of the files.
#[test]
fn shipped_rooms_have_the_geometry_of_the_references() {
    for (text, reference, unit) in [
        (shipped::PENUMBRA, "d_penumbra_h1.5", 1.0),
        (shipped::CORNELL, "c_cornell_grey", 1.0),
        (shipped::CORNELL_RGB, "c_cornell_rgb", 1.0),
        (shipped::OFFICE, "e_office", 200.0),
    ] {
        let json: Value = serde_json::from_str(&reference_text(reference)).expect("JSON");
        let polygons = json["polygons"].as_array().expect("polygons");
        let scene = accepted(text);
        assert_eq!(scene.surfaces.len(), polygons.len(), "{reference}");
        for polygon in polygons {
            let name = polygon["name"].as_str().expect("a name");
            let surface = &scene.surfaces[scene.surface_named(name).expect(name)];
            let channel = |value: &Value, channel: usize| {
                value
                    .get(channel)
                    .unwrap_or(value)
                    .as_f64()
                    .expect("a number")
            };
            for c in 0..3 {
                let radiance = unit * channel(&polygon["emission"], c);
                assert_eq!(surface.reflectance[c], channel(&polygon["reflectance"], c));
                assert_eq!(surface.radiance[c], radiance, "{reference} {name}");
                for (vertex, wanted) in surface.vertices.iter().zip(0..) {
                    let wanted = channel(&polygon["vertices"][wanted as usize], c);
                    assert!((vertex[c] - wanted).abs() <= 1e-14, "{reference} {name}");
                }
            }
        }
    }
    assert_eq!(accepted(shipped::CORNELL).budget.samples, Some(687));
    assert_eq!(accepted(shipped::OFFICE).quantity, Quantity::Photometric);
    let points: Vec<String> = accepted(shipped::OFFICE)
        .points
        .into_iter()
        .map(|p| p.name)
        .collect();
    assert_eq!(points, ["desk-1", "desk-2", "desk-3", "desk-4"]);
}

#[test]
fn sensor_points_are_read_as_radiance_writes_them() {
    let source = "# desk\n0 0 0.8\t0 0 1\n\n  1e0 .5 -2 0 0 -2.5 # below\r\n";
    let points = parse_points("desk.pts", source).expect("points");
    assert_eq!(points.len(), 2);
    assert_eq!(points[1].given, [1.0, 0.5, -2.0, 0.0, 0.0, -2.5]);
    assert_eq!(points[1].normal.to_array(), [0.0, 0.0, -1.0]);
    assert_eq!(points[1].line, 4);
    assert!(parse_points("none.pts", "").expect("no points").is_empty());
    for (source, line, column, message) in [
        ("0 0 0 0 0 1\n0 0 0 0 1\n", 2, 10, "six numbers, not 5"),
        ("0 0 0 0 0 1 7", 1, 13, "six numbers, not 7"),
        ("0 0 x 0 0 1", 1, 5, "`x` is not a number"),
        ("0 é 0 0 nan 1", 1, 3, "`é` is not a number"),
        ("0 0 0 0 nan 1", 1, 9, "`nan` is not a finite number"),
        ("inf 0 0 0 0 1", 1, 1, "`inf` is not a finite number"),
        ("1e400 0 0 0 0 1", 1, 1, "`1e400` is not a finite number"),
        ("\n\n0 0 0 0 0 0", 3, 7, "the normal is zero"),
        ("0 -2e6 0 0 0 1", 1, 3, "beyond 1000000 m"),
    ] {
        let diagnostic = parse_points("desk.pts", source).expect_err(source);
        assert!(diagnostic.message.contains(message), "{diagnostic}");
        assert_eq!(
            (diagnostic.line, diagnostic.column),
            (Some(line), Some(column)),
            "{diagnostic}"
        );
        assert!(!diagnostic.remedy.is_empty());
    }
}

/// What replaces a piece of a sound file: single bytes and the words that the
/// format gives a meaning.
fn edit() -> impl Strategy<Value = (usize, usize, Vec<u8>)> {
    let word = prop::sample::select(vec![
        "nan",
        "inf",
        "-",
        "1e308",
        "1e999",
        "[[",
        "]]",
        "[",
        "]",
        "{",
        "}",
        "\"",
        "'''",
        "\n",
        "=",
        "#",
        "0",
        "1e-320",
        "9999999999999999999999",
        "0x",
        "é",
        "\u{1b}",
        "\r",
        "\t",
        "\u{feff}",
        "[surface]",
        "[[body]]\n",
        "[[point]]\n",
        "name",
        "A",
        "LS",
        "surfaces = [\"A\", \"B\"]\n",
        "2024-01-01",
        "true",
        ".",
        ",",
    ])
    .prop_map(|word| word.as_bytes().to_vec());
    let byte = any::<u8>().prop_map(|byte| vec![byte]);
    (
        0..4096_usize,
        0..12_usize,
        prop_oneof![word, byte, Just(Vec::new())],
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 6000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever the bytes: a scene or a diagnostic that can be shown.
    #[test]
    fn edited_files_never_panic(edits in prop::collection::vec(edit(), 1..4)) {
        let mut bytes = shipped::PAPER.as_bytes().to_vec();
        for (at, removed, inserted) in edits {
            let at = at % (bytes.len() + 1);
            let end = (at + removed).min(bytes.len());
            bytes.splice(at..end, inserted);
        }
        let text = String::from_utf8_lossy(&bytes);
        match parse("edited.toml", &text) {
            Ok(scene) => {
                for surface in &scene.surfaces {
                    prop_assert!((surface.normal.length() - 1.0).abs() < 1e-12);
                    prop_assert!(surface.area > 0.0 && surface.area.is_finite());
                }
            }
            Err(diagnostic) => {
                prop_assert!(!diagnostic.message.is_empty() && !diagnostic.remedy.is_empty());
                let lines = text.split('\n').count();
                let line = diagnostic.line.expect("a place");
                prop_assert!((1..=lines).contains(&line));
                let width = text.split('\n').nth(line - 1).expect("the line").chars().count();
                prop_assert!((1..=width + 1).contains(&diagnostic.column.expect("a column")));
                prop_assert!(diagnostic.to_string().contains("edited.toml"));
            }
        }
    }

    /// The same for sensor points.
    #[test]
    fn any_text_is_points_or_a_diagnostic(text in "([-0-9.e#nai \t\n\réfx]{0,12} ?){0,16}") {
        match parse_points("any.pts", &text) {
            Ok(points) => for point in points {
                prop_assert!((point.normal.length() - 1.0).abs() < 1e-12);
            },
            Err(diagnostic) => prop_assert!(!diagnostic.to_string().is_empty()),
        }
    }
}
