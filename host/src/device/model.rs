//! What a run costs before it runs: operations counted on the host, times what each
//! costs on a core.
//!
//! The costs are committed (`benches/model.csv`), fitted once to runs of many scenes on
//! the emulated core by `cargo bench --bench model -- --write`; [`Model::error`] is what the
//! sum errs by in them at the most, with an allowance for other scenes. They are of every
//! rung on a Cortex-M4F with its own square root, and of tables in integers on a Cortex-M3,
//! which has no FPU; in a program linked for speed. A combination of rungs that no run was
//! made of has none.

use std::collections::BTreeMap;

use serde::Serialize;

use super::operations::{Done, Operations};
use super::{Core, Steps};

/// The committed costs.
const COMMITTED: &str = include_str!("../../../benches/model.csv");

/// Estimated cycles of an instruction on a Cortex-M4F with zero wait states, by the rung of
/// arithmetic: what the trace of `benches/trade/trade.csv` gives for form factors.
const CYCLES: [(&str, f64); 5] = [
    ("-libm", 1.76),
    ("-micromath", 1.50),
    ("-poly3", 1.65),
    ("-poly5", 1.63),
    ("-poly8", 1.60),
];

/// The same for `best`.
const CYCLES_OF_BEST: f64 = 1.55;

/// The same for `q29`, by the same model: a Cortex-M3 takes up to four cycles more for a
/// long product.
const CYCLES_IN_INTEGERS: f64 = 1.47;

/// The core that costs of a kind of light are of.
pub fn core(kind: &str) -> Core {
    match is_integer(kind) {
        true => Core::CortexM3,
        false => Core::CortexM4F,
    }
}

/// Estimated cycles of an instruction of a kind of light.
pub fn cycles(kind: &str) -> f64 {
    let rung = CYCLES.iter().find(|(rung, _)| kind.contains(rung));
    match (is_integer(kind), rung) {
        (true, _) => CYCLES_IN_INTEGERS,
        (false, Some(&(_, cycles))) => cycles,
        (false, None) => CYCLES_OF_BEST,
    }
}

fn is_integer(kind: &str) -> bool {
    kind.starts_with('q')
}

/// What the operations cost.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// By step and operation, in instructions. Direct light and shots are one step.
    costs: BTreeMap<(String, String), f64>,
    /// What a step may be above the sum, relative to it.
    errors: BTreeMap<String, f64>,
}

/// What is predicted of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Predicted {
    /// The sum of its operations, in instructions.
    pub expected: u64,
    /// The same with what the model is allowed to err by.
    pub at_most: u64,
}

/// The steps of a run, predicted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PredictedSteps {
    /// Checking the tables and making the dark state.
    pub load: Predicted,
    /// Direct light.
    pub direct: Predicted,
    /// Every shot after it.
    pub shoot: Predicted,
    /// Every row of every grid.
    pub resample: Predicted,
}

impl Model {
    /// The committed one.
    pub fn committed() -> Self {
        Self::read(COMMITTED)
    }

    /// Reads `step,operation,instructions` lines; the operation `error` is what
    /// a step may be above the sum, relative to it.
    pub fn read(text: &str) -> Self {
        let mut model = Self::default();
        for line in text.lines() {
            let cells: Vec<&str> = line.split(',').collect();
            let [step, operation, number] = *cells.as_slice() else {
                continue;
            };
            let Ok(number) = number.parse() else {
                continue;
            };
            if operation == "error" {
                model.errors.insert(step.to_owned(), number);
            } else {
                let key = (step.to_owned(), operation.to_owned());
                model.costs.insert(key, number);
            }
        }
        model
    }

    /// What a step of a kind of light is allowed to be above the sum; `None` where no run
    /// that the model was fitted to has such a step.
    pub fn error(&self, step: &str, kind: &str, done: &Done) -> Option<f64> {
        let group = group(step, kind, done.keys().copied());
        self.errors.get(&group).copied()
    }

