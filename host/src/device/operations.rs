//! What the steps of a run do, counted from the tables and the host's own solve.

use std::collections::BTreeMap;

use isolux::Error;
use isolux::integers;
use isolux::scene::Scene;
use isolux::scene::fields::{Fields, Mesh, Tensor};
use isolux::scene::records::Counts;
use isolux::shoot::Stop;
use serde::Serialize;

use crate::bake::Tables;
use crate::solve::Sight;
use crate::solve::tally::{Operation, Tally, tally, tally_in_integers};

/// How often every operation of a step is done, by its name.
pub type Done = BTreeMap<&'static str, u64>;

/// The operations of every step.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Operations {
    /// What the types of the light are: its program, and so its costs, are others for each.
    pub kind: String,
    /// Checking the tables and making the dark state.
    pub load: Done,
    /// Direct light.
    pub direct: Done,
    /// Every shot after it.
    pub shoot: Done,
    /// Every row of every grid.
    pub resample: Done,
}

impl Operations {
    /// Those of the firmware that `isolux device` runs: the tables are loaded, lit until
    /// `stop`, and every surface with samples is put together as a grid of `resolution`
    /// rows and columns.
    ///
    /// # Errors
    /// Where the kernel does not take the tables.
    pub fn of(tables: &Tables, sight: Sight, stop: Stop, resolution: usize) -> Result<Self, Error> {
        let scene = Scene::load(tables.bytes())?;
        let [direct, shoot] = split(tally(tables, sight, stop)?);
        Ok(Self {
            kind: kind(scene.counts()),
            load: load(scene.counts(), tables.bytes().len()),
            direct,
            shoot,
            resample: resample(&scene, resolution as u64),
        })
    }

    /// Those of tables in integers, on `q24` where `is_short` and else on `q29`.
    ///
    /// # Errors
    /// Where the kernel does not take the tables.
    pub fn in_integers(
        tables: &Tables,
        is_short: bool,
        stop: Stop,
        resolution: usize,
    ) -> Result<Self, Error> {
        let scene = integers::Scene::load(tables.bytes())?;
        let rung = if is_short { "q24" } else { "q29" };
        let transfer = if scene.counts().coefficients > 1 {
            "matrix"
        } else {
            "constant"
        };
        let [direct, shoot] = split(tally_in_integers(tables.bytes(), is_short, stop)?);
        let mut resample = Done::new();
        for surface in scene.surfaces().iter().filter(|s| s.samples > 0) {
            let wide = |place: [i32; 2]| place.map(|x| x as f32);
            let (_, places) = scene.samples_of(surface);
            let places: Vec<[f32; 2]> = places.iter().copied().map(wide).collect();
            let grid = (wide(surface.size), surface.filter_radius as f32);
            painted(resolution as u64, &mut resample);
            filtered(&places, grid, resolution as u64, &mut resample);
        }
        Ok(Self {
            kind: format!("{rung}-{transfer}"),
            load: load(scene.counts(), tables.bytes().len()),
            direct,
            shoot,
            resample,
        })
    }

