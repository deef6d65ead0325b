//! `isolux render`, and `isolux` alone.

use crate::program::isolux;
use crate::{desk, document, files, keys, refused, set, write};
use serde_json::Value;
use std::path::Path;

fn is_picture(path: &Path) {
    let file = std::fs::File::open(path).expect("a file");
    let decoder = png::Decoder::new(std::io::BufReader::new(file));
    let mut reader = decoder
        .read_info()
        .unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    reader
        .next_frame(&mut pixels)
        .unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let first = pixels[..3].to_vec();
    assert!(
        pixels.chunks(3).any(|pixel| pixel != first),
        "{} is empty",
        path.display()
    );
}

fn is_error(error: &Value) {
    assert_eq!(keys(error), set(["relative", "full_scale"]));
    for kind in ["relative", "full_scale"] {
        assert_eq!(keys(&error[kind]), set(["max", "rms", "p95", "over"]));
        assert_eq!(keys(&error[kind]["over"]), set(["1", "2", "5", "10", "15"]));
        let number = |key: &str| error[kind][key].as_f64().expect("a number");
        assert!(number("rms") <= number("max") && number("p95") <= number("max"));
        let over: Vec<f64> = ["1", "2", "5", "10", "15"]
            .map(|percent| error[kind]["over"][percent].as_f64().expect("a number"))
            .to_vec();
        assert!(over.windows(2).all(|pair| pair[0] >= pair[1]), "{over:?}");
        assert!(over.iter().all(|part| (0.0..=100.0).contains(part)));
    }
}

#[test]
fn alone_it_renders_the_papers_scene() {
    let directory = tempfile::tempdir().expect("a directory");
    let ran = isolux(&[], directory.path(), "");
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    for said in [
        "paper-simple",
        "camera",
        "A ",
        "B ",
        "reference",
        "isolux-out",
    ] {
        assert!(ran.stdout.contains(said), "{said}: {}", ran.stdout);
    }
    let written = files(directory.path());
    assert!(written.len() >= 5, "{written:?}");
    for path in &written {
        assert!(
            path.starts_with(directory.path().join("isolux-out")),
            "{}",
            path.display()
        );
        assert_eq!(path.extension().and_then(|e| e.to_str()), Some("png"));
        is_picture(path);
    }
}

#[test]
fn the_document_has_the_contracts_keys() {
    let directory = tempfile::tempdir().expect("a directory");
    let arguments = [
        "render",
        "paper",
        "-o",
        "out",
        "--resolution",
        "64",
        "--json",
    ];
    let rendered = document(&isolux(&arguments, directory.path(), ""));
    let found = keys(&rendered);
    for key in [
        "scene",
        "form_factor_samples",
        "form_factor_evaluations",
        "surfaces",
        "error",
        "files",
        "free_samples",
        "resolution",
        "reference",
    ] {
        assert!(found.contains(key), "{key} in {found:?}");
    }
    assert_eq!(rendered["scene"], "paper-simple");
    assert_eq!(rendered["form_factor_samples"], 58);
    assert_eq!(rendered["resolution"], serde_json::json!([64, 64]));
    is_error(&rendered["error"]);
    let surfaces = rendered["surfaces"].as_array().expect("a list");
    let names: Vec<_> = surfaces
        .iter()
        .map(|s| s["name"].as_str().expect("a name"))
        .collect();
    assert_eq!(
        names,
        ["A", "B"],
        "emitters that reflect nothing are left out"
    );
    for surface in surfaces {
        for key in ["name", "samples", "emitters", "error"] {
            assert!(keys(surface).contains(key), "{key}");
        }
        is_error(&surface["error"]);
    }
    // The nodes of a grid of 7 x 7 on A shoot, and those of 3 x 3 on B.
    let counts = |k: usize| ["samples", "emitters"].map(|key| surfaces[k][key].as_u64());
    assert_eq!(counts(0), [Some(49), Some(49)]);
    assert_eq!(counts(1), [Some(9), Some(9)]);
    for (ladder, rung) in [
        ("placement", "error"),
        ("emitters", "points"),
        ("reconstruction", "tensor"),
    ] {
        assert_eq!(rendered["rungs"][ladder], rung);
    }

    // Every file that is named exists, and no other does.
    let named = rendered["files"].as_array().expect("a list");
    let written = files(directory.path());
    assert_eq!(named.len(), written.len(), "{named:?} {written:?}");
    for name in named {
        let name = Path::new(name.as_str().expect("a name"));
        let found = written.iter().any(|path| path.ends_with(name));
        assert!(found, "{} of {written:?}", name.display());
    }
    written.iter().for_each(|path| is_picture(path));
}

/// The paper's own way is a flag away: 48 samples on A and 10 on B, in 4 bands.
#[test]
fn the_papers_way_is_still_there() {
    let directory = tempfile::tempdir().expect("a directory");
    let arguments = [
        "render",
        "paper",
        "-o",
        "out",
        "--resolution",
        "16",
        "--placement",
        "isolux",
        "--json",
    ];
    let rendered = document(&isolux(&arguments, directory.path(), ""));
    let surfaces = rendered["surfaces"].as_array().expect("a list");
    let counts = |k: usize| ["samples", "emitters"].map(|key| surfaces[k][key].as_u64());
    assert_eq!(counts(0), [Some(48), Some(4)]);
    assert_eq!(counts(1)[0], Some(10));
    for (ladder, rung) in [
        ("placement", "isolux"),
        ("emitters", "isolux"),
        ("reconstruction", "cone"),
    ] {
        assert_eq!(rendered["rungs"][ladder], rung);
    }
}

