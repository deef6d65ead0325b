//! The terms of a surface's irradiance in a plan file.

use super::super::fields::tensor::Tensor;
use super::super::fields::{Field as Term, Mesh, Node};
use super::samples::Samples;
use super::surfaces::{index, indices, pair, place, within};
use crate::scene::diagnostic::Diagnostic;
use crate::scene::document::{Field, Table};
use crate::scene::frame::Frame;
use isolux::scene::fields::{MOST_NODES, SHARE};

/// The largest coefficient of a factor.
const LARGEST: f64 = 1e16;

/// The largest entry of a matrix that tables hold: nodes too close to each other have
/// larger ones.
const STEEPEST: f64 = 64.0;

/// The largest weight in a node that tables hold, up to the digits it is written with.
const HEAVIEST: f64 = i16::MAX as f64 * SHARE as f64 + 1e-5;

/// Nodes of a mesh at the most: triangles name them by 16 bits.
const MOST: usize = u16::MAX as usize;

const NODE: &str = "`[0.5, 1.25, 0.0, [0, 0.75], [1, 0.25]]`";

pub(super) fn read(
    table: &Table<'_>,
    samples: &Samples<'_>,
    frame: &Frame,
) -> Result<Vec<Term>, Diagnostic> {
    let Some(field) = table.optional("field") else {
        return Ok(Vec::new());
    };
    let tables = field.tables("a field")?;
    let term = |table: &Table<'_>| {
        let table = table.only(&["tensor", "mesh"])?;
        let tensor = table.optional("tensor");
        let mesh = table.optional("mesh");
        if tensor.is_none() && mesh.is_none() {
            return Err(table.error(
                "a field has a tensor grid, a mesh, or both",
                "remove it, or give it a `[surface.field.mesh]`",
            ));
        }
        let tensor = tensor.map(|field| read_tensor(&field, samples, frame));
        let mesh = mesh.map(|field| read_mesh(&field, samples, frame));
        Ok(Term {
            tensor: tensor.transpose()?,
            mesh: mesh.transpose()?,
        })
    };
    tables.iter().map(term).collect()
}

fn read_tensor(
    field: &Field<'_>,
    samples: &Samples<'_>,
    frame: &Frame,
) -> Result<Tensor, Diagnostic> {
    let table = field.table("a tensor grid")?;
    let table = table.only(&["first", "nodes-u", "nodes-v", "center", "half", "factor"])?;
    let first = table.required("first", "first = 0")?;
    let half = table.required("half", "half = [2.5, 2.5]")?;
    let center = table.required("center", "center = [2.5, 2.5]")?;
    let tensor = Tensor {
        first: index(&first, samples.all.len(), "samples of this surface")?,
        nodes: [nodes(&table, "nodes-u")?, nodes(&table, "nodes-v")?],
        center: pair(&center, "two lengths [u, v]", "`center = [2.5, 2.5]`")?,
        half: pair(&half, "two lengths [u, v]", "`half = [2.5, 2.5]`")?,
        factor: match table.optional("factor") {
            Some(field) => Some(factor(&field)?),
            None => None,
        },
    };
    let sizes = [frame.size_u, frame.size_v];
    if (0..2).any(|axis| !(1e-6..=2.0).contains(&(tensor.half[axis] / sizes[axis]))) {
        return Err(half.error(
            "this is nothing like half the size of the surface",
            "it is what a node of 1 is away from `center`, in metres",
        ));
    }
    if (0..2).any(|axis| {
        tensor
            .matrix(axis)
            .iter()
            .any(|x| !(-STEEPEST..=STEEPEST).contains(x))
    }) {
        let at = table.required("nodes-u", "nodes-u = [-0.5, 0.5]")?;
        return Err(at.error(
            "nodes along u or v are so close to each other that polynomials through them are too steep",
            "move them apart, as Chebyshev's are",
        ));
    }
    if first_beyond(&tensor, samples) {
        return Err(first.error(
            format!(
                "the grid needs {} samples from sample {} on, the surface has {}",
                tensor.samples(),
                tensor.first,
                samples.all.len()
            ),
            "give the grid fewer nodes, or the surface more samples",
        ));
    }
    on_nodes(&tensor, samples, sizes)?;
    Ok(tensor)
}

fn first_beyond(tensor: &Tensor, samples: &Samples<'_>) -> bool {
    tensor.first + tensor.samples() > samples.all.len()
}

/// Refuses samples that are not where the polynomials take them to be.
fn on_nodes(tensor: &Tensor, samples: &Samples<'_>, sizes: [f64; 2]) -> Result<(), Diagnostic> {
    let far = 1e-6 * sizes[0].max(sizes[1]);
    for (k, node) in (tensor.first..).zip(tensor.places()) {
        let place = samples.all.get(k).map_or(node, |sample| sample.place);
        if (place[0] - node[0]).hypot(place[1] - node[1]) > far {
            let message = format!(
                "the sample is not at its node of a tensor grid, [{:?}, {:?}]",
                node[0], node[1]
            );
            let remedy = "move a row or column of samples together with its node; samples of meshes may lie anywhere";
            if let Some(diagnostic) = samples.error(k, message, remedy) {
                return Err(diagnostic);
            }
        }
    }
    Ok(())
}

