//! Direct light of tests/data/references, made by other systems.

use crate::lit::{Lit, Roomy, Small};
use crate::published::{FILES, Point, read};
use glam::{DMat3, DVec3};

/// Relative errors, sorted, where the light is more than 1e-3 of the largest;
/// and the largest light where there should be none, as a part of it.
fn errors(lit: &Lit, points: &[Point]) -> (Vec<f64>, f64) {
    let mut workspace = Roomy::<f32>::new();
    let largest = points.iter().fold(0.0, |l: f64, p| l.max(p.direct));
    let (mut relative, mut dark) = (Vec::new(), 0.0_f64);
    for point in points {
        let e = lit.irradiance(&mut workspace, point.place, point.normal);
        if point.direct > 1e-3 * largest {
            relative.push((e / point.direct - 1.0).abs());
        } else if point.direct == 0.0 {
            dark = dark.max(e / largest);
        } else {
            assert!((e - point.direct).abs() < 1e-6 * largest);
        }
    }
    relative.sort_by(f64::total_cmp);
    (relative, dark)
}

fn judge(name: &str, lit: &Lit, points: &[Point]) {
    let (relative, dark) = errors(lit, points);
    let worst = relative[relative.len() - 1];
    let p95 = relative[(relative.len() * 95).div_ceil(100) - 1];
    println!(
        "{name:20} {} points: p95 {p95:.1e}, max {worst:.1e}, dark {dark:.1e}",
        relative.len()
    );
    assert!(p95 <= 1e-5 && worst <= 1e-3 && dark <= 1e-6, "{name}");
}

#[test]
fn direct_light_is_that_of_other_systems() {
    for (name, text) in FILES {
        let (scene, points) = read(text, |v| v);
        judge(name, &Lit::new(&scene), &points);
    }
}

#[test]
fn direct_light_is_the_same_in_rotated_and_shifted_scenes() {
    for seed in 1..=8_u32 {
        let angle = f64::from(seed);
        let turn = DMat3::from_axis_angle(DVec3::new(0.3, angle.sin(), 0.7).normalize(), angle);
        let shift = DVec3::new(-3.0, 1.7, angle.cos());
        for (name, text) in FILES {
            let (scene, points) = read(text, |v| turn * v + shift);
            judge(&format!("{name} {seed}"), &Lit::new(&scene), &points);
        }
    }
}

#[test]
fn the_planned_capacities_hold_every_reference_scene() {
    let mut workspace = Small::<f32>::new();
    for (_, text) in FILES {
        let (scene, points) = read(text, |v| v);
        let lit = Lit::new(&scene);
        for point in &points {
            lit.irradiance(&mut workspace, point.place, point.normal); // asserts that it is exact
        }
    }
}
