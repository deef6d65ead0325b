//! The tables between host and kernel: what is refused and why, what happens
//! to tables that somebody changed, and the energy in what they describe.

#[path = "tables/bytes.rs"]
mod bytes;
#[path = "tables/coded.rs"]
mod coded;
#[path = "tables/endurance.rs"]
mod endurance;
#[path = "tables/energy.rs"]
mod energy;
#[path = "tables/fuzz.rs"]
mod fuzz;
#[path = "tables/integers.rs"]
mod integers;
#[path = "tables/lit.rs"]
mod lit;
#[path = "tables/mutation.rs"]
mod mutation;
#[path = "tables/parts.rs"]
mod parts;
#[path = "tables/points.rs"]
mod points;
#[path = "tables/refusals.rs"]
mod refusals;

use glam::DVec3;
use isolux_host::bake::{self, Tables};
use isolux_host::plan::{self, Plan};
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::{Scene, file, shipped};
use std::sync::OnceLock;

/// A scene, planned and baked for light reflected once.
fn planned(name: &str, source: &str) -> (Scene, Plan, Tables) {
    let scene = file::parse(name, source).unwrap_or_else(|error| panic!("{error}"));
    let once = Reference::new(&scene, Reflections::AtMost(1), &mut |_| {}).expect("a reference");
    let field = |places: &[(DVec3, DVec3)]| once.irradiance_at(places);
    let plan = plan::isolux(&scene, &scene.budget, &field).expect("a plan");
    let tables = bake::bake(&scene, &plan, None).expect("tables");
    (scene, plan, tables)
}

/// The paper's scene, planned once for all tests.
fn paper() -> &'static (Scene, Plan, Tables) {
    static PAPER: OnceLock<(Scene, Plan, Tables)> = OnceLock::new();
    PAPER.get_or_init(|| {
        let (name, source) = shipped::ALL[0];
        assert_eq!(name, "paper.toml");
        planned(name, source)
    })
}

fn put(bytes: &mut [u8], at: usize, value: u32) {
    bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
}
