//! A plan as text: one sample, node, triangle or member of an emitter a line.

use super::super::fields::tensor::Tensor;
use super::super::fields::{Field, Mesh, Node};
use super::super::patches::Patch;
use super::super::{Band, Plan, Sample, SurfacePlan};
use super::{LADDERS, VERSION};
use crate::scene::{Rungs, Scene, Surface};
use isolux::scene::fields::SHARE;

const HEAD: &str = "\
# A plan of isolux: where a scene is sampled, what shoots the light that it reflects, and
# what its irradiance is reconstructed from. Edit it as you like and use it with --plan;
# radiances and reflectances of the scene may change, its geometry may not.
";

const REPAINT: &str = "\
# The device keeps reflectances of its own, which may change there.
repaint = true
";

const RUNGS: &str = "
# What it was planned for. Flags go before these, and these before the scene's own.
# Placement, emitters and reconstruction are what the sections below are.
";

const SURFACE: &str = "
# A surface: its place is origin + u U + v V, in metres. The geometry is compared with the
# scene's; change it there and plan anew.
";

const PREDICTED: &str = "\
# What is predicted to err, by how much of the light at the place (root of the mean square)
# and over how many m2.
";

const BY_TAG: &str = "\
# The same of all light at the places of each tag: [tag, error, m2].
";

const SAMPLES: &str = "\
# Samples [u, v, tag]; where a vertex of an emitter is another place, [u, v, tag, u, v].
# Tags: unshadowed light at \"lit\", then direct light at \"direct\" and \"penumbra\", then
# reflected light at \"reflected\", \"contact\" (at the foot of something), \"umbra\" (where all
# else is hidden) and \"view\" (for the camera); or all light at the others.
";

const POINTS: &str = "\
# Samples that shoot for the area around them: [sample, m2], samples counted from 0.
";

const BANDS: &str = "
# Emitters: loops of samples, outer ones counter-clockwise, and the samples whose mean each
# shoots, or whose sum with these weights.";

const PATCHES: &str = "
# Emitters with linear radiosity: convex pieces, counter-clockwise corners [u, v]; and
# members [sample, weights of the mean and of both gradients].";

const FIELDS: &str = "
# The irradiance is the sum of these: of tensor grids, meshes and products of both.
# A tensor grid: polynomials through samples from `first` on, the lowest v first; nodes are
# from -1 to 1, `half` is what 1 is in metres. With a factor s = s0 + s1 u + s2 v they are of
# sqrt(s/E). Its samples lie on its nodes: move both.
# A mesh: triangles with linear values at nodes [u, v, constant, [sample, weight], ...],
# samples counted from `first`; where no triangle is, `outside`, else the nearest value.";

const END: &str = "
# Nothing is missing where the file ends here.
[end]
";

/// The plan of a scene as a file, made for these rungs.
///
/// The same plan gives the same text.
pub fn text(scene: &Scene, rungs: &Rungs, plan: &Plan) -> String {
    let mut text = format!(
        "{HEAD}isolux-plan = {VERSION}\nscene = {}\n",
        quoted(&scene.name)
    );
    if plan.repaint {
        text += REPAINT;
    }
    text += &format!("{RUNGS}[rungs]\n");
    let mut rungs = rungs.clone();
    for ladder in LADDERS {
        let choice = rungs.choice_mut(ladder).and_then(|choice| choice.take());
        if let Some(rung) = choice {
            text += &format!("{ladder} = {}\n", quoted(&rung));
        }
    }
    for (surface, planned) in scene.surfaces.iter().zip(&plan.surfaces) {
        text += &of_surface(surface, planned);
    }
    text + END
}

fn of_surface(surface: &Surface, planned: &SurfacePlan) -> String {
    let frame = &planned.frame;
    let mut text = format!("{SURFACE}[[surface]]\nname = {}\n", quoted(&surface.name));
    text += &format!("emits = {}\n", surface.emits());
    text += &format!("origin = {}\n", list(&frame.origin.to_array()));
    text += &format!("u = {}\n", list(&frame.u.to_array()));
    text += &format!("v = {}\n", list(&frame.v.to_array()));
    text += &format!("size = {}\n", list(&[frame.size_u, frame.size_v]));
    text += &format!("area = {:?}\n", surface.area);
    if planned.filter_radius > 0.0 {
        text += "# How far the cone filter reaches, in metres.\n";
        text += &format!("filter-radius = {:?}\n", planned.filter_radius);
    }
    if !planned.predicted.is_empty() {
        let parts = planned.predicted.iter().map(|predicted| {
            let (rms, area) = (single(predicted.rms), single(predicted.area));
            format!("[{}, {rms}, {area}]", quoted(predicted.part.name()))
        });
        text += PREDICTED;
        text += &lines("predicted", parts);
    }
    if !planned.predicted_by_tag.is_empty() {
        let tags = planned.predicted_by_tag.iter().map(|predicted| {
            let (rms, area) = (single(predicted.rms), single(predicted.area));
            format!("[{}, {rms}, {area}]", quoted(predicted.tag.name()))
        });
        text += BY_TAG;
        text += &lines("predicted-by-tag", tags);
    }
    if !planned.samples.is_empty() {
        text += SAMPLES;
        text += &lines("samples", planned.samples.iter().map(of_sample));
    }
    if !planned.points.is_empty() {
        let points = planned.points.iter();
        text += POINTS;
        text += &lines(
            "points",
            points.map(|p| format!("[{}, {:?}]", p.sample, p.area)),
        );
    }
    text += &section(BANDS, planned.bands.iter().map(of_band));
    text += &section(PATCHES, planned.patches.iter().map(of_patch));
    text + &section(FIELDS, planned.fields.iter().map(of_field))
}

