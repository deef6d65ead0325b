//! What `isolux bake` writes: four files that are the same every time, a source that
//! a firmware links, tables that the kernel takes and of another version refuses.

#[path = "command_line/program.rs"]
mod program;

use isolux::scene::{Scene, VERSION, records::checksum};
use program::isolux;
use std::fs;
use std::path::Path;
use tempfile::TempDir;
use zerocopy::IntoBytes;

fn directory() -> TempDir {
    tempfile::tempdir().expect("a directory")
}

/// Bakes a scene and gives the answer on stdout.
fn bake(arguments: &[&str], directory: &Path) -> String {
    let ran = isolux(&[&["bake"], arguments].concat(), directory, "");
    assert_eq!(ran.code, 0, "{arguments:?}: {}", ran.stderr);
    ran.stdout
}

/// The files of a directory by name, with their bytes.
fn files(directory: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(directory).expect("a directory");
    let mut found: Vec<_> = entries
        .map(|entry| {
            let entry = entry.expect("an entry");
            let name = entry.file_name().into_string().expect("UTF-8");
            (name, fs::read(entry.path()).expect("a file"))
        })
        .collect();
    found.sort();
    found
}

fn text(directory: &Path, file: &str) -> String {
    fs::read_to_string(directory.join(file)).expect("a file")
}

/// Bytes where words may lie.
fn words(bytes: &[u8]) -> Vec<u32> {
    let word = |word: &[u8]| u32::from_le_bytes(word.try_into().expect("four bytes"));
    bytes.chunks_exact(4).map(word).collect()
}

#[test]
fn baking_twice_gives_the_same_four_files() {
    let directory = directory();
    let said = bake(&["penumbra", "-o", "a"], directory.path());
    let document = bake(&["--json", "penumbra", "-o", "b/c"], directory.path());
    let (first, second) = (
        files(&directory.path().join("a")),
        files(&directory.path().join("b/c")),
    );
    let names: Vec<_> = first.iter().map(|(name, _)| name.as_str()).collect();
    let expected = [
        "penumbra.isolux",
        "penumbra.json",
        "penumbra.md",
        "penumbra.rs",
    ];
    assert_eq!(names, expected);
    assert!(first == second, "other bytes");
    assert!(said.contains("wrote a/penumbra.isolux"), "{said}");

    // The document on stdout is the sheet in the file, and the files.
    let mut document: serde_json::Value = serde_json::from_str(&document).expect("JSON");
    let files = document
        .as_object_mut()
        .and_then(|object| object.remove("files"));
    assert_eq!(files.expect("files").as_array().map(Vec::len), Some(4));
    let sheet: serde_json::Value =
        serde_json::from_str(&text(&directory.path().join("a"), "penumbra.json")).expect("JSON");
    assert_eq!(document, sheet);
    assert_eq!(sheet["table_bytes"].as_u64(), Some(first[0].1.len() as u64));
}

#[test]
fn a_plan_is_baked_as_it_is() {
    let directory = directory();
    let planned = ["plan", "penumbra", "--samples", "30", "-o", "p.plan"];
    assert_eq!(isolux(&planned, directory.path(), "").code, 0);
    bake(
        &["penumbra", "--plan", "p.plan", "-o", "a"],
        directory.path(),
    );
    let tables = words(&fs::read(directory.path().join("a/penumbra.isolux")).expect("tables"));
    let scene = Scene::load(tables.as_bytes()).expect("sound tables");
    // Named points are beside the plan's samples.
    let planned = scene.counts().samples - scene.counts().points;
    assert!(planned <= 30, "{planned}");
    let source = text(&directory.path().join("a"), "penumbra.rs");
    let samples = format!("pub const SAMPLES: usize = {};", scene.counts().samples);
    assert!(source.contains(&samples), "{source}");
}

/// What a scene does not need is not named: nothing of it can be linked.
#[test]
fn the_source_names_what_the_scene_requires() {
    let directory = directory();
    let of = |scene: &str, flags: &[&str]| {
        bake(&[&[scene, "-o", "a"], flags].concat(), directory.path());
        text(&directory.path().join("a"), &format!("{scene}.rs"))
    };
    let open = of("paper", &[]);
    for part in ["Best<Root>", "Constant<f32>", "Unoccluded", "Tensors<Root>"] {
        assert!(open.contains(part), "{part}: {open}");
    }
    for part in ["Rgb", "Exact<", "Stencils", "Linear", "Codes"] {
        assert!(!open.contains(part), "{part}: {open}");
    }
    let integers = of("paper", &["--arithmetic", "q29"]);
    assert!(integers.contains("isolux::integers::Q29"), "{integers}");
    assert!(!integers.contains("Root;"), "{integers}");
    let shadows = of(
        "penumbra",
        &["--transfer", "codes", "--arithmetic", "poly3"],
    );
    for part in [
        "Poly3<Root>",
        "Linear<f32>",
        "transfer::Codes",
        "Stencils<Root>",
    ] {
        assert!(shadows.contains(part), "{part}: {shadows}");
    }
    assert!(!shadows.contains("Exact<"), "{shadows}");
}

