//! What firmwares of several kinds of scene take of flash, RAM and stack.

use isolux_host::device::{Core, Error, Linked, Optimised, linked};
use isolux_host::scene::shipped;
use std::fs;
use std::path::Path;

/// Where the committed figures are.
pub(crate) const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/sizes.csv");

/// The first line there.
pub(crate) const HEAD: &str = "kind,core,for,surfaces,code,constants,tables,ram,stack bound";

/// A kind of scene.
pub(crate) struct Kind {
    /// What it is called.
    pub(crate) name: &'static str,
    scene: &'static str,
    /// Whether its light is coloured.
    colour: bool,
    flags: &'static [&'static str],
    core: Core,
}

/// All of them, from the least to everything.
pub(crate) const KINDS: [Kind; 7] = [
    Kind {
        name: "open; isolux bands of constant radiosity; cone filter; poly3",
        scene: "paper",
        colour: false,
        flags: &["--placement", "isolux", "--arithmetic", "poly3"],
        core: Core::CortexM4F,
    },
    Kind {
        name: "the same in integers; q29; without FPU",
        scene: "paper",
        colour: false,
        flags: &["--arithmetic", "q29"],
        core: Core::CortexM3,
    },
    Kind {
        name: "open; points; tensor grids; best",
        scene: "paper",
        colour: false,
        flags: &[],
        core: Core::CortexM4F,
    },
    Kind {
        name: "shadows written as codes; linear patches; stencils; best",
        scene: "penumbra",
        colour: false,
        flags: &["--transfer", "codes"],
        core: Core::CortexM4F,
    },
    Kind {
        name: "shadows by vertex rays; linear patches; stencils; best",
        scene: "penumbra",
        colour: false,
        flags: &["--visibility", "vertex-rays"],
        core: Core::CortexM4F,
    },
    Kind {
        name: "exact shadows; linear patches; stencils; best",
        scene: "penumbra",
        colour: false,
        flags: &[],
        core: Core::CortexM4F,
    },
    Kind {
        name: "everything: the same in colour",
        scene: "penumbra",
        colour: true,
        flags: &[],
        core: Core::CortexM4F,
    },
];

/// What one of them takes.
pub(crate) struct Row {
    pub(crate) name: &'static str,
    pub(crate) core: Core,
    pub(crate) optimised: Optimised,
    /// Whether surfaces are put together, or samples are read alone.
    pub(crate) surfaces: bool,
    pub(crate) taken: Linked,
}

impl Row {
    /// What names it in the file.
    pub(crate) fn key(&self) -> String {
        let read = if self.surfaces { "yes" } else { "no" };
        let (core, optimised) = (self.core.name(), self.optimised.name());
        format!("{},{core},{optimised},{read}", self.name)
    }

    /// Its line of the file.
    pub(crate) fn line(&self) -> String {
        let Linked {
            code_bytes,
            constant_bytes,
            table_bytes,
            ram_bytes,
            stack_bound_bytes,
            ..
        } = self.taken;
        format!(
            "{},{code_bytes},{constant_bytes},{table_bytes},{ram_bytes},{stack_bound_bytes}",
            self.key()
        )
    }
}

/// Bakes every kind with `bake`, which takes the arguments of `isolux bake`, and links
/// it: for speed and for size, with surfaces and with samples alone.
pub(crate) fn measure(bake: impl Fn(&[&str], &Path)) -> Result<Vec<Row>, Error> {
    let directory = tempfile::tempdir().expect("a directory");
    let directory = directory.path();
    let mut rows = Vec::new();
    for kind in &KINDS {
        let file = format!("{}.toml", kind.scene);
        let shipped = shipped::ALL.iter().find(|(name, _)| *name == file);
        let mut text = shipped.expect("shipped").1.to_owned();
        if kind.colour {
            text = text.replace("reflectance = 0.5", "reflectance = [0.6, 0.5, 0.4]");
        }
        fs::write(directory.join(&file), text).expect("a file");
        bake(
            &[&["bake", &file, "-o", "."], kind.flags].concat(),
            directory,
        );
        let source = directory.join(format!("{}.rs", kind.scene));
        for optimised in [Optimised::Size, Optimised::Speed] {
            for surfaces in [false, true] {
                let taken = linked(kind.core, &source, optimised, !surfaces)?;
                rows.push(Row {
                    name: kind.name,
                    core: kind.core,
                    optimised,
                    surfaces,
                    taken,
                });
            }
        }
    }
    Ok(rows)
}
