//! What things cost in instructions does not creep up unseen: every figure is
//! held against benches/instructions.csv, and the calls that were measured
//! gave the host's answers.
//!
//! Skipped, loudly, where the emulator or the Rust target is missing; with
//! `ISOLUX_REQUIRE_QEMU=1` in the environment that is a failure instead.

#[path = "firmware/src/cost_cases.rs"]
mod cost_cases;
#[path = "firmware/src/cost_ready.rs"]
mod cost_ready;
#[path = "firmware/src/cost_samples.rs"]
mod cost_samples;
#[path = "../benches/parts/ledger.rs"]
mod ledger;
#[path = "../benches/parts/planned.rs"]
mod planned;

use cost_cases::{CASES, VERTICES};
use cost_samples::{RECEIVERS, Samples};
use isolux::form_factor::fixed_point::{self, Format, Q24, Q29};
use isolux::form_factor::{Baked, Edge, Outline, of_baked_loops};
use isolux::geometry::Plane;
use isolux::number::SoftRoot;
use isolux_host::device::Cost;
use isolux_host::solve::{FormFactorRung, Rung};
use ledger::Row;
use std::collections::BTreeMap;

/// What a figure may be above its committed value: 3 %.
const ALLOWANCE: f64 = 1.03;

#[test]
fn nothing_costs_more_than_the_ledger_says() {
    let (rows, costs) = match ledger::measure() {
        Ok(measured) => measured,
        Err(error) => {
            let required = std::env::var_os("ISOLUX_REQUIRE_QEMU").is_some();
            assert!(error.is_missing() && !required, "{error}");
            eprintln!("SKIPPED: {error}");
            return;
        }
    };
    let committed = std::fs::read_to_string(ledger::PATH).expect("the ledger is committed");
    let committed = ledger::read(&committed).expect("the ledger is one");
    let complaints = complaints(&rows, &committed);
    assert!(
        complaints.is_empty(),
        "{}\nIf that is meant, write the ledger anew with `{}` and commit it.",
        complaints.join("\n"),
        ledger::COMMAND
    );
    assert!(answers_compared(&costs) >= CASES.len() * VERTICES.len() * FormFactorRung::ALL.len());
}

/// What is dearer than the ledger says, or known to one side only.
fn complaints(rows: &[Row], committed: &[Row]) -> Vec<String> {
    let mut known: BTreeMap<_, _> = committed.iter().map(|row| (&row.name, row)).collect();
    let mut complaints = Vec::new();
    for row in rows {
        let name = row.name.join(" ");
        let Some(old) = known.remove(&row.name) else {
            complaints.push(format!("{name}: not in the ledger"));
            continue;
        };
        let figures = [
            ("mean", row.mean, old.mean),
            ("largest", row.largest as f64, old.largest as f64),
        ];
        for (what, new, old) in figures {
            if new > ALLOWANCE * old {
                let percent = 100.0 * (new / old - 1.0);
                complaints.push(format!(
                    "{name}: {what} {new:.2} instructions, {percent:+.1} % on {old:.2}"
                ));
            }
        }
    }
    complaints.extend(
        known
            .keys()
            .map(|name| format!("{}: in the ledger only", name.join(" "))),
    );
    complaints
}

/// Compares the sums of the device's answers with the host's, bit by bit, and
/// says how many there were.
fn answers_compared(costs: &[Cost]) -> usize {
    let mut compared = 0;
    for cost in costs {
        let expected = match (cost.operation.as_str(), cost.rung.as_str()) {
            ("form-factor", "q24") => fixed_form_factors::<Q24>(cost),
            ("form-factor", "q29") => fixed_form_factors::<Q29>(cost),
            ("form-factor", "baked") => baked_form_factors(cost),
            ("form-factor", _) => form_factors(cost),
            ("ready-sum", _) => ready_sums(cost),
            ("delta-form-factors", _) => classical(cost.size),
            ("outline", _) => continue,
            _ => panic!("an operation the host does not know: {cost:?}"),
        };
        assert_eq!(cost.answers, expected.to_bits(), "{cost:?}");
        assert!(expected != 0.0, "{cost:?}");
        compared += 1;
    }
    compared
}

