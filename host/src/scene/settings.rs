//! The parts of a scene file that are not geometry: rungs, camera, budget.

use super::diagnostic::{Diagnostic, nearest_name};
use super::document::{Field, Table, listed};
use super::rungs::LADDERS;
use super::{Budget, Camera, Rungs};

/// Smallest sine of the angle between the camera's view and its `up`.
const MIN_UP_SINE: f64 = 1e-6;

pub(crate) fn rungs(root: &Table<'_>) -> Result<Rungs, Diagnostic> {
    let mut rungs = Rungs::default();
    let Some(field) = root.optional("rungs") else {
        return Ok(rungs);
    };
    let table = field
        .table("the table `[rungs]`")?
        .only(&LADDERS.map(|ladder| ladder.name))?;
    for ladder in LADDERS {
        let Some(choice) = table.optional(ladder.name) else {
            continue;
        };
        let name = choice.string(&format!("`{} = \"{}\"`", ladder.name, ladder.rungs[0]))?;
        if !ladder.has(name) {
            let guess = nearest_name(name, ladder.rungs.iter().copied())
                .map_or(String::new(), |near| format!("did you mean `{near}`? "));
            return Err(choice.error(
                format!("unknown rung `{name}` of the ladder `{}`", ladder.name),
                format!("{guess}its rungs are {}", listed(ladder.rungs)),
            ));
        }
        if let Some(place) = rungs.choice_mut(ladder.name) {
            *place = Some(name.to_owned());
        }
    }
    Ok(rungs)
}

pub(crate) fn camera(root: &Table<'_>) -> Result<Option<Camera>, Diagnostic> {
    let Some(field) = root.optional("camera") else {
        return Ok(None);
    };
    let table = field
        .table("the table `[camera]`")?
        .only(&["eye", "target", "up", "fov"])?;
    let eye_field = table.required("eye", "eye = [0, -8, 3]")?;
    let eye = eye_field.position("`eye = [0, -8, 3]`")?;
    let target_field = table.required("target", "target = [0, 0, 1]")?;
    let target = target_field.position("`target = [0, 0, 1]`")?;
    let up_field = table.required("up", "up = [0, 0, 1]")?;
    let up = up_field.vector("`up = [0, 0, 1]`")?;
    let fov_field = table.required("fov", "fov = 40.0")?;
    let fov = fov_field.number("`fov = 40.0`")?;
    let Some(view) = super::unit(target - eye) else {
        return Err(target_field.error(
            "the camera's eye and target are the same place",
            "move the target to the middle of what the picture shall show",
        ));
    };
    let Some(up) = super::unit(up) else {
        return Err(up_field.error(
            "the camera's up is zero",
            "give the direction that is up in the picture, such as [0, 0, 1]",
        ));
    };
    if view.cross(up).length() < MIN_UP_SINE {
        return Err(up_field.error(
            "the camera's up is parallel to its view",
            "choose an up across the line from eye to target, such as [0, 1, 0] when looking along z",
        ));
    }
    if !(fov > 0.0 && fov < 180.0) {
        return Err(fov_field.error(
            format!("a field of view of {fov} degrees is not possible"),
            "give the vertical angle in degrees, more than 0 and less than 180, such as 40",
        ));
    }
    Ok(Some(Camera {
        eye,
        target,
        up,
        fov,
    }))
}

pub(crate) fn budget(root: &Table<'_>) -> Result<Budget, Diagnostic> {
    let Some(field) = root.optional("budget") else {
        return Ok(Budget::default());
    };
    let table = field
        .table("the table `[budget]`")?
        .only(&["ram", "flash", "samples"])?;
    let bytes_of = |key| table.optional(key).map(|field| bytes(&field)).transpose();
    let ram = bytes_of("ram")?;
    let flash = bytes_of("flash")?;
    let samples = table.optional("samples").map(|f| samples(&f)).transpose()?;
    Ok(Budget {
        ram,
        flash,
        samples,
    })
}

/// A number of bytes: an integer, or a string such as "16 KiB" or "128 kB".
/// KiB counts 1024 bytes, kB 1000.
pub fn parse_bytes(text: &str) -> Result<u64, String> {
    parse_size::parse_size(text).map_err(|error| match error {
        parse_size::Error::PosOverflow => format!("`{text}` is more bytes than can be counted"),
        _ => format!("`{text}` is not a number of bytes"),
    })
}

fn bytes(field: &Field<'_>) -> Result<u64, Diagnostic> {
    let remedy = "write a string such as \"16 KiB\" or \"128 kB\", or an integer number of bytes";
    let count = match (field.as_str(), field.as_integer()) {
        (Some(text), _) => parse_bytes(text).map_err(|message| field.error(message, remedy))?,
        (None, Some(integer)) => u64::try_from(integer).map_err(|_| {
            field.error(
                format!("{integer} is not a possible number of bytes"),
                remedy,
            )
        })?,
        (None, None) => return Err(field.error("this is not a number of bytes", remedy)),
    };
    if count == 0 {
        return Err(field.error(
            "a budget of 0 bytes holds no scene",
            "leave the key out where there is no limit",
        ));
    }
    Ok(count)
}

fn samples(field: &Field<'_>) -> Result<u64, Diagnostic> {
    field
        .as_integer()
        .and_then(|integer| u64::try_from(integer).ok())
        .filter(|&count| count > 0)
        .ok_or_else(|| {
            field.error(
                "`samples` must be a whole number of at least 1",
                "write it like `samples = 59`, or leave it out where there is no limit",
            )
        })
}
