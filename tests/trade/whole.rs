//! The whole way from samples to surfaces, in the committed figures.

use super::{column, read};
use isolux_host::trade::whole::{self, WAYS};
use std::collections::BTreeMap;

/// The command that writes the committed result of a scene anew.
const COMMAND: &str =
    "cargo run --release --bin isolux -- trade SCENE --whole -o benches/trade/SCENE";

/// A committed column of a scene, by ways and samples.
fn committed(scene: &str, name: &str) -> BTreeMap<String, f64> {
    let rows = read(&format!("{scene}/trade-whole.csv"));
    assert_eq!(rows[0].join(","), whole::COLUMNS, "see {COMMAND}");
    let plans = column(&rows, name, 5);
    let key = |key: String| key.split(' ').skip(2).collect::<Vec<_>>().join(" ");
    plans
        .into_iter()
        .map(|(name, value)| (key(name), value))
        .collect()
}

/// With the same samples meshes of stencils err by a tenth of what the paper's way errs by,
/// or less; and more samples lessen their error.
#[test]
fn samples_are_worth_more_than_in_the_paper() {
    let [papers, .., best] = WAYS;
    let of = |way: whole::Way| format!("{} {}", way.reconstruction, way.emitters);
    for scene in ["paper", "penumbra"] {
        let rms = committed(scene, "rms");
        let way =
            |way: whole::Way, samples: u32| rms.get(&format!("{} {samples}", of(way))).copied();
        for samples in [48, 96, 200] {
            let (theirs, ours) = (way(papers, samples), way(best, samples));
            let (theirs, ours) = (theirs.expect("a plan"), ours.expect("a plan"));
            assert!(10.0 * ours <= theirs, "{scene}, {samples}: {ours} {theirs}");
        }
        assert!(way(best, 200) < way(best, 48), "{scene}: {rms:?}");
    }
}
