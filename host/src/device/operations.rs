//! What the steps of a run do, counted from the tables and the host's own solve.

mod grid;
mod load;

use std::collections::BTreeMap;

use isolux::Error;
use isolux::integers;
use isolux::scene::Scene;
use isolux::scene::records::Counts;
use isolux::shoot::Stop;
use serde::Serialize;

use crate::bake::Tables;
use crate::solve::tally::{Operation, Tally, tally, tally_in_integers};
use crate::solve::{Rung, Sight};

/// How often every operation of a step is done, by its name.
pub type Done = BTreeMap<&'static str, u64>;

/// The operations of every step.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Operations {
    /// What the types of the light are: its program, and so its costs, are others for each.
    pub kind: String,
    /// Checking the tables and making the dark state.
    pub load: Done,
    /// Direct light.
    pub direct: Done,
    /// Every shot after it.
    pub shoot: Done,
    /// Every row of every grid.
    pub resample: Done,
}

impl Operations {
    /// Those of the firmware that `isolux device` runs: the tables are loaded, lit until
    /// `stop`, and every surface with samples is put together as a grid of `resolution`
    /// rows and columns.
    ///
    /// # Errors
    /// Where the kernel does not take the tables.
    pub fn of(
        tables: &Tables,
        (rung, sight): (Rung, Sight),
        stop: Stop,
        resolution: usize,
    ) -> Result<Self, Error> {
        let scene = Scene::load(tables.bytes())?;
        let [direct, shoot] = split(tally(tables, rung, sight, stop)?);
        Ok(Self {
            kind: kind(scene.counts(), rung, sight),
            load: load::of(scene.counts(), tables.bytes().len()),
            direct,
            shoot,
            resample: grid::of(&scene, resolution as u32),
        })
    }

    /// Those of tables in integers, on `q24` where `is_short` and else on `q29`.
    ///
    /// # Errors
    /// Where the kernel does not take the tables.
    pub fn in_integers(
        tables: &Tables,
        is_short: bool,
        stop: Stop,
        resolution: usize,
    ) -> Result<Self, Error> {
        let scene = integers::Scene::load(tables.bytes())?;
        let rung = if is_short { "q24" } else { "q29" };
        let transfer = if scene.counts().coefficients > 1 {
            "matrix"
        } else {
            "constant"
        };
        let [direct, shoot] = split(tally_in_integers(tables.bytes(), is_short, stop)?);
        let resample = grid::in_integers(&scene, resolution as u32);
        Ok(Self {
            kind: format!("{rung}-{transfer}"),
            load: load::of(scene.counts(), tables.bytes().len()),
            direct,
            shoot,
            resample,
        })
    }

    /// The steps by name, in the order of a run.
    pub fn steps(&self) -> [(&'static str, &Done); 4] {
        [
            ("load", &self.load),
            ("direct", &self.direct),
            ("shoot", &self.shoot),
            ("resample", &self.resample),
        ]
    }
}

/// Direct light and what comes after it, by name.
fn split([direct, all]: [Tally; 2]) -> [Done; 2] {
    let shoot: Tally = std::array::from_fn(|index| all[index].saturating_sub(direct[index]));
    [direct, shoot].map(|tally| {
        let names = Operation::ALL.iter().map(|operation| operation.name());
        names.zip(tally).filter(|&(_, times)| times > 0).collect()
    })
}

/// How radiosity varies over an emitter, how what a sample receives is had, the rung of
/// arithmetic where it is not the best, and channels.
fn kind(counts: &Counts, rung: Rung, sight: Sight) -> String {
    let form = match (counts.coefficients, counts.weights) {
        (1, 0) => "constant",
        (1, _) => "increment",
        _ => "linear",
    };
    let transfer = match () {
        () if counts.terms > 0 => format!("-matrix{}", counts.bits),
        () if counts.responses > 0 => "-vectors".to_owned(),
        () if counts.is_coded() => "-codes".to_owned(),
        () if counts.occluders == 0 => String::new(),
        () if sight == Sight::VertexRays => "-rays".to_owned(),
        () => "-exact".to_owned(),
    };
    let rung = match rung {
        Rung::Best => String::new(),
        other => format!("-{}", other.name()),
    };
    let colour = if counts.channels == 1 { "" } else { "-rgb" };
    format!("{form}{transfer}{rung}{colour}")
}

fn add(done: &mut Done, operation: &'static str, times: u64) {
    if times > 0 {
        *done.entry(operation).or_insert(0) += times;
    }
}
