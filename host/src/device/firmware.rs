//! Builds the firmware for one baked scene, from the sources this program was
//! built from.

use std::env;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use fs4::FileExt;
use isolux::shoot::Stop;

use crate::bake::{Described, Names, source};
use crate::report::write_file;
use crate::solve::{FormFactorRung, Sight};

use super::Job;
use super::emulator::{Core, PROGRAM};
use super::error::Error;

/// The package of the firmware.
const PACKAGE: &str = "isolux-firmware";
/// The profile it is built with where none is named.
const PROFILE: &str = "firmware";
/// Variables of the caller's environment that would change the firmware's code,
/// by the beginning of their names: flags, linkers and profiles, also those of
/// one target alone (`CARGO_TARGET_THUMBV7EM_NONE_EABIHF_RUSTFLAGS`).
const FOREIGN: [&str; 7] = [
    "RUSTFLAGS",
    "CARGO_ENCODED_RUSTFLAGS",
    "CARGO_BUILD_",
    "CARGO_PROFILE_",
    "CARGO_TARGET_",
    "RUSTC_WRAPPER",
    "RUSTC_WORKSPACE_WRAPPER",
];

/// A variant of the firmware, one program each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Variant {
    /// libm's software root in place of the FPU's.
    pub(crate) software_root: bool,
    /// One resampled bit flipped: the negative control.
    pub(crate) wrong_bit: bool,
}

/// A program for the device, and how it is built.
#[derive(Clone, Copy, Debug)]
pub struct Build<'a> {
    /// The package it belongs to.
    pub package: &'a str,
    /// The program.
    pub program: &'a str,
    /// Features of the package.
    pub features: &'a [&'a str],
    /// Without the package's default features: with those named and no other.
    pub bare: bool,
    /// The profile of the workspace it is built with.
    pub profile: &'a str,
    /// What its build script reads.
    pub environment: &'a [(&'a str, &'a OsStr)],
}

impl<'a> Build<'a> {
    /// A program with the package's default features.
    #[must_use]
    pub fn of(program: &'a str) -> Self {
        Self {
            package: PACKAGE,
            program,
            features: &[],
            bare: false,
            profile: PROFILE,
            environment: &[],
        }
    }
}

/// The machine's tools that a firmware is built with, found once.
#[derive(Clone, Debug)]
pub struct Toolchain {
    workspace: PathBuf,
    sysroot: PathBuf,
}

impl Toolchain {
    /// Finds the sources, the emulator and the Rust toolchain.
    ///
    /// # Errors
    /// [`Error::Sources`] and [`Error::Missing`].
    pub fn find() -> Result<Self, Error> {
        let workspace = Path::new(env!("CARGO_MANIFEST_DIR"))
            .parent()
            .unwrap_or(Path::new("/"))
            .to_owned();
        if !workspace.join("tests/firmware/Cargo.toml").is_file() {
            return Err(Error::Sources { workspace });
        }
        answer(Command::new(PROGRAM).arg("--version")).ok_or_else(|| Error::Missing {
            what: PROGRAM.to_owned(),
            remedy: "install it with `apt-get install qemu-system-arm`, `brew install qemu`, or from https://www.qemu.org/download".to_owned(),
        })?;
        let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
        let sysroot = answer(
            Command::new(rustc)
                .args(["--print", "sysroot"])
                .current_dir(&workspace),
        )
        .ok_or_else(|| Error::Missing {
            what: "rustc".to_owned(),
            remedy: "install Rust from https://rustup.rs".to_owned(),
        })?;
        Ok(Self {
            workspace,
            sysroot: PathBuf::from(sysroot.trim()),
        })
    }

    /// Whether the core's Rust target is installed.
    ///
    /// # Errors
    /// [`Error::Missing`] where it is not.
    pub fn require(&self, core: Core) -> Result<(), Error> {
        let target = core.target();
        if self
            .sysroot
            .join("lib/rustlib")
            .join(target)
            .join("lib")
            .is_dir()
        {
            return Ok(());
        }
        Err(Error::Missing {
            what: format!("the Rust target {target}"),
            remedy: format!(
                "install it with `rustup target add {target}`, run in {}",
                self.workspace.display()
            ),
        })
    }

    /// A tool of the toolchain's component `llvm-tools`, such as `llvm-objdump`.
    ///
    /// # Errors
    /// [`Error::Missing`] where the component is not installed.
    pub fn tool(&self, name: &str) -> Result<PathBuf, Error> {
        let file = format!("{name}{}", env::consts::EXE_SUFFIX);
        let libraries = self.sysroot.join("lib/rustlib");
        fs::read_dir(&libraries)
            .into_iter()
            .flatten()
            .flatten()
            .map(|entry| entry.path().join("bin").join(&file))
            .find(|path| path.is_file())
            .ok_or_else(|| Error::Missing {
                what: format!("{name} of the Rust toolchain"),
                remedy: format!(
                    "install it with `rustup component add llvm-tools`, run in {}",
                    self.workspace.display()
                ),
            })
    }

