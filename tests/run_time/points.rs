//! Named points, as the device reports them.

use crate::scenes;
use isolux::Error;
use isolux::error::What;
use isolux::form_factor::Best;
use isolux::luminance::{Constant, Linear};
use isolux::scene::Scene;
use isolux::shoot::{Light, Stop};
use isolux::transfer::{Matrix, Vectors};
use isolux::visibility::Exact;
use isolux_host::bake::Tables;
use isolux_host::solve::{self, Rung, Sight};

const STOP: Stop = Stop::below(1e-4);

fn solved(tables: &Tables) -> solve::Solution<'_> {
    solve::solve(tables, Rung::Best, Sight::Exact, STOP).expect("a solution")
}

/// A point is what its place is: the same emitters, added up as they shoot.
#[test]
fn a_point_is_what_is_evaluated_there() {
    let planned = scenes::office();
    let tables = planned.baked();
    let places = planned.scene.points.iter().map(|point| {
        let single = |v: glam::DVec3| v.as_vec3().to_array();
        (single(point.position), single(point.normal))
    });
    let places: Vec<_> = places.collect();
    assert_eq!(places.len(), 4);
    let solution = solved(&tables);
    let there = solution.at(&places).expect("receivers");
    let points = solution.points();
    assert_eq!(points.len(), places.len());
    for (point, there) in points.iter().zip(&there) {
        let off = (point[0] / there.value[0] - 1.0).abs();
        assert!(off < 1e-5, "{point:?} {there:?}");
    }
}

/// However terms are had, and whatever is on, a desk has what it has.
#[test]
fn points_agree_on_every_rung_of_transfer() {
    let planned = scenes::office();
    let exact = planned.baked();
    let nominal = planned.radiances();
    let others = [
        (planned.coded(), 5e-3),
        (planned.matrix(8), 2e-3),
        (planned.vectors(), 1e-3),
    ];
    for on in 0..nominal.len() {
        let lit = |tables: &Tables| {
            let mut solution = solved(tables);
            for (lamp, radiance) in nominal.iter().enumerate() {
                let level = if lamp == on { 1.0 } else { 0.1 };
                let radiance = radiance.map(|l| l * level);
                solution.set_radiance(lamp, radiance).expect("sound");
            }
            solution.update(STOP);
            solution.points()
        };
        let exact = lit(&exact);
        for (tables, most) in &others {
            for (got, exact) in lit(tables).iter().zip(&exact) {
                let off = (got[0] / exact[0] - 1.0).abs();
                assert!(off < *most, "{got:?} {exact:?}");
            }
        }
    }
}

#[test]
fn there_is_no_other_point() {
    let tables = scenes::office().vectors();
    let scene = Scene::load(tables.bytes()).expect("sound tables");
    assert_eq!(scene.points().len(), 4);
    let surfaces = scene.surfaces().len();
    assert_eq!(surfaces, scenes::office().scene.surfaces.len());
    assert!(scene.surface(surfaces).is_err());
    let light = Light::<Best, 1024, 8, Constant<f32>, Vectors>::new(scene).expect("room");
    for index in [4, usize::MAX] {
        let refused = Error::Unknown {
            what: What::Points,
            asked: index as u32,
            have: 4,
        };
        assert_eq!(light.point(index), Err(refused));
    }
}

/// A type reads the tables that were written for it, and no others.
#[test]
fn a_rung_reads_its_own_tables_alone() {
    type With<'t, L, V> = Light<'t, Best, 1024, 256, L, V>;
    let planned = scenes::office();
    let [exact, matrix, vectors] = [planned.baked(), planned.matrix(6), planned.vectors()];
    let scene = |tables: &'static Tables| Scene::load(tables.bytes()).expect("sound tables");
    let [exact, matrix, vectors] = [exact, matrix, vectors].map(|tables| {
        let tables: &'static Tables = Box::leak(Box::new(tables));
        scene(tables)
    });
    type Looking = Exact<32, 64, 256, 64>;
    assert!(With::<Linear<f32>, Matrix<6>>::new(matrix).is_ok());
    assert!(With::<Constant<f32>, Vectors>::new(vectors).is_ok());
    assert!(With::<Linear<f32>, Looking>::new(exact).is_ok());
    let refused = |what, needed, have| Some(Error::Capacity { what, needed, have });
    let bits = With::<Linear<f32>, Matrix<8>>::new(matrix).err();
    assert_eq!(bits, refused(What::Bits, 6, 8));
    let counts = matrix.counts();
    let looking = With::<Linear<f32>, Looking>::new(matrix).err();
    let fractions = refused(What::Fractions, counts.fractions, 0);
    assert_eq!(looking, fractions);
    let codes = With::<Linear<f32>, isolux::transfer::Codes>::new(matrix).err();
    assert_eq!(codes, refused(What::Terms, counts.terms, 0));
    let none = With::<Linear<f32>, Matrix<8>>::new(exact).err();
    assert!(matches!(
        none,
        Some(Error::Unknown {
            what: What::Terms,
            ..
        })
    ));
    let none = With::<Linear<f32>, Vectors>::new(exact).err();
    assert!(matches!(
        none,
        Some(Error::Unknown {
            what: What::Responses,
            ..
        })
    ));
    // Responses hold for the reflectances that they were computed for.
    type Painted<'t> = Light<'t, Best, 1024, 256, Constant<f32>, Vectors, 64>;
    let mut light = Painted::new(vectors).expect("room");
    let refused = light.set_reflectance(0, 0.5);
    assert!(matches!(
        refused,
        Err(Error::Unknown {
            what: What::Reflectances,
            ..
        })
    ));
}
