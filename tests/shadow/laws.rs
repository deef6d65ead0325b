//! Laws of the visible fraction and of the lines.

use crate::lit::{self, Lit, Roomy};
use crate::{cornell, encloses, map, places, read};
use glam::DVec2;
use isolux_host::plan::shadow::{Kind, Line, Mesh, Options, Shadow, ShadowMap};
use isolux_host::scene::{Scene, shipped};

const MAPS: [(&str, &str, &str); 6] = [
    (shipped::PENUMBRA, "receiver", "light"),
    (shipped::CORNELL, "floor", "light"),
    (shipped::CORNELL, "back", "light"),
    (shipped::CORNELL, "right", "light"),
    (shipped::OFFICE, "floor", "lum00"),
    (shipped::OFFICE, "wall_y1", "lum11"),
];

fn each(mut look: impl FnMut(&Scene, ShadowMap, &str)) {
    for (text, receiver, luminaire) in MAPS {
        let scene = read(text);
        let map = map(&scene, receiver, luminaire);
        look(&scene, map, luminaire);
    }
}

/// V by the kernel in double precision, from the vertices rounded to single.
pub(crate) fn by_the_kernel(lit: &Lit, map: &ShadowMap, at: DVec2) -> Option<f64> {
    let frame = &map.floor.frame;
    let receiver = lit::receiver::<f64>(frame.to_world(at.x, at.y), frame.normal);
    let [(_, emitter)] = &lit.emitters[..] else {
        panic!("one emitter");
    };
    let whole = lit::unoccluded(&receiver, emitter);
    let mut workspace = Roomy::<f64>::new();
    let seen = lit.form_factor(&mut workspace, &receiver, emitter);
    (whole > 0.0).then(|| seen.low / whole)
}

fn alone(scene: &Scene, luminaire: &str) -> Lit {
    let mut scene = scene.clone();
    for surface in &mut scene.surfaces {
        if surface.name != luminaire {
            surface.radiance = [0.0; 3];
        }
    }
    Lit::new(&scene)
}

#[test]
fn the_kernel_sees_the_same() {
    each(|scene, map, luminaire| {
        let lit = alone(scene, luminaire);
        for place in places(&map, 1000, 11) {
            let known = map.fraction(place.x, place.y);
            let other = by_the_kernel(&lit, &map, place);
            let off = known.unwrap_or(0.0) - other.unwrap_or(0.0);
            assert!(off.abs() < 2e-5, "{place}: {known:?} {other:?}");
        }
    });
}

/// Free values by the kernel: vertices on outlines see all or nothing.
#[test]
fn free_values_are_what_the_kernel_sees() {
    each(|scene, map, luminaire| {
        let lit = alone(scene, luminaire);
        let options = Options {
            longest: map.floor.frame.size_u / 10.0,
            ..Options::default()
        };
        let mesh = Mesh::of(&map.floor, &[&map], &options);
        let mut met = 0;
        for (vertex, free) in mesh.vertices.iter().zip(&mesh.free) {
            let Some(free) = free else { continue };
            let at = DVec2::from(*vertex);
            // On the outline adjoining surfaces lie in the place's way, or do
            // not, by rounding.
            if clearance(&map, at) < 1e-3 {
                continue;
            }
            met += 1;
            let seen = by_the_kernel(&lit, &map, at).expect("light");
            assert!((seen - free).abs() < 1e-5, "{at}: {free} {seen}");
        }
        assert!(met > 20, "{met}");
    });
}

/// The distance to the outline of the surface and to contact lines.
pub(crate) fn clearance(map: &ShadowMap, at: DVec2) -> f64 {
    let corners = &map.floor.frame.vertices;
    let count = corners.len();
    let sides = (0..count).map(|i| [corners[i], corners[(i + 1) % count]].map(DVec2::from));
    let feet = map
        .floor
        .contacts
        .iter()
        .map(|line| line.ends.map(DVec2::from));
    sides
        .chain(feet)
        .map(|[a, b]| distance(at, a, b))
        .fold(f64::INFINITY, f64::min)
}

