//! What is refused, and how the refusal reads.

use std::fs;

use isolux_host::scene::Diagnostic;
use isolux_host::scene::file::{parse, read};

use crate::{HEAD, SQUARE, body_of, cube_without, with_extra, with_vertices};

fn refusal(source: &str) -> Diagnostic {
    match parse("room.toml", source) {
        Ok(_) => panic!("accepted:\n{source}"),
        Err(diagnostic) => diagnostic,
    }
}

/// A malformed scene and what its diagnostic must say.
struct Refused {
    source: String,
    line: usize,
    column: usize,
    message: &'static str,
    remedy: &'static str,
}

fn check_refused(cases: &[Refused]) {
    for case in cases {
        let diagnostic = refusal(&case.source);
        let shown = format!("{diagnostic}\nfrom:\n{}", case.source);
        assert!(diagnostic.message.contains(case.message), "{shown}");
        assert!(diagnostic.remedy.contains(case.remedy), "{shown}");
        assert_eq!(
            (diagnostic.line, diagnostic.column),
            (Some(case.line), Some(case.column)),
            "{shown}"
        );
        assert_eq!(diagnostic.file, "room.toml");
        let place = format!("room.toml:{}:{}", case.line, case.column);
        assert!(shown.contains(&place), "{shown}");
        assert!(shown.contains("help: "), "{shown}");
    }
}

fn refused(
    source: String,
    (line, column): (usize, usize),
    message: &'static str,
    remedy: &'static str,
) -> Refused {
    Refused {
        source,
        line,
        column,
        message,
        remedy,
    }
}

#[test]
#[rustfmt::skip] // one case a line
fn document_faults_are_shown_with_place_and_remedy() {
    let swap = |from: &str, to: &str| with_extra("").replacen(from, to, 1);
    check_refused(&[
        refused("isolux = 1\nname = \n".into(), (2, 8), "not valid TOML", "toml.io"),
        refused("isolux = 1\nisolux = 1\n".into(), (2, 1), "duplicate key", "remove one"),
        refused("isolux = ".to_owned() + &"[".repeat(100_000), (1, 90), "not valid TOML", "nested brackets"),
        refused(String::new(), (1, 1), "version is missing", "isolux = 1"),
        refused(swap("isolux = 1\n", ""), (1, 1), "version is missing", "isolux = 1"),
        refused(swap("isolux = 1", "isolux = 2"), (1, 10), "unknown format version", "isolux = 1"),
        refused(swap("isolux = 1", "isolux = \"1\""), (1, 10), "unknown format version", "isolux = 1"),
        refused(swap("name = \"t\"\n", ""), (1, 1), "no `name`", "name = "),
        refused(swap("\"t\"", "\"\""), (2, 8), "visible character", "short name"),
        refused(swap("quantity = \"radiometric\"\n", ""), (1, 1), "no `quantity`", "quantity = "),
        refused(swap("radiometric", "radiant"), (3, 12), "unknown quantity `radiant`", "photometric"),
        refused(swap("quantity", "quantiti"), (3, 1), "unknown key `quantiti`", "did you mean `quantity`?"),
        refused(swap("name = \"A\"", "zzz = 1\nname = \"A\""), (5, 1), "unknown key `zzz` in a surface", "`vertices`"),
        refused(HEAD.into(), (1, 1), "no surface", "[[surface]]"),
        refused(format!("{HEAD}surface = []"), (1, 1), "no surface", "[[surface]]"),
        refused(swap("[[surface]]", "[surface]"), (4, 1), "must be a list of tables", "[[surface]]"),
        refused(format!("{HEAD}surface = [3]"), (4, 12), "must be a list of tables", "[[surface]]"),
    ]);
}

