//! `isolux check`: never exits 1.

use crate::program::isolux;
use crate::{desk, document, keys, red, set, shaded, write};

const KEYS: [&str; 9] = [
    "scene",
    "surfaces",
    "emitters",
    "bodies",
    "channels",
    "requires",
    "capacities",
    "ram_bytes",
    "flash_bytes",
];

#[test]
fn the_paper_scene_is_described() {
    let directory = tempfile::tempdir().expect("a directory");
    let checked = document(&isolux(&["check", "paper", "--json"], directory.path(), ""));
    assert_eq!(keys(&checked), set(KEYS));
    assert_eq!(checked["scene"], "paper-simple");
    let counts = ["surfaces", "emitters", "bodies", "channels"].map(|key| checked[key].as_u64());
    assert_eq!(counts, [Some(3), Some(1), Some(0), Some(1)]);
    assert!(!checked["requires"].as_array().expect("a list").is_empty());
    for need in checked["requires"].as_array().expect("a list") {
        assert_eq!(keys(need), set(["what", "why"]));
        assert!(need["why"].as_str().is_some_and(|why| !why.is_empty()));
    }
    assert_eq!(checked["capacities"]["samples"], 58);
    let ram = checked["ram_bytes"].as_u64().expect("a number");
    let flash = checked["flash_bytes"].as_u64().expect("a number");
    assert!((232..2048).contains(&ram), "{ram}");
    assert!((1000..32_768).contains(&flash), "{flash}");

    let said = isolux(&["check", "paper"], directory.path(), "");
    assert_eq!((said.code, said.stderr.as_str()), (0, ""));
    assert!(said.stdout.contains("58 samples"), "{}", said.stdout);
    assert!(
        said.stdout.contains(&format!("{ram} bytes of RAM")),
        "{}",
        said.stdout
    );
}

#[test]
fn what_this_build_lacks_is_said_and_is_no_failure() {
    let directory = tempfile::tempdir().expect("a directory");
    for (name, text, what) in [
        (
            "rung.toml",
            desk() + "[rungs]\ntransfer = \"matrix\"\nemitters = \"isolux\"\n",
            "matrix",
        ),
        (
            "few.toml",
            desk().replace("samples = 24", "samples = 1"),
            "samples",
        ),
    ] {
        write(directory.path(), name, &text);
        let said = isolux(&["check", name], directory.path(), "");
        assert_eq!((said.code, said.stderr.as_str()), (0, ""), "{name}");
        assert!(
            said.stdout.contains("cannot be planned by this build"),
            "{}",
            said.stdout
        );
        assert!(said.stdout.contains(what), "{}", said.stdout);
        let checked = document(&isolux(&["check", name, "--json"], directory.path(), ""));
        let mut expected = set(KEYS);
        expected.insert("lacking");
        assert_eq!(keys(&checked), expected);
        assert!(
            checked["lacking"]
                .as_str()
                .is_some_and(|text| text.contains(what))
        );
        assert!(checked["capacities"].is_null() && checked["ram_bytes"].is_null());
    }
    write(directory.path(), "shaded.toml", &shaded());
    write(directory.path(), "red.toml", &red());
    let check = |name| document(&isolux(&["check", name, "--json"], directory.path(), ""));
    let needs = check("shaded.toml")["requires"].to_string();
    assert!(needs.contains("board"), "why names the occluder: {needs}");
    assert_eq!(check("red.toml")["channels"], 3);
    assert_eq!(keys(&check("red.toml")), set(KEYS), "nothing is lacking");
}

#[test]
fn scenes_are_found_by_path_before_name() {
    let directory = tempfile::tempdir().expect("a directory");
    for name in ["paper", "paper.toml", "paper-aspect", "paper-aspect.toml"] {
        assert_eq!(
            isolux(&["check", name], directory.path(), "").code,
            0,
            "{name}"
        );
    }
    write(directory.path(), "paper.toml", &desk());
    let checked = document(&isolux(
        &["check", "paper.toml", "--json"],
        directory.path(),
        "",
    ));
    assert_eq!(checked["scene"], "desk");
}
