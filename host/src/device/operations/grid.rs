//! What grids take: the loops of the kernel's [`resample`](isolux::resample), counted.

use super::{Done, add};
use isolux::integers;
use isolux::scene::Scene;
use isolux::scene::fields::{Fields, Mesh, Tensor};
use isolux::scene::records::Surface;

/// Grids of every surface with samples, of so many rows and columns.
pub(super) fn of(scene: &Scene<'_>, resolution: u32) -> Done {
    let mut done = Done::new();
    for surface in scene.surfaces().iter().filter(|s| s.samples > 0) {
        let rows = u64::from(resolution);
        add(&mut done, "grid-surface", 1);
        add(&mut done, "row", rows);
        add(&mut done, "pixel", rows * rows);
        if surface.fields > 0 {
            for (tensor, mesh) in scene.fields().of(surface) {
                field(scene.fields(), tensor, mesh, resolution, &mut done);
            }
            continue;
        }
        filtered(scene, surface, resolution, &mut done);
    }
    done
}

/// As the cone filter goes: light of both kinds together, or each by itself.
fn filtered(scene: &Scene<'_>, surface: &Surface, resolution: u32, done: &mut Done) {
    let step = surface.size.map(|length| length / resolution as f32);
    let apart = surface.direct > 0 || surface.indirect > 0;
    if apart {
        let rows = u64::from(resolution);
        add(done, "pixel-apart", rows * rows);
    }
    let kinds: &[bool] = if apart { &[true, false] } else { &[true] };
    for &is_luminaire in kinds {
        let samples = scene.samples().get(scene.receivers(surface, is_luminaire));
        let samples = samples.unwrap_or(&[]);
        let within = |at: [f32; 2], radius: f32| {
            let reach = radius * radius;
            let near = |&&[u, v]: &&[f32; 2]| {
                let (du, dv) = (at[0] - u, at[1] - v);
                du * du + dv * dv < reach
            };
            samples.iter().filter(near).count()
        };
        for row in 0..resolution {
            for column in 0..resolution {
                let at = [
                    (column as f32 + 0.5) * step[0],
                    (row as f32 + 0.5) * step[1],
                ];
                let mut radius = surface.filter_radius;
                cone(samples.len(), done, || {
                    let hits = within(at, radius);
                    radius += radius;
                    hits
                });
            }
        }
    }
}

/// A place looks at all samples, with twice the radius until one is in reach.
fn cone(samples: usize, done: &mut Done, mut hits: impl FnMut() -> usize) {
    add(done, "cone", 1);
    // 2⁴⁰ spans every ratio of lengths.
    for _ in 0..if samples > 0 { 40 } else { 0 } {
        let hits = hits();
        add(done, "cone-round", 1);
        add(done, "cone-sample", samples as u64);
        add(done, "cone-hit", hits as u64);
        if hits > 0 {
            return;
        }
    }
}

/// The same of tables in integers.
pub(super) fn in_integers(scene: &integers::Scene<'_>, resolution: u32) -> Done {
    let mut done = Done::new();
    let center = |cell: u32, length: i32| {
        let twice = 2 * i64::from(cell) + 1;
        (twice * i64::from(length) / 2) / i64::from(resolution)
    };
    for surface in scene.surfaces().iter().filter(|s| s.samples > 0) {
        let rows = u64::from(resolution);
        add(&mut done, "grid-surface", 1);
        add(&mut done, "row", rows);
        add(&mut done, "pixel", rows * rows);
        let apart = surface.direct > 0 || surface.indirect > 0;
        if apart {
            add(&mut done, "pixel-apart", rows * rows);
        }
        let kinds: &[bool] = if apart { &[true, false] } else { &[true] };
        for &is_luminaire in kinds {
            let samples = scene.samples().get(scene.receivers(surface, is_luminaire));
            let samples = samples.unwrap_or(&[]);
            for row in 0..resolution {
                for column in 0..resolution {
                    let at = [
                        center(column, surface.size[0]),
                        center(row, surface.size[1]),
                    ];
                    let mut radius = i128::from(surface.filter_radius);
                    cone(samples.len(), &mut done, || {
                        let near = |&&[u, v]: &&[i32; 2]| {
                            let squared = |a: i64, b: i32| i128::from(a - i64::from(b)).pow(2);
                            squared(at[0], u) + squared(at[1], v) < radius * radius
                        };
                        let hits = samples.iter().filter(near).count();
                        radius *= 2;
                        hits
                    });
                }
            }
        }
    }
    done
}

