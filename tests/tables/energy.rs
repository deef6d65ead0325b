//! Energy: what is shot arrives or is absorbed, shooting converges, and its
//! order does not matter.

use crate::paper;
use glam::DVec3;
use isolux::form_factor::Best;
use isolux::geometry::Receiver;
use isolux::number::SoftRoot;
use isolux::scene::Scene;
use isolux::shoot::{Light, Stop};
use isolux_host::bake::{self, Tables};
use isolux_host::plan::{Band, Plan, Sample, SurfacePlan, Tag};
use isolux_host::scene;
use isolux_host::scene::frame::Frame;
use std::f64::consts::PI;
use std::fmt::Write;
use std::sync::OnceLock;

type Room<'t> = Light<'t, Best, 1024, 256>;
pub(crate) type Planned = (scene::Scene, Plan, Tables);

fn light(tables: &Tables) -> Box<Room<'_>> {
    let scene = Scene::load(tables.bytes()).expect("sound tables");
    Box::new(Light::new(scene).expect("room"))
}

/// The inward faces of a box, each with its radiance and reflectance.
pub(crate) fn room(size: [f64; 3], faces: [(f64, f64); 6]) -> String {
    let corner = |i: usize| [(i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64];
    let sides = [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ];
    let mut text = String::from("isolux = 1\nname = \"room\"\nquantity = \"radiometric\"\n");
    for ((k, side), (radiance, reflectance)) in (0..).zip(sides).zip(faces) {
        let vertices = side.map(|i| {
            let [x, y, z] = corner(i);
            [x * size[0], y * size[1], z * size[2]]
        });
        writeln!(
            text,
            "[[surface]]\nname = \"face-{k}\"\nvertices = {vertices:?}\nradiance = {radiance:?}\nreflectance = {reflectance:?}"
        )
        .expect("a string takes it");
    }
    text
}

/// A face in `side` x `side` patches: emitters whose radiosity follows the
/// irradiance in their middles.
fn patches(surface: &scene::Surface, side: usize) -> SurfacePlan {
    let frame = Frame::new(surface);
    let sample = |(u, v): (f64, f64), tag| Sample {
        place: [u, v],
        vertex: [u, v],
        tag,
    };
    let at = |k: usize, of: f64| k as f64 / side as f64 * of;
    let places = |count: usize| (0..count * count).map(move |k| (k % count, k / count));
    let mut samples: Vec<Sample> = places(side + 1)
        .map(|(i, j)| sample((at(i, frame.size_u), at(j, frame.size_v)), Tag::Isolux))
        .collect();
    let mut bands = Vec::new();
    for (i, j) in places(side) {
        let corner = |i: usize, j: usize| j * (side + 1) + i;
        bands.push(Band {
            loops: vec![vec![
                corner(i, j),
                corner(i + 1, j),
                corner(i + 1, j + 1),
                corner(i, j + 1),
            ]],
            members: vec![samples.len()],
            weights: Vec::new(),
            area: surface.area / (side * side) as f64,
        });
        let middle = frame.cell_center(i, j, side, side);
        samples.push(sample(middle, Tag::Peak));
    }
    if surface.reflectance[0] == 0.0 {
        samples.clear();
        bands.clear();
    }
    SurfacePlan {
        samples,
        bands,
        patches: Vec::new(),
        points: Vec::new(),
        fields: Vec::new(),
        predicted: Vec::new(),
        predicted_by_tag: Vec::new(),
        filter_radius: if surface.reflectance[0] == 0.0 {
            0.0
        } else {
            1.0
        },
        frame,
    }
}

pub(crate) fn patched(source: &str, side: usize) -> Planned {
    let scene = scene::file::parse("room.toml", source).expect("a room");
    let surfaces = scene.surfaces.iter().map(|surface| patches(surface, side));
    let plan = Plan::from(surfaces.collect::<Vec<_>>());
    let tables = bake::bake(&scene, &plan, None).expect("tables");
    (scene, plan, tables)
}

/// A room with a bright ceiling and unlike reflectances, a wall in 4 x 4 patches.
fn bright_ceiling() -> &'static Planned {
    static ROOM: OnceLock<Planned> = OnceLock::new();
    ROOM.get_or_init(|| {
        let wall = |rho| (0.0, rho);
        let faces = [
            wall(0.2),
            (10.0, 0.0),
            wall(0.5),
            wall(0.5),
            wall(0.3),
            wall(0.7),
        ];
        patched(&room([4.0, 5.0, 3.0], faces), 4)
    })
}

