//! The pictures: that they are drawn for realistic and for extreme inputs, say
//! what the numbers say, and are the same bytes each time.
//!
//! `ISOLUX_PICTURES=DIR cargo test --test pictures` keeps them in DIR to be
//! looked at.

#[path = "pictures/inputs.rs"]
mod inputs;

use std::path::PathBuf;

use glam::DVec3;
use inputs::*;
use isolux_host::compare;
use isolux_host::picture::{
    CameraView, EmitterShape, Picture, PictureError, camera_error_map, camera_false_colour,
    camera_picture, error_map, false_colour, samples, side_by_side,
};
use isolux_host::scene::Quantity;

/// Where pictures go: kept on request, otherwise gone with the returned guard.
fn write(picture: &Picture, name: &str) {
    let temporary = tempfile::tempdir().unwrap();
    let directory = std::env::var_os("ISOLUX_PICTURES").map_or(temporary.path().into(), |kept| {
        let kept = PathBuf::from(kept);
        std::fs::create_dir_all(&kept).unwrap();
        kept
    });
    let path = directory.join(name);
    picture.write(&path).unwrap();
    let decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(path).unwrap()));
    let reader = decoder.read_info().unwrap();
    let size = (reader.info().width as usize, reader.info().height as usize);
    assert_eq!(size, (picture.width(), picture.height()));
}

#[test]
fn surfaces_are_shown_in_false_colour() {
    let picture = false_colour(&receiver()).unwrap();
    assert!((900..1400).contains(&picture.width()), "{picture:?}");
    write(&picture, "false-colour-A.png");
    write(&false_colour(&floor()).unwrap(), "false-colour-floor.png");
}

#[test]
fn the_camera_is_shown_in_false_colour() {
    let view = view(1000, 640, exact);
    let title = "paper-simple: irradiance";
    let picture = camera_false_colour(&view, title, Quantity::Radiometric).unwrap();
    write(&picture, "false-colour-camera.png");
}

#[test]
fn the_camera_takes_a_picture_and_three_side_by_side() {
    let view_of = |shade: fn(usize, DVec3) -> f64| view(900, 600, shade);
    let views = [view_of(exact), view_of(structured), view_of(patches)];
    write(&camera_picture(&views[0]).unwrap(), "picture.png");
    let panels = [
        ("exact", &views[0]),
        ("structured sampling", &views[1]),
        ("ray-traced form factors", &views[2]),
    ];
    let picture = side_by_side(&panels, Quantity::Radiometric).unwrap();
    assert!((900..=1400).contains(&picture.width()), "{picture:?}");
    write(&picture, "side-by-side.png");
}

#[test]
fn samples_and_emitters_are_shown() {
    write(&samples(&plan()).unwrap(), "samples-A.png");
    let mut bare = plan();
    bare.emitters.clear();
    write(&samples(&bare).unwrap(), "samples-no-emitters.png");
    // A grid of many small emitters on a concave surface.
    let mut many = plan();
    many.name = "floor".to_owned();
    many.quantity = Quantity::Photometric;
    (many.low, many.size) = ([0.0, 0.0], [9.0, 6.0]);
    many.outline = FLOOR.to_vec();
    many.field = Some(floor());
    let corners = (0..54).map(|k| [f64::from(k % 9), f64::from(k / 9)]);
    let cells = corners.filter(|at| holds(&FLOOR, [at[0] + 0.5, at[1] + 0.5]));
    many.emitters = cells
        .map(|[x, y]| EmitterShape {
            loops: vec![vec![[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]]],
            radiosity: 100.0 / (1.0 + x),
        })
        .collect();
    write(&samples(&many).unwrap(), "samples-many.png");
}

#[test]
fn errors_are_shown_per_surface() {
    for reference in [receiver(), floor()] {
        let picture = error_map(&approximation(&reference), &reference).unwrap();
        write(&picture, &format!("error-{}.png", reference.name));
    }
}

#[test]
fn errors_are_shown_through_the_camera() {
    let reference = view(1000, 640, exact);
    let approximate = view(1000, 640, structured);
    let mut full_scale = [0.0; 3];
    for pixel in reference.pixels.iter().flatten() {
        full_scale[pixel.surface] = pixel.irradiance.max(full_scale[pixel.surface]);
    }
    // Part of the surface is too dark for a relative error.
    full_scale[1] *= 60.0;
    let title = "paper-simple: relative error against the reference";
    let picture = camera_error_map(&approximate, &reference, &full_scale, title).unwrap();
    write(&picture, "error-camera.png");
}

/// The colour of the map where the error is known tells its sign: the map's
/// left half is too bright (orange), its right half too dark (purple).
#[test]
fn the_sign_of_an_error_is_the_colour_of_the_map() {
    let reference = field("A", &SQUARE, 20, Quantity::Radiometric, |_| 1.0);
    let approximate = field("A", &SQUARE, 20, Quantity::Radiometric, |at| {
        if at[0] < 0.0 { 1.04 } else { 0.96 }
    });
    let picture = error_map(&approximate, &reference).unwrap();
    let left = picture.pixel(92 + 100, 500).unwrap();
    let right = picture.pixel(92 + 600, 500).unwrap();
    assert!(left[0] > left[2] + 40, "{left:?}");
    assert!(right[2] > right[0] + 20, "{right:?}");
}

