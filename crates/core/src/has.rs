//! Which features a scene has, as bits that hot loops take as a const generic.
//!
//! A loop that is written `fn radiance<const HAS: u32>(..)` and asks `HAS & has::CURVED != 0` pays nothing for what a
//! scene lacks: the branch is resolved when the loop is compiled. [`specialise!`](crate::specialise) picks the variant,
//! once a pass.

/// Analytic spheres, disks or cylinders beside the triangles.
pub const CURVED: u32 = 1;
/// Instances, hence a two-level hierarchy.
pub const INSTANCES: u32 = 2;
/// Any scattering other than constant Lambert reflection (other lobes, mixtures).
pub const LOBES: u32 = 4;
/// Light from infinity: an environment or a directional light.
pub const INFINITE: u32 = 8;
/// Textures: a material's parameters or normals, or what a light emits, depend on where it is hit.
pub const TEXTURES: u32 = 16;
/// Absorption inside objects (Beer's law). Rare enough that such scenes run the loop that can do anything.
pub const MEDIA: u32 = 32;
/// Every bit: the loop that can do anything.
pub const ALL: u32 = 63;

/// Calls an expression with the scene's feature bits as a constant.
///
/// ```
/// fn loop_body<const HAS: u32>() -> bool {
///     HAS & etendue_core::has::LOBES != 0
/// }
/// let bits = etendue_core::has::LOBES | etendue_core::has::CURVED;
/// assert!(etendue_core::specialise!(bits, HAS => loop_body::<HAS>()));
/// ```
#[macro_export]
macro_rules! specialise {
    ($bits:expr, $HAS:ident => $body:expr) => {
        $crate::specialise!(@arms $bits, $HAS, $body,
            0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31)
    };
    (@arms $bits:expr, $HAS:ident, $body:expr, $($n:literal)*) => {
        match $bits {
            $($n => { const $HAS: u32 = $n; $body })*
            _ => { const $HAS: u32 = $crate::has::ALL; $body }
        }
    };
}

/// As [`specialise!`](crate::specialise), with four variants instead of one for every set of features: for loops that are
/// long to compile. The smallest variant that has all that a scene has is at most a few per cent slower than its own.
#[macro_export]
macro_rules! specialise_coarsely {
    ($bits:expr, $HAS:ident => $body:expr) => {{
        use $crate::has::{ALL, CURVED, INFINITE, LOBES};
        const INSIDE: u32 = CURVED | LOBES;
        const OUTSIDE: u32 = INSIDE | INFINITE;
        let bits: u32 = $bits;
        if bits == 0 {
            const $HAS: u32 = 0;
            $body
        } else if bits & !INSIDE == 0 {
            const $HAS: u32 = INSIDE;
            $body
        } else if bits & !OUTSIDE == 0 {
            const $HAS: u32 = OUTSIDE;
            $body
        } else {
            const $HAS: u32 = ALL;
            $body
        }
    }};
}
