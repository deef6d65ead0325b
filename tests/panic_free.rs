//! No panic can be reached from the kernel, and its stack is bounded: both read
//! off the linked programs of every core, for every entry point and every rung.
//!
//! Skipped, loudly, where a tool is missing; with `ISOLUX_REQUIRE_QEMU=1` in
//! the environment that is a failure instead.

use std::path::{Path, PathBuf};
use std::process::Command;

use isolux_host::device::{Build, Core, Error, Toolchain, stack};

/// The prefix of the proof's entry points.
const ENTRY: &str = "isolux_entry_";

/// The most stack in bytes that an entry point may take: what a firmware has
/// to keep free for the kernel.
const STACK: u64 = 2048;

/// The same where there is no FPU: what its registers hold elsewhere is on the stack.
const STACK_WITHOUT_FPU: u64 = 2112;

/// The same for the entry points in `f64`, which only the host uses: every
/// number is twice as long and every operation a call.
const STACK_F64: u64 = 4096;

/// The same where the kernel is linked for few bytes: what is called there in place of being
/// written out has a frame of its own.
const STACK_SMALL: u64 = 2304;

/// The feature of the kernel for few bytes.
const SMALL: &str = "small";

/// The toolchain, where this machine has what the proof takes.
fn toolchain() -> Option<Toolchain> {
    let found = Toolchain::find().and_then(|toolchain| {
        Core::ALL
            .map(|core| toolchain.require(core))
            .into_iter()
            .collect::<Result<(), _>>()?;
        toolchain.tool("llvm-nm")?;
        Ok(toolchain)
    });
    match found {
        Ok(toolchain) => Some(toolchain),
        Err(error) => {
            let required = std::env::var_os("ISOLUX_REQUIRE_QEMU").is_some();
            assert!(error.is_missing() && !required, "{error}");
            eprintln!("SKIPPED: {error}");
            None
        }
    }
}

/// Links the proof into a directory.
fn link(
    toolchain: &Toolchain,
    core: Core,
    features: &[&str],
    directory: &Path,
) -> Result<PathBuf, Error> {
    let program = directory.join("proof");
    let plain = Build::of("proof");
    let is_small = features.contains(&SMALL);
    let build = Build {
        features,
        profile: if is_small {
            "firmware-small"
        } else {
            plain.profile
        },
        ..plain
    };
    toolchain.link(core, &build, &program)?;
    Ok(program)
}

/// Entry points that the proof's source defines.
fn defined() -> Vec<&'static str> {
    include_str!("firmware/src/proof.rs")
        .lines()
        .filter_map(|line| line.trim().strip_prefix("fn "))
        .filter_map(|rest| rest.split('(').next())
        .filter(|name| name.starts_with(ENTRY) && *name != "isolux_entry_bad")
        .collect()
}

#[test]
fn no_panic_is_reachable_and_the_stack_is_bounded() {
    let Some(toolchain) = toolchain() else { return };
    for core in Core::ALL {
        let directory = tempfile::tempdir().expect("a temporary directory");
        let program = link(&toolchain, core, &[], directory.path());
        let program = program.unwrap_or_else(|error| panic!("{}: {error}", core.name()));
        no_panic_is_linked(&toolchain, &program);
        let most = match core {
            Core::CortexM3 => STACK_WITHOUT_FPU,
            _ => STACK,
        };
        every_entry_is_bounded(&toolchain, core, &program, most);
    }
}

#[test]
fn few_bytes_of_code_are_as_safe() {
    let Some(toolchain) = toolchain() else { return };
    let core = Core::CortexM4F;
    let directory = tempfile::tempdir().expect("a temporary directory");
    let program = link(&toolchain, core, &[SMALL], directory.path());
    let program = program.unwrap_or_else(|error| panic!("{error}"));
    no_panic_is_linked(&toolchain, &program);
    every_entry_is_bounded(&toolchain, core, &program, STACK_SMALL);
}

fn no_panic_is_linked(toolchain: &Toolchain, program: &Path) {
    let names = toolchain.tool("llvm-nm").expect("found above");
    let listed = Command::new(names)
        .args(["--demangle", "--format=just-symbols"])
        .arg(program)
        .output()
        .expect("llvm-nm runs");
    let symbols = String::from_utf8_lossy(&listed.stdout);
    assert!(symbols.contains(ENTRY), "the symbols are listed");
    for suspect in [
        "core::panicking",
        "panic_fmt",
        "rust_begin_unwind",
        "__rust_alloc",
    ] {
        assert!(!symbols.contains(suspect), "{suspect} is linked");
    }
}

fn every_entry_is_bounded(toolchain: &Toolchain, core: Core, program: &Path, most: u64) {
    let disassembler = toolchain.tool("llvm-objdump").expect("beside llvm-nm");
    let bounds = stack::bounds(&disassembler, program, ENTRY);
    let bounds = bounds.unwrap_or_else(|error| panic!("{}: {error}", core.name()));
    let defined = defined();
    assert!(defined.len() > 30, "the source is read");
    for name in defined {
        // Double precision is for hosts: without FPU it has no place in the flash.
        let is_double = name.ends_with("_f64");
        if is_double && core == Core::CortexM3 {
            continue;
        }
        let bound = bounds.functions.get(name);
        let bound = bound.unwrap_or_else(|| panic!("{name} is not in the program"));
        println!(
            "{} {:5} bytes  {}",
            core.name(),
            bound.bytes,
            bound.path.join(" > ")
        );
        let most = if is_double { STACK_F64 } else { most };
        assert!(bound.bytes <= most, "{} {name}: {bound:?}", core.name());
    }
}

#[test]
fn a_reachable_panic_does_not_link() {
    let Some(toolchain) = toolchain() else { return };
    let directory = tempfile::tempdir().expect("a temporary directory");
    match link(&toolchain, Core::CortexM4F, &["bad"], directory.path()) {
        Err(Error::Build { output, .. }) => {
            assert!(output.contains("isolux_panic_is_reachable"), "{output}");
        }
        other => panic!("{other:?}"),
    }
}

/// The gate on the stack refuses what it must, in a program as linked.
#[test]
fn a_stack_without_bound_is_refused() {
    let Some(toolchain) = toolchain() else { return };
    let directory = tempfile::tempdir().expect("a temporary directory");
    let program = link(
        &toolchain,
        Core::CortexM4F,
        &["unbounded"],
        directory.path(),
    )
    .expect("it links");
    let disassembler = toolchain.tool("llvm-objdump").expect("beside llvm-nm");
    for (name, function, reason) in [
        ("recursion", "recursion", "recursive"),
        ("pointer", "pointer", "through a register"),
        ("step", "step", "an amount that is not in the code"),
        ("below", "recursion", "recursive"),
    ] {
        let prefix = format!("isolux_unbounded_{name}");
        match stack::bounds(&disassembler, &program, &prefix) {
            Err(Error::Unbounded { function: at, why }) => {
                assert_eq!(at, format!("isolux_unbounded_{function}"), "{name}");
                assert!(why.contains(reason), "{name}: {why}");
            }
            other => panic!("{name}: {other:?}"),
        }
    }
    // The kernel's own entries beside them are bounded all the same.
    stack::bounds(&disassembler, &program, ENTRY).expect("every entry is bounded");
}