fn form_factors(cost: &Cost) -> f32 {
    let rung = Rung::named(&cost.rung).expect("a rung of the host");
    let mut cases = CASES.iter();
    let case = cases.find(|case| case.name == cost.case).expect("a case");
    let corners = case.emitter(cost.size);
    (0..RECEIVERS).fold(0.0, |sum, index| {
        let receiver = case.receiver(index).expect("a receiver");
        sum + rung.form_factor_at(&receiver, &corners[..cost.size])
    })
}

fn ready_sums(cost: &Cost) -> f32 {
    let mut cases = CASES.iter();
    let case = cases.find(|case| case.name == cost.case).expect("a case");
    (0..RECEIVERS).fold(0.0, |sum, index| {
        let receiver = case.receiver(index).expect("a receiver");
        let corners = cost_ready::seen(case, &receiver, cost.size);
        sum + cost_ready::ready::<SoftRoot>(receiver.normal(), &corners[..cost.size])
    })
}

fn baked_form_factors(cost: &Cost) -> f32 {
    let mut cases = CASES.iter();
    let case = cases.find(|case| case.name == cost.case).expect("a case");
    let corners = case.emitter(cost.size);
    let corners = &corners[..cost.size];
    let edges: Vec<Edge> = Edge::of_loop(corners).collect();
    let baked = Baked::new(Outline::new(corners), &edges).expect("a table of its edges");
    let plane = Plane::of_polygon(corners);
    (0..RECEIVERS).fold(0.0, |sum, index| {
        let receiver = case.receiver(index).expect("a receiver");
        sum + of_baked_loops::<SoftRoot>(&receiver, &plane, [baked].into_iter())
    })
}

fn fixed_form_factors<F: Format>(cost: &Cost) -> f32 {
    let mut cases = CASES.iter();
    let case = cases.find(|case| case.name == cost.case).expect("a case");
    (0..RECEIVERS).fold(0.0, |sum, index| {
        let (corners, receiver) = case.fixed::<F>(cost.size, index).expect("a receiver");
        sum + fixed_point::form_factor(&receiver, &corners[..cost.size]).to_bits() as f32
    })
}

fn classical(count: usize) -> f32 {
    let samples = Samples::on_the_light(count.isqrt());
    (0..RECEIVERS).fold(0.0, |sum, index| {
        let receiver = Samples::receiver(index).expect("a receiver");
        sum + samples.form_factor(&receiver)
    })
}

fn row(size: &str, mean: f64, largest: u64) -> Row {
    Row {
        name: ["core", "form-factor", "best", "fpu", "large", size].map(str::to_owned),
        calls: 36,
        mean,
        largest,
    }
}

#[test]
fn the_gate_lets_through_what_it_should_and_nothing_else() {
    let committed = [row("3", 400.0, 420), row("4", 500.0, 520)];
    assert!(complaints(&committed, &committed).is_empty());
    let cheaper = [row("3", 300.0, 320), row("4", 514.0, 535)];
    assert!(complaints(&cheaper, &committed).is_empty());
    let dearer = [row("3", 413.0, 420), row("4", 500.0, 536)];
    assert_eq!(complaints(&dearer, &committed).len(), 2);
    let other = [row("3", 400.0, 420), row("8", 1.0, 1)];
    assert_eq!(complaints(&other, &committed).len(), 2);
}

#[test]
fn a_ledger_is_read_as_it_was_written() {
    let rows = [row("3", 400.25, 420), row("4", 500.0, 520)];
    assert_eq!(ledger::read(&ledger::write(&rows)), Ok(rows.to_vec()));
    for broken in ["", "# only a comment\n", "core,operation\n"] {
        assert!(ledger::read(broken).is_err(), "{broken}");
    }
    let cut = ledger::write(&rows).replace(",420", "");
    let message = ledger::read(&cut).expect_err("a cell is missing");
    assert!(message.starts_with("line 3 "), "{message}");
}
