//! The program as its users meet it: exit codes, what is on stdout and what on
//! stderr, the columns and keys that scripts rely on, and that no run leaves
//! half a file behind.

#[path = "command_line/check.rs"]
mod check;
#[path = "command_line/form_factor.rs"]
mod form_factor;
#[path = "command_line/program.rs"]
mod program;
#[path = "command_line/refusals.rs"]
mod refusals;
#[path = "command_line/render.rs"]
mod render;
#[path = "command_line/rooms.rs"]
mod rooms;
#[path = "command_line/solve.rs"]
mod solve;
#[path = "command_line/whole.rs"]
mod whole;

use program::Ran;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

const HEAD: &str = "isolux = 1\nname = \"t\"\nquantity = \"radiometric\"\n";

/// A floor that reflects and a light above it, in lx; two named points.
fn desk() -> String {
    "isolux = 1\nname = \"desk\"\nquantity = \"photometric\"\n".to_owned()
        + "[[surface]]\nname = \"floor\"\nvertices = [[0,0,0],[4,0,0],[4,4,0],[0,4,0]]\nreflectance = 0.5\n"
        + "[[surface]]\nname = \"light\"\nvertices = [[1,1,2],[1,3,2],[3,3,2],[3,1,2]]\nradiance = 1000\n"
        + "[[point]]\nname = \"desk-1\"\nposition = [1, 1, 0.75]\nnormal = [0, 0, 2]\n"
        + "[[point]]\nname = \"up\"\nposition = [2, 2, 1]\nnormal = [0, 0, -1]\n"
        + "[budget]\nsamples = 24\n"
}

/// The same with a black board between light and floor: it needs visibility.
fn shaded() -> String {
    desk()
        + "[[surface]]\nname = \"board\"\nvertices = [[1.5,1.5,1],[2.5,1.5,1],[2.5,2.5,1],[1.5,2.5,1]]\n"
}

/// The same with a red floor: it needs three channels.
fn red() -> String {
    desk().replace("reflectance = 0.5", "reflectance = [0.8, 0.2, 0.2]")
}

fn write(directory: &Path, name: &str, text: &str) -> PathBuf {
    let path = directory.join(name);
    std::fs::write(&path, text).expect("a file");
    path
}

/// stdout as one JSON document of one line.
fn document(ran: &Ran) -> Value {
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert_eq!(ran.stdout.lines().count(), 1, "{}", ran.stdout);
    serde_json::from_str(&ran.stdout).expect("one JSON document")
}

fn keys(value: &Value) -> BTreeSet<&str> {
    let object = value.as_object().expect("an object");
    object.keys().map(String::as_str).collect()
}

fn set<const N: usize>(names: [&'static str; N]) -> BTreeSet<&'static str> {
    BTreeSet::from(names)
}

/// Nothing was answered, the code is this, and stderr is for people.
fn refused(ran: &Ran, code: i32) {
    assert_eq!(ran.code, code, "{ran:?}");
    assert_eq!(ran.stdout, "", "an answer beside a refusal");
    assert!(ran.stderr.starts_with("error"), "{}", ran.stderr);
    assert!(!ran.stderr.contains("panicked"), "{}", ran.stderr);
}

/// All files below a directory.
fn files(directory: &Path) -> BTreeSet<PathBuf> {
    let mut found = BTreeSet::new();
    for entry in std::fs::read_dir(directory).expect("a directory") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            found.insert(path);
        }
    }
    found
}
