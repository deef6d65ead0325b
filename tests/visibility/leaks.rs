//! No light comes through where occluders meet.

use crate::lit::{Lit, Roomy, receiver, scene, surface, unoccluded};
use crate::random::Random;
use glam::DVec3;
use isolux_host::scene::Surface;

/// A bent sheet of places, wide enough to hide the emitter, in rows.
fn sheet(random: &mut Random, steps: usize) -> Vec<Vec<DVec3>> {
    let (low, bend) = (random.between(1.0, 2.0), random.between(0.0, 0.2));
    let turn = random.between(0.0, 0.4);
    let step = 8.0 / steps as f64;
    (0..=steps)
        .map(|i| {
            (0..=steps)
                .map(|j| {
                    let inner = |k: usize| k > 0 && k < steps;
                    let jitter = if inner(i) && inner(j) { 0.35 } else { 0.0 };
                    let x = (i as f64 + random.between(-jitter, jitter)) * step - 4.0;
                    let y = (j as f64 + random.between(-jitter, jitter)) * step - 4.0;
                    DVec3::new(x, y, low + bend * (x + 0.3 * y).sin() + turn * 0.2 * x)
                })
                .collect()
        })
        .collect()
}

fn triangles(places: &[Vec<DVec3>]) -> Vec<Surface> {
    let mut surfaces = Vec::new();
    for pair in places.windows(2) {
        for j in 1..pair[0].len() {
            let [a, b, c, d] = [pair[0][j - 1], pair[1][j - 1], pair[1][j], pair[0][j]];
            surfaces.push(surface(vec![a, b, c], 0.0));
            surfaces.push(surface(vec![a, c, d], 0.0));
        }
    }
    surfaces
}

/// No more light than this part of the unoccluded form factor.
fn assert_dark(lit: &Lit, random: &mut Random, receivers: usize, allowed: f32) {
    let mut exact = Roomy::<f32>::new();
    for _ in 0..receivers {
        let (place, normal) = random.receiver();
        let at = receiver::<f32>(place, normal);
        for (_, emitter) in &lit.emitters {
            let f = lit.form_factor(&mut exact, &at, emitter);
            let most = allowed * unoccluded(&at, emitter);
            assert!(f.high <= most, "{f:?} at {place} {normal}");
        }
    }
}

#[test]
fn a_wall_of_triangles_is_tight() {
    let mut random = Random(101);
    for steps in [2, 4, 9] {
        for _ in 0..20 {
            let mut surfaces = triangles(&sheet(&mut random, steps));
            surfaces.push(random.emitter());
            assert_dark(&Lit::new(&scene(surfaces)), &mut random, 50, 0.0);
        }
    }
}

/// Rows of rectangles of different widths in a tilted plane; coordinates are
/// multiples of `grain`.
fn rows(random: &mut Random, grain: f64) -> Vec<Surface> {
    let whole = |x: f64| (x / grain).round() * grain;
    let height = whole(random.between(1.0, 2.0));
    let place = |[x, y]: [f64; 2]| DVec3::new(x, y, 0.125 * x - 0.0625 * y + height);
    let mut surfaces = Vec::new();
    let mut y = -4.0;
    while y < 4.0 {
        let next = whole(y + random.between(0.5, 1.5));
        let mut x = whole(-4.0 - random.between(0.0, 1.0));
        while x < 4.0 {
            let right = whole(x + random.between(0.5, 2.0));
            let corners = [[x, y], [right, y], [right, next], [x, next]];
            surfaces.push(surface(corners.map(place).to_vec(), 0.0));
            x = right;
        }
        y = next;
    }
    surfaces
}

#[test]
fn rows_with_t_junctions_are_tight() {
    let mut random = Random(102);
    // The device holds these places exactly.
    for _ in 0..30 {
        let mut surfaces = rows(&mut random, 1.0 / 64.0);
        surfaces.push(random.emitter());
        assert_dark(&Lit::new(&scene(surfaces)), &mut random, 40, 0.0);
    }
    // Between these, rounding the vertices leaves gaps of 0.5 um.
    for _ in 0..30 {
        let mut surfaces = rows(&mut random, 1e-9);
        surfaces.push(random.emitter());
        assert_dark(&Lit::new(&scene(surfaces)), &mut random, 40, 2e-6);
    }
}

#[test]
fn a_split_concave_sheet_is_tight() {
    // A star of 16 corners: its parts meet along common edges.
    let mut random = Random(103);
    for _ in 0..20 {
        let tall = random.between(1.0, 2.0);
        let star = (0..16).map(|i| {
            let angle = std::f64::consts::TAU * f64::from(i) / 16.0;
            let radius = if i % 2 == 0 {
                9.0
            } else {
                random.between(5.0, 6.0)
            };
            DVec3::new(angle.cos() * radius, angle.sin() * radius, tall)
        });
        let star: Vec<DVec3> = star.collect();
        let lit = Lit::new(&scene(vec![random.emitter(), surface(star, 0.0)]));
        assert!(lit.emitters[0].1.blockers().len() > 1, "it was not split");
        assert_dark(&lit, &mut random, 50, 0.0);
    }
}