fn distance(at: DVec2, a: DVec2, b: DVec2) -> f64 {
    let t = ((at - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    at.distance(a.lerp(b, t))
}

/// V is continuous across every line; outer outlines of the only shadow have
/// V = 1 beyond, umbra outlines V = 0 within.
#[test]
fn the_fraction_is_continuous_across_lines() {
    let mut looked = 0;
    each(|_, map, _| {
        for line in map.lines.iter().filter(|line| line.kind > Kind::Horizon) {
            let [a, b] = line.ends.map(DVec2::from);
            let across = (b - a).normalize().perp() * 1e-6;
            for t in [0.2, 0.5, 0.8] {
                let at = a.lerp(b, t);
                if clearance(&map, at) < 1e-3 {
                    continue;
                }
                let [left, right] =
                    [at + across, at - across].map(|p| map.fraction(p.x, p.y).expect("light"));
                // The steepest penumbra of these scenes rises in a millimetre.
                assert!(
                    (left - right).abs() < 4e-3,
                    "{line:?} at {t}: {left} {right}"
                );
                looked += 1;
            }
        }
    });
    assert!(looked > 100, "{looked}");
}

/// Where V's curvature jumps.
#[derive(Default)]
pub(crate) struct Jumps {
    /// On lines of the map.
    pub(crate) on: usize,
    /// Elsewhere in the shadows of two occluders or more: the curved events of
    /// three edges, which are not in the map.
    pub(crate) curved: usize,
    /// Elsewhere: lines that are missing.
    pub(crate) missing: usize,
}

impl Jumps {
    pub(crate) fn add(&mut self, other: &Self) {
        self.on += other.on;
        self.curved += other.curved;
        self.missing += other.missing;
    }
}

/// Walks over a surface and counts where V's curvature jumps.
pub(crate) fn jumps(map: &ShadowMap, walks: usize, seed: u64) -> Jumps {
    const STEPS: usize = 600;
    let frame = &map.floor.frame;
    let step = frame.size_u.max(frame.size_v) / 1000.0;
    let mut found = Jumps::default();
    let ends = places(map, 2 * walks, seed);
    for pair in ends.chunks_exact(2) {
        let along = (pair[1] - pair[0]).normalize() * step;
        let at = |k: usize| pair[0] + along * k as f64;
        let value = |k: usize| {
            let place = at(k);
            let inside = frame.contains(place.x, place.y) && clearance(map, place) > 4.0 * step;
            inside.then(|| map.fraction(place.x, place.y)).flatten()
        };
        let values: Vec<Option<f64>> = (0..STEPS).map(value).collect();
        let third = |k: usize| -> Option<f64> {
            let [a, b, d, e] = [k - 2, k - 1, k + 1, k + 2].map(|i| values[i]);
            Some((e? - 2.0 * d? + 2.0 * b? - a?).abs())
        };
        let thirds: Vec<Option<f64>> = (2..STEPS - 2).map(third).collect();
        for (k, window) in thirds.windows(17).enumerate() {
            let Some(around) = window.iter().copied().collect::<Option<Vec<f64>>>() else {
                continue;
            };
            let calm = [0, 1, 2, 14, 15, 16]
                .map(|i| around[i])
                .into_iter()
                .fold(0.0, f64::max);
            let peak = around[8];
            let is_peak = around[4..13].iter().all(|&other| other <= peak);
            if is_peak && peak > 2e-6 && peak > 10.0 * calm {
                let place = at(k + 10);
                let near = |line: &Line| {
                    distance(place, line.ends[0].into(), line.ends[1].into()) < 3.0 * step
                };
                let over = |shadow: &&Shadow| encloses(&shadow.outer, place);
                let count = match map.shadows.iter().filter(over).count() {
                    _ if map.lines.iter().any(near) => &mut found.on,
                    0 | 1 => &mut found.missing,
                    _ => &mut found.curved,
                };
                *count += 1;
            }
        }
    }
    found
}

/// Walking over a surface, V curves anew on lines only; but for the curved
/// events of three edges, which are not in the map.
#[test]
fn between_lines_the_fraction_is_smooth() {
    let mut all = Jumps::default();
    each(|_, map, _| all.add(&jumps(&map, 60, 5)));
    let Jumps {
        on,
        curved,
        missing,
    } = all;
    println!("{on} jumps on lines, {curved} on curves, {missing} elsewhere");
    assert!(
        on > 300 && missing == 0,
        "{on} on lines, {missing} elsewhere"
    );
    assert!(curved * 50 <= on, "{on} on lines, {curved} on curves");
}

/// A mesh of all lines interpolates V better than a grid of as many samples that
/// knows no lines; free vertices are no samples.
#[test]
fn outlines_are_worth_their_vertices() {
    let map = map(&cornell(), "floor", "light");
    let options = Options {
        longest: 0.5,
        ..Options::default()
    };
    let mesh = Mesh::of(&map.floor, &[&map], &options);
    let value = |p: DVec2| map.fraction(p.x, p.y).expect("light");
    let nodes: Vec<f64> = mesh.vertices.iter().map(|&v| value(v.into())).collect();
    let paid = mesh.free.iter().filter(|free| free.is_none()).count();
    let side = (paid as f64).sqrt().ceil() as usize;
    let frame = &map.floor.frame;
    let cell = DVec2::new(frame.size_u, frame.size_v) / side as f64;
    let (mut ours, mut grids, mut count) = (0.0, 0.0, 0.0);
    for place in places(&map, 2000, 9) {
        if clearance(&map, place) < 0.5 {
            continue;
        }
        let exact = value(place);
        let (triangle, shares) = mesh.locate(place.x, place.y).expect("a triangle");
        let corners = mesh.triangles[triangle];
        let linear: f64 = (0..3).map(|k| shares[k] * nodes[corners[k]]).sum();
        let low = (place / cell).floor();
        let t = place / cell - low;
        let node = |i: f64, j: f64| value((low + DVec2::new(i, j)) * cell);
        let bilinear = (node(0.0, 0.0) * (1.0 - t.x) + node(1.0, 0.0) * t.x) * (1.0 - t.y)
            + (node(0.0, 1.0) * (1.0 - t.x) + node(1.0, 1.0) * t.x) * t.y;
        ours += (linear - exact).powi(2);
        grids += (bilinear - exact).powi(2);
        count += 1.0;
    }
    let [ours, grids] = [ours, grids].map(|sum: f64| (sum / count).sqrt());
    assert!(ours < 0.7 * grids, "{ours} {grids} with {paid} samples");
    println!("rms of V {ours:.5}, of a grid {grids:.5}, {paid} samples");
}