#[test]
#[rustfmt::skip] // one case a line
fn surface_faults_are_shown_with_place_and_remedy() {
    let twice = format!("[[surface]]\nname = \"A\"\nvertices = {SQUARE}");
    check_refused(&[
        refused(format!("{HEAD}[[surface]]\nname = \"A\""), (4, 1), "no `vertices`", "vertices = [["),
        refused(format!("{HEAD}[[surface]]\nvertices = {SQUARE}"), (4, 1), "no `name`", "name = "),
        refused(with_extra(&twice), (8, 8), "two surfaces are named `A`", "line 5"),
        refused(with_extra("reflectanse = 0.5"), (7, 1), "unknown key `reflectanse`", "`reflectance`?"),
        refused(with_extra("reflectance = 1.0"), (7, 15), "reflectance 1 is not below 1", "rho < 1"),
        refused(with_extra("reflectance = 1"), (7, 15), "not below 1", "rho < 1"),
        refused(with_extra("reflectance = -0.1"), (7, 15), "reflectance -0.1 is negative", "0 <= rho"),
        refused(with_extra("reflectance = [0.1, 0.2, 1.5]"), (7, 26), "reflectance 1.5", "rho < 1"),
        refused(with_extra("reflectance = 0.99999999999"), (7, 15), "single precision", "0.9999999"),
        refused(with_extra("reflectance = [0.1, 0.2]"), (7, 15), "not 2 of them", "[0.6, 0.5, 0.4]"),
        refused(with_extra("reflectance = \"half\""), (7, 15), "must be a number, not a string", "= 0.5"),
        refused(with_extra("reflectance = nan"), (7, 15), "finite number, not nan", "= 0.5"),
        refused(with_extra("radiance = inf"), (7, 12), "finite number, not inf", "= 0.5"),
        refused(with_extra("radiance = 1e999"), (7, 12), "finite number, not 1e999", "= 0.5"),
        refused(with_extra("radiance = -1"), (7, 12), "radiance -1 is negative", "radiance >= 0"),
        refused(with_extra("radiance = 1e30"), (7, 12), "radiance 1e30 is outside", "scale all"),
        refused(with_extra("radiance = [1, 1e-30, 0]"), (7, 16), "radiance 1e-30 is outside", "scale all"),
    ]);
}

#[test]
#[rustfmt::skip] // one case a line
fn polygon_faults_are_shown_with_place_and_remedy() {
    let polygon = |vertices: &str, column, message, remedy| {
        refused(with_vertices(vertices), (6, column), message, remedy)
    };
    let many = (0..300)
        .map(|i| format!("[{i},{},0]", i * i))
        .collect::<Vec<_>>();
    check_refused(&[
        polygon("[[0,0,0],[1,0,0]]", 12, "at least 3 vertices, not 2", "three vertices"),
        polygon("[]", 12, "at least 3 vertices, not 0", "three vertices"),
        polygon(&format!("[{}]", many.join(",")), 12, "at most 256", "split"),
        polygon("3", 12, "must be a list of vertices, not a number", "[[0, 0, 0]"),
        polygon("[[0,0,0],[1,0],[1,1,0]]", 21, "not 2 of them", "[1.5, 0, 2]"),
        polygon("[[0,0,0],[1,0,0],[1,nan,0]]", 32, "finite number, not nan", "[1.5, 0, 2]"),
        polygon("[[0,0,0],[1,0,0],[1,-inf,0]]", 32, "finite number, not -inf", "[1.5, 0, 2]"),
        polygon("[[0,0,0],[1,0,0],[1,1e7,0]]", 29, "beyond 1000000 m", "metres"),
        polygon("[[0,0,0],[1,0,0],[2,0,0]]", 12, "zero area", "off the line"),
        polygon("[[0,0,0],[1,0,0],[2,1e-8,0]]", 12, "zero area", "off the line"),
        polygon("[[0,0,0],[1e-7,0,0],[0,1e-7,0]]", 12, "m across", "metres"),
        polygon("[[0,0,0],[1,0,0],[1,1,0.01],[0,1,0]]", 12, "not planar: a vertex lies 2.500e-3 m", "triangles"),
        polygon("[[0,0,0],[1,0,0],[2,0.5,0],[1,1,0.1],[0,1,0],[-1,0.5,0]]", 39, "not planar: vertex 4 lies", "triangles"),
        polygon("[[0,0,0],[1,1,0],[1,0,0],[0,1,0]]", 29, "crosses itself", "in order around"),
        polygon("[[0,0,0],[4,4,0],[4,0,0],[0,2,0]]", 29, "crosses itself", "in order around"),
        polygon("[[0,0,0],[1,0,0],[1,0,0],[0,1,0]]", 21, "vertex 2 and the next are the same", "leave one"),
        polygon("[[0,0,0],[1,0,0],[0,1,0],[0,0,0]]", 37, "vertex 4 and the next are the same", "by itself"),
        polygon("[[0,0,0],[2,0,0],[1,0,0],[1,1,0]]", 21, "folds back on itself at vertex 2", "tip"),
        // a corner of the polygon rests on one of its other edges
        polygon("[[0,0,0],[2,0,0],[2,2,0],[1,0,0],[0,2,0]]", 29, "touches itself", "split"),
    ]);
}

