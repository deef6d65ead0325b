//! Scenes with several luminaires, planned for every rung of emitters.

use glam::DVec3;
use isolux_host::bake::{self, Tables};
use isolux_host::occlusion::Occlusion;
use isolux_host::plan::{self, Plan};
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::{Scene, file, shipped};
use std::sync::OnceLock;

type Place = (DVec3, DVec3);

/// A scene and where its samples are.
pub(crate) struct Planned {
    pub(crate) scene: Scene,
    pub(crate) plan: Plan,
    occlusion: Option<Occlusion>,
}

impl Planned {
    /// Its tables.
    pub(crate) fn baked(&self) -> Tables {
        bake::bake(&self.scene, &self.plan, self.occlusion.clone()).expect("tables")
    }

    /// Its tables with codes in place of occluders.
    pub(crate) fn coded(&self) -> Tables {
        bake::bake_coded(&self.scene, &self.plan, self.occlusion.clone()).expect("tables")
    }

    /// Its tables with terms in place of occluders.
    pub(crate) fn matrix(&self, bits: u32) -> Tables {
        let occlusion = self.occlusion.clone();
        bake::bake_matrix(&self.scene, &self.plan, occlusion, bits).expect("tables")
    }

    /// The same in integers.
    pub(crate) fn matrix_in_integers(&self, bits: u32) -> Tables {
        let occlusion = self.occlusion.clone();
        bake::integers::bake_matrix(&self.scene, &self.plan, occlusion, bits).expect("tables")
    }

    /// Its tables with responses in place of all that reflects.
    pub(crate) fn vectors(&self) -> Tables {
        bake::bake_vectors(&self.scene, &self.plan, self.occlusion.clone()).expect("tables")
    }

    /// The same plan for a scene whose luminaires have these times their radiances.
    pub(crate) fn dimmed(&self, times: &[f64]) -> Self {
        let mut scene = self.scene.clone();
        let luminaires = scene.surfaces.iter_mut().filter(|surface| surface.emits());
        for (luminaire, times) in luminaires.zip(times) {
            luminaire.radiance = luminaire.radiance.map(|radiance| radiance * times);
        }
        self.with(scene)
    }

    /// The same plan for a scene whose surfaces have these times their reflectances.
    pub(crate) fn painted(&self, times: f64) -> Self {
        let mut scene = self.scene.clone();
        for surface in &mut scene.surfaces {
            surface.reflectance = surface.reflectance.map(|rho| rho * times);
        }
        self.with(scene)
    }

    fn with(&self, scene: Scene) -> Self {
        Self {
            scene,
            plan: self.plan.clone(),
            occlusion: self.occlusion.clone(),
        }
    }

    /// The radiances of its luminaires.
    pub(crate) fn radiances(&self) -> Vec<[f32; 3]> {
        let luminaires = self.scene.surfaces.iter().filter(|surface| surface.emits());
        luminaires
            .map(|luminaire| luminaire.radiance.map(|radiance| radiance as f32))
            .collect()
    }
}

/// The paper's scene with a second light, beside the first and smaller.
fn open(in_colour: bool) -> Scene {
    let (name, source) = shipped::ALL[0];
    let mut scene = file::parse(name, source).expect("a shipped scene");
    let mut second = scene.surfaces[1].clone();
    second.name = "second".to_owned();
    let corner = |x, y| DVec3::new(x, y, 1.9);
    second.vertices = vec![
        corner(-2.4, 1.0),
        corner(-0.6, 1.0),
        corner(-0.6, -1.2),
        corner(-2.4, -1.2),
    ];
    second.area = 1.8 * 2.2;
    second.radiance = [20.0; 3];
    scene.surfaces.push(second);
    if in_colour {
        scene.surfaces[0].reflectance = [0.7, 0.5, 0.1];
        scene.surfaces[3].radiance = [3.0, 9.0, 30.0];
    }
    scene
}

fn once(scene: &Scene) -> Reference {
    Reference::new(scene, Reflections::AtMost(1), &mut |_| {}).expect("a reference")
}

fn planned(scene: Scene, how: impl Fn(&Scene, &plan::Field<'_>) -> Plan) -> Planned {
    let light = once(&scene);
    let field = |places: &[Place]| light.irradiance_at(places);
    let plan = how(&scene, &field);
    Planned {
        scene,
        plan,
        occlusion: None,
    }
}

/// The bands of the paper.
pub(crate) fn bands(in_colour: bool) -> Planned {
    planned(open(in_colour), |scene, field| {
        plan::isolux(scene, &scene.budget, field).expect("a plan")
    })
}

/// Nested outlines.
pub(crate) fn layers() -> Planned {
    planned(open(false), |scene, field| {
        plan::layer_cake(scene, &scene.budget, field).expect("a plan")
    })
}

/// Samples that are the emitters.
pub(crate) fn points() -> Planned {
    planned(open(false), |scene, field| {
        let plan = plan::error_driven(scene, &scene.budget, field, &[]);
        plan.expect("a plan").expect("points hold")
    })
}

/// The office in few patches: four luminaires, a desk and many reflections.
pub(crate) fn office() -> &'static Planned {
    static OFFICE: OnceLock<Planned> = OnceLock::new();
    OFFICE.get_or_init(|| patches(shipped::OFFICE, 400))
}

/// The office in as many samples as its budget allows.
pub(crate) fn finer() -> &'static Planned {
    static OFFICE: OnceLock<Planned> = OnceLock::new();
    OFFICE.get_or_init(|| patches(shipped::OFFICE, 800))
}

/// The box with coloured walls in few patches.
pub(crate) fn coloured() -> &'static Planned {
    static CORNELL: OnceLock<Planned> = OnceLock::new();
    CORNELL.get_or_init(|| {
        let mut sources = shipped::ALL.iter();
        let found = sources.find(|(name, _)| *name == "cornell-rgb.toml");
        patches(found.expect("shipped").1, 250)
    })
}

fn patches(source: &str, samples: u64) -> Planned {
    let mut scene = file::parse("a room", source).expect("a shipped scene");
    scene.budget.samples = Some(samples);
    let direct = Reference::new(&scene, Reflections::AtMost(0), &mut |_| {}).expect("a reference");
    let field = |places: &[Place]| direct.irradiance_at(places);
    let plan = plan::patches::linear(&scene, &scene.budget, &field).expect("a plan");
    let occlusion = Occlusion::of(&scene).expect("few vertices");
    Planned {
        scene,
        plan,
        occlusion: Some(occlusion),
    }
}
