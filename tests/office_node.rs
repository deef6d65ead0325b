//! The example firmware: its control by itself, and the whole node on the emulated
//! Cortex-M4F with the host's numbers.
//!
//! The second is skipped, loudly, where a tool is missing; with
//! `ISOLUX_REQUIRE_QEMU=1` in the environment that is a failure instead.

#[path = "office-node/src/control.rs"]
mod control;
#[path = "office-node/src/node.rs"]
mod node;
#[path = "command_line/program.rs"]
#[allow(dead_code, reason = "the command line's tests use the rest")]
mod program;

use control::{DESKS, LUMINAIRES, Response, is_enough, levels, lit};
use isolux::form_factor::Best;
use isolux::luminance::Constant;
use isolux::scene::Scene;
use isolux::shoot::{Light, Stop};
use isolux::transfer::Vectors;
use isolux_host::device::{self, Build, Core, Toolchain};
use node::{DAY, Office, POWER, WANTED};
use program::isolux;
use proptest::prelude::*;
use std::ffi::OsStr;
use std::fs;
use std::path::Path;
use std::time::Duration;

/// Rooms in which every luminaire lights every desk, one of them most.
fn any_response() -> impl Strategy<Value = Response> {
    let row = prop::array::uniform4(5.0_f32..400.0);
    prop::array::uniform4(row)
}

proptest! {
    /// Whatever is decided is allowed, lights the desks where that can be done, and
    /// no cheaper levels do, of many tried.
    #[test]
    fn levels_are_enough_and_the_cheapest(
        response in any_response(),
        needed in prop::array::uniform4(-100.0_f32..600.0),
        power in prop::array::uniform4(1.0_f32..60.0),
        others in prop::collection::vec(prop::array::uniform4(0.0_f32..=1.0), 200),
    ) {
        let found = levels(&response, &needed, &power);
        prop_assert!(found.iter().all(|level| (0.0..=1.0).contains(level)), "{found:?}");
        let full = [1.0; LUMINAIRES];
        if !is_enough(&response, &needed, &full) {
            prop_assert_eq!(found, full);
            return Ok(());
        }
        prop_assert!(is_enough(&response, &needed, &found), "{found:?}");
        let cost = lit(&power, &found);
        for other in others {
            // On the way from there to everything at its most, the first that is enough.
            let enough = (0..=20).map(|k| {
                let t = k as f32 / 20.0;
                other.map(|level| level + t * (1.0 - level))
            });
            for other in enough.filter(|other| is_enough(&response, &needed, other)) {
                let cheapest = cost <= lit(&power, &other) * (1.0 + 1e-3) + 1e-3;
                prop_assert!(cheapest, "{other:?} takes less than {found:?}");
            }
        }
    }
}

#[test]
fn nothing_is_lit_where_nothing_is_needed() {
    let response = [[100.0, 20.0, 30.0, 10.0]; DESKS];
    assert_eq!(levels(&response, &[0.0; DESKS], &POWER), [0.0; LUMINAIRES]);
    assert_eq!(
        levels(&response, &[-20.0; DESKS], &POWER),
        [0.0; LUMINAIRES]
    );
    assert_eq!(
        levels(&response, &[900.0; DESKS], &POWER),
        [1.0; LUMINAIRES]
    );
    // The luminaire that brings most for its power does all of it.
    let found = levels(&response, &[50.0; DESKS], &POWER);
    assert!((found[0] - 0.5).abs() < 1e-4, "{found:?}");
    assert_eq!(found[1..], [0.0; 3]);
}

type Room<'t> = Light<'t, Best, 2048, 8, Constant<f32>, Vectors>;

/// The same office on the host.
struct OnHost<'t> {
    light: Box<Room<'t>>,
    full: [f32; LUMINAIRES],
}

