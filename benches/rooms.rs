//! What rooms cost on the host, one thread, beside what other systems take.
//!
//! ```text
//! cargo bench --bench rooms              prints it
//! cargo bench --bench rooms -- --write   also writes benches/rooms.md
//! ```
//!
//! Times are those of the processor, not of the clock on the wall, and the
//! least of several runs.

#[path = "parts/clock.rs"]
mod clock;
#[path = "parts/directly.rs"]
mod directly;
#[path = "parts/grid.rs"]
mod grid;
#[path = "../tests/visibility/lit.rs"]
#[allow(dead_code, reason = "the tests use more of it")]
mod lit;
#[path = "rooms/measure.rs"]
mod measure;
#[path = "../tests/visibility/published.rs"]
#[allow(dead_code, reason = "the tests use more of it")]
mod published;
#[path = "../tests/visibility/random.rs"]
#[allow(dead_code, reason = "the tests use more of it")]
mod random;
#[path = "parts/room.rs"]
mod room;
#[path = "parts/written.rs"]
mod written;

use grid::grid;
use isolux_host::report::quantity;
use measure::{Bounces, Clutter, Direct, Many};
use std::process::ExitCode;

const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/rooms.md");

/// The scenes: name, and what is asked of direct light and has been measured of
/// View3D, the fastest of the other systems, in microseconds a point.
const DIRECT: [(&str, f64, f64); 3] = [
    ("penumbra", 0.4, 17.0),
    ("office", 1.2, 61.0),
    ("cornell", 0.5, 206.0),
];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if !arguments.iter().any(|argument| argument == "--bench") {
        return ExitCode::SUCCESS; // `cargo test` builds it, and no more
    }
    let text = clock::on_one_thread(document);
    written::answer(&text, PATH)
}

fn document() -> String {
    let before = include_str!("rooms/before.md").trim_end();
    let after = include_str!("rooms/after.md");
    let (direct, bounces, many) = (direct(), bounces(), many());
    format!(
        "{before}\n\n## Direct light\n\n{direct}\n## Many bounces\n\n{bounces}\n\
         ## Time against the number of polygons\n\n{many}\n{after}"
    )
}

fn row(name: &str, cells: impl IntoIterator<Item = String>) -> Vec<String> {
    std::iter::once(name.to_owned()).chain(cells).collect()
}

fn direct() -> String {
    let measured = DIRECT.map(|(name, ..)| measure::direct(name));
    let cells = |of: &dyn Fn(&Direct) -> f64| measured.iter().map(|m| quantity(of(m))).collect();
    let asked = |of: fn(&(&str, f64, f64)) -> f64| DIRECT.iter().map(|d| quantity(of(d))).collect();
    let mut rows = vec![row("µs a point", DIRECT.map(|(name, ..)| name.to_owned()))];
    let mut push = |name: &str, cells: Vec<String>| rows.push(row(name, cells));
    push("kernel, visibility `exact`", cells(&|m| 1e6 * m.exact));
    push("kernel, visibility `none`", cells(&|m| 1e6 * m.none));
    push(
        "whole solution at points, as `solve --points --bounces 0`",
        cells(&|m| 1e6 * m.solution),
    );
    push("asked", asked(|d| d.1));
    push("View3D, published", asked(|d| d.2));
    grid(&rows)
}

fn bounces() -> String {
    // With the budget of the scene, and without.
    let rooms = ["cornell", "office"].map(|name| [(name, true), (name, false)]);
    let measured = rooms.as_flattened().iter().copied().map(measure::bounces);
    let measured: Vec<Bounces> = measured.collect();
    let names = rooms
        .as_flattened()
        .iter()
        .map(|&(name, within)| match within {
            true => name.to_owned(),
            false => format!("{name}, no budget"),
        });
    let cells = |of: &dyn Fn(&Bounces) -> String| measured.iter().map(of).collect::<Vec<_>>();
    let mut rows = vec![row("", names)];
    let mut push = |name: &str, cells: Vec<String>| rows.push(row(name, cells));
    push("samples", cells(&|m| m.samples.to_string()));
    push("emitters", cells(&|m| m.emitters.to_string()));
    push("plan, ms", cells(&|m| quantity(1e3 * m.plan)));
    push(
        "bake with the survey, ms",
        cells(&|m| quantity(1e3 * m.bake)),
    );
    push(
        "solve once to 0.1 % unshot, ms",
        cells(&|m| quantity(1e3 * m.solve)),
    );
    push("asked", cells(&|_| "40".to_owned()));
    push("shots", cells(&|m| m.shots.to_string()));
    push(
        "form factors of the solve",
        cells(&|m| m.form_factors.to_string()),
    );
    push("then a point, µs", cells(&|m| quantity(1e6 * m.point)));
    push("asked", cells(&|_| "30".to_owned()));
    push(
        "Mitsuba a point to 1 %, published, µs",
        cells(&|_| "1400".to_owned()),
    );
    grid(&rows)
}

fn many() -> String {
    const COUNTS: [usize; 3] = [10, 100, 1000];
    let mut rows = vec![row(
        "direct light, µs a point",
        COUNTS.map(|n| n.to_string()).into_iter().chain([
            "10 to 100: times".to_owned(),
            "100 to 1000: times".to_owned(),
        ]),
    )];
    for (name, clutter) in [
        ("boxes on the floor", Clutter::Furniture),
        ("leaves before the light", Clutter::Leaves),
    ] {
        let found: Vec<Many> = COUNTS.map(|n| measure::many(n, clutter)).into();
        let times = found.iter().map(|m| quantity(1e6 * m.seconds));
        let ratio = |pair: &[Many]| quantity(pair[1].seconds / pair[0].seconds);
        rows.push(row(name, times.chain(found.windows(2).map(ratio))));
        let dash = ["-".to_owned(), "-".to_owned()];
        let brackets = found.iter().map(|m| m.inexact.to_string());
        rows.push(row(
            &format!("{name}: brackets among {} places", measure::PLACES),
            brackets.chain(dash),
        ));
    }
    grid(&rows)
}
