//! One rung of the ladder alone, for what it takes of the flash: without the
//! package's default features and with one `rung-…` the form factor on that
//! rung, with `whole-kernel` besides all that a firmware calls in the kernel.
//! With no rung what every program has: start-up code and vector table.
//!
//! The program is linked, and never run.

#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]

#[cfg(target_os = "none")]
#[allow(dead_code, reason = "the integer rungs take no root")]
mod root;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This program is for the device; it is linked, and never run.");
    std::process::exit(2);
}

#[cfg(target_os = "none")]
#[allow(dead_code, unused_imports, reason = "one rung needs not all of it")]
mod target {
    use core::hint::black_box;

    use cortex_m as _; // the vector table's exceptions
    use isolux::Error;
    use isolux::form_factor::{self, Outline};
    use isolux::geometry::{Plane, Receiver};
    use isolux::resample::Row;
    use isolux::scene::Scene;
    use isolux::shoot::{Light, Solved, Stop};

    use crate::root::Chosen;

    /// No code depends on the capacities' values.
    type State<A> = Light<'static, A, 64, 16>;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        #[cfg(feature = "rung-libm")]
        libm::keep();
        #[cfg(feature = "rung-micromath")]
        micromath::keep();
        #[cfg(feature = "rung-poly3")]
        poly3::keep();
        #[cfg(feature = "rung-poly5")]
        poly5::keep();
        #[cfg(feature = "rung-poly8")]
        poly8::keep();
        #[cfg(feature = "rung-best")]
        best::keep();
        #[cfg(feature = "rung-q24")]
        q24::keep();
        #[cfg(feature = "rung-q29")]
        q29::keep();
        loop {
            cortex_m::asm::nop();
        }
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        loop {
            cortex_m::asm::nop();
        }
    }

    /// A rung in floating point: functions that are called by nobody the
    /// optimiser knows.
    macro_rules! float {
        ($feature:literal, $name:ident, $kernel:ty) => {
            #[cfg(feature = $feature)]
            mod $name {
                use super::*;

                fn form_factor(
                    receiver: &Receiver<f32>,
                    plane: &Plane<f32>,
                    outline: &Outline<'_, f32>,
                ) -> f32 {
                    let outlines = core::iter::once(*outline);
                    form_factor::of_loops::<$kernel, f32>(receiver, plane, outlines)
                }

                #[cfg(feature = "whole-kernel")]
                fn load(tables: &'static [u8]) -> Result<State<$kernel>, Error> {
                    Light::new(Scene::load(tables)?)
                }

                #[cfg(feature = "whole-kernel")]
                fn solve(light: &mut State<$kernel>, stop: Stop) -> Solved {
                    light.solve(stop)
                }

                #[cfg(feature = "whole-kernel")]
                fn resample(
                    light: &State<$kernel>,
                    surface: usize,
                    grid: [u32; 2],
                    row: u32,
                    out: &mut [f32],
                ) -> Result<Row, Error> {
                    light.resample_row::<Chosen>(surface, grid, row, out)
                }

                pub(super) fn keep() {
                    black_box(form_factor as fn(_, _, &Outline<'_, f32>) -> _);
                    #[cfg(feature = "whole-kernel")]
                    {
                        black_box(load as fn(_) -> _);
                        black_box(solve as fn(&mut _, _) -> _);
                        black_box(resample as fn(_, _, _, _, &mut _) -> _);
                    }
                }
            }
        };
    }

    float!("rung-libm", libm, form_factor::Libm<Chosen>);
    float!("rung-micromath", micromath, form_factor::Micromath);
    float!("rung-poly3", poly3, form_factor::Poly3<Chosen>);
    float!("rung-poly5", poly5, form_factor::Poly5<Chosen>);
    float!("rung-poly8", poly8, form_factor::Poly8<Chosen>);
    float!("rung-best", best, form_factor::Best<Chosen>);

    /// A rung in integers.
    macro_rules! fixed {
        ($feature:literal, $name:ident, $format:ident) => {
            #[cfg(feature = $feature)]
            mod $name {
                use super::*;
                use form_factor::fixed_point::{Plane, Receiver, of_loops, $format};

                fn form_factor(
                    receiver: &Receiver<$format>,
                    plane: &Plane,
                    outline: &[[i64; 3]],
                ) -> $format {
                    of_loops(receiver, plane, core::iter::once(outline))
                }

                #[cfg(feature = "whole-kernel")]
                type State = isolux::integers::Light<'static, $format, 64, 16>;

                #[cfg(feature = "whole-kernel")]
                fn load(tables: &'static [u8]) -> Result<State, Error> {
                    State::new(isolux::integers::Scene::load(tables)?)
                }

                #[cfg(feature = "whole-kernel")]
                fn solve(light: &mut State, stop: Stop) -> Solved {
                    let solved = light.solve(stop);
                    let radiance = light.radiance(solved.shots as usize);
                    match light.set_radiance(0, radiance) {
                        Ok(()) => light.update(stop),
                        Err(_) => solved,
                    }
                }

                #[cfg(feature = "whole-kernel")]
                fn resample(
                    light: &State,
                    surface: usize,
                    grid: [u32; 2],
                    row: u32,
                    out: &mut [i32],
                ) -> Result<Row, Error> {
                    light.resample_row(surface, grid, row, out)
                }

                #[cfg(feature = "whole-kernel")]
                fn at(light: &State, position: [f32; 3], normal: [f32; 3]) -> Result<u64, Error> {
                    let receiver = light.scene().receiver(position, normal)?;
                    Ok(light.at(&receiver))
                }

                pub(super) fn keep() {
                    black_box(form_factor as fn(_, _, &[[i64; 3]]) -> _);
                    #[cfg(feature = "whole-kernel")]
                    {
                        black_box(load as fn(_) -> _);
                        black_box(solve as fn(&mut _, _) -> _);
                        black_box(resample as fn(_, _, _, _, &mut _) -> _);
                        black_box(at as fn(&_, _, _) -> _);
                    }
                }
            }
        };
    }

    fixed!("rung-q24", q24, Q24);
    fixed!("rung-q29", q29, Q29);
}
