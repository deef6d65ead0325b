//! The Rust source beside baked tables: types and constants for a firmware that
//! links what its scene requires and nothing else.
//!
//! Every choice is a type: the rung of arithmetic, how radiosity varies and its
//! channels, the rung of transfer with the capacities of its workspace, and how
//! surfaces are put together. The source holds no code of its own but a function of
//! one line.

use super::names::{Names, listed};
use crate::solve::{FormFactorRung, Rung, Sight};
use isolux::integers;
use isolux::scene::parts;
use isolux::scene::records::{self, Counts};
use zerocopy::FromBytes;

/// What a source is written from.
#[derive(Clone, Copy, Debug)]
pub struct Described<'a> {
    /// The scene's name.
    pub scene: &'a str,
    /// The baked tables.
    pub tables: &'a [u8],
    /// The file they are in, beside the source.
    pub file: &'a str,
    /// The rung of arithmetic they were baked for.
    pub arithmetic: FormFactorRung,
    /// The rung of visibility, where something occludes.
    pub sight: Sight,
    /// Whether reflectances may change on the device.
    pub repaint: bool,
    /// What surfaces, luminaires and points are called.
    pub names: &'a Names,
}

/// The head of tables.
struct Head {
    version: u32,
    checksum: u32,
    counts: Counts,
    sight: records::Sight,
}

impl Head {
    /// The head alone: tables that have changed since they were baked are the
    /// device's to refuse.
    fn of(tables: &[u8], in_integers: bool) -> Option<Self> {
        if in_integers {
            let (header, _) = integers::Header::read_from_prefix(tables).ok()?;
            return Some(Self {
                version: header.version,
                checksum: header.checksum,
                counts: header.counts,
                sight: records::Sight::default(),
            });
        }
        let (header, _) = records::Header::read_from_prefix(tables).ok()?;
        Some(Self {
            version: header.version,
            checksum: header.checksum,
            counts: header.counts,
            sight: header.sight,
        })
    }
}

/// The source of a firmware's module for baked tables; `None` where they are
/// shorter than their head. The same tables and names give the same source.
pub fn source(described: &Described<'_>) -> Option<String> {
    let in_integers = described.arithmetic.is_integer();
    let head = Head::of(described.tables, in_integers)?;
    let mut text = beginning(described, &head);
    text += &capacities(&head.counts, in_integers);
    text += &match in_integers {
        true => integer_types(described.arithmetic, &head.counts),
        false => float_types(described, &head),
    };
    text += &listed(described.names);
    Some(text)
}

