//! Hashes of the host's answers, and the committed ones.

use super::hash_cases::{Cases, Hash};
use isolux_host::solve::FormFactorRung;
use std::collections::BTreeMap;

/// Where the committed hashes are: `evaluations,rung,hash`.
pub(crate) const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/hashes.csv");

/// The hash of so many answers of a rung on this machine, in this build.
fn of(rung: FormFactorRung, evaluations: u32) -> u64 {
    let (mut cases, mut hash) = (Cases::new(), Hash::new());
    for _ in 0..evaluations {
        let case = cases.following();
        let answer = rung.form_factor(case.position, case.normal, case.vertices());
        hash.add(answer.map_or(0, |(_, bits)| bits));
    }
    hash.0
}

/// Hashes by rung.
pub(crate) type Hashes = BTreeMap<String, u64>;

/// The hashes of every rung on this machine, in this build.
pub(crate) fn all(evaluations: u32) -> Hashes {
    let rungs = FormFactorRung::ALL.into_iter();
    rungs
        .map(|rung| (rung.name().to_owned(), of(rung, evaluations)))
        .collect()
}

/// The committed hashes by the number of evaluations.
pub(crate) fn read() -> BTreeMap<u32, Hashes> {
    let text = std::fs::read_to_string(PATH).unwrap_or_default();
    let row = |line: &str| {
        let (count, rest) = line.split_once(',')?;
        let (rung, hash) = rest.split_once(',')?;
        let hash = u64::from_str_radix(hash, 16).ok()?;
        Some((count.parse().ok()?, rung.to_owned(), hash))
    };
    let mut all: BTreeMap<u32, Hashes> = BTreeMap::new();
    for (count, rung, hash) in text.lines().filter_map(row) {
        all.entry(count).or_default().insert(rung, hash);
    }
    all
}
