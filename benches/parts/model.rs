//! The costs of operations, fitted to runs of many scenes on the emulated core.

use isolux_host::device::model::group;
use isolux_host::scene::shipped;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Where the committed costs are.
pub(crate) const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/model.csv");

/// Scenes of kinds that no shipped one is of.
const SCENES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/scenes");

/// The first line there.
pub(crate) const HEAD: &str = "step,operation,instructions";

/// A run: a shipped scene or one of `benches/scenes`, its samples where they are others,
/// flags of `isolux device`, and the rung of arithmetic where it is named.
#[derive(Clone, Copy)]
pub(crate) struct Run {
    scene: &'static str,
    samples: Option<u32>,
    flags: &'static [&'static str],
    arithmetic: Option<&'static str>,
}

const fn run(scene: &'static str, samples: u32, flags: &'static [&'static str]) -> Run {
    Run {
        scene,
        samples: if samples > 0 { Some(samples) } else { None },
        flags,
        arithmetic: None,
    }
}

/// The same where its rung of arithmetic is named.
const fn on(arithmetic: &'static str, run: Run) -> Run {
    Run {
        arithmetic: Some(arithmetic),
        ..run
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
const RAYS: &[&str] = &["--visibility", "vertex-rays"];
const TERMS: &[&str] = &["--transfer", "matrix"];
const VECTORS: &[&str] = &["--transfer", "vectors"];

/// What the costs are fitted to: the shipped scenes as they are and every kind of emitter,
/// visibility, transfer and reconstruction, each in several sizes.
pub(crate) const RUNS: [Run; 94] = [
    run("paper", 0, &[]),
    run("paper", 40, &[]),
    run("paper", 70, &[]),
    run("paper-aspect", 0, &[]),
    run("paper", 0, ISOLUX),
    run("paper", 40, ISOLUX),
    run("paper", 80, ISOLUX),
    run("paper-aspect", 0, ISOLUX),
    run("paper", 0, LAYERS),
    run("paper", 30, LAYERS),
    run("paper", 70, LAYERS),
    run("paper-aspect", 0, LAYERS),
    run("paper-aspect", 40, LAYERS),
    run("penumbra", 0, &[]),
    run("penumbra", 20, &[]),
    run("penumbra", 30, &[]),
    run("penumbra", 45, &[]),
    run("penumbra", 80, &[]),
    run("penumbra", 60, ISOLUX),
    run("paper", 0, CODES),
    run("paper-aspect", 0, CODES),
    run("penumbra", 0, CODES),
    run("penumbra", 20, CODES),
    run("penumbra", 30, CODES),
    run("penumbra", 45, CODES),
    run("cornell", 0, &[]),
    run("cornell", 200, &[]),
    run("cornell", 350, &[]),
    run("cornell", 500, &[]),
    run("cornell", 200, ISOLUX),
    run("cornell-rgb", 0, &[]),
    run("cornell-rgb", 220, &[]),
    run("cornell-rgb", 170, ISOLUX),
    run("office", 0, &[]),
    run("office", 340, &[]),
    run("office", 500, &[]),
    run("office", 340, ISOLUX),
    run("cornell", 0, CODES),
    run("cornell", 200, CODES),
    run("cornell", 350, CODES),
    run("cornell", 250, CODED_ROOM),
    run("cornell-rgb", 0, CODES),
    run("cornell-rgb", 220, CODES),
    run("cornell-rgb", 350, CODES),
    run("office", 0, CODES),
    run("office", 340, CODES),
    run("paper", 0, Q29),
    run("paper", 40, Q29),
    run("paper", 80, Q29),
    run("paper-aspect", 0, Q29),
    run("paper", 0, Q24),
    run("paper", 40, Q24),
    run("paper", 80, Q24),
    run("paper-aspect", 0, Q24),
    run("cornell", 0, Q29_TERMS),
    run("cornell", 170, Q29_TERMS),
    run("cornell", 250, Q29_TERMS),
    run("office", 0, Q29_TERMS),
    run("office", 340, Q29_TERMS),
    run("cornell", 0, Q24_TERMS),
    run("cornell", 170, Q24_TERMS),
    run("cornell", 250, Q24_TERMS),
    run("office", 0, Q24_TERMS),
    run("office", 340, Q24_TERMS),
    run("room", 60, &[]),
    run("room", 90, &[]),
    run("room", 0, &[]),
    run("room", 180, &[]),
    run("room-rgb", 60, &[]),
    run("room-rgb", 0, &[]),
    run("room-rgb", 180, &[]),
    run("paper-rgb", 30, &[]),
    run("paper-rgb", 0, &[]),
    run("paper-rgb", 80, &[]),
    run("paper-rgb", 30, LAYERS),
    run("paper-rgb", 0, LAYERS),
    run("paper-rgb", 80, LAYERS),
    run("penumbra", 0, RAYS),
    run("penumbra", 30, RAYS),
    run("penumbra", 80, RAYS),
    run("cornell", 200, RAYS),
    run("cornell", 350, RAYS),
    run("office", 340, RAYS),
    run("cornell-rgb", 200, RAYS),
    run("cornell", 170, TERMS),
    run("cornell", 200, TERMS),
    run("cornell", 250, TERMS),
    run("cornell-rgb", 120, TERMS),
    run("cornell-rgb", 170, TERMS),
    run("penumbra", 0, VECTORS),
    run("cornell", 250, VECTORS),
    run("office", 0, VECTORS),
    run("cornell-rgb", 120, VECTORS),
    run("cornell-rgb", 220, VECTORS),
];

/// Every kind of light in `f32`, on each of [`ARITHMETIC`].
const OF_EVERY_RUNG: [Run; 15] = [
    run("paper", 0, &[]),
    run("paper", 40, &[]),
    run("paper", 70, &[]),
    run("paper-aspect", 0, &[]),
    run("penumbra", 0, &[]),
    run("penumbra", 30, &[]),
    run("penumbra", 80, &[]),
    run("cornell", 200, &[]),
    run("office", 340, &[]),
    run("paper-aspect", 0, LAYERS),
    run("cornell", 200, CODES),
    run("cornell-rgb", 200, &[]),
    run("room", 0, &[]),
    run("room-rgb", 0, &[]),
    run("paper-rgb", 0, &[]),
];

const ARITHMETIC: [&str; 5] = ["libm", "micromath", "poly3", "poly5", "poly8"];

/// What the light of further rungs is fitted to; their loads and grids are those of [`RUNS`].
pub(crate) fn rungs() -> Vec<Run> {
    let of_arithmetic = |rung| OF_EVERY_RUNG.into_iter().map(move |run| on(rung, run));
    ARITHMETIC.into_iter().flat_map(of_arithmetic).collect()
}

/// What the costs are tried on, and are not fitted to.
pub(crate) const OTHERS: [Run; 16] = [
    run("penumbra", 70, &[]),
    run("cornell", 450, &[]),
    run("cornell-rgb", 350, &[]),
    run("office", 600, &[]),
    run("cornell", 450, CODES),
    run("office", 600, Q29_TERMS),
    run("room", 140, &[]),
    run("cornell", 130, RAYS),
    run("cornell", 220, TERMS),
    run("office", 340, VECTORS),
    on("poly3", run("paper", 100, &[])),
    on("poly5", run("cornell", 120, &[])),
    on("poly5", run("office", 200, CODES)),
    on("poly8", run("penumbra", 60, &[])),
    on("libm", run("office", 250, &[])),
    on("micromath", run("cornell-rgb", 130, &[])),
];

impl Run {
    /// Whether a flag or the rung of arithmetic is this word.
    pub(crate) fn has(&self, word: &str) -> bool {
        let named = self.flags.contains(&"--arithmetic");
        let best = word == "best" && self.arithmetic.is_none() && !named;
        best || self.flags.contains(&word) || self.arithmetic == Some(word)
    }

    /// Its scene, its samples and its flags.
    pub(crate) fn name(&self) -> String {
        let samples = self.samples.map(|samples| format!(" {samples}"));
        let flags = self.words().collect::<Vec<_>>().join(" ");
        format!("{}{} {flags}", self.scene, samples.unwrap_or_default())
    }

    fn words(&self) -> impl Iterator<Item = &'static str> {
        let rung = self.arithmetic.into_iter();
        let named = rung.flat_map(|rung| ["--arithmetic", rung]);
        self.flags.iter().copied().chain(named)
    }

    /// Writes its scene and gives the arguments of the program.
    pub(crate) fn arguments(&self, directory: &Path) -> Vec<String> {
        let file = format!("{}.toml", self.scene);
        let mut text = match shipped::ALL.iter().find(|(name, _)| *name == file) {
            Some((_, text)) => (*text).to_owned(),
            None => std::fs::read_to_string(Path::new(SCENES).join(&file)).expect("a scene"),
        };
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
        let mut all = ["device", &file, "--sheet", "--json"]
            .map(str::to_owned)
            .to_vec();
        all.extend(self.words().map(str::to_owned));
        all
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

/// The costs that err least, none below 0: the squares of relative errors are least
/// (Lawson & Hanson 1974). Of operations that come in one proportion everywhere each gets
/// a part. What few runs tell nothing of stays `like` the costs that these are near to.
pub(crate) fn fitted(all: &[Observed], like: &Costs) -> Costs {
    let names: BTreeSet<&String> = all.iter().flat_map(|one| one.done.keys()).collect();
    let of = |one: &Observed, name: &String| {
        one.done.get(name).copied().unwrap_or(0.0) / one.instructions
    };
    // A column an operation, each of length 1.
    let columns: Vec<(&String, f64, Vec<f64>)> = { names.into_iter() }
        .map(|name| {
            let column: Vec<f64> = all.iter().map(|one| of(one, name)).collect();
            let length = dot(&column, &column).sqrt();
            (name, length, column.iter().map(|x| x / length).collect())
        })
        .collect();
    let count = columns.len();
    let products = |one: usize| (0..count).map(move |other| (one, other));
    // What is known of a cost beforehand, and what a square of its change weighs.
    let known = |one: usize| match like.get(columns[one].0) {
        Some(&cost) => (
            cost * columns[one].1,
            (LIKE / (cost * columns[one].1)).powi(2),
        ),
        None => (0.0, RIDGE),
    };
    let normal: Vec<Vec<f64>> = (0..count)
        .map(|one| {
            let row = products(one).map(|(a, b)| dot(&columns[a].2, &columns[b].2));
            let kept = |(other, x)| x + if one == other { known(one).1 } else { 0.0 };
            row.enumerate().map(kept).collect()
        })
        .collect();
    let along: Vec<f64> = (0..count)
        .map(|one| columns[one].2.iter().sum::<f64>() + known(one).0 * known(one).1)
        .collect();
    let scaled = not_negative(&normal, &along);
    let costs = columns.iter().zip(scaled);
    costs
        .map(|((name, length, _), cost)| ((*name).clone(), cost / length))
        .filter(|&(_, cost)| cost > 0.0)
        .collect()
}

/// What keeps the normal equations of operations in one proportion solvable.
const RIDGE: f64 = 1e-10;
/// A cost that is twice another's counts as so much of an error of a step.
const LIKE: f64 = 0.003;

/// What operations cost.
pub(crate) type Costs = BTreeMap<String, f64>;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The x ≥ 0 for which xᵀ(N x/2 − b) is least.
fn not_negative(normal: &[Vec<f64>], along: &[f64]) -> Vec<f64> {
    let count = along.len();
    let (mut costs, mut free) = (vec![0.0; count], vec![false; count]);
    let mut refused = vec![false; count];
    loop {
        let slope = |index: usize| along[index] - dot(&normal[index], &costs);
        let best = { (0..count).filter(|&index| !free[index] && !refused[index]) }
            .map(|index| (index, slope(index)))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((new, _)) = best.filter(|&(_, slope)| slope > 1e-13) else {
            return costs;
        };
        free[new] = true;
        let mut first = true;
        loop {
            let solved = solved(normal, along, &free);
            if first && solved[new] <= 0.0 {
                (free[new], refused[new]) = (false, true);
                break;
            }
            first = false;
            let below = (0..count).filter(|&index| free[index] && solved[index] <= 0.0);
            let part = below
                .map(|index| costs[index] / (costs[index] - solved[index]))
                .fold(1.0, f64::min);
            for (cost, solved) in costs.iter_mut().zip(&solved) {
                *cost += part * (solved - *cost);
            }
            if part >= 1.0 {
                refused.fill(false);
                break;
            }
            for (cost, free) in costs.iter_mut().zip(&mut free) {
                *free &= *cost > 1e-15;
                *cost = if *free { *cost } else { 0.0 };
            }
        }
    }
}

/// The solution of the normal equations of the free unknowns, 0 for the others, by
/// Gaussian elimination: the matrix is positive definite.
fn solved(normal: &[Vec<f64>], along: &[f64], free: &[bool]) -> Vec<f64> {
    let free: Vec<usize> = (0..free.len()).filter(|&index| free[index]).collect();
    let mut rows: Vec<Vec<f64>> = { free.iter() }
        .map(|&one| {
            let row = free.iter().map(|&other| normal[one][other]);
            row.chain([along[one]]).collect()
        })
        .collect();
    for pivot in 0..rows.len() {
        let (done, rest) = rows.split_at_mut(pivot + 1);
        let from = &done[pivot];
        for row in rest {
            let factor = row[pivot] / from[pivot];
            for (x, y) in row.iter_mut().zip(from).skip(pivot) {
                *x -= factor * y;
            }
        }
    }
    let mut found = vec![0.0; along.len()];
    for (row, &index) in rows.iter().zip(&free).rev() {
        let place = free.iter().position(|&other| other == index).expect("free");
        let known: f64 = (place + 1..free.len())
            .map(|k| row[k] * found[free[k]])
            .sum();
        found[index] = (row[free.len()] - known) / row[place];
    }
    found
}

/// By how much costs are wrong of a step, relative to what it took.
pub(crate) fn error(costs: &Costs, one: &Observed) -> f64 {
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

/// What sums may err by beyond the largest error of the fit, in other scenes.
const OTHERWISE: f64 = 0.003;
/// The same of costs that as many operations as runs fit exactly, whatever they are worth.
const UNTRIED: f64 = 0.009;
/// What they may err by in loads, which the compiler makes other ones for every table.
const LOADS: f64 = 0.05;

/// The costs that those of a group are near to: the same in grey, or on the rung `best`, or
/// of exact visibility.
fn like(group: &str) -> Option<String> {
    let grey = ["-rgb", " rgb"]
        .iter()
        .find_map(|rgb| group.strip_suffix(rgb));
    if grey.is_some() || group == "load rooms" {
        return Some(grey.unwrap_or("load exact").to_owned());
    }
    let rungs = ARITHMETIC.iter().map(|rung| format!("-{rung}"));
    let own = { rungs }.find_map(|rung| Some(group.strip_suffix(&rung)?.to_owned()));
    own.or_else(|| Some(format!("{}-exact", group.strip_suffix("-rays")?)))
}

/// The committed file, and what it errs by, in words; `written` has the costs of groups
/// that are not of these steps.
pub(crate) fn model(all: &[Observed], written: &str) -> (String, String) {
    let (mut text, mut said) = (format!("{HEAD}\n"), String::new());
    let mut known = read(written);
    let groups: BTreeSet<&String> = all.iter().map(|one| &one.group).collect();
    for name in groups {
        let of_group = |one: &&Observed| one.group == *name;
        let its: Vec<Observed> = all.iter().filter(of_group).cloned().collect();
        let like = like(name).and_then(|like| known.get(&like));
        let costs = fitted(&its, like.unwrap_or(&Costs::new()));
        known.insert(name.clone(), costs.clone());
        let errors: Vec<f64> = its.iter().map(|one| error(&costs, one)).collect();
        let largest = errors
            .iter()
            .fold(0.0, |most: f64, error| most.max(error.abs()));
        let least = match name {
            name if name.starts_with("load") => LOADS,
            _ if its.len() <= costs.len() => UNTRIED,
            _ => 0.0,
        };
        let allowed = f64::max(largest + OTHERWISE, least);
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

/// Written costs, by group.
fn read(written: &str) -> BTreeMap<String, Costs> {
    let mut costs: BTreeMap<String, Costs> = BTreeMap::new();
    for line in written.lines() {
        if let [group, operation, cost] = *line.split(',').collect::<Vec<_>>()
            && operation != "error"
            && let Ok(cost) = cost.parse()
        {
            let its = costs.entry(group.to_owned()).or_default();
            its.insert(operation.to_owned(), cost);
        }
    }
    costs
}

/// What written costs err by in steps that they were not fitted to, in words.
pub(crate) fn tried(written: &str, others: &[(String, Observed)]) -> String {
    let costs = read(written);
    let said = |(run, one): &(String, Observed)| {
        let error = costs.get(&one.group).map(|costs| 100.0 * error(costs, one));
        let error = error.map_or("no costs".to_owned(), |error| format!("{error:+.2} %"));
        format!("not fitted: {run} {}: {error}\n", one.group)
    };
    others.iter().map(said).collect()
}