/// Where walls may be painted the light keeps their reflectances, and the sheet has them.
#[test]
fn reflectances_change_where_that_is_asked_for() {
    let directory = directory();
    let directory = directory.path();
    let planned = [
        "plan",
        "penumbra",
        "--samples",
        "30",
        "--repaint",
        "-o",
        "p.plan",
    ];
    assert_eq!(isolux(&planned, directory, "").code, 0);
    let plan = text(directory, "p.plan");
    assert!(plan.contains("\nrepaint = true\n"), "{plan}");
    fs::write(
        directory.join("not.plan"),
        plan.replace("repaint = true\n", ""),
    )
    .expect("a file");
    let ram = |plan: &str, flags: &[&str]| {
        let flags = [&["--json", "penumbra", "--plan", plan, "-o", "a"], flags].concat();
        let sheet: serde_json::Value =
            serde_json::from_str(&bake(&flags, directory)).expect("JSON");
        sheet["ram_bytes"].as_u64().expect("bytes")
    };
    let without = ram("not.plan", &[]);
    assert!(!text(&directory.join("a"), "penumbra.rs").contains(", SURFACES>"));
    let with = ram("p.plan", &[]);
    assert!(text(&directory.join("a"), "penumbra.rs").contains("Transfer, SURFACES>;"));
    // The luminaire, the receiver and the occluder.
    assert_eq!(with, without + 4 * 3);
    assert_eq!(ram("not.plan", &["--repaint"]), with);
    let vectors = ["--plan", "p.plan", "--transfer", "vectors", "-o", "a"];
    let refused = isolux(
        &[&["bake", "penumbra"], &vectors[..]].concat(),
        directory,
        "",
    );
    assert_eq!(refused.code, 2, "{}", refused.stderr);
    assert!(refused.stderr.contains("--repaint"), "{}", refused.stderr);
}

#[test]
fn names_are_constants() {
    let directory = directory();
    let scene = "isolux = 1\nname = \"two words\"\nquantity = \"photometric\"\n\
        [[surface]]\nname = \"floor\"\nvertices = [[0,0,0],[4,0,0],[4,4,0],[0,4,0]]\nreflectance = 0.5\n\
        [[surface]]\nname = \"lamp 1\"\nvertices = [[1,1,2],[1,3,2],[3,3,2],[3,1,2]]\nradiance = 1000\n\
        [[point]]\nname = \"desk-1\"\nposition = [1, 1, 0.75]\nnormal = [0, 0, 2]\n\
        [budget]\nsamples = 24\n";
    fs::write(directory.path().join("My room.toml"), scene).expect("a file");
    bake(&["My room.toml", "-o", "."], directory.path());
    let source = text(directory.path(), "my_room.rs");
    for line in [
        "    pub const FLOOR: usize = 0;",
        "    pub const LAMP_1: usize = 1;",
        "    pub const LAMP_1: usize = 0;",
        "    pub const DESK_1: usize = 0;",
        "    [[1.0, 1.0, 0.75], [0.0, 0.0, 1.0]],",
        "pub const IRRADIANCE_UNIT: &str = \"lx\";",
    ] {
        assert!(source.lines().any(|has| has == line), "{line}: {source}");
    }
}

#[test]
fn tables_of_another_version_are_refused() {
    let directory = directory();
    bake(&["penumbra", "-o", "."], directory.path());
    let mut tables = words(&fs::read(directory.path().join("penumbra.isolux")).expect("tables"));
    assert_eq!(tables[2], VERSION);
    for other in [VERSION - 1, VERSION + 1] {
        tables[2] = other;
        tables[4] = checksum(&tables.as_bytes()[20..]);
        let error = Scene::load(tables.as_bytes()).expect_err("another version");
        let said = error.to_string();
        assert!(said.contains(&format!("version {other}")), "{said}");
        assert!(said.contains("bake the scene again"), "{said}");
    }
}

#[test]
fn a_directory_that_cannot_be_made_is_refused_before_the_work() {
    let directory = directory();
    fs::write(directory.path().join("taken"), "").expect("a file");
    let ran = isolux(&["bake", "cornell", "-o", "taken"], directory.path(), "");
    assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{ran:?}");
    assert!(ran.stderr.contains("-o DIR"), "{}", ran.stderr);
}