fn nodes(table: &Table<'_>, key: &'static str) -> Result<Vec<f64>, Diagnostic> {
    let example = "`nodes-u = [-0.7, 0.0, 0.7]`";
    let field = table.required(key, "nodes-u = [-0.7, 0.0, 0.7]")?;
    let elements = field.elements("a list of nodes", example)?;
    if elements.is_empty() || elements.len() > MOST_NODES {
        return Err(field.error(
            format!(
                "a tensor grid has 1 to {MOST_NODES} nodes along a side, not {}",
                elements.len()
            ),
            format!("write them like {example}"),
        ));
    }
    let mut nodes: Vec<f64> = Vec::new();
    for element in &elements {
        // The outermost may be drawn out to the ends, up to rounding.
        let node = within(element, -1.0 - 1e-9..=1.0 + 1e-9, example)?;
        if nodes.last().is_some_and(|&last| last >= node) {
            return Err(element.error("nodes must rise", "sort them, and let no two be equal"));
        }
        nodes.push(node);
    }
    Ok(nodes)
}

fn factor(field: &Field<'_>) -> Result<[f64; 3], Diagnostic> {
    let example = "`factor = [1.0, 0.0, 0.0]`";
    let elements = field.elements("three numbers", example)?;
    match elements.as_slice() {
        [s, along_u, along_v] => {
            let number = |field| within(field, -LARGEST..=LARGEST, example);
            Ok([number(s)?, number(along_u)?, number(along_v)?])
        }
        _ => Err(field.error(
            "a factor is three numbers",
            format!("write it like {example}"),
        )),
    }
}

fn read_mesh(field: &Field<'_>, samples: &Samples<'_>, frame: &Frame) -> Result<Mesh, Diagnostic> {
    let table = field.table("a mesh")?;
    let table = table.only(&["first", "samples", "outside", "nodes", "triangles"])?;
    let all = samples.all.len();
    let first = table.required("first", "first = 0")?;
    let count = table.required("samples", "samples = 12")?;
    let (first, count) = (number(&first, all)?, number(&count, all)?);
    if first + count > all {
        let at = table.required("samples", "samples = 12")?;
        return Err(at.error(
            format!("the mesh needs {count} samples from sample {first} on, the surface has {all}"),
            "lower `first` or `samples`, or give the surface more samples",
        ));
    }
    let outside = table.optional("outside");
    let outside = outside.map(|field| within(&field, 0.0..=1.0, "`outside = 1.0`"));
    let nodes = table.required("nodes", "nodes = [[0.0, 0.0, 1.0]]")?;
    let lines = nodes.elements("a list of nodes", NODE)?;
    if lines.len() > MOST {
        return Err(nodes.error(
            format!("a mesh has at most {MOST} nodes"),
            "plan with fewer",
        ));
    }
    let nodes: Vec<Node> = lines
        .iter()
        .map(|line| read_node(line, count, frame))
        .collect::<Result<_, _>>()?;
    let field = table.required("triangles", "triangles = [[0, 1, 2]]")?;
    let mut triangles = Vec::new();
    for line in field.elements("a list of triangles", "`[0, 1, 2]`")? {
        let corners = indices(&line, nodes.len(), "nodes of this mesh")?;
        let corners: Result<[usize; 3], _> = corners.try_into();
        triangles.push(
            corners.map_err(|_| {
                line.error("a triangle has three nodes", "write it like `[0, 1, 2]`")
            })?,
        );
    }
    Ok(Mesh {
        first,
        samples: count,
        nodes,
        triangles,
        outside: outside.transpose()?,
    })
}

/// A whole number up to all samples of a surface.
fn number(field: &Field<'_>, all: usize) -> Result<usize, Diagnostic> {
    let number = field
        .as_integer()
        .and_then(|integer| usize::try_from(integer).ok());
    number.filter(|&number| number <= all).ok_or_else(|| {
        field.error(
            format!("this is no number of samples up to {all}, which the surface has"),
            "write a whole number",
        )
    })
}

fn read_node(line: &Field<'_>, samples: usize, frame: &Frame) -> Result<Node, Diagnostic> {
    let parts = line.elements("a node [u, v, constant, [sample, weight], ...]", NODE)?;
    let [u, v, constant, shares @ ..] = parts.as_slice() else {
        return Err(line.error(
            "a node is [u, v, constant, [sample, weight], ...]",
            format!("write it like {NODE}"),
        ));
    };
    let weight = |field: &Field<'_>| within(field, -HEAVIEST..=HEAVIEST, NODE);
    let share = |field: &Field<'_>| {
        let parts = field.elements("a share [sample, weight]", NODE)?;
        match parts.as_slice() {
            [sample, of] => Ok((index(sample, samples, "samples of this mesh")?, weight(of)?)),
            _ => Err(field.error(
                "a share is [sample, weight]",
                format!("write it like {NODE}"),
            )),
        }
    };
    Ok(Node {
        place: place(u, v, frame)?,
        constant: weight(constant)?,
        shares: shares.iter().map(share).collect::<Result<_, _>>()?,
    })
}
