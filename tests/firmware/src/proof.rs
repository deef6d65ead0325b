//! The proof that no panic can be reached from the kernel.
//!
//! The panic handler calls a function that exists nowhere. Every entry point of
//! the kernel is here as a function of its own that is called by nobody the
//! optimiser knows, so it can assume nothing of the arguments. If any of them
//! could panic, the handler would stay in the program and the link would fail
//! for the missing symbol; this program links, so none can. `--features bad`
//! adds one that can, and must not link; `--features unbounded` adds functions
//! whose stack has no bound, and the gate on the stack must refuse each.
//!
//! The program is never run. No logger is in it: its own panics would be found.

#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]

#[cfg(target_os = "none")]
mod root;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This program is for the device; it is linked, and never run.");
    std::process::exit(2);
}

#[cfg(target_os = "none")]
mod entries {
    use core::hint::black_box;

    use cortex_m as _; // the vector table's exceptions
    use isolux::clip::{self, Corners, Place};
    use isolux::form_factor::fixed_point::{self, Q24, Q29, Scale};
    use isolux::form_factor::{
        self, Baked, Best, Edge, Libm, Micromath, Outline, Poly3, Poly5, Poly8, of_baked_loops,
    };
    use isolux::geometry::{Plane, Receiver};
    use isolux::integers;
    use isolux::luminance::{Constant, Linear, Rgb};
    use isolux::number::{self, Root, SoftRoot};
    use isolux::resample::{self, Filtered, Reconstructed, Row, Stencils, Tensors};
    use isolux::scene::records::{self, Counts, Emitter, Surface};
    use isolux::scene::{Scene, parts, required_bytes};
    use isolux::shoot::{self, Solved, Stop};
    use isolux::transfer::{Codes, Matrix, Vectors};
    use isolux::visibility::records::{Blocker, Occluders, Target};
    use isolux::visibility::{
        Bracket, Exact, Gathered, Polygons, Unoccluded, VertexRays, Visibility,
    };
    use isolux::{Error, budget};

    use crate::root::Chosen;

    unsafe extern "C" {
        /// Defined nowhere: whoever needs it does not link.
        fn isolux_panic_is_reachable() -> !;
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        // SAFETY: never executed, because a program that contains this call
        // does not link.
        unsafe { isolux_panic_is_reachable() }
    }

    /// Capacities of the proof; no code depends on their values.
    type Light<'t, A> = shoot::Light<'t, A, 64, 16>;
    type FixedLight<'t> = integers::Light<'t, Q29, 64, 16>;
    /// The other rung of both ladders, so that each is here once.
    type ShortMatrix<'t> = integers::Light<'t, Q24, 64, 16, integers::Matrix<8>>;
    type BestLight<'t> = Light<'t, Best<Chosen>>;
    type LibmLight<'t> = Light<'t, Libm<Chosen>>;
    /// What `open` firmware has: no emitter is a point, nothing hides any.
    type PolygonsLight<'t> = shoot::Light<'t, Best<Chosen>, 64, 16, Constant<f32>, Polygons>;
    type CodedLight<'t> = shoot::Light<'t, Best<Chosen>, 64, 16, Linear<f32>, Codes>;

    /// Reflectances that may change, in colour.
    type ColouredLight<'t> = shoot::Light<'t, Best<Chosen>, 64, 16, Constant<Rgb>, Unoccluded, 8>;

    type MatrixLight<'t> = shoot::Light<'t, Best<Chosen>, 64, 16, Linear<f32>, Matrix<8>>;
    type TightLight<'t> = shoot::Light<'t, Best<Chosen>, 64, 16, Linear<Rgb>, Matrix<6>>;
    type VectorsLight<'t> = shoot::Light<'t, Best<Chosen>, 64, 16, Constant<Rgb>, Vectors>;

