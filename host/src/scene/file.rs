//! Scene files: TOML in, a validated [`Scene`] or a [`Diagnostic`] out.
//!
//! The first fault found is reported: syntax, then the format version, then
//! unknown keys, then each table in the order of the keys, surfaces first.

use std::collections::HashMap;
use std::path::Path;

use glam::DVec3;
use toml::de::DeTable;

use super::diagnostic::{Diagnostic, nearest_name};
use super::document::{Document, Field, Table, listed};
use super::settings;
use super::{Body, Point, Quantity, Scene, Surface, body, polygon};

/// The format version that this program reads.
pub const FORMAT_VERSION: i128 = 1;

/// Largest radiance. With coordinates up to 1e6 m the power π L A of a surface
/// stays below 1e33, so sums over many surfaces and bounces stay in f32.
pub const MAX_RADIANCE: f64 = 1e20;

/// Smallest radiance other than 0: irradiances down to 1e-10 of it are still
/// normal numbers in f32.
pub const MIN_RADIANCE: f64 = 1e-20;

const ROOT_KEYS: [&str; 9] = [
    "isolux", "name", "quantity", "surface", "body", "point", "rungs", "camera", "budget",
];
const VERTICES_EXAMPLE: &str = "vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]";
const VERTEX_EXAMPLE: &str = "`[1.5, 0, 2]`";

/// Reads and validates the scene file at `path`.
///
/// Fails with a [`Diagnostic`] where the file cannot be read or breaks a rule
/// of the format. Never panics.
pub fn read(path: impl AsRef<Path>) -> Result<Scene, Diagnostic> {
    let path = path.as_ref();
    parse(&path.display().to_string(), &read_text(path)?)
}

/// The text of an input file, or why it cannot be read.
pub fn read_text(path: &Path) -> Result<String, Diagnostic> {
    let file = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|error| {
        Diagnostic::of_file(
            &file,
            format!("cannot read the file: {error}"),
            "check the path and that you may read it",
        )
    })?;
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let text = String::from_utf8_lossy(error.as_bytes());
        Diagnostic::at(
            &file,
            &text,
            at..at + 1,
            "not UTF-8 text",
            "save the file as UTF-8; if it is not a text file, name another",
        )
    })
}

/// Validates the scene file `source`; `name` is what diagnostics call it.
///
/// Fails with a [`Diagnostic`] where it breaks a rule of the format. Never
/// panics, whatever the text.
pub fn parse(name: &str, source: &str) -> Result<Scene, Diagnostic> {
    let document = Document { name, source };
    let entries = DeTable::parse(source).map_err(|error| document.syntax_error(&error))?;
    let root = Table::root(document, entries.get_ref(), "a scene");
    check_version(&root)?;
    let root = root.only(&ROOT_KEYS)?;
    let scene_name = root.required("name", "name = \"my-room\"")?.name()?;
    let quantity = read_quantity(&root)?;
    let surfaces = read_surfaces(document, &root)?;
    let bodies = read_bodies(document, &root, &surfaces)?;
    Ok(Scene {
        name: scene_name,
        quantity,
        surfaces,
        bodies,
        points: read_points(document, &root)?,
        rungs: settings::rungs(&root)?,
        camera: settings::camera(&root)?,
        budget: settings::budget(&root)?,
    })
}

fn check_version(root: &Table<'_>) -> Result<(), Diagnostic> {
    let Some(version) = root.optional("isolux") else {
        return Err(root.error(
            "the format version is missing",
            "begin the file with the line `isolux = 1`",
        ));
    };
    if version.as_integer() != Some(FORMAT_VERSION) {
        return Err(version.error(
            format!("unknown format version: this program reads version {FORMAT_VERSION}"),
            format!("write `isolux = {FORMAT_VERSION}`, or use an isolux that reads this version"),
        ));
    }
    Ok(())
}

fn read_quantity(root: &Table<'_>) -> Result<Quantity, Diagnostic> {
    let example = "quantity = \"radiometric\"";
    let field = root.required("quantity", example)?;
    match field.string(example)? {
        "radiometric" => Ok(Quantity::Radiometric),
        "photometric" => Ok(Quantity::Photometric),
        other => Err(field.error(
            format!("unknown quantity `{other}`"),
            "write \"radiometric\" (W/m2) or \"photometric\" (lx)",
        )),
    }
}