/// A term of a surface's irradiance: what is made of its samples once, and every row.
fn field(
    fields: Fields<'_>,
    tensor: Option<&Tensor>,
    mesh: Option<&Mesh>,
    resolution: u32,
    done: &mut Done,
) {
    let rows = u64::from(resolution);
    add(done, "row-field", rows);
    if let Some(tensor) = tensor {
        let [along_u, along_v] = tensor.nodes.map(u64::from);
        add(done, "tensor", 1);
        add(done, "tensor-value", along_u * along_v);
        if tensor.transformed != 0 {
            add(done, "tensor-root", along_u * along_v);
        }
        add(done, "tensor-line", along_u + along_v);
        let products = along_u * along_v * (along_u + along_v);
        add(done, "tensor-product", products);
        lines(tensor, rows, done);
        if mesh.is_none_or(|mesh| mesh.outside > 0.0) {
            values(tensor, rows * rows, done);
        }
    }
    let Some(mesh) = mesh else {
        return;
    };
    add(done, "mesh", 1);
    add(done, "node", u64::from(mesh.nodes));
    let shares = fields.nodes(mesh).iter();
    let shares = shares.map(|node| u64::from(node.shares)).sum();
    add(done, "share", shares);
    let painted = triangles(fields, mesh, resolution, done);
    match tensor {
        Some(tensor) => {
            let samples = u64::from(mesh.samples);
            add(done, "fraction", samples);
            lines(tensor, samples, done);
            values(tensor, samples + painted, done);
            add(done, "part-cell", painted);
        }
        None => add(done, "cell", painted),
    }
}

/// A tensor grid brought to lines of constant v.
fn lines(tensor: &Tensor, times: u64, done: &mut Done) {
    let [along_u, along_v] = tensor.nodes.map(u64::from);
    add(done, "line", times);
    add(done, "line-row", times * along_v);
    add(done, "line-node", times * along_u * along_v);
}

/// Values on such lines, by Clenshaw's recurrence.
fn values(tensor: &Tensor, times: u64, done: &mut Done) {
    add(done, "line-value", times);
    let steps = u64::from(tensor.nodes[0]).saturating_sub(1);
    add(done, "line-step", times * steps);
    if tensor.transformed != 0 {
        add(done, "line-quotient", times);
    }
}

/// The triangles of a mesh on every row, as the kernel finds them; gives how many cells
/// they paint.
fn triangles(fields: Fields<'_>, mesh: &Mesh, resolution: u32, done: &mut Done) -> u64 {
    let end = f32::from(u16::MAX);
    let step = end / resolution as f32;
    let nodes = fields.nodes(mesh);
    let corner = |node: u16| {
        let place = nodes.get(usize::from(node)).map_or([0; 2], |n| n.place);
        place.map(f32::from)
    };
    let crossing = |a: u16, b: u16, v: f32| {
        let (a, b) = if a < b { (a, b) } else { (b, a) };
        let (from, to) = (corner(a), corner(b));
        ((from[1] <= v) != (to[1] <= v)).then(|| {
            let part = (v - from[1]) / (to[1] - from[1]);
            from[0] + part * (to[0] - from[0])
        })
    };
    let column = |u: f32| {
        let x = u - 0.5;
        let below = x as u32;
        let column = below.saturating_add(u32::from((below as f32) < x));
        column.min(resolution)
    };
    let [
        mut thirds,
        mut crossings,
        mut crossed,
        mut spans,
        mut painted,
    ] = [0; 5];
    for row in 0..resolution {
        let v = (row as f32 + 0.5) / resolution as f32 * end;
        for &[a, b, c] in fields.triangles(mesh) {
            let mut found = [crossing(a, b, v), crossing(b, c, v), None];
            if found[0].is_none() || found[1].is_none() {
                thirds += 1;
                found[2] = crossing(c, a, v);
            }
            let found: Vec<f32> = found.into_iter().flatten().collect();
            crossings += found.len() as u64;
            let [one, other] = *found else {
                continue;
            };
            let (left, right) = if one < other {
                (one, other)
            } else {
                (other, one)
            };
            let (first, end) = (column(left / step), column(right / step));
            crossed += 1;
            if first < end && right - left > 0.0 {
                spans += 1;
                painted += u64::from(end - first);
            }
        }
    }
    let rows = u64::from(resolution);
    add(done, "row-triangle", rows * u64::from(mesh.triangles));
    for (operation, times) in [
        ("third-edge", thirds),
        ("crossing", crossings),
        ("crossed", crossed),
        ("span", spans),
    ] {
        add(done, operation, times);
    }
    painted
}