    /// Whether costs were measured for all that a run does.
    pub fn knows(&self, operations: &Operations) -> bool {
        let mut steps = operations.steps().into_iter();
        steps.all(|(step, done)| self.error(step, &operations.kind, done).is_some())
    }

    /// What a step of a kind of light will cost.
    pub fn step(&self, step: &str, kind: &str, done: &Done) -> Predicted {
        let group = group(step, kind, done.keys().copied());
        let cost = |operation: &str| {
            let key = (group.clone(), operation.to_owned());
            self.costs.get(&key).copied().unwrap_or(0.0)
        };
        let sum = done
            .iter()
            .map(|(operation, &times)| cost(operation) * times as f64);
        let expected: f64 = sum.sum();
        Predicted {
            expected: expected.round() as u64,
            at_most: (expected * (1.0 + self.error(step, kind, done).unwrap_or(0.0))).ceil() as u64,
        }
    }

    /// What all steps will cost.
    pub fn steps(&self, operations: &Operations) -> PredictedSteps {
        let kind = operations.kind.as_str();
        PredictedSteps {
            load: self.step("load", kind, &operations.load),
            direct: self.step("direct", kind, &operations.direct),
            shoot: self.step("shoot", kind, &operations.shoot),
            resample: self.step("resample", kind, &operations.resample),
        }
    }
}

impl PredictedSteps {
    /// The sum of all steps.
    pub fn total(&self) -> Predicted {
        let all = [self.load, self.direct, self.shoot, self.resample];
        Predicted {
            expected: all.iter().map(|step| step.expected).sum(),
            at_most: all.iter().map(|step| step.at_most).sum(),
        }
    }

    /// Whether a run kept to what was predicted at most.
    pub fn hold(&self, measured: &Steps) -> bool {
        measured.load <= self.load.at_most
            && measured.direct <= self.direct.at_most
            && measured.shoot <= self.shoot.at_most
            && measured.resample <= self.resample.at_most
    }
}

/// Which costs a step has: direct light and shots are one program, another one for every
/// kind of light; loads are others by transfer, and in colour where nothing hides anything; grids are others by cone, by tensors
/// alone and with meshes, and in colour; in integers loads and grids are others too.
pub fn group<'a>(step: &str, kind: &str, done: impl IntoIterator<Item = &'a str>) -> String {
    let colour = if kind.ends_with("-rgb") { " rgb" } else { "" };
    match step {
        "load" | "resample" if is_integer(kind) => format!("{step} integers"),
        "direct" | "shoot" => format!("light {kind}"),
        "load" if kind.contains("-codes") => "load codes".to_owned(),
        "load" if kind.contains("-matrix") => "load matrix".to_owned(),
        "load" if kind.contains("-vectors") => "load vectors".to_owned(),
        "load" if kind.contains("-exact") || kind.contains("-rays") => "load exact".to_owned(),
        "load" if kind.starts_with("linear") => format!("load rooms{colour}"),
        "load" => format!("load{colour}"),
        step => {
            let words: Vec<&str> = done.into_iter().collect();
            let way = match () {
                () if words.contains(&"cone-sample") => "cone",
                () if words.contains(&"row-triangle") => "meshes",
                () => "tensors",
            };
            format!("{step} {way}{colour}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_are_read_and_added() {
        let model =
            Model::read("step,operation,instructions\nlight x,pair,10\nlight x,error,0.5\n");
        let done = Done::from([("pair", 7), ("loop", 3)]);
        let predicted = model.step("shoot", "x", &done);
        assert_eq!((predicted.expected, predicted.at_most), (70, 105));
        assert_eq!(model.step("load", "x", &done).expected, 0);
        assert_eq!(model.error("shoot", "x", &done), Some(0.5));
        assert_eq!(model.error("load", "x", &done), None);
        let operations = Operations {
            kind: "constant".to_owned(),
            ..Operations::default()
        };
        assert!(Model::committed().knows(&operations) && !model.knows(&operations));
    }
}