/// Irradiance integrated over a face by the midpoint rule.
fn received(light: &Room<'_>, surface: &scene::Surface, cells: usize) -> f64 {
    let corner = surface.vertices[0];
    let (u, v) = (surface.vertices[1] - corner, surface.vertices[3] - corner);
    let at = |k: usize| (k as f64 + 0.5) / cells as f64;
    let single = |x: DVec3| x.as_vec3().to_array();
    let sum: f64 = (0..cells * cells)
        .map(|k| {
            let place = corner + u * at(k % cells) + v * at(k / cells);
            let receiver = Receiver::new::<SoftRoot>(single(place), single(surface.normal));
            f64::from(light.at(&receiver.expect("a receiver")))
        })
        .sum();
    sum / (cells * cells) as f64 * surface.area
}

fn emitted(scene: &scene::Scene) -> f64 {
    let power = |surface: &scene::Surface| PI * surface.radiance[0] * surface.area;
    scene.surfaces.iter().map(power).sum()
}

#[test]
fn direct_light_arrives_as_it_was_shot() {
    let (scene, _, tables) = bright_ceiling();
    let mut light = light(tables);
    light.direct();
    let arrived: f64 = scene.surfaces.iter().map(|s| received(&light, s, 24)).sum();
    let off = arrived / emitted(scene) - 1.0;
    // The midpoint rule itself, beside the edge that a wall shares with the
    // ceiling: 24 cells err by about 1/(8 · 24²) of a cell row's light.
    assert!(off.abs() < 1e-3, "{off:e}");
}

#[test]
fn what_is_shot_is_absorbed() {
    let (scene, _, tables) = bright_ceiling();
    let mut light = light(tables);
    let solved = light.solve(Stop::below(1e-4));
    assert!(solved.unshot <= 1e-4, "{solved:?}");
    let absorbed: f64 = scene
        .surfaces
        .iter()
        .map(|s| (1.0 - s.reflectance[0]) * received(&light, s, 12))
        .sum();
    let off = absorbed / emitted(scene) - 1.0;
    println!("absorbed {:.2} % more than emitted", 100.0 * off);
    // What a patch receives in its middle stands for its mean.
    assert!(off.abs() < 0.02, "{off}");
}

/// Every wall emits L and reflects ρ: then E = π L / (1 − ρ) everywhere, in a
/// room of any shape, and one emitter a face is exact.
#[test]
fn a_furnace_is_equally_bright_everywhere() {
    for (radiance, rho, size) in [
        (2.0, 0.5, [3.0; 3]),
        (0.25, 0.8, [2.0, 6.0, 3.0]),
        (1e4, 0.1, [8.0, 1.0, 4.0]),
    ] {
        let source = room(size, [(radiance, rho); 6]);
        let (scene, _, tables) = patched(&source, 1);
        let mut light = light(&tables);
        let worst = |light: &Room<'_>, exact: f64| {
            let places = scene.surfaces.iter().flat_map(|surface| {
                let corner = surface.vertices[0] - surface.center();
                [0.0, 0.3, 0.6, 0.9].map(|t| (surface, surface.center() + corner * t))
            });
            let off = places.map(|(surface, place)| {
                let receiver = Receiver::new::<SoftRoot>(
                    place.as_vec3().to_array(),
                    surface.normal.as_vec3().to_array(),
                );
                f64::from(light.at(&receiver.expect("a receiver"))) / exact - 1.0
            });
            off.fold(0.0, |most: f64, x| most.max(x.abs()))
        };
        // Five form factors that sum to 1, each with its error; all light is
        // 1/(1 − ρ) of that.
        let own = 5.0 * 2.5e-7;
        let direct = PI * radiance;
        light.direct();
        let off = worst(&light, direct);
        assert!(off <= own, "direct light in {size:?}: {off:e}");
        let rest = 1e-6;
        let solved = light.solve(Stop::below(rest));
        // A sum of n shots rounds n times; what is unshot has not arrived.
        let allowed = (own + f64::from(rest)) / (1.0 - rho) + f64::from(solved.shots) * 6e-8;
        let off = worst(&light, direct / (1.0 - rho));
        println!("furnace {size:?}, rho {rho}: {off:.1e} of {allowed:.1e}");
        assert!(
            off <= allowed,
            "all light in {size:?}: {off:e}, {allowed:e} allowed"
        );
    }
}

#[test]
fn light_only_grows_and_what_is_left_only_shrinks() {
    for (_, _, tables) in [paper(), bright_ceiling()] {
        let mut light = light(tables);
        light.direct();
        let mut before = light.irradiance().to_vec();
        let mut unshot = light.unshot_fraction();
        for _ in 0..40 {
            light.reflect();
            for (now, before) in light.irradiance().iter().zip(&before) {
                assert!(now >= before, "{now} < {before}");
            }
            assert!(
                light.unshot_fraction() <= unshot,
                "{} > {unshot}",
                light.unshot_fraction()
            );
            before = light.irradiance().to_vec();
            unshot = light.unshot_fraction();
        }
        assert!(unshot < 1e-6, "{unshot}");
        // Nothing is left to be shot: the answer stands.
        light.direct();
        let mut shots = 0;
        while light.shoot().is_some() && shots < 100_000 {
            shots += 1;
        }
        assert!(shots < 100_000, "shooting ends by itself");
    }
}