/// The names of one kind of table, each with the byte at which it stands.
struct Names<'d> {
    document: Document<'d>,
    kind: &'static str,
    places: HashMap<String, usize>,
}

impl<'d> Names<'d> {
    fn new(document: Document<'d>, kind: &'static str) -> Self {
        Self {
            document,
            kind,
            places: HashMap::new(),
        }
    }

    /// The name of a table, refused where another of its kind has it.
    fn read(&mut self, table: &Table<'_>, example: &str) -> Result<String, Diagnostic> {
        let field = table.required("name", example)?;
        let name = field.name()?;
        if let Some(first) = self.places.insert(name.clone(), field.span().start) {
            let first = self.document.line_of(first);
            return Err(field.error(
                format!("two {} are named `{name}`", self.kind),
                format!("the first is on line {first}: give this one another name"),
            ));
        }
        Ok(name)
    }
}

fn read_surfaces(document: Document<'_>, root: &Table<'_>) -> Result<Vec<Surface>, Diagnostic> {
    let tables = match root.optional("surface") {
        Some(field) => field.tables("a surface")?,
        None => Vec::new(),
    };
    if tables.is_empty() {
        return Err(root.error(
            "the scene has no surface",
            format!("add a table `[[surface]]` with a name and `{VERTICES_EXAMPLE}`"),
        ));
    }
    let mut names = Names::new(document, "surfaces");
    tables
        .into_iter()
        .map(|table| {
            let table = table.only(&["name", "vertices", "reflectance", "radiance"])?;
            let name = names.read(&table, "name = \"floor\"")?;
            let vertices = table.required("vertices", VERTICES_EXAMPLE)?;
            let (vertices, measured) = read_polygon(&vertices)?;
            Ok(Surface {
                name,
                vertices,
                normal: measured.normal,
                area: measured.area,
                reflectance: channels(&table, "reflectance", check_reflectance)?,
                radiance: channels(&table, "radiance", check_radiance)?,
            })
        })
        .collect()
}

fn read_polygon(field: &Field<'_>) -> Result<(Vec<DVec3>, polygon::Measured), Diagnostic> {
    let elements = field.elements("a list of vertices", &format!("`{VERTICES_EXAMPLE}`"))?;
    let vertices = elements
        .iter()
        .map(|element| element.position(VERTEX_EXAMPLE))
        .collect::<Result<Vec<DVec3>, Diagnostic>>()?;
    match polygon::measure(&vertices) {
        Ok(measured) => Ok((vertices, measured)),
        Err(flaw) => {
            let at = flaw.vertex().and_then(|vertex| elements.get(vertex));
            Err(at.unwrap_or(field).error(flaw.to_string(), flaw.remedy()))
        }
    }
}