#[test]
#[rustfmt::skip] // one case a line
fn body_faults_are_shown_with_place_and_remedy() {
    let whole = cube_without(&[]);
    let list = "surfaces = [\"bottom\"";
    let inward = whole.replacen(
        "[[0,0,1],[1,0,1],[1,1,1],[0,1,1]]",
        "[[0,1,1],[1,1,1],[1,0,1],[0,0,1]]",
        1,
    );
    // An L of two cubes' worth: its inner corner is not convex.
    let notch = body_of(&[
        ("floor", "[[0,0,0],[0,1,0],[2,1,0],[2,0,0]]"),
        ("step", "[[1,0,1],[2,0,1],[2,1,1],[1,1,1]]"),
        ("inner", "[[1,0,1],[1,1,1],[1,1,2],[1,0,2]]"),
    ]);
    check_refused(&[
        refused(whole.replace(list, "surfaces = [\"botom\""), (24, 13), "no surface `botom`", "did you mean `bottom`?"),
        refused(whole.replace(list, "surfaces = [7"), (24, 13), "must be a string", "block-top"),
        refused(whole.replace(list, "surfaces = [\"top\""), (24, 20), "already a face of body `cube`", "name it once"),
        refused(with_extra("[[body]]\nname = \"b\"\nsurfaces = []"), (9, 12), "no surface", "leave the body out"),
        refused(with_extra("[[body]]\nname = \"b\"\nsurfaces = [\"A\"]"), (9, 12), "no volume", "occlude by themselves"),
        refused(inward, (24, 23), "looks into its body", "reverse"),
        refused(notch, (15, 22), "not convex", "convex bodies"),
        refused(cube_without(&["bottom", "top"]), (20 - 2, 13), "not closed", "missing faces"),
        refused(cube_without(&["bottom", "south"]), (20 - 2, 13), "not closed", "missing faces"),
        refused(format!("{whole}{}", "[[body]]\nname = \"cube\"\nsurfaces = [\"top\"]" ), (26, 8), "two bodies are named", "line 23"),
        refused(whole.replace("name = \"cube\"\n", ""), (22, 1), "no `name`", "name = "),
    ]);
}

