//! Gives the linker the device's memory, and the node the scene it was baked for.
//!
//! `OFFICE` names the directory that `isolux bake office --transfer vectors -o DIR`
//! wrote.

use std::env;
use std::fs;
use std::path::PathBuf;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=OFFICE");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let variable = |name| env::var_os(name).map(PathBuf::from);
    let (Some(manifest), Some(out)) = (variable("CARGO_MANIFEST_DIR"), variable("OUT_DIR")) else {
        println!("cargo::error=this script is run by cargo");
        return;
    };
    let memory = manifest.join("../../memory.x");
    println!("cargo::rerun-if-changed={}", memory.display());
    fs::copy(&memory, out.join("memory.x")).expect("memory.x is copied beside the linker script");
    println!("cargo::rustc-link-search={}", out.display());
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
    let baked = variable("OFFICE").map(|office| office.join("office.rs"));
    let Some(baked) = baked.filter(|baked| baked.is_file()) else {
        println!(
            "cargo::error=OFFICE must name a directory with a baked office: isolux bake office --transfer vectors -o DIR"
        );
        return;
    };
    println!("cargo::rerun-if-changed={}", baked.display());
    println!(
        "cargo::rerun-if-changed={}",
        baked.with_extension("isolux").display()
    );
    let module = format!("/// The office, as it was baked.\n#[path = {baked:?}]\nmod office;\n");
    fs::write(out.join("office.rs"), module).expect("OUT_DIR is writable");
}