fn beginning(described: &Described<'_>, head: &Head) -> String {
    let Described { scene, file, .. } = described;
    let (bytes, version, checksum) = (described.tables.len(), head.version, head.checksum);
    let features = match described.arithmetic {
        FormFactorRung::Q24 | FormFactorRung::Q29 => "the feature `fixed`",
        FormFactorRung::Float(Rung::Micromath) => "the feature `micromath`",
        FormFactorRung::Float(_) => "no feature",
    };
    let root = match described.arithmetic.is_integer() {
        true => "",
        false => {
            "//! The module above names the square root that the part has:
//! `use isolux::number::SoftRoot as Root;`, or its FPU's own.
"
        }
    };
    format!(
        "//! The light of the scene {scene:?}: what a firmware needs besides `{file}`.
//!
//! Written by isolux {program}: bake the scene again rather than edit this. Of the
//! kernel, crate `isolux`, it needs {features}.
{root}#![allow(dead_code, unreachable_pub)]

/// Bytes of the tables.
pub const TABLES_BYTES: usize = {bytes};

/// The version of their format.
pub const TABLES_VERSION: u32 = {version};

/// Their checksum. Tables that come from elsewhere, over the air, need not have it:
/// they fit where `enter` says so.
pub const TABLES_CHECKSUM: u32 = {checksum:#010x};

/// The tables, read in place from flash.
pub static TABLES: isolux::scene::Aligned<[u8; TABLES_BYTES]> =
    isolux::scene::Aligned(*include_bytes!({file:?}));
",
        program = env!("CARGO_PKG_VERSION"),
    )
}

fn capacities(counts: &Counts, in_integers: bool) -> String {
    let Counts {
        samples,
        emitters,
        luminaires,
        surfaces,
        room,
        ..
    } = counts;
    let room = if in_integers { &0 } else { room };
    format!(
        "
/// Surfaces.
pub const SURFACES: usize = {surfaces};

/// Luminaires: the first of the emitters.
pub const LUMINAIRES: usize = {luminaires};

/// Room for emitters.
pub const EMITTERS: usize = {emitters};

/// Room for samples.
pub const SAMPLES: usize = {samples};

/// Values that the reconstruction of a surface needs room for; 0 where the cone
/// filter does it.
pub const ROOM: usize = {room};
"
    )
}

/// The kernel's type of radiosity for these tables, and of irradiance.
fn luminance(counts: &Counts) -> (String, &'static str) {
    let colour = match counts.channels {
        1 => "f32",
        _ => "isolux::luminance::Rgb",
    };
    let form = match (counts.coefficients, counts.weights) {
        (1, 0) => "Constant",
        (1, _) => "Increment",
        _ => "Linear",
    };
    (format!("isolux::luminance::{form}<{colour}>"), colour)
}

/// The kernel's type of transfer for these tables, what the host wrote down where
/// they have that and else a rung of visibility, and an empty workspace.
fn transfer(head: &Head, sight: Sight) -> [String; 2] {
    let records::Sight {
        vertices,
        pieces,
        lines,
        blockers,
    } = head.sight;
    match sight {
        // What is seen is in the tables.
        _ if head.counts.responses > 0 => ["isolux::transfer::Vectors"; 2].map(str::to_owned),
        _ if head.counts.terms > 0 => {
            let bits = head.counts.bits;
            ["", "::"].map(|of| format!("isolux::transfer::Matrix{of}<{bits}>"))
        }
        _ if head.counts.is_coded() => ["isolux::transfer::Codes"; 2].map(str::to_owned),
        // No emitter without a shape is a point.
        _ if head.counts.shapes == 0 => ["isolux::visibility::Polygons"; 2].map(str::to_owned),
        _ if head.counts.occluders == 0 => ["isolux::visibility::Unoccluded"; 2].map(str::to_owned),
        Sight::VertexRays => ["isolux::visibility::VertexRays"; 2].map(str::to_owned),
        Sight::Exact | Sight::None => [
            format!("isolux::visibility::Exact<{vertices}, {pieces}, {lines}, {blockers}>"),
            "Transfer::new()".to_owned(),
        ],
    }
}

/// The kernel's type of a rung in floating point, with the square root that the part has.
fn rung(arithmetic: FormFactorRung) -> &'static str {
    let FormFactorRung::Float(rung) = arithmetic else {
        return "";
    };
    match rung {
        Rung::Libm => "isolux::form_factor::Libm<Root>",
        Rung::Micromath => "isolux::form_factor::Micromath",
        Rung::Poly3 => "isolux::form_factor::Poly3<Root>",
        Rung::Poly5 => "isolux::form_factor::Poly5<Root>",
        Rung::Poly8 => "isolux::form_factor::Poly8<Root>",
        Rung::Best => "isolux::form_factor::Best<Root>",
    }
}

/// The parts of tables with these counts, as the kernel names them.
fn named_parts(counts: &Counts) -> String {
    let there = parts::of(counts);
    let names = [
        (parts::OCCLUDERS, "parts::OCCLUDERS"),
        (parts::WRITTEN, "parts::WRITTEN"),
        (parts::FIELDS, "parts::FIELDS"),
        (parts::SHAPES, "parts::SHAPES"),
    ];
    let names = names.into_iter().filter(|(part, _)| there & part != 0);
    let names: Vec<&str> = names.map(|(_, name)| name).collect();
    match names.is_empty() {
        true => "parts::NONE".to_owned(),
        false => names.join(" | "),
    }
}