#[test]
fn what_a_device_does_not_hold_is_refused_and_nothing_is_written() {
    let directory = directory();
    let script = |flash: &str, ram: &str| {
        let regions = format!("FLASH : LENGTH = {flash}\n  RAM : LENGTH = {ram}\n");
        let script = format!("MEMORY\n{{\n  {regions}}}\n");
        fs::write(directory.path().join("part.x"), script).expect("a file");
    };
    let bake = || {
        let arguments = ["bake", "penumbra", "-o", "out", "--memory", "part.x"];
        isolux(&arguments, directory.path(), "")
    };
    // Its tables take about 20 KiB, its state 3 KiB.
    for (flash, ram, words) in [
        (
            "8K",
            "64K",
            ["of flash for its tables, part.x has 8192", "--flash 8192"],
        ),
        ("256K", "2K", ["of RAM, part.x has 2048", "--ram 2048"]),
    ] {
        script(flash, ram);
        let ran = bake();
        assert_eq!((ran.code, ran.stdout.as_str()), (1, ""), "{ran:?}");
        for word in words {
            assert!(ran.stderr.contains(word), "{word}: {}", ran.stderr);
        }
        assert!(files(&directory.path().join("out")).is_empty());
    }
    // They fit, but leave less than half to the code.
    script("32K", "64K");
    let ran = bake();
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(
        ran.stderr.contains("part.x has 16384 beside 16384 of code"),
        "{}",
        ran.stderr
    );
    // A plan for the part does.
    let arguments = ["plan", "penumbra", "-o", "part.plan", "--memory", "part.x"];
    let planned = isolux(&arguments, directory.path(), "");
    assert_eq!(planned.code, 0, "{}", planned.stderr);
    let arguments = [
        "bake",
        "penumbra",
        "-o",
        "out",
        "--memory",
        "part.x",
        "--plan",
        "part.plan",
    ];
    let ran = isolux(&arguments, directory.path(), "");
    assert_eq!((ran.code, ran.stderr.as_str()), (0, ""));
    assert!(
        fs::metadata(directory.path().join("out/penumbra.isolux"))
            .expect("tables")
            .len()
            <= 16384
    );
    // What is no memory is an input error with its place.
    script("much", "64K");
    let ran = bake();
    assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{ran:?}");
    assert!(ran.stderr.contains("part.x:3:20"), "{}", ran.stderr);
}

/// The README's program, with what the README's command bakes, in a crate of its own:
/// it compiles without a warning and gives the light that `isolux solve` gives.
#[test]
fn the_readmes_program_runs() {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR"));
    let readme = fs::read_to_string(workspace.join("README.md")).expect("a README");
    let section = readme
        .split("\n## ")
        .find(|part| part.starts_with("In your own firmware"));
    let program = section.and_then(|part| part.split("```rust\n").nth(1)?.split("```").next());
    let directory = directory();
    let source = directory.path().join("src");
    bake(&["office", "-o", "src"], directory.path());
    fs::write(source.join("main.rs"), program.expect("a program")).expect("a file");
    let manifest = format!(
        "[package]\nname = \"yours\"\nedition = \"2024\"\n[dependencies]\nisolux = {{ path = {:?} }}\n[workspace]\n[profile.dev]\nopt-level = 1\n",
        workspace.join("kernel")
    );
    fs::write(directory.path().join("Cargo.toml"), manifest).expect("a file");
    // The same versions of what the kernel takes.
    fs::copy(
        workspace.join("Cargo.lock"),
        directory.path().join("Cargo.lock"),
    )
    .expect("a file");
    let ran = std::process::Command::new(std::env::var_os("CARGO").expect("cargo runs tests"))
        .args(["run", "--quiet"])
        .current_dir(directory.path())
        .env("CARGO_TARGET_DIR", workspace.join("target/yours"))
        .env("RUSTFLAGS", "-Dwarnings")
        .output()
        .expect("cargo runs");
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert!(
        ran.status.success(),
        "{}",
        String::from_utf8_lossy(&ran.stderr)
    );
    let value = |name: &str| -> f64 {
        let line = said.lines().find_map(|line| line.strip_prefix(name));
        let word = line.and_then(|line| line.trim().strip_suffix("lx"));
        word.and_then(|word| word.trim().parse().ok()).expect(name)
    };
    let places = "2 2 0 0 0 1\n1.4 4.1 0.72 0 0 1\n";
    fs::write(directory.path().join("places.pts"), places).expect("a file");
    let solved = isolux(
        &["solve", "office", "--points", "places.pts"],
        directory.path(),
        "",
    );
    let expected: Vec<f64> = solved
        .stdout
        .lines()
        .skip(1)
        .map(|line| {
            let last = line.rsplit(',').next().and_then(|word| word.parse().ok());
            last.expect("a number")
        })
        .collect();
    // The one is reconstructed, and both are of another plan than `solve` makes.
    assert!(
        (value("floor") / expected[0] - 1.0).abs() < 0.02,
        "{said} {expected:?}"
    );
    assert!(
        (value("desk-1") / expected[1] - 1.0).abs() < 0.01,
        "{said} {expected:?}"
    );
}