#[test]
fn a_scene_without_a_camera_is_judged_over_its_surfaces() {
    let directory = tempfile::tempdir().expect("a directory");
    write(directory.path(), "desk.toml", &desk());
    let arguments = [
        "render",
        "desk.toml",
        "-o",
        "a/b/c",
        "--json",
        "--bounces",
        "1",
    ];
    let rendered = document(&isolux(&arguments, directory.path(), ""));
    is_error(&rendered["error"]);
    assert!(rendered["resolution"].is_null());
    assert_eq!(rendered["quantity"], "lx");
    assert_eq!(rendered["bounces"], 1);
    files(&directory.path().join("a/b/c"))
        .iter()
        .for_each(|path| is_picture(path));
}

#[test]
fn a_place_that_cannot_be_written_is_refused_whole() {
    let directory = tempfile::tempdir().expect("a directory");
    write(directory.path(), "desk.toml", &desk());
    write(directory.path(), "taken", "precious");
    let long = "x".repeat(300);
    for output in ["taken", "taken/below", "/dev/null/below", &long, ""] {
        let ran = isolux(&["render", "desk.toml", "-o", output], directory.path(), "");
        refused(&ran, 2);
    }
    let taken = std::fs::read_to_string(directory.path().join("taken")).expect("the file");
    assert_eq!(taken, "precious");
    assert_eq!(files(directory.path()).len(), 2);
}

#[test]
fn a_run_that_fails_midway_leaves_whole_pictures() {
    let directory = tempfile::tempdir().expect("a directory");
    write(directory.path(), "desk.toml", &desk());
    let arguments = ["render", "desk.toml", "-o", "out"];
    assert_eq!(isolux(&arguments, directory.path(), "").code, 0);
    let out = directory.path().join("out");
    let pictures = files(&out);
    // Each name in turn is taken by a directory, which no file can replace.
    for blocked in &pictures {
        std::fs::remove_dir_all(&out).expect("removed");
        std::fs::create_dir_all(blocked).expect("in the way");
        let ran = isolux(&arguments, directory.path(), "");
        refused(&ran, 2);
        let name = blocked
            .file_name()
            .and_then(|name| name.to_str())
            .expect("UTF-8");
        assert!(ran.stderr.contains(name), "{}", ran.stderr);
        for left in files(&out) {
            assert!(
                pictures.contains(&left),
                "{} is left behind",
                left.display()
            );
            is_picture(&left);
        }
    }
}

/// A surface's errors, put together from those of its tags.
fn is_put_together(whole: &Value, samples: Option<u64>) {
    let number = |value: &Value| value.as_f64().expect("a number");
    let tags = whole["tags"].as_array().expect("a list");
    let sum = |of: &dyn Fn(&Value) -> f64| tags.iter().map(of).sum::<f64>();
    let share = |tag: &Value| number(&tag["share"]) / 100.0;
    assert!((sum(&share) - 1.0).abs() < 1e-12, "{whole}");
    let count = |tag: &Value| tag["samples"].as_u64();
    assert_eq!(tags.iter().map(count).sum::<Option<u64>>(), samples);
    let metric = |of: &Value, name: &str| number(&of["error"]["full_scale"][name]);
    let square = sum(&|tag| share(tag) * metric(tag, "rms").powi(2));
    let rms = metric(whole, "rms");
    assert!((square.sqrt() - rms).abs() < 1e-9 * rms, "{whole}");
    let max = |worst: f64, tag| worst.max(metric(tag, "max"));
    assert_eq!(tags.iter().fold(0.0, max), metric(whole, "max"));
    let above = |of: &Value| number(&of["error"]["full_scale"]["over"]["1"]);
    let together = sum(&|tag| share(tag) * above(tag));
    assert!((together - above(whole)).abs() < 1e-9, "{whole}");
}

#[test]
fn errors_are_told_apart_by_what_light_does() {
    let directory = tempfile::tempdir().expect("a directory");
    let render = |scene: &str| {
        let arguments = ["render", scene, "-o", "out", "--resolution", "64", "--json"];
        document(&isolux(&arguments, directory.path(), ""))
    };
    let names = |whole: &Value| -> Vec<String> {
        let tags = whole["tags"].as_array().expect("a list").iter();
        tags.map(|tag| tag["tag"].as_str().expect("a name").to_owned())
            .collect()
    };
    let shadowed = render("penumbra");
    let receiver = &shadowed["surfaces"][0];
    assert_eq!(names(receiver), ["lit", "penumbra"]);
    assert_eq!(names(&shadowed), ["lit", "penumbra"]);
    is_put_together(receiver, receiver["samples"].as_u64());
    is_put_together(&shadowed, None);
    // B lies in the light's plane and sees A alone.
    let open = render("paper");
    for (surface, tag) in [(0, "lit"), (1, "reflected")] {
        let surface = &open["surfaces"][surface];
        assert_eq!(names(surface), [tag]);
        is_put_together(surface, surface["samples"].as_u64());
    }
}
