//! Scenes with occluders, colour and many reflections, by every command.

use crate::program::{Ran, isolux};
use crate::{desk, document, files, keys, red, refused, set, shaded, write};
use serde_json::Value;
use std::path::Path;

/// Header and rows of an answered `solve`.
fn rows(ran: &Ran) -> (String, Vec<Vec<f64>>) {
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let mut lines = ran.stdout.lines();
    let header = lines.next().expect("a header").to_owned();
    let row = |line: &str| {
        let fields = line.split(',').skip(6);
        fields.map(|x| x.parse().expect("a number")).collect()
    };
    (header, lines.map(row).collect())
}

fn solve(directory: &Path, scene: &str, more: &[&str]) -> Vec<Vec<f64>> {
    let ran = isolux(&[&["solve", scene], more].concat(), directory, "");
    let (header, rows) = rows(&ran);
    let columns = header.strip_prefix("x,y,z,nx,ny,nz,").expect("a header");
    assert!(["E", "E_r,E_g,E_b"].contains(&columns), "{header}");
    let width = columns.split(',').count();
    assert!(rows.iter().all(|row| row.len() == width), "{rows:?}");
    rows
}

/// Each value within `error` of the other, relative, or both dark.
fn agree(a: &[Vec<f64>], b: &[Vec<f64>], error: f64) {
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
        assert!((a - b).abs() <= error * b.abs(), "{a} {b}");
    }
}

/// A closed room of 2 x 3 x 2 m whose ceiling glows and reflects.
fn closed() -> String {
    let [a, b, c, d] = ["0,0,0", "2,0,0", "2,3,0", "0,3,0"];
    let [e, f, g, h] = ["0,0,2", "2,0,2", "2,3,2", "0,3,2"];
    let face = |name: &str, vertices: [&str; 4], rest: &str| {
        let vertices = vertices.map(|v| format!("[{v}]")).join(",");
        format!(
            "[[surface]]\nname = \"{name}\"\nvertices = [{vertices}]\nreflectance = 0.6\n{rest}"
        )
    };
    "isolux = 1\nname = \"closed\"\nquantity = \"radiometric\"\n".to_owned()
        + &face("floor", [a, b, c, d], "")
        + &face("ceiling", [h, g, f, e], "radiance = 2\n")
        + &face("front", [a, e, f, b], "")
        + &face("right", [b, f, g, c], "")
        + &face("back", [c, g, h, d], "")
        + &face("left", [d, h, e, a], "")
        + "[[point]]\nname = \"p\"\nposition = [1, 1, 0]\nnormal = [0, 0, 1]\n"
        + "[budget]\nsamples = 480\n"
}

/// The wall that the camera looks at gets more samples than it does otherwise, the one
/// behind it fewer; and what cannot be placed for a camera is refused.
#[test]
fn samples_are_placed_for_the_camera_where_it_is_asked_for() {
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path();
    let camera = "[camera]\neye = [1, 0.2, 1]\ntarget = [1, 3, 1]\nup = [0, 0, 1]\nfov = 60\n";
    let few = closed().replace("samples = 480", "samples = 120");
    write(path, "room.toml", &(few.clone() + camera));
    write(path, "blind.toml", &few);
    let samples = |more: &[&str]| {
        let all = [&["plan", "room.toml", "-o", "a.plan", "--json"], more].concat();
        let ran = isolux(&all, path, "");
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        let sheet = document(&ran);
        let surfaces = sheet["surfaces"].as_array().expect("surfaces").clone();
        ["back", "front"].map(|name| {
            let surface = surfaces.iter().find(|surface| surface["name"] == name);
            surface.expect("a wall")["samples"]
                .as_u64()
                .expect("a count")
        })
    };
    let ([seen, unseen], [seen_before, unseen_before]) = (samples(&["--for-camera"]), samples(&[]));
    assert!(seen > seen_before && unseen < unseen_before);
    for (scene, more) in [
        ("blind.toml", &[][..]),
        ("paper", &[]),
        ("room.toml", &["--placement", "isolux"]),
    ] {
        let all = [&["plan", scene, "-o", "b.plan", "--for-camera"], more].concat();
        refused(&isolux(&all, path, ""), 2);
    }
    assert!(!path.join("b.plan").exists());
}

