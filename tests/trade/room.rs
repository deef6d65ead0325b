//! The rungs that change what is planned and baked.

use super::{ALLOWANCE, column, read};
use isolux::shoot::Stop;
use isolux_host::bake;
use isolux_host::occlusion::Occlusion;
use isolux_host::pilot;
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::{file, shipped};
use isolux_host::solve::Sight;
use isolux_host::trade::room::{self, Baked, Field};
use std::collections::BTreeMap;

/// The command that writes the committed result of a scene anew.
const COMMAND: &str =
    "cargo run --release --bin isolux -- trade SCENE --without-arithmetic -o benches/trade/SCENE";

/// A committed column of a scene, by the rungs' names.
fn committed(scene: &str, name: &str) -> BTreeMap<String, f64> {
    let rows = read(&format!("{scene}/trade-room.csv"));
    assert_eq!(rows[0].join(","), room::COLUMNS, "see {COMMAND}");
    let rungs = column(&rows, name, 4);
    assert_eq!(
        rungs.len(),
        room::choices(true).len(),
        "{name}; see {COMMAND}"
    );
    let named = rungs.into_iter().map(|(key, value)| {
        let rungs = key.split_once(' ').map(|(_, rungs)| rungs.to_owned());
        (rungs.unwrap_or(key), value)
    });
    named.collect()
}

/// What each rung is for, in the committed figures.
#[test]
fn rungs_buy_what_they_promise() {
    for scene in ["penumbra", "cornell"] {
        let p95 = committed(scene, "p95");
        let best = p95["exact linear exact"];
        for lesser in ["none linear exact", "vertex-rays linear exact"] {
            assert!(p95[lesser] > 5.0 * best, "{scene}: {p95:?}");
        }
        let instructions = committed(scene, "m4f_instructions");
        let [exact, codes] =
            ["exact linear exact", "exact linear codes"].map(|rungs| instructions[rungs]);
        assert!(codes < exact, "{scene}: {instructions:?}");
    }
    let rms = committed("cornell", "rms");
    assert!(rms["exact layer-cake exact"] < rms["exact isolux exact"]);
    assert!(rms["exact linear exact"] < rms["exact layer-cake exact"]);
}

/// The best combination still gives what is committed.
#[test]
fn no_room_errs_by_more_than_committed() {
    let scene = file::parse("penumbra.toml", shipped::PENUMBRA).expect("a shipped scene");
    let light = |reflections| {
        let light = Reference::new(&scene, reflections, &mut |_| {});
        light.expect("a reference")
    };
    let (direct, all) = (
        light(Reflections::AtMost(0)),
        light(Reflections::UntilUnshot(1e-5)),
    );
    let vertices = scene.surfaces.iter().flat_map(|surface| &surface.vertices);
    let points = scene.points.iter().map(|point| &point.position);
    let reach = vertices.chain(points).copied();
    let occlusion = Occlusion::for_receivers_within(&scene, reach).expect("few vertices");
    let field = |places: &[_]| direct.irradiance_at(places);
    let looking = (Some(&occlusion), Sight::Exact);
    let plan = pilot::linear(&scene, &scene.budget, looking, &field).expect("a plan");
    let tables = bake::bake(&scene, &plan, Some(occlusion)).expect("tables");
    let baked = Baked {
        scene: &scene,
        plan: &plan,
        tables: &tables,
        sight: Sight::Exact,
        ram_bytes: 0,
        stop: Stop::below(0.001),
    };
    let choices = room::choices(true);
    let best = choices.into_iter().find(|choice| {
        let names = [choice.visibility, choice.emitters, choice.transfer];
        names == ["exact", "linear", "exact"]
    });
    let field = Field::new(&scene, &all);
    let row = room::measure(best.expect("a choice"), &baked, &field, false).expect("a row");
    for (name, got) in [
        ("p95", row.error.relative.p95),
        ("rms", row.error.relative.rms),
        ("table_bytes", row.table_bytes as f64),
    ] {
        let known = committed("penumbra", name)["exact linear exact"];
        assert!(
            got <= ALLOWANCE * known,
            "{name}: {got}, {known}; see {COMMAND}"
        );
    }
}
