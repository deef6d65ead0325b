//! The error table on a terminal.

use super::{Judged, Rendered};
use crate::compare::Errors;
use crate::report::{ErrorRow, error_table, percent};
use std::path::Path;

pub(super) fn table(judged: &Judged<'_>, rendered: &Rendered<'_>, output: &Path) -> String {
    let all = |error: Errors| ErrorRow {
        name: if judged.camera.is_some() {
            "camera"
        } else {
            "all"
        }
        .to_owned(),
        samples: None,
        emitters: None,
        error,
    };
    let structured = rendered.surfaces.iter().map(|surface| ErrorRow {
        name: surface.name.to_owned(),
        samples: Some(surface.samples),
        emitters: Some(surface.emitters),
        error: surface.error,
    });
    let structured: Vec<_> = structured.chain([all(rendered.error)]).collect();
    let mut text = format!(
        "{}: structured sampling, {} samples, {} shots, {} form factors, {} % of the light unshot\n\n{}\n",
        rendered.scene,
        rendered.form_factor_samples,
        rendered.shots,
        rendered.form_factor_evaluations,
        percent(100.0 * f64::from(rendered.unshot)),
        error_table(&structured),
    );
    if let Some(classical) = &rendered.baseline {
        let rows = classical.surfaces.iter().map(|surface| ErrorRow {
            name: surface.name.to_owned(),
            samples: Some(surface.vertices),
            emitters: None,
            error: surface.error,
        });
        let rows: Vec<_> = rows.chain([all(classical.error)]).collect();
        text.push_str(&format!(
            "\nbeside it: ray-traced form factors, {} delta form factors\n\n{}\n",
            classical.delta_form_factors,
            error_table(&rows),
        ));
    }
    text.push_str(&format!(
        "\nreference: {}, {} reflections, accurate to {:.0e}\npictures in {}: {}\n",
        rendered.reference.name,
        rendered.reference.reflections,
        rendered.reference.accuracy,
        output.display(),
        rendered.files.join(", "),
    ));
    text
}