fn float_types(described: &Described<'_>, head: &Head) -> String {
    let (luminance, colour) = luminance(&head.counts);
    let [transfer, workspace] = transfer(head, described.sight);
    let arithmetic = rung(described.arithmetic);
    let reconstruction = match head.counts.meshes {
        0 => "Tensors",
        _ => "Stencils",
    };
    let workspace_bytes = match transfer.contains("Exact<") {
        true => isolux::budget::sight_bytes(&head.sight),
        false => 0,
    };
    let (surfaces, reflectances) = match described.repaint {
        true => (
            ", SURFACES",
            isolux::budget::reflectance_bytes(&head.counts),
        ),
        false => ("", 0),
    };
    let bytes = isolux::budget::light_bytes(&head.counts) + reflectances + workspace_bytes;
    let parts = named_parts(&head.counts);
    format!(
        "
#[allow(unused_imports)]
use super::Root;

/// The rung of arithmetic.
pub type Arithmetic = {arithmetic};

/// How radiosity varies over an emitter, and its channels.
pub type Radiosity = {luminance};

/// What a sample receives, in every channel.
pub type Value = {colour};

/// The rung of transfer with its workspace: how what a sample receives is had.
pub type Transfer = {transfer};

/// How surfaces are put together from their fields.
pub type Reconstruction = isolux::resample::{reconstruction}<Root>;

/// The light. It belongs into a `static`, which `DARK` makes.
pub type Light =
    isolux::shoot::Light<'static, Arithmetic, SAMPLES, EMITTERS, Radiosity, Transfer{surfaces}>;

/// Bytes of RAM of the light on a 32-bit part, the workspace of visibility included.
pub const LIGHT_BYTES: usize = {bytes};

#[cfg(target_pointer_width = \"32\")]
const _: () = assert!(
    core::mem::size_of::<Light>() == LIGHT_BYTES,
    \"this kernel is not the one that the scene was baked for\"
);

/// The light of no scene; `enter` gives it one.
pub const DARK: Light = isolux::shoot::Light::empty({workspace});

/// Checks the tables and borrows them; of parts that they do not have no check is linked.
///
/// # Errors
/// Where flash does not hold what was baked.
pub fn load() -> Result<isolux::scene::Scene<'static>, isolux::Error> {{
    use isolux::scene::parts;
    isolux::scene::Scene::load_with::<{{ {parts} }}>(&TABLES.0)
}}
"
    )
}

fn integer_types(arithmetic: FormFactorRung, counts: &Counts) -> String {
    let bytes = integers::light_bytes(counts);
    let format = match arithmetic {
        FormFactorRung::Q24 => "Q24",
        _ => "Q29",
    };
    let transfer = match (counts.coefficients, counts.bits) {
        (1, _) => "Computed".to_owned(),
        // Where nothing reflects there are no terms, and any bits will do.
        (_, 0) => "Matrix<8>".to_owned(),
        (_, bits) => format!("Matrix<{bits}>"),
    };
    format!(
        "
/// The rung of arithmetic.
pub type Arithmetic = isolux::integers::{format};

/// What a sample receives, in the tables' unit of irradiance.
pub type Value = i32;

/// The rung of transfer: how what a sample receives is had.
pub type Transfer = isolux::integers::{transfer};

/// The light. It belongs into a `static`, which `DARK` makes.
pub type Light =
    isolux::integers::Light<'static, Arithmetic, SAMPLES, EMITTERS, Transfer>;

/// Bytes of RAM of the light on a 32-bit part.
pub const LIGHT_BYTES: usize = {bytes};

#[cfg(target_pointer_width = \"32\")]
const _: () = assert!(
    core::mem::size_of::<Light>() == LIGHT_BYTES,
    \"this kernel is not the one that the scene was baked for\"
);

/// The light of no scene; `enter` gives it one.
pub const DARK: Light = Light::empty();

/// Checks the tables and borrows them.
///
/// # Errors
/// Where flash does not hold what was baked.
pub fn load() -> Result<isolux::integers::Scene<'static>, isolux::Error> {{
    isolux::integers::Scene::load(&TABLES.0)
}}
"
    )
}