#[test]
fn stopping_below_a_fraction_leaves_no_more() {
    for (_, _, tables) in [paper(), bright_ceiling()] {
        let mut light = light(tables);
        let mut last = 0;
        for fraction in [0.3, 0.1, 0.01, 1e-3, 1e-4] {
            let solved = light.solve(Stop::below(fraction));
            assert!(solved.unshot <= fraction, "{solved:?}");
            assert_eq!(solved.unshot.to_bits(), light.unshot_fraction().to_bits());
            assert!(solved.shots >= last, "a smaller rest takes no fewer shots");
            last = solved.shots;
        }
        let few = light.solve(Stop::Below {
            fraction: 1e-6,
            shots: 3,
        });
        assert_eq!(few.shots, 3, "the limit of shots holds");
    }
}

#[test]
fn the_order_of_shots_does_not_matter() {
    for (_, _, tables) in [paper(), bright_ceiling()] {
        let (mut progressive, mut neumann) = (light(tables), light(tables));
        let rest = 1e-6;
        let solved = progressive.solve(Stop::below(rest));
        let other = neumann.solve(Stop::Reflections(40));
        assert!(solved.unshot <= rest && other.unshot <= rest);
        // What is left of the emitted power could at most fall on the smallest
        // emitter; each shot rounds a sum once.
        let scene = progressive.scene();
        let power: f32 = (scene.emitters().iter().enumerate())
            .map(|(k, e)| scene.exitance::<f32>(k) * e.area)
            .sum();
        let areas = scene.emitters().iter().map(|e| e.area);
        let smallest = areas.fold(f32::INFINITY, f32::min);
        let shots = (solved.shots + other.shots) as f32;
        for (a, b) in progressive.irradiance().iter().zip(neumann.irradiance()) {
            let allowed = 4.0 * rest * power / smallest + shots * f32::EPSILON * a;
            assert!((a - b).abs() <= allowed, "{a} {b}, {allowed:e} allowed");
        }
    }
}

#[test]
fn answers_do_not_depend_on_what_else_was_asked() {
    let (_, _, tables) = paper();
    let mut light = light(tables);
    light.solve(Stop::below(1e-3));
    let places: Vec<Receiver<f32>> = (0..200_u8)
        .map(|k| {
            let x = f32::from(k);
            let p = [
                x * 0.05 - 2.0,
                (x * 0.7).rem_euclid(5.0) - 2.5,
                (x * 0.3).rem_euclid(2.0),
            ];
            Receiver::new::<SoftRoot>(p, [x - 100.0, 30.0, 50.0 - x]).expect("a receiver")
        })
        .collect();
    let bits = |receiver: &Receiver<f32>| light.at(receiver).to_bits();
    let forward: Vec<u32> = places.iter().map(bits).collect();
    let mut backward: Vec<u32> = places.iter().rev().map(bits).collect();
    backward.reverse();
    assert_eq!(forward, backward);
    assert!(forward.iter().any(|&bits| bits != 0));
    // The host asks on several threads at once.
    let solution = isolux_host::solve::solve(
        tables,
        isolux_host::solve::Rung::Best,
        isolux_host::solve::Sight::None,
        Stop::below(1e-3),
    )
    .expect("a solution");
    let asked: Vec<_> = places
        .iter()
        .map(|r| (r.position().into(), r.normal().into()))
        .collect();
    let host = solution.at(&asked).expect("receivers");
    for (host, kernel) in host.iter().zip(&asked) {
        let receiver = Receiver::new::<SoftRoot>(kernel.0, kernel.1).expect("a receiver");
        assert_eq!(host.value[0].to_bits(), light.at(&receiver).to_bits());
    }
}

#[test]
fn solving_again_gives_the_same_bits() {
    for (_, _, tables) in [paper(), bright_ceiling()] {
        let mut light = light(tables);
        let bits = |light: &Room<'_>| -> Vec<u32> {
            light.irradiance().iter().map(|e| e.to_bits()).collect()
        };
        let first = light.solve(Stop::below(1e-3));
        let before = bits(&light);
        light.solve(Stop::Reflections(7));
        light.darken();
        assert!(light.irradiance().iter().all(|&e| e == 0.0));
        assert_eq!(light.solve(Stop::below(1e-3)), first);
        assert_eq!(bits(&light), before);
    }
}