#[test]
fn visibility_is_a_choice_and_exact_where_something_occludes() {
    let directory = tempfile::tempdir().expect("a directory");
    write(directory.path(), "shaded.toml", &shaded());
    write(
        directory.path(),
        "f.pts",
        "2 2 0 0 0 1\n1.2 1.4 0 0 0 1\n0.2 0.2 0 0 0 1\n",
    );
    let at = |more: &[&str]| {
        let all = [&["--points", "f.pts", "--bounces", "0"], more].concat();
        solve(directory.path(), "shaded.toml", &all)
    };
    let exact = at(&[]);
    assert_eq!(at(&["--visibility", "exact"]), exact);
    agree(&exact, &at(&["--reference"]), 1e-5);
    let open = at(&["--visibility", "none"]);
    let rays = at(&["--visibility", "vertex-rays"]);
    assert!(exact[0][0] < 0.9 * open[0][0], "the board takes light");
    for row in 0..3 {
        assert!(exact[row][0] <= open[row][0] && rays[row][0] <= open[row][0]);
    }
    // All four vertices of the light are seen past the board, or none is.
    assert_ne!(rays[0], exact[0]);
}

#[test]
fn a_scene_with_colour_has_three_columns_from_every_method() {
    let directory = tempfile::tempdir().expect("a directory");
    write(directory.path(), "red.toml", &red());
    write(directory.path(), "f.pts", "2 2 1 0 0 -1\n2 2 0 0 0 1\n");
    for more in [&[][..], &["--reference"], &["--emitters", "linear"]] {
        let all = [&["--points", "f.pts", "--bounces", "1"], more].concat();
        let found = solve(directory.path(), "red.toml", &all);
        // White light: all channels alike; seen in the red floor, four to one.
        let [r, g, b] = found[1][..] else {
            panic!("{found:?}")
        };
        assert!(r > 100.0 && r == g && g == b, "{found:?}");
        let [r, g, b] = found[0][..] else {
            panic!("{found:?}")
        };
        assert!(
            (r / g - 4.0).abs() < 1e-5 && (g / b - 1.0).abs() < 1e-5,
            "{found:?}"
        );
    }
    let solved = isolux(&["solve", "red.toml", "--json"], directory.path(), "");
    let solved = document(&solved);
    let names = set(["name", "position", "normal", "E_r", "E_g", "E_b"]);
    assert_eq!(keys(&solved["points"][0]), names);
}

#[test]
fn shipped_rooms_answer_their_named_points() {
    let directory = tempfile::tempdir().expect("a directory");
    let direct = ["--bounces", "0"];
    let kernel = solve(directory.path(), "penumbra", &direct);
    let reference = solve(
        directory.path(),
        "penumbra",
        &["--bounces", "0", "--reference"],
    );
    agree(&kernel, &reference, 1e-5);
    let coloured = solve(directory.path(), "cornell-rgb", &direct);
    let reference = ["--bounces", "0", "--reference"];
    agree(
        &coloured,
        &solve(directory.path(), "cornell-rgb", &reference),
        1e-5,
    );
    // The light is 17 : 12 : 4; behind the blocks there is none of it.
    assert!((coloured[0][0] / coloured[0][2] - 17.0 / 4.0).abs() < 1e-5);
    assert_eq!(coloured[2], [0.0; 3]);
}

#[test]
fn what_was_chosen_is_said() {
    let directory = tempfile::tempdir().expect("a directory");
    write(directory.path(), "desk.toml", &desk());
    for (transfer, emitters) in [
        ("codes", "linear"),
        ("exact", "layer-cake"),
        ("exact", "isolux"),
    ] {
        let mut arguments = vec!["render", "desk.toml", "-o", "out", "--json"];
        arguments.extend(["--bounces", "0", "--resolution", "16"]);
        arguments.extend(["--transfer", transfer, "--emitters", emitters]);
        let rendered = document(&isolux(&arguments, directory.path(), ""));
        assert_eq!(rendered["rungs"]["transfer"], transfer);
        assert_eq!(rendered["rungs"]["emitters"], emitters);
    }
}

#[test]
fn emitters_are_a_choice() {
    let directory = tempfile::tempdir().expect("a directory");
    write(directory.path(), "desk.toml", &desk());
    let at = |more: &[&str]| solve(directory.path(), "desk.toml", more);
    let isolux = at(&["--emitters", "isolux"]);
    assert_eq!(isolux, at(&["--placement", "isolux"]), "the paper's way");
    // Bands are coarse; patches follow the light.
    let reference = at(&["--reference"]);
    agree(&isolux, &reference, 0.1);
    // What each outline encloses sends all that it receives.
    agree(&at(&["--emitters", "layer-cake"]), &reference, 0.04);
    // The budget allows four patches, whose linear functions fit the light best on
    // the whole: they flatten the peak in the middle that is looked at. More do not.
    let patches = ["--emitters", "linear", "--placement", "isolux"];
    agree(&at(&patches), &reference, 0.03);
    // Points do not stand for a desk that is looked at from near by: patches do.
    assert_eq!(at(&[]), at(&patches), "the default for points in the room");
    write(
        directory.path(),
        "desk.toml",
        &desk().replace("samples = 24", "samples = 48"),
    );
    agree(&at(&patches), &reference, 0.005);
}

