//! A plan of linear patches becomes integer tables with a matrix: those of floating point
//! in other units.

use super::{Content, Refused, Units, scaled};
use crate::bake::{TOLERANCE, Tables, TooLarge, content, largest_coordinate, matrix};
use crate::occlusion::Occlusion;
use crate::plan::Plan;
use crate::scene::Scene;
use crate::scene::requires::requirements;
use crate::solve::{Rung, Sight, solve};
use isolux::integers::{Emitter, Surface};
use isolux::scene::records;
use isolux::shoot::Stop;

/// Bakes a planned scene of linear patches with a matrix in place of its occluders, its
/// terms' factors of so many bits: 4, 6 or 8.
///
/// The terms, weights, visible fractions and places are those that [`crate::bake::bake_matrix`]
/// writes, in whole numbers. The unit of irradiance is chosen so that what arrives at a
/// sample, and what a patch reflects anywhere, has 30 bits with every luminaire as bright
/// as it is here, whichever of them are on: that is solved beforehand.
///
/// # Errors
/// See [`Refused`].
pub fn bake_matrix(
    scene: &Scene,
    plan: &Plan,
    occlusion: Option<Occlusion>,
    bits: u32,
) -> Result<Tables, Refused> {
    if requirements(scene).channels > 1 {
        return Err(Refused::Colour);
    }
    let mut surfaces = plan.surfaces.iter();
    if surfaces.any(|s| !s.bands.is_empty() || !s.points.is_empty()) {
        return Err(Refused::Constant);
    }
    let mut surfaces = plan.surfaces.iter();
    if surfaces.any(|surface| !surface.fields.is_empty()) {
        return Err(Refused::Fields);
    }
    let mut floats = content::Content::of(scene, plan, occlusion)?;
    let computed = floats.surveyed(scene)?;
    floats.replace_occluders(matrix::of(&computed, bits));
    let units = units(&floats, &floats.tables(scene)?)?;
    let content = of(&floats, &units)?;
    let tolerance = units.length(TOLERANCE * largest_coordinate(scene));
    let mut tables = content.into_tables(tolerance, &units)?;
    tables.computed = Some(Box::new(computed));
    Ok(tables)
}

/// What is left unshot where the light is solved for the unit of irradiance.
const STOP: Stop = Stop::below(1e-4);

/// And what is allowed for that.
const MARGIN: f64 = 1.001;

fn units(floats: &content::Content, tables: &Tables) -> Result<Units, TooLarge> {
    let vertices = floats.vertices.iter().flatten();
    let corners = floats.surfaces.iter().flat_map(|surface| surface.origin);
    // Places on a surface are told from its corner: twice as far at most.
    let halves = floats.surfaces.iter().flat_map(|s| s.size.map(|x| x / 2.0));
    let farthest = { vertices.copied() }
        .chain(corners)
        .chain(halves)
        .fold(0.0_f64, |most, x| most.max(f64::from(x).abs()));
    let exitances = floats.exitances.iter().copied();
    let brightest = exitances.fold(0.0_f64, |most, m| most.max(m.into()));
    let light = brightest_light(floats, tables).map_err(|_| TooLarge { what: "samples" })?;
    Ok(Units::of(farthest, brightest, MARGIN * light))
}

/// The most that arrives at a sample or anywhere on a patch in W m⁻²: the sum of what every
/// luminaire brings alone. Of a patch it is its coefficients before they are reflected,
/// which are words on the device as well.
fn brightest_light(floats: &content::Content, tables: &Tables) -> Result<f64, isolux::Error> {
    let mut solution = solve(tables, Rung::Best, Sight::None, STOP)?;
    let luminaires = floats.exitances.len();
    let mut received = vec![0.0; floats.samples.len()];
    let mut gathered = vec![0.0; floats.emitters.len()];
    for on in 0..luminaires {
        for (index, &exitance) in floats.exitances.iter().enumerate() {
            let radiance = match index == on {
                true => exitance / std::f32::consts::PI,
                false => 0.0,
            };
            solution.set_radiance(index, [radiance; 3])?;
        }
        solution.update(STOP);
        let irradiance = solution.irradiance().into_iter();
        let irradiance: Vec<f64> = irradiance.map(|value| value[0].into()).collect();
        for (sum, value) in received.iter_mut().zip(&irradiance) {
            *sum += value.abs();
        }
        for (sum, emitter) in gathered.iter_mut().zip(&floats.emitters) {
            let coefficients = coefficients(floats, emitter, &irradiance);
            *sum += coefficients.iter().map(|x| x.abs()).sum::<f64>();
        }
    }
    let all = received.into_iter().chain(gathered);
    Ok(all.fold(0.0, f64::max))
}

