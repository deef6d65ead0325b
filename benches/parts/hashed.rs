//! Hashes of the host's answers, and the committed ones.

use super::hash_cases::{Cases, Hash};
use isolux_host::solve::FormFactorRung;
use std::collections::BTreeMap;

/// Where the committed hashes are: `evaluations,rung,hash`.
pub(crate) const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/hashes.csv");

/// The hash of so many answers of a rung on this machine, in this build.
pub(crate) fn of(rung: FormFactorRung, evaluations: u32) -> u64 {
    let (mut cases, mut hash) = (Cases::new(), Hash::new());
    for _ in 0..evaluations {
        let case = cases.following();
        let answer = rung.form_factor(case.position, case.normal, case.vertices());
        hash.add(answer.map_or(0, |(_, bits)| bits));
    }
    hash.0
}

/// The committed hashes of so many evaluations, by rung.
pub(crate) fn committed(evaluations: u32) -> BTreeMap<String, u64> {
    let text = std::fs::read_to_string(PATH).unwrap_or_default();
    let row = |line: &str| {
        let (count, rest) = line.split_once(',')?;
        let (rung, hash) = rest.split_once(',')?;
        let hash = u64::from_str_radix(hash, 16).ok()?;
        (count.parse() == Ok(evaluations)).then(|| (rung.to_owned(), hash))
    };
    text.lines().filter_map(row).collect()
}