/// shot = received + elsewhere + on backs + leaving + missing, and
/// emitted + ρ received = shot + unshot.
fn is_balance(balance: &Value) {
    let at = |key: &str| balance[key].as_f64().expect("a number");
    let gone = at("received") + at("elsewhere") + at("on_backs") + at("leaving") + at("missing");
    let shot = at("shot");
    assert!((gone - shot).abs() < 1e-9 * shot, "{balance}");
    let reflected = at("received") - at("absorbed");
    let sent = at("emitted") + reflected - at("unshot");
    assert!((sent - shot).abs() < 1e-3 * shot, "{balance}");
}

#[test]
fn a_closed_room_keeps_its_light() {
    let directory = tempfile::tempdir().expect("a directory");
    write(directory.path(), "closed.toml", &closed());
    let solved = isolux(&["solve", "closed.toml", "--json"], directory.path(), "");
    let solved = document(&solved);
    assert_eq!(solved["inexact"], 0);
    let balance = &solved["balance"];
    is_balance(balance);
    let at = |key: &str| balance[key].as_f64().expect("a number");
    assert!((at("emitted") - 12.0 * std::f64::consts::PI).abs() < 1e-9);
    for key in ["leaving", "on_backs", "elsewhere"] {
        assert_eq!(at(key), 0.0, "{key}: {balance}");
    }
    assert!(at("unshot") <= 0.001 * at("emitted"), "{balance}");
    assert!(at("missing").abs() < 0.02 * at("shot"), "{balance}");
    // All that is emitted is absorbed in the end.
    let kept = at("absorbed") + at("unshot");
    assert!((kept / at("emitted") - 1.0).abs() < 0.05, "{balance}");
}

#[test]
fn an_open_scene_says_what_leaves_and_what_backs_take() {
    let directory = tempfile::tempdir().expect("a directory");
    // Enough samples that the board's shadow is not missed.
    let text = shaded().replace("samples = 24", "samples = 400");
    write(directory.path(), "shaded.toml", &text);
    let of = |more: &[&str]| {
        let all = [&["solve", "shaded.toml", "--json"], more].concat();
        document(&isolux(&all, directory.path(), ""))["balance"].clone()
    };
    let balance = of(&[]);
    is_balance(&balance);
    let at = |balance: &Value, key: &str| balance[key].as_f64().expect("a number");
    assert_eq!(balance["unit"], "lm");
    assert!(at(&balance, "leaving") > 0.05 * at(&balance, "shot"));
    assert!(at(&balance, "elsewhere") > 0.0, "the board is black");
    assert!(at(&balance, "on_backs") > 0.0, "and has a back");
    assert!(at(&balance, "missing").abs() < 0.02 * at(&balance, "shot"));
    // Light that passes through a board is counted twice, and found out.
    let wrong = of(&["--visibility", "none"]);
    assert!(
        at(&wrong, "missing") < -0.02 * at(&wrong, "shot"),
        "{wrong}"
    );
    // The reference has no balance of the kernel's to tell.
    let all = [
        "solve",
        "shaded.toml",
        "--json",
        "--reference",
        "--bounces",
        "0",
    ];
    let referred = document(&isolux(&all, directory.path(), ""));
    assert!(!keys(&referred).contains("balance"));
}

#[test]
fn a_room_is_rendered_evaluated_and_in_colour() {
    let directory = tempfile::tempdir().expect("a directory");
    let board = shaded().replace(&desk(), "");
    let text = red()
        + &board
        + "[camera]\neye = [2, -6, 3]\ntarget = [2, 2, 0.5]\nup = [0, 0, 1]\nfov = 40\n";
    write(
        directory.path(),
        "room.toml",
        &text.replace("samples = 24", "samples = 200"),
    );
    let arguments = [
        "render",
        "room.toml",
        "-o",
        "out",
        "--json",
        "--bounces",
        "1",
    ];
    let arguments = [&arguments[..], &["--resolution", "48"]].concat();
    let rendered = document(&isolux(&arguments, directory.path(), ""));
    assert_eq!(rendered["rungs"]["visibility"], "exact");
    assert_eq!(rendered["rungs"]["emitters"], "linear");
    assert!(
        rendered["baseline"].is_null(),
        "the classical method knows neither"
    );
    is_balance(&rendered["balance"]);
    let evaluated = &rendered["evaluated"];
    assert_eq!(evaluated["inexact"], 0);
    let worst = |errors: &Value| errors["full_scale"]["max"].as_f64().expect("a number");
    assert!(worst(&evaluated["error"]) < 1e-3, "{evaluated}");
    assert!(worst(&rendered["error"]) > worst(&evaluated["error"]));
    let written = files(&directory.path().join("out"));
    let named = rendered["files"].as_array().expect("a list");
    assert_eq!(named.len(), written.len());
    let picture = directory.path().join("out/picture.png");
    let file = std::io::BufReader::new(std::fs::File::open(picture).expect("a file"));
    let mut reader = png::Decoder::new(file).read_info().expect("a picture");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
    reader.next_frame(&mut bytes).expect("a frame");
    let is_red = |pixel: &&[u8]| pixel[0] > 100 && pixel[1] < pixel[0] - 40;
    assert!(bytes.chunks(3).filter(is_red).count() > 100, "a red floor");
}

