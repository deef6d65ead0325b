//! Synthetic but realistic inputs of pictures: fields of small lights with known
//! formulas, a concave floor, the paper's simple scene through a camera, a plan.

use glam::DVec3;
use isolux_host::picture::{CameraView, EmitterShape, Pixel, SampleMark, SamplePlan, SurfaceField};
use isolux_host::scene::Quantity;

/// Irradiance under a small light of unit strength at height h over (x, y):
/// E = h² / (h² + r²)².
pub(crate) fn under_light(at: [f64; 2], light: [f64; 2], height: f64) -> f64 {
    let squared = (at[0] - light[0]).powi(2) + (at[1] - light[1]).powi(2);
    height * height / (height * height + squared).powi(2)
}

/// A field over a polygon from a formula of the place.
pub(crate) fn field(
    name: &str,
    outline: &[[f64; 2]],
    resolution: usize,
    quantity: Quantity,
    value: impl Fn([f64; 2]) -> f64,
) -> SurfaceField {
    let bound = |axis: usize, pick: fn(f64, f64) -> f64| {
        outline
            .iter()
            .map(|corner| corner[axis])
            .reduce(pick)
            .unwrap()
    };
    let low = [bound(0, f64::min), bound(1, f64::min)];
    let size = [bound(0, f64::max) - low[0], bound(1, f64::max) - low[1]];
    let places: Vec<[f64; 2]> = (0..resolution * resolution)
        .map(|cell| {
            let share = |k: usize| (k as f64 + 0.5) / resolution as f64;
            [
                low[0] + share(cell % resolution) * size[0],
                low[1] + share(cell / resolution) * size[1],
            ]
        })
        .collect();
    SurfaceField {
        name: name.to_owned(),
        quantity,
        low,
        size,
        columns: resolution,
        rows: resolution,
        values: places.iter().map(|at| value(*at)).collect(),
        inside: places.iter().map(|at| holds(outline, *at)).collect(),
        outline: outline.to_vec(),
    }
}

