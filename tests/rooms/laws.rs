//! Laws of rooms.

use crate::fixtures::{file_scene, scene, surface};
use crate::{Place, baked, followed, single};
use glam::DVec3;
use isolux::Error;
use isolux::error::What;
use isolux::form_factor::Best;
use isolux::luminance::{Constant, Linear, Rgb};
use isolux::scene::Scene as Loaded;
use isolux::scene::records::Header;
use isolux::shoot::{Light, Stop};
use isolux::visibility::{Exact, Unoccluded, VertexRays};
use isolux_host::bake;
use isolux_host::occlusion::Occlusion;
use isolux_host::scene::frame::Frame;
use isolux_host::scene::{Scene, file, shipped};
use isolux_host::solve::{self, Rung, Sight};
use zerocopy::FromBytes;

/// A closed box whose ceiling emits, of these reflectances.
fn room(reflectance: f64) -> Scene {
    let [a, b, c, d] = [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [0.0, 2.0]];
    let at = |[x, y]: [f64; 2], z: f64| DVec3::new(x, y, z);
    let wall = |p, q| vec![at(p, 0.0), at(p, 2.5), at(q, 2.5), at(q, 0.0)];
    let floor = [a, b, c, d].map(|p| at(p, 0.0)).to_vec();
    let ceiling = [d, c, b, a].map(|p| at(p, 2.5)).to_vec();
    scene(vec![
        surface("floor", floor, reflectance, 0.0),
        surface("ceiling", ceiling, reflectance, 1.0),
        surface("south", wall(a, b), reflectance, 0.0),
        surface("east", wall(b, c), reflectance, 0.0),
        surface("north", wall(c, d), reflectance, 0.0),
        surface("west", wall(d, a), reflectance, 0.0),
    ])
}

/// What is absorbed in a closed room is what was emitted.
#[test]
fn a_closed_room_keeps_its_energy() {
    const SIDE: usize = 24;
    for reflectance in [0.2, 0.8] {
        let scene = room(reflectance);
        let tables = baked(&scene);
        let stop = Stop::below(1e-4);
        let solution = solve::solve(&tables, Rung::Best, Sight::Exact, stop).expect("a solution");
        let mut absorbed = 0.0;
        for surface in &scene.surfaces {
            let frame = Frame::new(surface);
            let places: Vec<Place> = (0..SIDE * SIDE)
                .map(|k| frame.cell_center(k % SIDE, k / SIDE, SIDE, SIDE))
                .map(|(u, v)| (frame.to_world(u, v), frame.normal))
                .collect();
            let values = solution.at(&single(&places)).expect("receivers");
            let sum: f64 = values.iter().map(|at| f64::from(at.value[0])).sum();
            absorbed += (1.0 - reflectance) * surface.area * sum / (SIDE * SIDE) as f64;
        }
        let emitted = std::f64::consts::PI * scene.surfaces[1].area;
        let off = absorbed / emitted - 1.0;
        assert!(off.abs() < 5e-3, "reflectance {reflectance}: {off:+e}");
    }
}

/// Shooting ahead of the light takes half the shots (358 and 400 without), leaves as
/// little, and takes back what was too much: the light is the same in the end.
#[test]
fn shooting_ahead_takes_half_the_shots_and_ends_at_the_same_light() {
    for (name, source, most) in [
        ("cornell", shipped::CORNELL, 200),
        ("office", shipped::OFFICE, 215),
    ] {
        let scene = file::parse(name, source).expect("a shipped scene");
        let occlusion = Occlusion::of(&scene).expect("few vertices");
        let tables = bake::bake(&scene, &followed(&scene), Some(occlusion)).expect("tables");
        let until = |fraction| {
            let stop = Stop::Below {
                fraction,
                shots: 10_000,
            };
            solve::solve(&tables, Rung::Best, Sight::Exact, stop).expect("a solution")
        };
        let (quick, all) = (until(1e-3), until(1e-6));
        assert!(quick.solved.shots <= most, "{name}: {:?}", quick.solved);
        assert!(all.solved.unshot <= 1e-6, "{name}: {:?}", all.solved);
        let (mut squares, mut off) = (0.0, 0.0);
        for ([quick, ..], [all, ..]) in quick.irradiance().into_iter().zip(all.irradiance()) {
            squares += f64::from(all).powi(2);
            off += f64::from(quick - all).powi(2);
        }
        let off = (off / squares).sqrt();
        assert!(off <= 1e-3, "{name}: {off:e}");
    }
}

