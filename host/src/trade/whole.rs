//! What the whole way from samples to surfaces gives and costs in a scene.
//!
//! Every row is a plan of its own: so many samples, placed and reconstructed one way,
//! with the emitters that go with it. Errors are of the surfaces as they are put together
//! from the samples; instructions are those that the budget sheet predicts, or where it
//! knows no costs those that the emulator counts.

use super::front;
use super::room::error_cells;
use super::table::{finished, plain};
use crate::compare::Errors;
use crate::report::quantity;
use serde::Serialize;

/// One rung of each ladder, by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Way {
    /// How samples become surfaces.
    pub reconstruction: &'static str,
    /// What shoots reflected light.
    pub emitters: &'static str,
}

/// Every reconstruction with the emitters that go with it, the paper's own way first:
/// isolux outlines, bands between them and the cone filter.
pub const WAYS: [Way; 6] = [
    Way {
        reconstruction: "cone",
        emitters: "isolux",
    },
    Way {
        reconstruction: "cone",
        emitters: "layer-cake",
    },
    Way {
        reconstruction: "cone",
        emitters: "linear",
    },
    Way {
        reconstruction: "tensor",
        emitters: "points",
    },
    Way {
        reconstruction: "tensor",
        emitters: "few-points",
    },
    Way {
        reconstruction: "stencil",
        emitters: "linear",
    },
];

impl Way {
    /// Where its samples are: on isolux outlines for the cone filter, else by error.
    #[must_use]
    pub fn placement(&self) -> &'static str {
        match self.reconstruction {
            "cone" => "isolux",
            _ => "error",
        }
    }

    /// What it is called in a plot.
    #[must_use]
    pub fn name(&self) -> String {
        let Self {
            reconstruction,
            emitters,
        } = self;
        match *self == WAYS[0] {
            true => "the paper's".to_owned(),
            false => format!("{reconstruction}, {emitters}"),
        }
    }
}

/// A plan, and what became of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// How.
    #[serde(flatten)]
    pub way: Way,
    /// Samples at the most.
    pub asked: u64,
    /// Samples that it has.
    pub samples: usize,
    /// Luminaires and what reflects.
    pub shooters: u32,
    /// Errors of irradiance on all surfaces, in percent.
    pub error: Errors,
    /// Instructions of direct light and shots on the Cortex-M4F; `None` where no costs are
    /// known and there is no emulator, or the device has no room.
    pub instructions: Option<u64>,
    /// Whether the emulator counted them; else they are predicted.
    pub counted: bool,
    /// Those of grids of 200 × 200 of all surfaces beside them, where they are predicted.
    pub grid_instructions: Option<u64>,
    /// Bytes of flash that the tables take.
    pub table_bytes: usize,
    /// Bytes of RAM for light, workspace and reconstruction.
    pub ram_bytes: usize,
    /// Whether no other plan takes as few instructions and errs as little, by rms.
    pub on_front: bool,
}

/// Marks the plans on the front of instructions and rms.
pub fn mark(rows: &mut [Row]) {
    let points: Vec<(f64, f64)> = rows
        .iter()
        .map(|row| {
            let cost = row.instructions.map_or(f64::NAN, |count| count as f64);
            (cost, row.error.relative.rms)
        })
        .collect();
    for (row, on_front) in rows.iter_mut().zip(front::pareto(&points)) {
        row.on_front = on_front;
    }
}

/// The columns of [`csv`]; errors in percent: relative, then of full scale.
pub const COLUMNS: &str = "scene,placement,reconstruction,emitters,samples_asked,samples,shooters,\
max,p95,rms,over_5,over_15,full_scale_max,full_scale_p95,full_scale_rms,\
m4f_instructions,counted,m4f_grid_instructions,table_bytes,ram_bytes,on_front";

/// The plans, one a line.
#[must_use]
pub fn csv(name: &str, rows: &[Row]) -> String {
    let mut text = format!("{COLUMNS}\n");
    for row in rows {
        let way = &row.way;
        let names = [name, way.placement(), way.reconstruction, way.emitters];
        let mut cells = names.map(str::to_owned).to_vec();
        cells.push(row.asked.to_string());
        cells.push(row.samples.to_string());
        cells.push(row.shooters.to_string());
        cells.extend(error_cells(&row.error));
        let count = |count: Option<u64>| count.map_or_else(String::new, |n| n.to_string());
        cells.push(count(row.instructions));
        cells.push(row.counted.to_string());
        cells.push(count(row.grid_instructions));
        cells.extend([row.table_bytes, row.ram_bytes].map(|bytes| bytes.to_string()));
        cells.push(row.on_front.to_string());
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    text
}

/// The plans for a person; a star marks the front.
#[must_use]
pub fn terminal(rows: &[Row]) -> String {
    let mut table = plain([
        "reconstruction",
        "emitters",
        "samples",
        "max %",
        "p95 %",
        "rms %",
        "> 5 %",
        "instructions",
        "of grids",
        "tables",
        "RAM",
        "front",
    ]);
    for row in rows {
        let relative = &row.error.relative;
        let [_, _, over_5, ..] = relative.over;
        let errors = [relative.max, relative.p95, relative.rms, over_5];
        let names = [row.way.reconstruction, row.way.emitters].map(str::to_owned);
        let counted = |count: Option<u64>| count.map_or_else(|| "-".to_owned(), |n| n.to_string());
        let rest = [
            counted(row.instructions),
            counted(row.grid_instructions),
            row.table_bytes.to_string(),
            row.ram_bytes.to_string(),
            if row.on_front { "*" } else { "" }.to_owned(),
        ];
        let samples = std::iter::once(row.samples.to_string());
        let cells = names.into_iter().chain(samples);
        table.add_row(cells.chain(errors.map(quantity)).chain(rest));
    }
    finished(table)
}