pub(crate) fn holds(outline: &[[f64; 2]], at: [f64; 2]) -> bool {
    let mut inside = false;
    for (index, a) in outline.iter().enumerate() {
        let b = outline[(index + 1) % outline.len()];
        if (a[1] > at[1]) != (b[1] > at[1])
            && at[0] < a[0] + (at[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        {
            inside = !inside;
        }
    }
    inside
}

pub(crate) const SQUARE: [[f64; 2]; 4] = [[-2.5, -2.5], [2.5, -2.5], [2.5, 2.5], [-2.5, 2.5]];
pub(crate) const PEAK: [f64; 2] = [1.2, 0.0];

/// A room's floor around a core: concave, with a notch.
pub(crate) const FLOOR: [[f64; 2]; 8] = [
    [0.0, 0.0],
    [9.0, 0.0],
    [9.0, 6.0],
    [6.5, 6.0],
    [5.5, 3.0],
    [4.0, 3.0],
    [4.0, 6.0],
    [0.0, 6.0],
];

pub(crate) fn receiver() -> SurfaceField {
    field("A", &SQUARE, 200, Quantity::Radiometric, |at| {
        30.0 * under_light(at, PEAK, 1.4)
    })
}

pub(crate) fn floor() -> SurfaceField {
    field("floor", &FLOOR, 200, Quantity::Photometric, |at| {
        40.0 + 2200.0 * under_light(at, [2.0, 4.5], 2.0) + 2600.0 * under_light(at, [7.5, 1.5], 2.0)
    })
}

/// What few samples make of the field: ripples that follow it, and one bad spot.
pub(crate) fn approximation(reference: &SurfaceField) -> SurfaceField {
    let mut field = reference.clone();
    for (cell, value) in field.values.iter_mut().enumerate() {
        let x = (cell % field.columns) as f64 / field.columns as f64;
        let y = (cell / field.columns) as f64 / field.rows as f64;
        let ripple = 0.03 * (14.0 * x).sin() * (11.0 * y).cos();
        let spot = 0.6 * (-((x - 0.2).powi(2) + (y - 0.8).powi(2)) / 0.004).exp();
        *value *= 1.0 + ripple + spot;
    }
    field
}

/// The paper's simple scene through a camera: A below, B and the light above.
pub(crate) fn view(width: usize, height: usize, shade: impl Fn(usize, DVec3) -> f64) -> CameraView {
    let eye = DVec3::new(2.4, -5.2, 1.0);
    let forward = (DVec3::new(2.9, 0.0, 1.1) - eye).normalize();
    let right = forward.cross(DVec3::Z).normalize();
    let up = right.cross(forward);
    let tangent = (62.0_f64.to_radians() / 2.0).tan();
    // Height of the plane and the rectangle in it, in metres.
    let surfaces = [
        (0.0, [-2.5, 2.5], [-2.5, 2.5]),
        (2.2, [3.7, 8.7], [-2.5, 2.5]),
        (2.2, [-0.3, 2.7], [-1.5, 1.5]),
    ];
    let pixel = |index: usize| {
        let across = ((index % width) as f64 + 0.5) / width as f64 * 2.0 - 1.0;
        let down = ((index / width) as f64 + 0.5) / height as f64 * 2.0 - 1.0;
        let aspect = width as f64 / height as f64;
        let ray = forward + right * (across * tangent * aspect) - up * (down * tangent);
        surfaces
            .iter()
            .enumerate()
            .find_map(|(surface, (z, x, y))| {
                let way = (z - eye.z) / ray.z;
                let hit = eye + ray * way;
                let seen =
                    way > 0.0 && (x[0]..=x[1]).contains(&hit.x) && (y[0]..=y[1]).contains(&hit.y);
                seen.then(|| {
                    let luminaire = surface == 2;
                    let irradiance = if luminaire { 0.0 } else { shade(surface, hit) };
                    let radiance = if luminaire {
                        12.0
                    } else {
                        0.5 * irradiance / std::f64::consts::PI
                    };
                    Pixel {
                        surface,
                        luminaire,
                        irradiance,
                        radiance: [radiance; 3],
                    }
                })
            })
    };
    CameraView {
        width,
        height,
        pixels: (0..width * height).map(pixel).collect(),
    }
}

pub(crate) fn exact(surface: usize, hit: DVec3) -> f64 {
    match surface {
        0 => 30.0 * under_light([hit.x, hit.y], PEAK, 1.4),
        _ => 0.9 * under_light([hit.x, hit.y], PEAK, 2.2),
    }
}

pub(crate) fn structured(surface: usize, hit: DVec3) -> f64 {
    exact(surface, hit) * (1.0 + 0.05 * (3.0 * hit.x).sin() * (2.0 * hit.y).cos())
}

/// Constant patches of half a metre.
pub(crate) fn patches(surface: usize, hit: DVec3) -> f64 {
    let middle = |x: f64| (x * 2.0).floor() / 2.0 + 0.25;
    exact(surface, DVec3::new(middle(hit.x), middle(hit.y), hit.z))
}

/// The isolux radius at which E falls to `share` of its peak.
pub(crate) fn isolux_radius(share: f64, height: f64) -> f64 {
    height * (share.powf(-0.5) - 1.0).sqrt()
}

pub(crate) fn plan() -> SamplePlan {
    let reference = receiver();
    let polygon = |radius: f64| -> Vec<[f64; 2]> {
        (0..10)
            .map(|k| {
                let angle = f64::from(k) / 10.0 * std::f64::consts::TAU;
                [
                    (PEAK[0] + radius * angle.cos()).clamp(-2.5, 2.5),
                    (PEAK[1] + radius * angle.sin()).clamp(-2.5, 2.5),
                ]
            })
            .collect()
    };
    let radii = [0.72, 0.36, 0.12].map(|share| isolux_radius(share, 1.4));
    let mut loops: Vec<Vec<[f64; 2]>> = radii.map(polygon).to_vec();
    loops.push(SQUARE.to_vec());
    let mut emitters = Vec::new();
    for band in 0..4 {
        let mut shape = vec![loops[band].clone()];
        if band > 0 {
            let mut hole = loops[band - 1].clone();
            hole.reverse();
            shape.push(hole);
        }
        emitters.push(EmitterShape {
            loops: shape,
            radiosity: [6.6, 4.1, 1.8, 0.37][band],
        });
    }
    let mark = |position: [f64; 2], tag: &str| SampleMark {
        position,
        tag: tag.to_owned(),
    };
    let mut marks: Vec<_> = loops[..3]
        .iter()
        .flatten()
        .map(|at| mark(*at, "light transfer"))
        .collect();
    marks.extend((0..16).map(|k| {
        let at = [f64::from(k % 4) * 1.5 - 2.25, f64::from(k / 4) * 1.5 - 2.25];
        mark(at, "display")
    }));
    marks.push(mark(PEAK, "both"));
    marks.push(mark([2.5, 2.5], "both"));
    SamplePlan {
        name: "A".to_owned(),
        quantity: Quantity::Radiometric,
        low: [-2.5, -2.5],
        size: [5.0, 5.0],
        outline: SQUARE.to_vec(),
        samples: marks,
        emitters,
        field: Some(reference),
    }
}
