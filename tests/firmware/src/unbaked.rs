//! What stands for a baked scene where the firmware was built without one.

use super::Root;

/// Nothing.
pub(crate) static TABLES: isolux::scene::Aligned<[u8; 0]> = isolux::scene::Aligned([]);

/// Values that a reconstruction needs room for.
pub(crate) const ROOM: usize = 0;

/// How radiosity varies over an emitter.
pub(crate) type Radiosity = isolux::luminance::Constant<f32>;

/// What a sample receives.
pub(crate) type Value = f32;

/// How surfaces are put together.
pub(crate) type Reconstruction = isolux::resample::Tensors<Root>;

/// The light.
pub(crate) type Light =
    isolux::shoot::Light<'static, isolux::form_factor::Best<Root>, 1, 1, Radiosity>;

/// The light of no scene.
pub(crate) const DARK: Light = isolux::shoot::Light::empty(isolux::visibility::Unoccluded);

/// Refuses.
pub(crate) fn load() -> Result<isolux::scene::Scene<'static>, isolux::Error> {
    isolux::scene::Scene::load(&TABLES.0)
}