#[test]
fn brighter_is_nearer_to_yellow() {
    let picture = false_colour(&receiver()).unwrap();
    // The peak lies at u = 1.2 of -2.5..2.5, v = 0; the dark corner at the left.
    let (x, y) = (92 + (3.7 / 5.0 * 760.0) as usize, 100 + 380);
    let [red, green, blue] = picture.pixel(x, y).unwrap();
    assert!(
        red > 180 && green > 200 && blue < 100,
        "{red} {green} {blue}"
    );
    let [red, _, blue] = picture.pixel(100, 840).unwrap();
    assert!(red < 90 && blue > 60, "{red} {blue}");
}

#[test]
fn the_same_numbers_give_the_same_bytes() {
    let png = || false_colour(&receiver()).unwrap().png().unwrap();
    assert_eq!(png(), png());
}

#[test]
fn the_extremes_have_pictures_too() {
    let thin = [[0.0, 0.0], [40.0, 0.0], [40.0, 0.05], [0.0, 0.05]];
    let tall = [[0.0, 0.0], [0.3, 0.0], [0.3, 30.0], [0.0, 30.0]];
    let shapes: [(&str, &[[f64; 2]]); 2] = [("thin", &thin), ("tall", &tall)];
    for (name, shape) in shapes {
        let field = field(name, shape, 40, Quantity::Photometric, |at| {
            500.0 / (1.0 + at[0] + at[1])
        });
        write(
            &false_colour(&field).unwrap(),
            &format!("extreme-{name}.png"),
        );
        write(
            &error_map(&field, &field).unwrap(),
            &format!("extreme-{name}-right.png"),
        );
    }
    for (name, value) in [
        ("dark", 0.0),
        ("even", 3.0),
        ("tiny", 1e-12),
        ("undefined", f64::NAN),
        ("infinite", f64::INFINITY),
    ] {
        let field = field("A", &SQUARE, 8, Quantity::Radiometric, |_| value);
        write(
            &false_colour(&field).unwrap(),
            &format!("extreme-{name}.png"),
        );
        write(
            &error_map(&field, &field).unwrap(),
            &format!("extreme-{name}-error.png"),
        );
    }
    let empty = CameraView {
        width: 3,
        height: 2,
        pixels: vec![None; 6],
    };
    write(&camera_picture(&empty).unwrap(), "extreme-empty.png");
    let picture = camera_false_colour(&empty, "empty", Quantity::Radiometric).unwrap();
    write(&picture, "extreme-empty-false-colour.png");
    let picture = camera_error_map(&empty, &empty, &[], "empty").unwrap();
    write(&picture, "extreme-empty-error.png");
    let one = field("one cell", &SQUARE, 1, Quantity::Radiometric, |_| 2.0);
    write(&false_colour(&one).unwrap(), "extreme-one-cell.png");
    let mut nothing = plan();
    nothing.samples.clear();
    nothing.emitters = vec![EmitterShape {
        loops: vec![vec![[0.0, 0.0]], vec![]],
        radiosity: f64::NAN,
    }];
    write(&samples(&nothing).unwrap(), "extreme-no-samples.png");
}

#[test]
fn what_does_not_fit_is_refused_in_words() {
    let refused = |result: Result<Picture, PictureError>, word: &str| {
        let message = result.unwrap_err().to_string();
        assert!(message.contains(word), "{message}");
    };
    let mut field = receiver();
    field.values.pop();
    refused(false_colour(&field), "39999 values");
    let mut field = receiver();
    field.size[1] = 0.0;
    refused(false_colour(&field), "bounding rectangle of A");
    field.size[1] = f64::NAN;
    refused(false_colour(&field), "bounding rectangle of A");
    let mut other = receiver();
    other.inside[0] = false;
    refused(error_map(&other, &receiver()), "same grid");

    let small = view(30, 20, exact);
    let large = view(40, 20, exact);
    refused(
        camera_error_map(&small, &large, &[1.0; 3], "errors"),
        "30 x 20",
    );
    refused(
        camera_error_map(&small, &small, &[1.0], "errors"),
        "full scales",
    );
    refused(side_by_side(&[], Quantity::Radiometric), "no views");
    let missing = CameraView {
        width: usize::MAX,
        height: 2,
        pixels: Vec::new(),
    };
    refused(camera_picture(&missing), "has 0 of them");
    let vast = CameraView {
        width: 9000,
        height: 1,
        pixels: vec![None; 9000],
    };
    refused(camera_picture(&vast), "each side must be 1 to 8192");
}

#[test]
fn the_caption_and_the_table_use_one_metric() {
    let reference = receiver();
    let approximate = approximation(&reference);
    let pairs = approximate
        .values
        .iter()
        .copied()
        .zip(reference.values.iter().copied());
    let scale = reference.values.iter().copied().fold(0.0, f64::max);
    let errors = compare::errors(pairs, scale);
    // The spot is 60 % too bright, plus at most 3 % of ripple.
    assert!(
        (errors.relative.max - 60.0).abs() < 5.0,
        "{}",
        errors.relative.max
    );
    assert!(errors.full_scale.max < errors.relative.max);
}
