//! A firmware with one rung holds that rung and no other, and nothing of the
//! features it did not ask for: read off the linked programs, from the names of
//! their functions and of those that the optimiser has put into them. How many
//! bytes each rung takes is gated by tests/trade.rs.
//!
//! Skipped, loudly, where a tool is missing; with `ISOLUX_REQUIRE_QEMU=1` in
//! the environment that is a failure instead.

use isolux_host::device::{self, Core, Extent, Flash};
use isolux_host::solve::FormFactorRung;

/// Parts of functions' names by whose rungs may hold them. Symbols spell a path
/// with the lengths of its words: `isolux11form_factor8residual`, or with dots
/// within brackets, `isolux..form_factor..residual`.
const PARTS: [(&[&str], &[&str]); 5] = [
    (
        &["11form_factor8residual", "form_factor..residual"],
        &["best"],
    ),
    (
        &["11form_factor5snell", "form_factor..snell"],
        &["poly3", "poly5", "poly8", "best"],
    ),
    (
        &["11form_factor5paper", "form_factor..paper", "acosf"],
        &["libm"],
    ),
    (&["9micromath", "micromath.."], &["micromath"]),
    (
        &["11fixed_point", "..fixed_point", "5fixed"],
        &["q24", "q29"],
    ),
];

/// What no program holds: the logger, panics, memory from a heap.
const NEVER: [&str; 4] = ["5defmt", "defmt..", "panic_fmt", "__rust_alloc"];

/// Every rung alone; `None` where the machine lacks what it takes.
fn alone(core: Core, extent: Extent) -> Option<Vec<Flash>> {
    let rungs = FormFactorRung::ALL.map(FormFactorRung::name);
    match device::flash(core, &rungs, extent) {
        Ok(found) => Some(found),
        Err(error) => {
            let required = std::env::var_os("ISOLUX_REQUIRE_QEMU").is_some();
            assert!(error.is_missing() && !required, "{error}");
            eprintln!("SKIPPED: {error}");
            None
        }
    }
}

/// Whether a symbol is what the compiler's runtime does to floating-point
/// numbers where no FPU does. Symbols alone: its debugger's strings name all of
/// the runtime, linked or not.
fn is_emulated(name: &str) -> bool {
    let begins = ["__aeabi_f", "__aeabi_d", "__aeabi_i2", "__aeabi_ui2"];
    let ends = ["sf3", "df3", "sf2", "df2"];
    begins.iter().any(|begin| name.starts_with(begin))
        || name.starts_with("__") && ends.iter().any(|end| name.ends_with(end))
}

/// On a core without FPU every floating-point operation is a call.
#[test]
fn the_whole_kernel_in_integers_reaches_no_floating_point() {
    let core = Core::CortexM3;
    let found = match device::flash(core, &["best", "q24", "q29"], Extent::WholeKernel) {
        Ok(found) => found,
        Err(error) => {
            let required = std::env::var_os("ISOLUX_REQUIRE_QEMU").is_some();
            assert!(error.is_missing() && !required, "{error}");
            eprintln!("SKIPPED: {error}");
            return;
        }
    };
    for flash in &found {
        println!("{} {} bytes", flash.rung, flash.code_bytes);
        let functions = flash.functions.iter();
        let emulated: Vec<_> = functions.filter(|name| is_emulated(name)).collect();
        let is_float = flash.rung == "best";
        assert_eq!(
            !emulated.is_empty(),
            is_float,
            "{}: {emulated:?}",
            flash.rung
        );
    }
}

/// The functions with one of these parts in their names.
fn named<'f>(flash: &'f Flash, parts: &[&str]) -> Vec<&'f String> {
    let functions = flash.functions.iter();
    let is_one = |name: &&String| parts.iter().any(|part| name.contains(part));
    functions.filter(is_one).collect()
}

fn holds(flash: &Flash, part: &str) -> bool {
    flash.functions.iter().any(|name| name.contains(part))
}

#[test]
fn the_whole_kernel_with_one_rung_holds_no_other() {
    let Some(all) = alone(Core::CortexM4F, Extent::WholeKernel) else {
        return;
    };
    for flash in &all {
        let rung = flash.rung.as_str();
        for (parts, rungs) in PARTS {
            let found: Vec<_> = parts.iter().filter(|part| holds(flash, part)).collect();
            let expected = rungs.contains(&rung);
            assert_eq!(
                !found.is_empty(),
                expected,
                "{rung}: {found:?} of {parts:?}: {:?}",
                named(flash, parts)
            );
        }
        for part in NEVER {
            assert!(!holds(flash, part), "{rung}: {part}");
        }
        // The root is the FPU's; libm's arc cosine alone has one of its own.
        assert_eq!(holds(flash, "4sqrt5sqrtf"), rung == "libm", "{rung}");
    }
}
