//! The error table on a terminal.

use super::{Judged, Rendered, TagErrors};
use crate::compare::{Balance, Errors};
use crate::report::{ErrorRow, error_table, percent, quantity};
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
    let structured = rendered.surfaces.iter().flat_map(|surface| {
        let whole = ErrorRow {
            name: surface.name.to_owned(),
            samples: Some(surface.samples),
            emitters: Some(surface.emitters),
            error: surface.error,
        };
        [whole].into_iter().chain(by_tag(&surface.tags))
    });
    let structured: Vec<_> = structured
        .chain([all(rendered.error)])
        .chain(by_tag(&rendered.tags))
        .collect();
    let mut text = format!(
        "{}: structured sampling, {} samples, {} shots, {} form factors, {} % of the light unshot\n\n{}\n",
        rendered.scene,
        rendered.form_factor_samples,
        rendered.shots,
        rendered.form_factor_evaluations,
        percent(100.0 * f64::from(rendered.unshot)),
        error_table(&structured),
    );
    if let Some(evaluated) = &rendered.evaluated {
        text.push_str(&format!(
            "\nevaluated at each pixel by the kernel, without reconstruction{}\n\n{}\n",
            match evaluated.inexact {
                0 => String::new(),
                count => format!("; at {count} pixels visibility met a bound of the workspace"),
            },
            error_table(&[all(evaluated.error)]),
        ));
    }
    text.push_str(&balance(&rendered.balance));
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

/// A row for each tag, where there is more than one.
fn by_tag(tags: &[TagErrors]) -> impl Iterator<Item = ErrorRow> {
    let several = if tags.len() > 1 { tags } else { &[] };
    several.iter().map(|of| ErrorRow {
        name: format!("  {} {} %", of.tag, percent(of.share)),
        samples: of.samples,
        emitters: None,
        error: of.error,
    })
}

/// Where the light went, in parts of what was shot.
fn balance(balance: &Balance) -> String {
    let part = |power: f64| {
        let part = if balance.shot > 0.0 {
            100.0 * power / balance.shot
        } else {
            0.0
        };
        format!("{} ({} %)", quantity(power), percent(part))
    };
    format!(
        "\nbalance in {}: {} emitted, {} shot, {} unshot\n\
         of the shot {} received, {} on black fronts, {} on backs, {} left the scene, {} missing\n",
        balance.unit,
        quantity(balance.emitted),
        quantity(balance.shot),
        quantity(balance.unshot),
        part(balance.received),
        part(balance.elsewhere),
        part(balance.on_backs),
        part(balance.leaving),
        part(balance.missing),
    )
}