impl Office for OnHost<'_> {
    fn dim(&mut self, levels: &[f32; LUMINAIRES]) {
        for (lamp, (full, level)) in self.full.into_iter().zip(levels).enumerate() {
            self.light.set_radiance(lamp, full * level).expect("sound");
        }
        self.light.update(Stop::below(0.001));
    }

    fn desks(&self) -> [f32; DESKS] {
        std::array::from_fn(|desk| self.light.point(desk).expect("a desk"))
    }
}

/// Bakes the office as the example says.
fn baked(directory: &Path) -> Vec<u32> {
    let arguments = [
        "bake",
        "office",
        "--placement",
        "isolux",
        "--transfer",
        "vectors",
        "-o",
        "office",
    ];
    let ran = isolux(&arguments, directory, "");
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let bytes = fs::read(directory.join("office/office.isolux")).expect("tables");
    let word = |word: &[u8]| u32::from_le_bytes(word.try_into().expect("four bytes"));
    bytes.chunks_exact(4).map(word).collect()
}

/// What the node says, if the machine can run it.
fn said(directory: &Path) -> Option<Vec<String>> {
    let office = directory.join("office");
    let environment = [("OFFICE", office.as_os_str() as &OsStr)];
    let build = Build {
        package: "isolux-office-node",
        environment: &environment,
        ..Build::of("office-node")
    };
    let program = directory.join("office-node");
    let ran = Toolchain::find().and_then(|toolchain| {
        toolchain.require(Core::CortexM4F)?;
        toolchain.link(Core::CortexM4F, &build, &program)?;
        device::messages(Core::CortexM4F, &program, Duration::from_secs(120))
    });
    match ran {
        Ok(said) => Some(said),
        Err(error) => {
            let required = std::env::var_os("ISOLUX_REQUIRE_QEMU").is_some();
            assert!(error.is_missing() && !required, "{error}");
            eprintln!("SKIPPED: {error}");
            None
        }
    }
}

#[test]
fn the_node_keeps_every_desk_lit_at_least_power() {
    let directory = tempfile::tempdir().expect("a directory");
    let words = baked(directory.path());
    let scene = Scene::load(zerocopy::IntoBytes::as_bytes(&words[..])).expect("sound tables");
    let light = Box::new(Room::new(scene).expect("room"));
    let full = std::array::from_fn(|lamp| light.radiance(lamp));
    let mut office = OnHost { light, full };
    let response = node::learn(&mut office);
    let mut expected: Vec<String> = response
        .iter()
        .map(|row| format!("response {row:?}"))
        .collect();
    let mut night = 0.0;
    for (hour, daylight) in &DAY {
        let decided = node::decide(&mut office, &response, daylight);
        let (levels, desks, power) = (decided.levels, decided.desks, decided.power);
        println!("{hour:2} h: {levels:?}, {desks:?} lx, {power} W");
        assert!(
            desks.iter().all(|&desk| desk >= 0.9999 * WANTED),
            "{desks:?}"
        );
        if *hour == 7 {
            night = power;
        }
        assert!(power <= night, "daylight costs power: {power} {night}");
        expected.push(format!(
            "at {hour} levels {levels:?} desks {desks:?} W {power:?}"
        ));
    }
    expected.push("end of the day".to_owned());
    // Less than everything on, even at night.
    assert!(night < POWER.iter().sum::<f32>(), "{night}");
    let Some(said) = said(directory.path()) else {
        return;
    };
    let numbers = |lines: &[String]| -> Vec<Vec<String>> {
        let words = |line: &String| -> Vec<String> {
            let words = line
                .split([' ', ',', '[', ']'])
                .filter(|word| !word.is_empty());
            // The same digits for the same bits, however they are printed.
            words
                .map(|word| {
                    word.parse::<f32>()
                        .map_or(word.to_owned(), |x| format!("{x:?}"))
                })
                .collect()
        };
        lines.iter().map(words).collect()
    };
    assert_eq!(numbers(&said), numbers(&expected));
}