    type Workspace = Exact<8, 4, 24, 6>;
    type WithMeshes = Reconstructed<'static, 'static, Stencils<Chosen>, f32>;
    type Grids = Reconstructed<'static, 'static, Tensors<Chosen>, f32>;

    /// Defines each entry, and `keep`, which hands their addresses to nobody
    /// knows whom.
    macro_rules! entries {
        ($($(#[$attribute:meta])* fn $name:ident($($argument:ident: $of:ty),* $(,)?) -> $gives:ty $body:block)*) => {
            $(
                $(#[$attribute])*
                #[inline(never)]
                #[unsafe(no_mangle)]
                fn $name($($argument: $of),*) -> $gives $body
            )*
            fn keep() {
                $(
                    $(#[$attribute])*
                    { black_box($name as fn($($of),*) -> $gives); }
                )*
            }
        };
    }

    entries! {
        fn isolux_entry_form_factor_best(receiver: &Receiver<f32>, vertices: &[[f32; 3]]) -> f32 {
            form_factor::form_factor::<Best<Chosen>, f32>(receiver, vertices)
        }
        fn isolux_entry_form_factor_best_software_root(receiver: &Receiver<f32>, vertices: &[[f32; 3]]) -> f32 {
            form_factor::form_factor::<Best<SoftRoot>, f32>(receiver, vertices)
        }
        fn isolux_entry_form_factor_libm(receiver: &Receiver<f32>, vertices: &[[f32; 3]]) -> f32 {
            form_factor::form_factor::<Libm<Chosen>, f32>(receiver, vertices)
        }
        fn isolux_entry_form_factor_libm_software_root(receiver: &Receiver<f32>, vertices: &[[f32; 3]]) -> f32 {
            form_factor::form_factor::<Libm<SoftRoot>, f32>(receiver, vertices)
        }
        fn isolux_entry_form_factor_poly3(receiver: &Receiver<f32>, vertices: &[[f32; 3]]) -> f32 {
            form_factor::form_factor::<Poly3<Chosen>, f32>(receiver, vertices)
        }
        fn isolux_entry_form_factor_poly5(receiver: &Receiver<f32>, vertices: &[[f32; 3]]) -> f32 {
            form_factor::form_factor::<Poly5<Chosen>, f32>(receiver, vertices)
        }
        fn isolux_entry_form_factor_poly8(receiver: &Receiver<f32>, vertices: &[[f32; 3]]) -> f32 {
            form_factor::form_factor::<Poly8<Chosen>, f32>(receiver, vertices)
        }
        fn isolux_entry_form_factor_micromath(receiver: &Receiver<f32>, vertices: &[[f32; 3]]) -> f32 {
            form_factor::form_factor::<Micromath, f32>(receiver, vertices)
        }
        // For hosts: with every operation a call it has no place beside all the rest.
        #[cfg(target_abi = "eabihf")]
        fn isolux_entry_form_factor_best_f64(receiver: &Receiver<f64>, vertices: &[[f64; 3]]) -> f64 {
            form_factor::form_factor::<Best<SoftRoot>, f64>(receiver, vertices)
        }
        fn isolux_entry_form_factor_of_two_loops(receiver: &Receiver<f32>, plane: &Plane<f32>, outline: &[[f32; 3]], hole: &[[f32; 3]]) -> f32 {
            let loops = [Outline::new(outline), Outline::new(hole)];
            form_factor::of_loops::<Best<Chosen>, f32>(receiver, plane, loops.into_iter())
        }
        fn isolux_entry_form_factor_q29(receiver: &fixed_point::Receiver<Q29>, vertices: &[[i64; 3]]) -> Q29 {
            fixed_point::form_factor(receiver, vertices)
        }
        fn isolux_entry_form_factor_q24(receiver: &fixed_point::Receiver<Q24>, vertices: &[[i64; 3]]) -> Q24 {
            fixed_point::form_factor(receiver, vertices)
        }
        fn isolux_entry_form_factor_q29_of_words(receiver: &fixed_point::Receiver<Q29>, vertices: &[[i32; 3]]) -> Q29 {
            fixed_point::form_factor(receiver, vertices)
        }
        fn isolux_entry_form_factor_q29_of_two_loops(receiver: &fixed_point::Receiver<Q29>, plane: &fixed_point::Plane, outline: &[[i64; 3]], hole: &[[i64; 3]]) -> Q29 {
            fixed_point::of_loops(receiver, plane, [outline, hole].into_iter())
        }
        fn isolux_entry_fixed_receiver(position: [i64; 3], normal: [i64; 3]) -> Result<fixed_point::Receiver<Q29>, Error> {
            fixed_point::Receiver::new(position, normal)
        }
        fn isolux_entry_fixed_plane(vertices: &[[i64; 3]]) -> fixed_point::Plane {
            fixed_point::Plane::of_polygon(vertices)
        }
        fn isolux_entry_fixed_scale(coordinates: &[f32]) -> Option<Scale> {
            Scale::of(coordinates.iter().copied())
        }
        fn isolux_entry_fixed_place(scale: Scale, place: [f32; 3]) -> [i64; 3] {
            scale.place(place)
        }
        fn isolux_entry_fixed_operations(a: Q29, b: Q29, constant: f64) -> Q29 {
            (a + b) * (a - b) / -b * number::Number::of(constant)
        }
        fn isolux_entry_receiver(position: [f32; 3], normal: [f32; 3]) -> Result<Receiver<f32>, Error> {
            Receiver::new::<Chosen>(position, normal)
        }
        fn isolux_entry_form_factor_baked(receiver: &Receiver<f32>, plane: &Plane<f32>, vertices: &[[f32; 3]], edges: &[Edge]) -> f32 {
            let baked = Baked::new(Outline::new(vertices), edges);
            of_baked_loops::<Chosen>(receiver, plane, baked.into_iter())
        }
        fn isolux_entry_edge(first: [f32; 3], from: [f32; 3], to: [f32; 3]) -> Edge {
            Edge::new(first, from, to)
        }
        fn isolux_entry_plane(vertices: &[[f32; 3]]) -> Plane<f32> {
            Plane::of_polygon(vertices)
        }
        fn isolux_entry_clip(places: &[Place<f32>], out: &mut Corners<f32, 8>) -> Result<(), Error> {
            clip::polygon(places.iter().copied(), out)
        }
        fn isolux_entry_turn_over_sine(z: f32) -> f32 {
            number::turn_over_sine::<6, f32>(z)
        }
        fn isolux_entry_residual_arctangent(w: f32) -> f32 {
            number::residual_arctangent(w)
        }
        fn isolux_entry_root(x: f32) -> f32 {
            SoftRoot::sqrt(x)
        }

        fn isolux_entry_load(tables: &'static [u8]) -> Result<Scene<'static>, Error> {
            Scene::load(tables)
        }
        fn isolux_entry_load_without_parts(tables: &'static [u8]) -> Result<Scene<'static>, Error> {
            Scene::load_with::<{ parts::NONE }>(tables)
        }
        fn isolux_entry_checksum(bytes: &[u8]) -> u32 {
            records::checksum(bytes)
        }
        fn isolux_entry_required_bytes(counts: &Counts) -> Option<u32> {
            required_bytes(counts)
        }
        fn isolux_entry_scene_surface(scene: &Scene<'static>, index: usize) -> Result<&'static Surface, Error> {
            scene.surface(index)
        }
        fn isolux_entry_scene_samples_of(scene: &Scene<'static>, surface: &Surface) -> (usize, usize) {
            let (first, places) = scene.samples_of(surface);
            (first, places.len())
        }
        fn isolux_entry_scene_members_of(scene: &Scene<'static>, emitter: &Emitter) -> usize {
            scene.members_of(emitter).count()
        }
        fn isolux_entry_scene_form_factor_best(scene: &Scene<'static>, receiver: &Receiver<f32>, emitter: &Emitter) -> f32 {
            scene.form_factor::<Best<Chosen>>(receiver, emitter)
        }
        fn isolux_entry_scene_form_factor_libm(scene: &Scene<'static>, receiver: &Receiver<f32>, emitter: &Emitter) -> f32 {
            scene.form_factor::<Libm<Chosen>>(receiver, emitter)
        }
        fn isolux_entry_budget(scene: &Scene<'static>) -> (u64, u64) {
            (budget::direct_form_factors(scene), budget::reflection_form_factors(scene))
        }

        fn isolux_entry_light_new(scene: Scene<'static>) -> Result<BestLight<'static>, Error> {
            Light::new(scene)
        }
        fn isolux_entry_light_darken(light: &mut BestLight<'static>) -> () {
            light.darken();
        }
        fn isolux_entry_light_direct(light: &mut BestLight<'static>) -> () {
            light.direct();
        }
        fn isolux_entry_light_reflect(light: &mut BestLight<'static>) -> u32 {
            light.reflect()
        }
        fn isolux_entry_light_shoot(light: &mut BestLight<'static>) -> Option<usize> {
            light.shoot()
        }
        fn isolux_entry_light_solve(light: &mut BestLight<'static>, stop: Stop) -> Solved {
            light.solve(stop)
        }
        fn isolux_entry_light_set_radiance(light: &mut BestLight<'static>, luminaire: usize, radiance: f32) -> Result<(), Error> {
            light.set_radiance(luminaire, radiance)
        }
        fn isolux_entry_light_set_radiance_in_colour(light: &mut ColouredLight<'static>, luminaire: usize, radiance: Rgb) -> Result<(), Error> {
            light.set_radiance(luminaire, radiance)
        }
        fn isolux_entry_light_set_reflectance(light: &mut ColouredLight<'static>, surface: usize, reflectance: Rgb) -> Result<(), Error> {
            light.set_reflectance(surface, reflectance)
        }
        fn isolux_entry_light_radiance(light: &BestLight<'static>, luminaire: usize) -> f32 {
            light.radiance(luminaire)
        }
        fn isolux_entry_light_update(light: &mut BestLight<'static>, stop: Stop) -> Solved {
            light.update(stop)
        }
        fn isolux_entry_light_solve_in_colour(light: &mut ColouredLight<'static>, stop: Stop) -> Solved {
            light.solve(stop)
        }
        fn isolux_entry_light_update_in_colour(light: &mut ColouredLight<'static>, stop: Stop) -> Solved {
            light.update(stop)
        }
        fn isolux_entry_light_solve_polygons(light: &mut PolygonsLight<'static>, stop: Stop) -> Solved {
            light.solve(stop)
        }
        fn isolux_entry_light_new_coded(scene: Scene<'static>) -> Result<CodedLight<'static>, Error> {
            CodedLight::new(scene)
        }
        fn isolux_entry_light_solve_coded(light: &mut CodedLight<'static>, stop: Stop) -> Solved {
            light.solve(stop)
        }
        fn isolux_entry_light_new_matrix(scene: Scene<'static>) -> Result<MatrixLight<'static>, Error> {
            MatrixLight::new(scene)
        }
        fn isolux_entry_light_solve_matrix(light: &mut MatrixLight<'static>, stop: Stop) -> Solved {
            light.solve(stop)
        }
        fn isolux_entry_light_update_matrix_of_6_bits(light: &mut TightLight<'static>, stop: Stop) -> Solved {
            light.update(stop)
        }
        fn isolux_entry_light_new_vectors(scene: Scene<'static>) -> Result<VectorsLight<'static>, Error> {
            VectorsLight::new(scene)
        }
        fn isolux_entry_light_update_vectors(light: &mut VectorsLight<'static>, stop: Stop) -> Solved {
            light.update(stop)
        }
        fn isolux_entry_light_point(light: &BestLight<'static>, index: usize) -> Result<f32, Error> {
            light.point(index)
        }
        fn isolux_entry_light_solve_libm(light: &mut LibmLight<'static>, stop: Stop) -> Solved {
            light.solve(stop)
        }
        fn isolux_entry_light_unshot_fraction(light: &BestLight<'static>) -> f32 {
            light.unshot_fraction()
        }
        fn isolux_entry_light_radiosity(light: &BestLight<'static>, emitter: usize) -> Constant<f32> {
            light.radiosity(emitter)
        }
        fn isolux_entry_light_at(light: &BestLight<'static>, receiver: &Receiver<f32>) -> f32 {
            light.at(receiver)
        }
        fn isolux_entry_light_at_libm(light: &LibmLight<'static>, receiver: &Receiver<f32>) -> f32 {
            light.at(receiver)
        }
        fn isolux_entry_light_resample_row(light: &BestLight<'static>, surface: usize, grid: [u32; 2], row: u32, out: &mut [f32]) -> Result<Row, Error> {
            light.resample_row::<Chosen>(surface, grid, row, out)
        }
        fn isolux_entry_light_resample_at(light: &BestLight<'static>, surface: usize, place: [f32; 2]) -> Result<Option<Filtered<f32>>, Error> {
            light.resample_at::<Chosen>(surface, place)
        }
        fn isolux_entry_light_reconstruct(light: &BestLight<'static>, surface: usize, room: &'static mut [f32]) -> Result<WithMeshes, Error> {
            light.reconstruct::<Stencils<Chosen>>(surface, room)
        }
        fn isolux_entry_light_reconstructed(light: &BestLight<'static>, surface: usize, room: &'static [f32]) -> Result<WithMeshes, Error> {
            light.reconstructed::<Stencils<Chosen>>(surface, room)
        }
        fn isolux_entry_light_reconstruct_grids(light: &BestLight<'static>, surface: usize, room: &'static mut [f32]) -> Result<Grids, Error> {
            light.reconstruct::<Tensors<Chosen>>(surface, room)
        }
        fn isolux_entry_reconstructed_row(surface: &WithMeshes, grid: [u32; 2], row: u32, out: &mut [f32]) -> Result<(), Error> {
            surface.row(grid, row, out)
        }
        fn isolux_entry_reconstructed_at(surface: &WithMeshes, place: [f32; 2]) -> f32 {
            surface.at(place)
        }
        fn isolux_entry_reconstructed_row_of_grids(surface: &Grids, grid: [u32; 2], row: u32, out: &mut [f32]) -> Result<(), Error> {
            surface.row(grid, row, out)
        }
        fn isolux_entry_reconstructed_at_grids(surface: &Grids, place: [f32; 2]) -> f32 {
            surface.at(place)
        }
        fn isolux_entry_fields_room(scene: &Scene<'static>, surface: &Surface) -> usize {
            scene.fields().room(surface)
        }
        fn isolux_entry_budget_room_bytes(counts: &Counts) -> usize {
            budget::room_bytes(counts)
        }
        fn isolux_entry_cone(places: &[[f32; 2]], values: &[f32], place: [f32; 2], radius: f32) -> Option<Filtered<f32>> {
            resample::cone::<Chosen, f32>(places, values, place, radius)
        }

        fn isolux_entry_integers_load(tables: &'static [u8]) -> Result<integers::Scene<'static>, Error> {
            integers::Scene::load(tables)
        }
        fn isolux_entry_integers_required_bytes(counts: &Counts) -> Option<u32> {
            integers::required_bytes(counts)
        }
        fn isolux_entry_integers_place(surface: &integers::Surface, place: [i32; 2]) -> [i64; 3] {
            surface.place(place)
        }
        fn isolux_entry_integers_receiver(scene: &integers::Scene<'static>, position: [f32; 3], normal: [f32; 3]) -> Result<fixed_point::Receiver<Q29>, Error> {
            scene.receiver(position, normal)
        }
        fn isolux_entry_integers_receiver_at(scene: &integers::Scene<'static>, position: [i64; 3], normal: [i64; 3]) -> Result<fixed_point::Receiver<Q29>, Error> {
            scene.receiver_at(position, normal)
        }
        fn isolux_entry_integers_form_factor(scene: &integers::Scene<'static>, receiver: &fixed_point::Receiver<Q29>, emitter: &integers::Emitter) -> Q29 {
            scene.form_factor(receiver, emitter)
        }
        fn isolux_entry_integers_new(scene: integers::Scene<'static>) -> Result<FixedLight<'static>, Error> {
            FixedLight::new(scene)
        }
        fn isolux_entry_integers_darken(light: &mut FixedLight<'static>) -> () {
            light.darken();
        }
        fn isolux_entry_integers_direct(light: &mut FixedLight<'static>) -> u32 {
            light.direct()
        }
        fn isolux_entry_integers_reflect(light: &mut FixedLight<'static>) -> u32 {
            light.reflect()
        }
        fn isolux_entry_integers_shoot(light: &mut FixedLight<'static>) -> Option<usize> {
            light.shoot()
        }
        fn isolux_entry_integers_solve(light: &mut FixedLight<'static>, stop: Stop) -> Solved {
            light.solve(stop)
        }
        fn isolux_entry_integers_solve_matrix_q24(light: &mut ShortMatrix<'static>, stop: Stop) -> Solved {
            light.solve(stop)
        }
        fn isolux_entry_integers_unshot_fraction(light: &FixedLight<'static>) -> f32 {
            light.unshot_fraction()
        }
        fn isolux_entry_integers_radiosity(light: &FixedLight<'static>, emitter: usize) -> i32 {
            light.radiosity(emitter)
        }
        fn isolux_entry_integers_point(light: &FixedLight<'static>, index: usize) -> Result<i32, Error> {
            light.point(index)
        }
        fn isolux_entry_integers_set_radiance(light: &mut FixedLight<'static>, luminaire: usize, radiance: f32) -> Result<(), Error> {
            light.set_radiance(luminaire, radiance)
        }
        fn isolux_entry_integers_radiance(light: &FixedLight<'static>, luminaire: usize) -> f32 {
            light.radiance(luminaire)
        }
        fn isolux_entry_integers_update(light: &mut FixedLight<'static>, stop: Stop) -> Solved {
            light.update(stop)
        }
        fn isolux_entry_integers_new_matrix(scene: integers::Scene<'static>) -> Result<ShortMatrix<'static>, Error> {
            ShortMatrix::new(scene)
        }
        fn isolux_entry_integers_update_matrix_q24(light: &mut ShortMatrix<'static>, stop: Stop) -> Solved {
            light.update(stop)
        }
        fn isolux_entry_integers_terms_of_6_bits(scene: &integers::Scene<'static>, emitter: usize, first: u32, radiosity: [i32; 3], values: &mut [i32]) -> bool {
            <integers::Matrix<6> as integers::Transfer>::add(scene, emitter, first, radiosity, values)
        }
        fn isolux_entry_integers_coefficients_matrix(light: &ShortMatrix<'static>, emitter: usize) -> [i32; 3] {
            light.coefficients(emitter)
        }
        fn isolux_entry_integers_at(light: &FixedLight<'static>, receiver: &fixed_point::Receiver<Q29>) -> u64 {
            light.at(receiver)
        }
        fn isolux_entry_integers_resample_row(light: &FixedLight<'static>, surface: usize, grid: [u32; 2], row: u32, out: &mut [i32]) -> Result<Row, Error> {
            light.resample_row(surface, grid, row, out)
        }
        fn isolux_entry_integers_resample_at(light: &FixedLight<'static>, surface: usize, place: [i32; 2]) -> Result<Option<Filtered<i32>>, Error> {
            light.resample_at(surface, place)
        }
        fn isolux_entry_integers_cone(places: &[[i32; 2]], values: &[i32], place: [i32; 2], radius: u32) -> Option<Filtered<i32>> {
            integers::cone(places, values, place, radius)
        }

        fn isolux_entry_visibility_gather(exact: &mut Workspace, receiver: &Receiver<f32>, target: &Target<'static>, occluders: &Occluders<'static>, blockers: &[Blocker]) -> Gathered {
            exact.gather(receiver, target, occluders, blockers.iter().copied())
        }
        fn isolux_entry_visibility_fold(exact: &mut Workspace) -> (f32, f32) {
            let seen = exact.fold(0.0, |sum, piece| {
                *sum += piece.corners().iter().fold(0.0, |sum, [a, b]| sum + a * b);
            });
            (seen.visible, seen.unresolved)
        }
        fn isolux_entry_visibility_exact(exact: &mut Workspace, receiver: &Receiver<f32>, target: &Target<'static>, occluders: &Occluders<'static>, blockers: &[Blocker], whole: f32) -> Bracket<f32> {
            let blockers = blockers.iter().copied();
            Visibility::form_factor::<Chosen>(exact, receiver, target, occluders, blockers, || whole)
        }
        fn isolux_entry_visibility_vertex_rays(receiver: &Receiver<f32>, target: &Target<'static>, occluders: &Occluders<'static>, blockers: &[Blocker], whole: f32) -> Bracket<f32> {
            let blockers = blockers.iter().copied();
            VertexRays.form_factor::<Chosen>(receiver, target, occluders, blockers, || whole)
        }

        #[cfg(feature = "bad")]
        fn isolux_entry_bad(values: &[f32], index: usize) -> f32 {
            values[index]
        }
    }

    /// What no bound of the stack follows from: the gate must refuse each.
    #[cfg(feature = "unbounded")]
    mod unbounded {
        use core::arch::naked_asm;
        use core::hint::black_box;

        /// Calls itself.
        #[inline(never)]
        #[unsafe(no_mangle)]
        fn isolux_unbounded_recursion(depth: u32) -> u32 {
            match depth {
                0 => 0,
                depth => 1 + black_box(isolux_unbounded_recursion(depth >> 1)),
            }
        }

        /// Calls whatever it is given.
        #[inline(never)]
        #[unsafe(no_mangle)]
        fn isolux_unbounded_pointer(function: fn(u32) -> u32) -> u32 {
            1 + function(1)
        }

        /// Takes as much stack as it is told.
        #[unsafe(naked)]
        #[unsafe(no_mangle)]
        extern "C" fn isolux_unbounded_step(bytes: u32) -> u32 {
            naked_asm!("mov r1, sp", "sub.w sp, sp, r0", "mov sp, r1", "bx lr")
        }

        /// Reaches one of them through a function that is bounded by itself.
        #[inline(never)]
        #[unsafe(no_mangle)]
        fn isolux_unbounded_below(depth: u32) -> u32 {
            2 * black_box(isolux_unbounded_recursion(depth | 1))
        }

        pub(super) fn keep() {
            black_box(isolux_unbounded_recursion as fn(u32) -> u32);
            black_box(isolux_unbounded_pointer as fn(fn(u32) -> u32) -> u32);
            black_box(isolux_unbounded_step as extern "C" fn(u32) -> u32);
            black_box(isolux_unbounded_below as fn(u32) -> u32);
        }
    }

    #[cortex_m_rt::entry]
    fn main() -> ! {
        keep();
        #[cfg(feature = "unbounded")]
        unbounded::keep();
        loop {
            cortex_m::asm::nop();
        }
    }
}
