//! The same bits on the host and on the device, on every rung: hashes of 10 000
//! form factors, on this build of the host and on every emulated core, equal to
//! the committed ones. `cargo bench --bench hashes` does the same with a
//! million, in any build of the host.
//!
//! The device's part is skipped, loudly, where the emulator or the Rust target
//! is missing; with `ISOLUX_REQUIRE_QEMU=1` that is a failure instead.

#[path = "firmware/src/hash_cases.rs"]
mod hash_cases;
#[path = "../benches/parts/hashed.rs"]
mod hashed;

use hash_cases::{Cases, Hash};
use isolux_host::device::{self, Core, Hashed};
use isolux_host::solve::{FormFactorRung, Rung};
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

const EVALUATIONS: u32 = 10_000;

/// The committed hashes: every rung has one.
fn committed() -> BTreeMap<String, u64> {
    let committed = hashed::read().remove(&EVALUATIONS).unwrap_or_default();
    let names: Vec<&str> = committed.keys().map(String::as_str).collect();
    let mut ladder = FormFactorRung::ALL.map(FormFactorRung::name);
    ladder.sort_unstable();
    assert_eq!(names, ladder, "{}", hashed::PATH);
    committed
}

#[test]
fn the_host_has_the_committed_bits() {
    assert_eq!(hashed::all(EVALUATIONS), committed());
}

#[test]
fn the_device_has_the_committed_bits() {
    match device::hashes(
        &Core::ALL,
        Hashed::All,
        EVALUATIONS,
        Duration::from_secs(300),
    ) {
        Ok(found) => {
            for (core, hashes) in Core::ALL.iter().zip(found) {
                assert_eq!(hashes, committed(), "{}", core.name());
            }
        }
        Err(error) => {
            let required = std::env::var_os("ISOLUX_REQUIRE_QEMU").is_some();
            assert!(error.is_missing() && !required, "{error}");
            eprintln!("SKIPPED: {error}");
        }
    }
}

/// What is hashed is not all the same: light and darkness, whole and clipped,
/// large and small.
#[test]
fn the_cases_are_many_kinds() {
    let mut cases = Cases::new();
    let (mut lit, mut tiny, mut large) = (0, 0, 0);
    let mut counts = BTreeSet::new();
    for _ in 0..EVALUATIONS {
        let case = cases.following();
        counts.insert(case.vertices().len());
        let answer = FormFactorRung::Float(Rung::Best).form_factor(
            case.position,
            case.normal,
            case.vertices(),
        );
        let (answer, _) = answer.expect("a receiver");
        lit += u32::from(answer > 0.0);
        tiny += u32::from(answer > 0.0 && answer < 1e-6);
        large += u32::from(answer > 0.01);
    }
    assert_eq!(counts, (3..=8).collect());
    assert!(lit > EVALUATIONS / 8, "{lit}");
    assert!(tiny > EVALUATIONS / 100, "{tiny}");
    assert!(large > EVALUATIONS / 100, "{large}");
}

#[test]
fn one_bit_is_another_hash() {
    let hash = |answers: &[f32]| {
        let mut hash = Hash::new();
        answers
            .iter()
            .for_each(|answer: &f32| hash.add(answer.to_bits()));
        hash.0
    };
    assert_ne!(hash(&[1.0]), hash(&[1.0 + f32::EPSILON]));
    assert_ne!(hash(&[0.0]), hash(&[-0.0]));
    assert_ne!(hash(&[1.0, 2.0]), hash(&[2.0, 1.0]));
    // FNV-1a of four bytes 0.
    assert_eq!(hash(&[0.0]), 0x4d25_767f_9dce_13f5);
}