#[test]
fn check_says_what_a_room_requires() {
    let directory = tempfile::tempdir().expect("a directory");
    for (scene, surfaces, emitters, bodies, channels) in [
        ("penumbra", 3, 1, 0, 1),
        ("cornell", 20, 1, 2, 1),
        ("cornell-rgb", 20, 1, 2, 3),
        ("office", 43, 4, 3, 1),
    ] {
        let checked = document(&isolux(&["check", scene, "--json"], directory.path(), ""));
        let counts = ["surfaces", "emitters", "bodies", "channels"].map(|key| &checked[key]);
        assert_eq!(counts, [surfaces, emitters, bodies, channels], "{scene}");
        assert!(checked.get("lacking").is_none(), "{scene}: {checked}");
        let needs = checked["requires"].as_array().expect("a list");
        let what: Vec<_> = needs
            .iter()
            .filter_map(|need| need["what"].as_str())
            .collect();
        assert!(
            what.contains(&"visibility") && what.contains(&"linear emitters"),
            "{what:?}"
        );
        assert_eq!(what.contains(&"bodies"), bodies > 0, "{what:?}");
        assert_eq!(what.contains(&"three channels"), channels == 3, "{what:?}");
        let capacities = &checked["capacities"];
        for key in ["samples", "emitters", "occluders", "blockers"] {
            assert!(
                capacities[key].as_u64().is_some_and(|n| n > 0),
                "{scene}: {key}"
            );
        }
        let sight = &capacities["sight"];
        assert_eq!(
            keys(sight),
            set(["vertices", "pieces", "lines", "blockers"])
        );
        assert!(
            sight["vertices"].as_u64().is_some_and(|n| n >= 4),
            "{sight}"
        );
    }
    // Without visibility there is no workspace, and less RAM.
    let ram = |more: &[&str]| {
        // Error-driven plans differ with what is seen; these have the same samples.
        let all = ["check", "penumbra", "--placement", "isolux", "--json"];
        let all = [&all, more].concat();
        document(&isolux(&all, directory.path(), ""))["ram_bytes"].as_u64()
    };
    assert!(ram(&["--visibility", "none"]) < ram(&[]));
    assert!(ram(&["--visibility", "vertex-rays"]) < ram(&[]));
}

#[test]
fn loose_surfaces_that_close_are_recognised() {
    let directory = tempfile::tempdir().expect("a directory");
    let sides = [
        ("lid", "[1,1,1],[2,1,1],[2,2,1],[1,2,1]"),
        ("s", "[1,1,0],[2,1,0],[2,1,1],[1,1,1]"),
        ("e", "[2,1,0],[2,2,0],[2,2,1],[2,1,1]"),
        ("n", "[2,2,0],[1,2,0],[1,2,1],[2,2,1]"),
        ("w", "[1,2,0],[1,1,0],[1,1,1],[1,2,1]"),
    ];
    let block = sides.map(|(name, vertices)| {
        format!("[[surface]]\nname = \"{name}\"\nvertices = [{vertices}]\n")
    });
    write(directory.path(), "block.toml", &(desk() + &block.concat()));
    let checked = document(&isolux(
        &["check", "block.toml", "--json"],
        directory.path(),
        "",
    ));
    assert_eq!(checked["bodies"], 1);
    let needs = checked["requires"].to_string();
    assert!(needs.contains("the loose `lid`"), "{needs}");
}

#[test]
fn the_workspace_counts_against_the_budget() {
    let directory = tempfile::tempdir().expect("a directory");
    write(directory.path(), "shaded.toml", &shaded());
    let checked = document(&isolux(
        &["check", "shaded.toml", "--json"],
        directory.path(),
        "",
    ));
    let ram = checked["ram_bytes"].as_u64().expect("a number");
    for (allowed, code) in [(ram, 0), (ram - 1, 1)] {
        let text = shaded().replace("samples = 24", &format!("samples = 24\nram = {allowed}"));
        write(directory.path(), "tight.toml", &text);
        let arguments = ["render", "tight.toml", "-o", "out", "--bounces", "0"];
        let ran = isolux(&arguments, directory.path(), "");
        if code == 0 {
            assert_eq!(ran.code, 0, "{}", ran.stderr);
        } else {
            refused(&ran, 1);
            assert!(
                ran.stderr.contains(&format!("{ram} bytes")),
                "{}",
                ran.stderr
            );
        }
    }
}