    /// The steps by name, in the order of a run.
    pub fn steps(&self) -> [(&'static str, &Done); 4] {
        [
            ("load", &self.load),
            ("direct", &self.direct),
            ("shoot", &self.shoot),
            ("resample", &self.resample),
        ]
    }
}

/// Direct light and what comes after it, by name.
fn split([direct, all]: [Tally; 2]) -> [Done; 2] {
    let shoot: Tally = std::array::from_fn(|index| all[index].saturating_sub(direct[index]));
    [direct, shoot].map(|tally| {
        let names = Operation::ALL.iter().map(|operation| operation.name());
        names.zip(tally).filter(|&(_, times)| times > 0).collect()
    })
}

/// How radiosity varies over an emitter, how what a sample receives is had, and channels.
fn kind(counts: &Counts) -> String {
    let form = match (counts.coefficients, counts.weights) {
        (1, 0) => "constant",
        (1, _) => "increment",
        _ => "linear",
    };
    let transfer = match (counts.is_coded(), counts.occluders) {
        (true, _) => "-codes",
        (false, 0) => "",
        _ => "-exact",
    };
    let colour = if counts.channels == 1 { "" } else { "-rgb" };
    format!("{form}{transfer}{colour}")
}

fn add(done: &mut Done, operation: &'static str, times: u64) {
    if times > 0 {
        *done.entry(operation).or_insert(0) += times;
    }
}

/// A load goes once over every word, and over every record.
fn load(counts: &Counts, bytes: usize) -> Done {
    let of = |counts: &[u32]| -> u64 { counts.iter().map(|&count| u64::from(count)).sum() };
    let mut done = Done::new();
    add(&mut done, "load", 1);
    add(&mut done, "word", bytes as u64 / 4);
    let state = of(&[counts.samples]) + 2 * of(&[counts.emitters]) * u64::from(counts.coefficients);
    add(&mut done, "state", u64::from(counts.channels) * state);
    add(&mut done, "surface", of(&[counts.surfaces]));
    add(&mut done, "emitter", of(&[counts.emitters]));
    add(&mut done, "loop", of(&[counts.loops]));
    add(&mut done, "vertex", of(&[counts.vertices, counts.places]));
    add(&mut done, "place", of(&[counts.samples, counts.corners]));
    add(&mut done, "number", of(&[counts.weights, counts.matrices]));
    add(
        &mut done,
        "member",
        of(&[counts.members, counts.blockers, counts.edges]),
    );
    add(&mut done, "occluder", of(&[counts.occluders, counts.faces]));
    add(
        &mut done,
        "tensor",
        of(&[counts.tensors, counts.meshes, counts.fields]),
    );
    add(&mut done, "node", of(&[counts.nodes]));
    add(&mut done, "share", of(&[counts.shares]));
    add(&mut done, "triangle", of(&[counts.triangles]));
    done
}

fn resample(scene: &Scene<'_>, resolution: u64) -> Done {
    let mut done = Done::new();
    for surface in scene.surfaces() {
        if surface.samples == 0 {
            continue;
        }
        painted(resolution, &mut done);
        match surface.fields {
            0 => {
                let (_, places) = scene.samples_of(surface);
                let grid = (surface.size, surface.filter_radius);
                filtered(places, grid, resolution, &mut done);
            }
            _ => {
                for (tensor, mesh) in scene.fields().of(surface) {
                    field(scene.fields(), tensor, mesh, resolution, &mut done);
                }
            }
        }
    }
    done
}

/// The rows and cells of a grid.
fn painted(resolution: u64, done: &mut Done) {
    add(done, "row", resolution);
    add(done, "pixel", resolution * resolution);
}

/// Every pixel looks at every sample that it may reach, on a surface of this size within
/// this radius.
fn filtered(
    places: &[[f32; 2]],
    (size, radius): ([f32; 2], f32),
    resolution: u64,
    done: &mut Done,
) {
    let cell = size.map(|size| size / resolution as f32);
    let mut within = 0;
    for row in 0..resolution {
        for column in 0..resolution {
            let at = [
                (column as f32 + 0.5) * cell[0],
                (row as f32 + 0.5) * cell[1],
            ];
            let near = |&&[u, v]: &&[f32; 2]| f32::hypot(u - at[0], v - at[1]) < radius;
            within += places.iter().filter(near).count() as u64;
        }
    }
    add(
        done,
        "cone-sample",
        resolution * resolution * places.len() as u64,
    );
    add(done, "cone-hit", within);
}

fn field(
    fields: Fields<'_>,
    tensor: Option<&Tensor>,
    mesh: Option<&Mesh>,
    resolution: u64,
    done: &mut Done,
) {
    let pixels = resolution * resolution;
    if let Some(tensor) = tensor {
        let [along_u, along_v] = tensor.nodes.map(u64::from);
        add(done, "grid", 1);
        add(done, "grid-value", along_u * along_v);
        add(
            done,
            "grid-product",
            along_u * along_v * (along_u + along_v),
        );
        let whole = mesh.is_none_or(|mesh| mesh.outside > 0.0);
        let painted = if whole { pixels } else { 0 };
        let again = mesh.map_or(0, |mesh| cells(fields, mesh, resolution));
        add(done, "line-value", painted + again);
        add(done, "line-node", (painted + again) * along_u);
        if let Some(mesh) = mesh {
            let fractions = u64::from(mesh.samples);
            add(done, "line-node", fractions * along_u);
            add(done, "part-cell", again);
        }
    } else if let Some(mesh) = mesh {
        add(done, "cell", cells(fields, mesh, resolution));
    }
    if let Some(mesh) = mesh {
        let nodes = fields.nodes(mesh);
        add(
            done,
            "share",
            nodes.iter().map(|node| u64::from(node.shares)).sum(),
        );
        add(done, "row-triangle", resolution * u64::from(mesh.triangles));
        add(done, "span", spans(fields, mesh, resolution, |_| 1));
    }
}

/// How many cells of a grid the triangles of a mesh cover, about.
fn cells(fields: Fields<'_>, mesh: &Mesh, resolution: u64) -> u64 {
    spans(fields, mesh, resolution, |columns| columns)
}

/// The sum over all rows, and the triangles that they cross, of a function of the
/// columns inside.
fn spans(fields: Fields<'_>, mesh: &Mesh, resolution: u64, of: impl Fn(u64) -> u64) -> u64 {
    let end = f64::from(u16::MAX);
    let nodes = fields.nodes(mesh);
    let mut sum = 0;
    for triangle in fields.triangles(mesh) {
        let corners = triangle.map(|node| nodes[usize::from(node)].place.map(f64::from));
        for row in 0..resolution {
            let v = (row as f64 + 0.5) / resolution as f64 * end;
            let mut found: Vec<f64> = Vec::new();
            for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                let (from, to) = (corners[from], corners[to]);
                if (from[1] <= v) != (to[1] <= v) {
                    let part = (v - from[1]) / (to[1] - from[1]);
                    found.push(from[0] + part * (to[0] - from[0]));
                }
            }
            if let [one, other] = *found {
                let column = |u: f64| (u / end * resolution as f64 - 0.5).ceil().max(0.0) as u64;
                let (first, last) = (column(one.min(other)), column(one.max(other)));
                sum += of(last.min(resolution).saturating_sub(first));
            }
        }
    }
    sum
}