/// The channels of an optional key, 0 where it is absent.
fn channels(
    table: &Table<'_>,
    key: &'static str,
    check: fn(f64, &Field<'_>) -> Result<(), Diagnostic>,
) -> Result<[f64; 3], Diagnostic> {
    let Some(field) = table.optional(key) else {
        return Ok([0.0; 3]);
    };
    let numbers = field.channels(&format!("`{key} = 0.5` or `{key} = [0.6, 0.5, 0.4]`"))?;
    for (number, place) in &numbers {
        check(*number, place)?;
    }
    Ok(numbers.map(|(number, _)| number))
}

fn check_reflectance(rho: f64, field: &Field<'_>) -> Result<(), Diagnostic> {
    let remedy = "a reflectance is the reflected part of the light: 0 <= rho < 1";
    if rho < 0.0 {
        return Err(field.error(format!("reflectance {rho} is negative"), remedy));
    }
    if rho >= 1.0 {
        return Err(field.error(format!("reflectance {rho} is not below 1"), remedy));
    }
    if rho as f32 >= 1.0 {
        return Err(field.error(
            format!("reflectance {rho} is 1 in the device's single precision"),
            "write a reflectance of at most 0.9999999",
        ));
    }
    Ok(())
}

fn check_radiance(radiance: f64, field: &Field<'_>) -> Result<(), Diagnostic> {
    if radiance < 0.0 {
        return Err(field.error(
            format!("radiance {radiance} is negative"),
            "a surface emits radiance >= 0; what absorbs has a low reflectance",
        ));
    }
    if radiance > MAX_RADIANCE || (radiance > 0.0 && radiance < MIN_RADIANCE) {
        return Err(field.error(
            format!(
                "radiance {radiance:e} is outside {MIN_RADIANCE:e} to {MAX_RADIANCE:e}, where the device's single precision is safe"
            ),
            "light is linear: scale all radiances of the scene by one factor",
        ));
    }
    Ok(())
}

fn read_bodies(
    document: Document<'_>,
    root: &Table<'_>,
    surfaces: &[Surface],
) -> Result<Vec<Body>, Diagnostic> {
    let Some(field) = root.optional("body") else {
        return Ok(Vec::new());
    };
    let by_name: HashMap<&str, usize> = surfaces
        .iter()
        .enumerate()
        .map(|(index, surface)| (surface.name.as_str(), index))
        .collect();
    let largest = super::largest_coordinate(surfaces);
    let mut names = Names::new(document, "bodies");
    let mut owner: HashMap<usize, String> = HashMap::new();
    let mut bodies = Vec::new();
    for table in field.tables("a body")? {
        let table = table.only(&["name", "surfaces"])?;
        let name = names.read(&table, "name = \"block\"")?;
        let example = "surfaces = [\"block-top\", \"block-north\"]";
        let list = table.required("surfaces", example)?;
        let fields = list.elements("a list of surface names", &format!("`{example}`"))?;
        let mut members = Vec::new();
        for face in &fields {
            let index = member(face, &by_name)?;
            if let Some(first) = owner.insert(index, name.clone()) {
                return Err(face.error(
                    format!("surface `{}` is already a face of body `{first}`", surfaces[index].name),
                    "a surface has one front and bounds one body: name it once, or add a surface for the other body",
                ));
            }
            members.push(index);
        }
        check_body(&list, &fields, &members, surfaces, largest)?;
        bodies.push(Body {
            name,
            surfaces: members,
        });
    }
    Ok(bodies)
}

fn member(face: &Field<'_>, by_name: &HashMap<&str, usize>) -> Result<usize, Diagnostic> {
    let name = face.string("`[\"block-top\", \"block-north\"]`")?;
    by_name.get(name).copied().ok_or_else(|| {
        let mut known: Vec<&str> = by_name.keys().copied().collect();
        known.sort_unstable();
        let remedy = match nearest_name(name, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None if known.len() <= 12 => format!("the scene's surfaces are {}", listed(&known)),
            None => "name a surface of this scene".to_owned(),
        };
        face.error(format!("the scene has no surface `{name}`"), remedy)
    })
}

fn check_body(
    list: &Field<'_>,
    fields: &[Field<'_>],
    members: &[usize],
    surfaces: &[Surface],
    largest: f64,
) -> Result<(), Diagnostic> {
    if members.is_empty() {
        return Err(list.error(
            "the body has no surface",
            "name the surfaces that bound it, or leave the body out",
        ));
    }
    let faces: Vec<&Surface> = members.iter().map(|&index| &surfaces[index]).collect();
    body::check(&faces, super::PLANE_TOLERANCE * largest).map_err(|flaw| {
        let at = flaw.face().and_then(|face| fields.get(face));
        at.unwrap_or(list).error(flaw.to_string(), flaw.remedy())
    })
}

fn read_points(document: Document<'_>, root: &Table<'_>) -> Result<Vec<Point>, Diagnostic> {
    let Some(field) = root.optional("point") else {
        return Ok(Vec::new());
    };
    let mut names = Names::new(document, "points");
    field
        .tables("a point")?
        .into_iter()
        .map(|table| {
            let table = table.only(&["name", "position", "normal"])?;
            let name = names.read(&table, "name = \"desk-1\"")?;
            let position = table
                .required("position", "position = [1.0, 1.0, 0.8]")?
                .position("`position = [1.0, 1.0, 0.8]`")?;
            let field = table.required("normal", "normal = [0, 0, 1]")?;
            let normal = super::unit(field.vector("`normal = [0, 0, 1]`")?).ok_or_else(|| {
                field.error(
                    "the normal is zero",
                    "give the direction the point faces, such as [0, 0, 1] for up",
                )
            })?;
            Ok(Point {
                name,
                position,
                normal,
            })
        })
        .collect()
}
