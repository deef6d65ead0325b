//! The costs of operations, fitted to runs of many scenes on the emulated core.

use isolux_host::device::model::group;
use isolux_host::scene::shipped;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Where the committed costs are.
pub(crate) const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/model.csv");

/// The first line there.
pub(crate) const HEAD: &str = "step,operation,instructions";

/// A run: a shipped scene, its samples where they are others, and
/// flags of `isolux device`.
pub(crate) struct Run {
    scene: &'static str,
    samples: Option<u32>,
    flags: &'static [&'static str],
}

const fn run(scene: &'static str, samples: u32, flags: &'static [&'static str]) -> Run {
    Run {
        scene,
        samples: if samples > 0 { Some(samples) } else { None },
        flags,
    }
}

const ISOLUX: &[&str] = &["--placement", "isolux"];
const CODES: &[&str] = &["--transfer", "codes"];
const CODED_ROOM: &[&str] = &["--placement", "isolux", "--transfer", "codes"];
const LAYERS: &[&str] = &["--emitters", "layer-cake"];
const Q29: &[&str] = &["--arithmetic", "q29"];
const Q24: &[&str] = &["--arithmetic", "q24"];
const Q29_TERMS: &[&str] = &["--arithmetic", "q29", "--transfer", "matrix"];
const Q24_TERMS: &[&str] = &["--arithmetic", "q24", "--transfer", "matrix"];

/// What the costs are fitted to: every kind of emitter, visibility, transfer and
/// reconstruction, each in several sizes.
pub(crate) const RUNS: [Run; 59] = [
    run("paper", 0, &[]),
    run("paper", 70, &[]),
    run("paper", 66, &[]),
    run("paper-aspect", 0, &[]),
    run("paper", 0, ISOLUX),
    run("paper", 40, ISOLUX),
    run("paper", 49, ISOLUX),
    run("paper", 80, ISOLUX),
    run("paper-aspect", 0, ISOLUX),
    run("paper", 0, LAYERS),
    run("paper", 30, LAYERS),
    run("paper", 70, LAYERS),
    run("paper-aspect", 40, LAYERS),
    run("penumbra", 0, &[]),
    run("penumbra", 20, &[]),
    run("penumbra", 30, &[]),
    run("penumbra", 45, &[]),
    run("penumbra", 80, &[]),
    run("penumbra", 60, ISOLUX),
    run("penumbra", 0, CODES),
    run("penumbra", 20, CODES),
    run("penumbra", 30, CODES),
    run("penumbra", 45, CODES),
    run("cornell", 170, ISOLUX),
    run("cornell", 200, ISOLUX),
    run("cornell", 250, ISOLUX),
    run("cornell", 170, CODED_ROOM),
    run("cornell", 200, CODED_ROOM),
    run("cornell", 250, CODED_ROOM),
    run("cornell-rgb", 170, ISOLUX),
    run("cornell-rgb", 220, ISOLUX),
    run("cornell-rgb", 170, CODED_ROOM),
    run("cornell-rgb", 220, CODED_ROOM),
    run("office", 340, ISOLUX),
    run("office", 380, ISOLUX),
    run("office", 340, CODED_ROOM),
    run("office", 380, CODED_ROOM),
    run("paper", 0, Q29),
    run("paper", 40, Q29),
    run("paper", 49, Q29),
    run("paper", 80, Q29),
    run("paper-aspect", 0, Q29),
    run("paper", 0, Q24),
    run("paper", 40, Q24),
    run("paper", 80, Q24),
    run("paper-aspect", 0, Q24),
    run("cornell", 170, Q29_TERMS),
    run("cornell", 250, Q29_TERMS),
    run("office", 340, Q29_TERMS),
    run("office", 380, Q29_TERMS),
    run("office", 600, Q29_TERMS),
    run("cornell", 0, Q29_TERMS),
    run("office", 0, Q29_TERMS),
    run("cornell", 170, Q24_TERMS),
    run("cornell", 250, Q24_TERMS),
    run("office", 340, Q24_TERMS),
    run("office", 380, Q24_TERMS),
    run("cornell", 0, Q24_TERMS),
    run("office", 0, Q24_TERMS),
];

impl Run {
    /// Whether a flag is this word.
    pub(crate) fn has(&self, word: &str) -> bool {
        self.flags.contains(&word)
    }

    /// Writes its scene and gives the arguments of the program.
    pub(crate) fn arguments(&self, directory: &Path) -> Vec<String> {
        let file = format!("{}.toml", self.scene);
        let shipped = shipped::ALL.iter().find(|(name, _)| *name == file);
        let mut text = shipped.expect("shipped").1.to_owned();
        if let Some(samples) = self.samples {
            let mut lines: Vec<&str> = text.lines().collect();
            lines.retain(|line| !line.trim_start().starts_with("samples"));
            text = lines.join("\n");
            let budget = format!("[budget]\nsamples = {samples}");
            text = match text.contains("[budget]") {
                true => text.replace("[budget]", &budget),
                false => format!("{text}\n{budget}\n"),
            };
        }
        std::fs::write(directory.join(&file), text).expect("a file");
        let begin = ["device", &file, "--sheet", "--json"];
        begin
            .iter()
            .chain(self.flags)
            .map(|word| (*word).to_owned())
            .collect()
    }
}

/// A step that was run: what it did, and what it cost.
#[derive(Clone, Debug)]
pub(crate) struct Observed {
    /// Which costs it has.
    pub(crate) group: String,
    pub(crate) done: BTreeMap<String, f64>,
    pub(crate) instructions: f64,
}

/// The steps of the answer of `isolux device --sheet --json`.
pub(crate) fn observed(answer: &Value) -> Vec<Observed> {
    let kind = answer["operations"]["kind"].as_str().unwrap_or_default();
    let steps = ["load", "direct", "shoot", "resample"].into_iter();
    let of = |step: &str| {
        let done = answer["operations"][step].as_object()?;
        let group = group(step, kind, done.keys().map(String::as_str));
        let done = done
            .iter()
            .filter_map(|(name, n)| Some((name.clone(), n.as_f64()?)));
        let instructions = answer["instructions_by_step"][step].as_f64()?;
        (instructions > 0.0).then(|| Observed {
            group,
            done: done.collect(),
            instructions,
        })
    };
    steps.filter_map(of).collect()
}

/// The costs that err least, none below 0: the squares of relative errors are least, by
/// going down one coordinate after the other.
pub(crate) fn fitted(all: &[Observed]) -> BTreeMap<String, f64> {
    let names: BTreeSet<&String> = all.iter().flat_map(|one| one.done.keys()).collect();
    let names: Vec<&String> = names.into_iter().collect();
    let of = |one: &Observed, name: &String| {
        one.done.get(name).copied().unwrap_or(0.0) / one.instructions
    };
    let rows: Vec<Vec<f64>> = all
        .iter()
        .map(|one| names.iter().map(|name| of(one, name)).collect())
        .collect();
    let mut costs = vec![0.0; names.len()];
    let mut left = vec![1.0; rows.len()];
    const ROUNDS: usize = 20_000;
    for _ in 0..ROUNDS {
        for column in 0..names.len() {
            let (mut along, mut square) = (0.0, 0.0);
            for (row, left) in rows.iter().zip(&left) {
                along += row[column] * left;
                square += row[column] * row[column];
            }
            if square == 0.0 {
                continue;
            }
            let better = f64::max(0.0, costs[column] + along / square);
            let change = better - costs[column];
            costs[column] = better;
            for (row, left) in rows.iter().zip(&mut left) {
                *left -= change * row[column];
            }
        }
    }
    let costs = names.into_iter().cloned().zip(costs);
    costs.filter(|&(_, cost)| cost > 0.0).collect()
}

/// By how much costs are wrong of a step, relative to what it took.
pub(crate) fn error(costs: &BTreeMap<String, f64>, one: &Observed) -> f64 {
    let cost = |(name, times): (&String, &f64)| costs.get(name).unwrap_or(&0.0) * times;
    let sum: f64 = one.done.iter().map(cost).sum();
    sum / one.instructions - 1.0
}

/// The written file with the costs of these steps in place of its own.
pub(crate) fn with_others(written: &str, new: &str) -> String {
    let group = |line: &str| line.split(',').next().unwrap_or_default().to_owned();
    let again: BTreeSet<String> = new.lines().map(group).collect();
    let kept = written.lines().filter(|line| !again.contains(&group(line)));
    let mut lines: Vec<&str> = kept.chain(new.lines().skip(1)).collect();
    // By step, in the order of a whole run; of one step as they are.
    lines.sort_by_key(|line| group(line));
    let body: String = lines.iter().map(|line| format!("{line}\n")).collect();
    format!("{HEAD}\n{body}")
}

/// What costs are said to err by at least: few runs are fitted exactly.
const LEAST: f64 = 0.05;

/// The committed file, and what it errs by, in words.
pub(crate) fn model(all: &[Observed]) -> (String, String) {
    let (mut text, mut said) = (format!("{HEAD}\n"), String::new());
    let groups: BTreeSet<&String> = all.iter().map(|one| &one.group).collect();
    for name in groups {
        let of_group = |one: &&Observed| one.group == *name;
        let its: Vec<Observed> = all.iter().filter(of_group).cloned().collect();
        let costs = fitted(&its);
        let errors: Vec<f64> = its.iter().map(|one| error(&costs, one)).collect();
        let largest = errors
            .iter()
            .fold(0.0, |most: f64, error| most.max(error.abs()));
        // Other scenes err by more than those that costs were fitted to.
        let allowed = f64::max(2.0 * largest, LEAST);
        for (operation, cost) in &costs {
            text += &format!("{name},{operation},{cost:.4}\n");
        }
        // Enough of an allowance that what is least predicted is not above it.
        text += &format!("{name},error,{:.4}\n", allowed / (1.0 - allowed) + 5e-5);
        said += &format!(
            "{name}: {} steps, {} operations, largest error {:.2} %\n",
            its.len(),
            costs.len(),
            100.0 * largest
        );
    }
    (text, said)
}