/// The coefficients of this light over an emitter.
fn coefficients(
    floats: &content::Content,
    emitter: &records::Emitter,
    irradiance: &[f64],
) -> [f64; 3] {
    let first = emitter.first_member as usize;
    let mut sum = [0.0; 3];
    for member in first..first + emitter.members as usize {
        let irradiance = irradiance[usize::from(floats.members[member])];
        let weights = floats.weights.get(3 * member..).unwrap_or(&[]);
        for (sum, &weight) in sum.iter_mut().zip(weights) {
            *sum += f64::from(weight) * irradiance;
        }
    }
    sum
}

/// Every section in integers.
fn of(floats: &content::Content, units: &Units) -> Result<Content, TooLarge> {
    let largest = floats.emitters.iter().map(|emitter| emitter.area);
    let largest = f64::from(largest.fold(f32::MIN_POSITIVE, f32::max));
    let written = &floats.written;
    let luminaires = floats.exitances.len();
    let emitters = floats.emitters.iter().enumerate();
    let lengths = |x: f32| units.length(x.into());
    let exitance = units.irradiance + units.shift;
    let scale = |&scale: &f32| scale_of(scale, written.bits);
    let (weights, _) = floats.weights.as_chunks::<3>();
    Ok(Content {
        coefficients: 3,
        points: floats.points,
        surfaces: floats.surfaces.iter().map(|s| surface(s, units)).collect(),
        reflectances: { floats.reflectances.iter() }
            .map(|&rho| scaled(rho.into(), -32) as u32)
            .collect(),
        emitters: emitters
            .map(|(index, emitter)| Emitter {
                surface: emitter.surface,
                first_loop: match index < luminaires {
                    true => emitter.first_loop,
                    false => 0,
                },
                // What reflects has terms in place of its outline.
                loops: match index < luminaires {
                    true => emitter.loops,
                    false => 0,
                },
                first_member: emitter.first_member,
                members: emitter.members,
                area: scaled(f64::from(emitter.area) / largest, -31) as u32,
            })
            .collect(),
        exitances: { floats.exitances.iter() }
            .map(|&x| scaled(x.into(), exitance) as i32)
            .collect(),
        loops: floats.loops[..loops(floats)].iter().map(outline).collect(),
        vertices: { floats.vertices[..vertices(floats)].iter() }
            .map(|vertex| vertex.map(lengths))
            .collect(),
        samples: { floats.samples.iter() }
            .map(|place| place.map(lengths))
            .collect(),
        weights: { weights.iter() }
            .map(|weights| weights.map(|w| scaled(w.into(), -24) as i32))
            .collect(),
        members: floats.members.clone(),
        scales: written.scales.iter().map(scale).collect(),
        fractions: written.fractions.clone(),
        terms: written.terms,
        bits: written.bits,
        bytes: written.bytes.clone(),
    })
}

/// A scale of terms in 2^−(31 + 2 bits), so that no factor reaches 1.
fn scale_of(scale: f32, bits: u32) -> u32 {
    let one = 1_u64 << (31 + 2 * bits);
    let most = (1_u64 << bits) - 1;
    let units = (f64::from(scale) * one as f64) as u64;
    units.min((one - 1) / (most * most)) as u32
}

/// How many loops the luminaires have, which come first.
fn loops(floats: &content::Content) -> usize {
    let last = floats.emitters[..floats.exitances.len()].last();
    last.map_or(0, |last| (last.first_loop + last.loops) as usize)
}

/// And how many vertices.
fn vertices(floats: &content::Content) -> usize {
    let last = floats.loops[..loops(floats)].last();
    last.map_or(0, |last| (last.first_vertex + last.vertices) as usize)
}

fn outline(outline: &records::Loop) -> isolux::integers::Loop {
    isolux::integers::Loop {
        first_vertex: outline.first_vertex,
        vertices: outline.vertices,
    }
}

fn surface(surface: &records::Surface, units: &Units) -> Surface {
    let direction = |axis: [f32; 3]| axis.map(|x| scaled(x.into(), -30) as i32);
    let length = |x: f32| units.length(x.into());
    Surface {
        origin: surface.origin.map(length),
        axis_u: direction(surface.axis_u),
        axis_v: direction(surface.axis_v),
        normal: direction(surface.normal),
        size: surface.size.map(|x| length(x).max(1)),
        filter_radius: match surface.samples {
            0 => 0,
            _ => length(surface.filter_radius).max(1),
        },
        first_sample: surface.first_sample,
        samples: surface.samples,
        direct: surface.direct,
        indirect: surface.indirect,
    }
}