/// Where most light leaves the scene nothing is sent ahead: it would all have to be taken
/// back.
#[test]
fn nothing_is_shot_ahead_in_the_open() {
    for (name, source, is_room) in [
        ("paper", shipped::PAPER, false),
        ("penumbra", shipped::PENUMBRA, false),
        ("cornell", shipped::CORNELL, true),
        ("office", shipped::OFFICE, true),
    ] {
        let scene = file::parse(name, source).expect("a shipped scene");
        let tables = baked(&scene);
        let header: &Header = Header::ref_from_prefix(tables.bytes()).expect("tables").0;
        assert_eq!(header.ahead > 0.0, is_room, "{name}");
    }
}

/// An answer does not depend on which other points were asked, nor on their
/// order.
#[test]
fn every_point_is_answered_by_itself() {
    let text = include_str!("../data/references/e_office.json");
    let tables = baked(&file_scene(&serde_json::from_str(text).expect("JSON")));
    let stop = Stop::Reflections(1);
    let solution = solve::solve(&tables, Rung::Best, Sight::Exact, stop).expect("a solution");
    let place = |k: i32| {
        let [x, y, z] = [7, 11, 13].map(|prime| f64::from(k * prime % 17) / 17.0);
        (
            DVec3::new(4.0 * x, 6.0 * y, 2.5 * z),
            DVec3::new(x - 0.5, 0.3, z - 0.2),
        )
    };
    let mut places: Vec<Place> = (1..40).map(place).collect();
    let together = solution.at(&single(&places)).expect("receivers");
    places.reverse();
    let mut reversed = solution.at(&single(&places)).expect("receivers");
    reversed.reverse();
    assert_eq!(together, reversed);
    places.reverse();
    for (place, together) in places.iter().zip(&together) {
        let alone = solution.at(&single(&[*place])).expect("a receiver");
        assert_eq!(alone, [*together]);
    }
}

/// Solved again, and with another number of threads, every bit is the same.
#[test]
fn threads_change_no_bit() {
    let tables = baked(&room(0.6));
    let solve = || {
        let stop = Stop::below(1e-3);
        let solution = solve::solve(&tables, Rung::Best, Sight::Exact, stop).expect("a solution");
        solution.irradiance()
    };
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(solve)
    };
    assert_eq!(on(1), on(3));
}

/// A type that lacks what the tables need is refused, with what.
#[test]
fn types_that_lack_what_a_scene_needs_are_refused() {
    type Of<'t, L, V> = Light<'t, Best, 16_384, 1024, L, V>;
    let text = include_str!("../data/references/c_cornell_grey.json");
    let tables = baked(&file_scene(&serde_json::from_str(text).expect("JSON")));
    let scene = Loaded::load(tables.bytes()).expect("sound tables");
    let refused = |what, needed, have| Some(Error::Capacity { what, needed, have });
    let sight = *scene.sight();
    assert!(sight.blockers > 0 && sight.lines > 0, "{sight:?}");
    let occluders = scene.counts().occluders;
    assert_eq!(
        Of::<Linear<f32>, Unoccluded>::new(scene).err(),
        refused(What::Occluders, occluders, 0)
    );
    assert_eq!(
        Of::<Constant<f32>, VertexRays>::new(scene).err(),
        refused(What::Coefficients, 3, 1)
    );
    assert_eq!(
        Of::<Linear<Rgb>, VertexRays>::new(scene).err(),
        refused(What::Channels, 1, 3)
    );
    assert_eq!(
        Of::<Linear<f32>, Exact<32, 64, 1, 64>>::new(scene).err(),
        refused(What::Lines, sight.lines, 1)
    );
    assert!(Of::<Linear<f32>, Exact<32, 64, 256, 64>>::new(scene).is_ok());
}
