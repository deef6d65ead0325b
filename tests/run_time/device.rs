//! What a dimming costs on the emulated Cortex-M4F, and in integers on the Cortex-M3 that
//! has no FPU, with the host's bits.
//!
//! Skipped, loudly, where a tool is missing; with `ISOLUX_REQUIRE_QEMU=1` in the
//! environment that is a failure instead.

use crate::program::isolux;
use isolux::form_factor::Best;
use isolux::integers::{self, Format, Q24, Q29};
use isolux::luminance::{Constant, Linear, Luminance};
use isolux::scene::Scene;
use isolux::shoot::{Light, Stop};
use isolux::transfer::{Codes, Matrix, Transfer, Vectors};
use isolux_host::device::{self, Core, Job, Relit};
use isolux_host::scene::Budget;
use isolux_host::solve::HostRoot;
use std::fs;
use std::time::Duration;

const STOP: Stop = Stop::below(0.001);

/// The tables of the shipped office, as the program bakes them.
fn office(transfer: &str, arithmetic: &str) -> Vec<u32> {
    let directory = tempfile::tempdir().expect("a directory");
    let arguments = [
        "bake",
        "office",
        "--placement",
        "isolux",
        "--transfer",
        transfer,
        "--arithmetic",
        arithmetic,
        "-o",
        "office",
    ];
    let ran = isolux(&arguments, directory.path(), "");
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let bytes = fs::read(directory.path().join("office/office.isolux")).expect("tables");
    let word = |word: &[u8]| u32::from_le_bytes(word.try_into().expect("four bytes"));
    bytes.chunks_exact(4).map(word).collect()
}

/// The host's bits after the same steps.
fn expected<L: Luminance<Colour = f32>, V: Transfer + Default>(tables: &[u8]) -> Vec<u32> {
    let scene = Scene::load(tables).expect("sound tables");
    type Room<'t, L, V> = Light<'t, Best<HostRoot>, 1024, 128, L, V>;
    let mut light = Box::new(Room::<L, V>::new(scene).expect("room"));
    light.solve(STOP);
    light
        .set_radiance(0, light.radiance(0) * 0.5)
        .expect("sound");
    light.update(STOP);
    let points = (0..scene.points().len()).map(|point| light.point(point).expect("a point"));
    assert_eq!(points.len(), 4);
    let samples = light.irradiance().iter().copied();
    samples.chain(points).map(f32::to_bits).collect()
}

/// The same in integers.
fn expected_in_integers<F: Format, T: integers::Transfer>(tables: &[u8]) -> Vec<u32> {
    let scene = integers::Scene::load(tables).expect("sound tables");
    type Room<'t, F, T> = integers::Light<'t, F, 1024, 128, T>;
    let mut light = Box::new(Room::<F, T>::new(scene).expect("room"));
    light.solve(STOP);
    light
        .set_radiance(0, light.radiance(0) * 0.5)
        .expect("sound");
    light.update(STOP);
    let points = (0..scene.points().len()).map(|point| light.point(point).expect("a point"));
    assert_eq!(points.len(), 4);
    let samples = light.irradiance().iter().copied();
    samples.chain(points).map(i32::cast_unsigned).collect()
}

/// Runs it on a core; `None` where there is none.
fn relit(tables: &[u8], arithmetic: &str, core: Core) -> Option<Relit> {
    let job = Job {
        scene: "office",
        tables,
        arithmetic,
        visibility: "exact",
        stop: STOP,
        resolution: 1,
        expected: &[],
        budget: Budget::default(),
    };
    match device::relit(&job, core, Duration::from_secs(300)) {
        Ok(relit) => Some(relit),
        Err(error) => {
            let required = std::env::var_os("ISOLUX_REQUIRE_QEMU").is_some();
            assert!(error.is_missing() && !required, "{error}");
            eprintln!("SKIPPED: {error}");
            None
        }
    }
}

fn measured<L: Luminance<Colour = f32>, V: Transfer + Default>(transfer: &str) -> Option<Relit> {
    let words = office(transfer, "best");
    let tables = zerocopy::IntoBytes::as_bytes(&words[..]);
    let expected = expected::<L, V>(tables);
    let relit = relit(tables, "best", Core::CortexM4F)?;
    judged(transfer, tables, &relit, &expected);
    Some(relit)
}

/// Says what it cost, and compares.
fn judged(what: &str, tables: &[u8], relit: &Relit, expected: &[u32]) {
    println!(
        "office, {what}: {} bytes of tables; first solve {} instructions, {} shots; one luminaire dimmed {}, {}; stack {}",
        tables.len(),
        relit.solve,
        relit.shots[0],
        relit.update,
        relit.shots[1],
        relit.stack
    );
    assert!(relit.values == expected, "other bits than the host's");
    assert!(relit.update < relit.solve);
}

/// Without FPU, in integers: a quarter more than a core with one takes in `f32`, a sixteenth of
/// it for the gradients of what is left.
#[test]
fn a_dimming_in_integers_costs_few_instructions_without_fpu() {
    fn of<F: Format>(arithmetic: &str) {
        let words = office("matrix", arithmetic);
        let tables = zerocopy::IntoBytes::as_bytes(&words[..]);
        let expected = expected_in_integers::<F, integers::Matrix<8>>(tables);
        if let Some(relit) = relit(tables, arithmetic, Core::CortexM3) {
            judged(&format!("matrix, {arithmetic}"), tables, &relit, &expected);
            assert!(relit.update <= 6_400_000, "{}", relit.update);
        }
    }
    of::<Q29>("q29");
    of::<Q24>("q24");
}

/// What is asked for: no more than 5 million instructions where terms are stored.
#[test]
fn a_dimming_with_a_matrix_costs_few_instructions() {
    if let Some(relit) = measured::<Linear<f32>, Matrix<8>>("matrix") {
        assert!(relit.update <= 5_000_000, "{}", relit.update);
    }
}

/// And no more than a fifth of a million where responses are.
#[test]
fn a_dimming_with_vectors_costs_next_to_nothing() {
    if let Some(relit) = measured::<Constant<f32>, Vectors>("vectors") {
        assert!(relit.update <= 200_000, "{}", relit.update);
    }
}

#[test]
fn a_dimming_with_codes_has_the_hosts_bits() {
    measured::<Linear<f32>, Codes>("codes");
}