#[test]
#[rustfmt::skip] // one case a line
fn settings_faults_are_shown_with_place_and_remedy() {
    let camera = |eye: &str, target: &str, up: &str, fov: &str| {
        with_extra(&format!(
            "[camera]\neye = {eye}\ntarget = {target}\nup = {up}\nfov = {fov}"
        ))
    };
    let (eye, target, up) = ("[0,-8,3]", "[0,0,1]", "[0,0,1]");
    let point = |position: &str, normal: &str| {
        with_extra(&format!(
            "[[point]]\nname = \"p\"\nposition = {position}\nnormal = {normal}"
        ))
    };
    let twice = point("[0,0,1]", "[0,0,1]")
        + "[[point]]\nname = \"p\"\nposition = [0,0,1]\nnormal = [0,0,1]\n";
    check_refused(&[
        refused(point("[0,0,1]", "[0,0,0]"), (10, 10), "normal is zero", "[0, 0, 1]"),
        refused(point("[0,0]", "[0,0,1]"), (9, 12), "not 2 of them", "position = "),
        refused(point("[0,0,1e9]", "[0,0,1]"), (9, 12), "beyond 1000000 m", "metres"),
        refused(twice, (12, 8), "two points are named `p`", "line 8"),
        refused(with_extra("[rungs]\narithmetic = \"besst\""), (8, 14), "unknown rung `besst`", "did you mean `best`? its rungs are `libm`"),
        refused(with_extra("[rungs]\nvisibility = \"q29\""), (8, 14), "unknown rung `q29` of the ladder `visibility`", "`none`, `vertex-rays` and `exact`"),
        refused(with_extra("[rungs]\nspeed = \"best\""), (8, 1), "unknown key `speed`", "`reconstruction`"),
        refused(with_extra("[rungs]\ntransfer = 1"), (8, 12), "must be a string", "transfer = \"exact\""),
        refused(camera(eye, eye, up, "40"), (9, 10), "same place", "target"),
        refused(camera(eye, "[0,-8,0]", up, "40"), (10, 6), "parallel to its view", "[0, 1, 0]"),
        refused(camera(eye, target, "[0,0,0]", "40"), (10, 6), "up is zero", "[0, 0, 1]"),
        refused(camera(eye, target, up, "0"), (11, 7), "0 degrees", "less than 180"),
        refused(camera(eye, target, up, "180"), (11, 7), "180 degrees", "less than 180"),
        refused(camera(eye, target, up, "nan"), (11, 7), "finite number", "fov = 40.0"),
        refused(with_extra("[camera]\neye = [0,0,1]"), (7, 1), "no `target`", "target = "),
        refused(with_extra("camera = 3"), (7, 1), "unknown key `camera` in a surface", "the keys"),
        refused(with_extra("[[budget]]\nram = 3"), (7, 1), "must be a table", "[budget]"),
        refused(with_extra("[budget]\nram = \"16 Kib of it\""), (8, 7), "not a number of bytes", "16 KiB"),
        refused(with_extra("[budget]\nram = -5"), (8, 7), "-5 is not a possible", "16 KiB"),
        refused(with_extra("[budget]\nflash = 1.5"), (8, 9), "not a number of bytes", "16 KiB"),
        refused(with_extra("[budget]\nflash = \"9999 EiB\""), (8, 9), "more bytes than", "16 KiB"),
        refused(with_extra("[budget]\nram = 0"), (8, 7), "0 bytes", "leave the key out"),
        refused(with_extra("[budget]\nsamples = 2.5"), (8, 11), "whole number", "samples = 59"),
        refused(with_extra("[budget]\nsamples = 0"), (8, 11), "at least 1", "samples = 59"),
    ]);
}

#[test]
fn files_that_cannot_be_read_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let missing = folder.path().join("missing.toml");
    let diagnostic = read(&missing).expect_err("missing");
    assert!(
        diagnostic.message.contains("cannot read the file"),
        "{diagnostic}"
    );
    assert_eq!((diagnostic.line, diagnostic.column), (None, None));
    assert!(diagnostic.to_string().contains("missing.toml"));
    read(folder.path()).expect_err("a folder is not a scene");
    let binary = folder.path().join("binary.toml");
    fs::write(&binary, b"isolux = 1\nname = \"\xff\xfe\"\n").expect("written");
    let diagnostic = read(&binary).expect_err("binary");
    assert!(diagnostic.message.contains("not UTF-8"), "{diagnostic}");
    assert_eq!((diagnostic.line, diagnostic.column), (Some(2), Some(9)));
}

#[test]
fn diagnostics_read_like_a_compilers() {
    let diagnostic = refusal(&with_extra("reflectanse = 0.5"));
    assert_eq!(
        diagnostic.to_string(),
        "error: unknown key `reflectanse` in a surface
 --> room.toml:7:1
  |
7 | reflectanse = 0.5
  | ^^^^^^^^^^^
  |
  = help: did you mean `reflectance`?"
    );
    let json = serde_json::to_value(&diagnostic).expect("JSON");
    assert_eq!(
        json,
        serde_json::json!({
            "message": "unknown key `reflectanse` in a surface",
            "file": "room.toml", "line": 7, "column": 1,
            "remedy": "did you mean `reflectance`?",
        })
    );
    assert!(diagnostic.render(true).contains('\u{1b}'));
    // Columns count characters, lines may end as Windows ends them.
    let source = with_extra("").replace('\n', "\r\n") + "\"é\\u001b\" = 1\r\n";
    let diagnostic = refusal(&source.replace("\"é", "  \"é"));
    assert_eq!(
        (diagnostic.line, diagnostic.column),
        (Some(8), Some(3)),
        "{diagnostic}"
    );
    assert!(!diagnostic.to_string().contains('\u{1b}'), "{diagnostic:?}");
}