    /// Links a program and copies it to `destination`.
    ///
    /// Runs at the same time wait for each other: they share the target
    /// directory, and the next build overwrites the program.
    ///
    /// # Errors
    /// [`Error::Build`] with what cargo said, [`Error::Io`].
    pub fn link(&self, core: Core, build: &Build<'_>, destination: &Path) -> Result<(), Error> {
        let binary = build.program;
        let directory = self.directory();
        fs::create_dir_all(&directory)
            .map_err(Error::io(format!("creating {}", directory.display())))?;
        let _lock = lock(&directory)?;
        let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        for (name, _) in env::vars_os() {
            if is_foreign(&name) {
                cargo.env_remove(name);
            }
        }
        cargo.arg("build");
        if build.bare {
            cargo.arg("--no-default-features");
        }
        let built = cargo
            .current_dir(&self.workspace)
            .args(["--quiet", "--package", build.package, "--bin", binary])
            .args(["--target", core.target(), "--profile", build.profile])
            .args(["--features", &build.features.join(",")])
            .env("CARGO_TARGET_DIR", &directory)
            // Of all places where flags may stand cargo asks this one first.
            .env(
                "CARGO_ENCODED_RUSTFLAGS",
                format!("-Ctarget-cpu={}", core.cpu()),
            )
            .env("DEFMT_LOG", "info")
            .envs(build.environment.iter().copied())
            .stdin(Stdio::null())
            .output()
            .map_err(Error::io("running cargo"))?;
        if !built.status.success() {
            return Err(Error::Build {
                what: format!("the program `{binary}` for {}", core.name()),
                output: String::from_utf8_lossy(&built.stderr).trim().to_owned(),
            });
        }
        let program = directory
            .join(core.target())
            .join(build.profile)
            .join(binary);
        fs::copy(&program, destination)
            .map_err(Error::io(format!("copying {}", program.display())))?;
        Ok(())
    }

    /// Links a variant of the firmware for a job.
    pub(crate) fn link_for(
        &self,
        job: &Job<'_>,
        core: Core,
        variant: Variant,
        destination: &Path,
    ) -> Result<(), Error> {
        let mut features: Vec<&str> = Vec::new();
        if variant.software_root {
            features.push("software-root");
        }
        if variant.wrong_bit {
            features.push("wrong-bit");
        }
        self.link_job("firmware", &features, job, core, destination)
    }

    /// Links a program of the firmware's package for a job.
    pub(crate) fn link_job(
        &self,
        program: &str,
        features: &[&str],
        job: &Job<'_>,
        core: Core,
        destination: &Path,
    ) -> Result<(), Error> {
        let baked = keep(&self.directory().join("tables"), job)?;
        let words = [
            ("ISOLUX_RESOLUTION", job.resolution.to_string()),
            ("ISOLUX_STOP", stop(job.stop)),
        ];
        let mut environment = vec![("ISOLUX_BAKED", baked.as_os_str())];
        environment.extend(words.iter().map(|(name, word)| (*name, OsStr::new(word))));
        let build = Build {
            features,
            environment: &environment,
            ..Build::of(program)
        };
        self.link(core, &build, destination)
    }

    /// Where the device's programs are built: apart from the host's, so that
    /// neither waits for the other.
    fn directory(&self) -> PathBuf {
        self.workspace.join("target/device")
    }
}

/// Whether a variable of the environment is one of [`FOREIGN`].
fn is_foreign(name: &OsStr) -> bool {
    let name = name.to_string_lossy();
    FOREIGN.iter().any(|begin| name.starts_with(begin))
}

/// The stop rule as the firmware's build script reads it.
fn stop(rule: Stop) -> String {
    match rule {
        Stop::Below { fraction, shots } => format!("below {fraction} {shots}"),
        Stop::Shots(shots) => format!("shots {shots}"),
        Stop::Reflections(times) => format!("reflections {times}"),
    }
}

/// What a command prints, if it is there and succeeds.
fn answer(command: &mut Command) -> Option<String> {
    let output = command.stdin(Stdio::null()).output().ok()?;
    output
        .status
        .success()
        .then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Writes the tables, and the source beside them, under a name of their content, so
/// that a scene that has not changed is not built again. Gives the source's path.
fn keep(directory: &Path, job: &Job<'_>) -> Result<PathBuf, Error> {
    fs::create_dir_all(directory)
        .map_err(Error::io(format!("creating {}", directory.display())))?;
    let mut hasher = DefaultHasher::new();
    (job.tables, job.arithmetic, job.visibility).hash(&mut hasher);
    let name = format!("{:016x}", hasher.finish());
    let tables = format!("{name}.isolux");
    let unknown = |what: &str| Error::Program {
        what: format!("the firmware does not know {what}"),
    };
    let source = source(&Described {
        scene: job.scene,
        tables: job.tables,
        file: &tables,
        arithmetic: FormFactorRung::named(job.arithmetic).ok_or_else(|| unknown(job.arithmetic))?,
        sight: Sight::named(job.visibility).ok_or_else(|| unknown(job.visibility))?,
        // The program paints nothing.
        repaint: false,
        names: &Names::default(),
    });
    let source = source.ok_or_else(|| unknown("tables that are shorter than their head"))?;
    put(directory, &tables, job.tables)?;
    put(directory, &format!("{name}.rs"), source.as_bytes())
}

/// Writes a file unless it is there already.
fn put(directory: &Path, name: &str, bytes: &[u8]) -> Result<PathBuf, Error> {
    let path = directory.join(name);
    if !fs::read(&path).is_ok_and(|kept| kept == bytes) {
        write_file(&path, bytes).map_err(|error| Error::Io {
            doing: format!("writing {}", path.display()),
            source: error.source,
        })?;
    }
    Ok(path)
}

/// Holds the builds' lock until dropped.
fn lock(directory: &Path) -> Result<File, Error> {
    let path = directory.join("build.lock");
    let doing = format!("locking {}", path.display());
    let file = File::create(&path).map_err(Error::io(doing.clone()))?;
    FileExt::lock(&file).map_err(Error::io(doing))?;
    Ok(file)
}