/// Tables of a kind under what they are; nothing where there are none.
fn section(comment: &str, tables: impl Iterator<Item = String>) -> String {
    let tables: String = tables.collect();
    match tables.is_empty() {
        true => tables,
        false => format!("{comment}{tables}"),
    }
}

fn of_sample(sample: &Sample) -> String {
    let ([u, v], tag) = (sample.place, sample.tag.name());
    match sample.vertex == sample.place {
        true => format!("[{u:?}, {v:?}, \"{tag}\"]"),
        false => format!(
            "[{u:?}, {v:?}, \"{tag}\", {:?}, {:?}]",
            sample.vertex[0], sample.vertex[1]
        ),
    }
}

fn of_band(band: &Band) -> String {
    let mut text = format!("\n[[surface.band]]\narea = {:?}\n", band.area);
    text += &lines(
        "loops",
        band.loops.iter().map(|outline| format!("{outline:?}")),
    );
    text += &format!("members = {:?}\n", band.members);
    if !band.weights.is_empty() {
        let weights: Vec<String> = band.weights.iter().map(|&w| single(w)).collect();
        text += &format!("weights = [{}]\n", weights.join(", "));
    }
    text
}

fn of_patch(patch: &Patch) -> String {
    let mut text = format!("\n[[surface.patch]]\narea = {:?}\n", patch.area);
    let piece = |piece: &Vec<[f64; 2]>| {
        let corners: Vec<String> = piece.iter().map(|corner| list(corner)).collect();
        format!("[{}]", corners.join(", "))
    };
    text += &lines("pieces", patch.pieces.iter().map(piece));
    let member = |(sample, weights): &(usize, [f64; 3])| {
        let [mean, along_u, along_v] = weights.map(single);
        format!("[{sample}, {mean}, {along_u}, {along_v}]")
    };
    text += &lines("members", patch.members.iter().map(member));
    text
}

fn of_field(field: &Field) -> String {
    let mut text = "\n[[surface.field]]\n".to_owned();
    text.extend(field.tensor.iter().map(of_tensor));
    text.extend(field.mesh.iter().map(of_mesh));
    text
}

fn of_tensor(tensor: &Tensor) -> String {
    let mut text = format!("[surface.field.tensor]\nfirst = {}\n", tensor.first);
    text += &format!("nodes-u = {}\n", list(&tensor.nodes[0]));
    text += &format!("nodes-v = {}\n", list(&tensor.nodes[1]));
    text += &format!("center = {}\n", list(&tensor.center));
    text += &format!("half = {}\n", list(&tensor.half));
    if let Some(factor) = &tensor.factor {
        text += &format!("factor = {}\n", list(factor));
    }
    text
}

fn of_mesh(mesh: &Mesh) -> String {
    let (first, samples) = (mesh.first, mesh.samples);
    let mut text = format!("[surface.field.mesh]\nfirst = {first}\nsamples = {samples}\n");
    if let Some(outside) = mesh.outside {
        text += &format!("outside = {}\n", single(outside));
    }
    text += &lines("nodes", mesh.nodes.iter().map(of_node));
    text + &lines(
        "triangles",
        mesh.triangles.iter().map(|corners| format!("{corners:?}")),
    )
}

fn of_node(node: &Node) -> String {
    let [u, v] = node.place;
    let mut text = format!("[{u:?}, {v:?}, {}", units(node.constant));
    for &(sample, weight) in &node.shares {
        text += &format!(", [{sample}, {}]", units(weight));
    }
    text + "]"
}

/// A list with one element a line.
fn lines(key: &str, elements: impl Iterator<Item = String>) -> String {
    let elements: String = elements.map(|element| format!("  {element},\n")).collect();
    format!("{key} = [\n{elements}]\n")
}

fn list(numbers: &[f64]) -> String {
    format!("{numbers:?}")
}

/// A string of TOML.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// A number that the tables keep in single precision.
fn single(number: f64) -> String {
    let kept = number as f32;
    let short = format!("{kept:?}");
    match short.parse::<f64>().is_ok_and(|read| read as f32 == kept) {
        true => short,
        false => format!("{number:?}"),
    }
}

/// A number that the tables keep in units of [`SHARE`], 2⁻¹³: five digits tell which.
fn units(number: f64) -> String {
    let unit = f64::from(SHARE);
    let most = f64::from(i16::MAX);
    let kept = (number / unit).round().clamp(-most, most) * unit;
    let short = format!("{kept:.5}");
    let digits = short.trim_end_matches('0');
    let whole = if digits.ends_with('.') { "0" } else { "" };
    format!("{digits}{whole}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_digits_tell_every_unit() {
        for count in -32767_i32..=32767 {
            let weight = f64::from(count) * f64::from(SHARE);
            let read: f64 = units(weight).parse().unwrap();
            assert_eq!((read / f64::from(SHARE)).round(), f64::from(count));
            assert!(
                units(weight).contains('.'),
                "a TOML float: {}",
                units(weight)
            );
        }
        assert_eq!(units(0.5), "0.5");
        assert_eq!(units(1.0), "1.0");
        assert_eq!(units(9.0), units(4.0), "no table holds more");
    }

    #[test]
    fn names_are_strings_of_toml() {
        for name in ["A", "say \"hi\"", "back\\slash", "ümlaut"] {
            let table: toml::Table = format!("name = {}", quoted(name)).parse().unwrap();
            assert_eq!(table["name"].as_str(), Some(name));
        }
    }
}
