//! Which features the loops are compiled for.

/// As [`etendue_core::specialise!`], with four variants instead of one for every set of features: these loops are long to
/// compile, and the smallest variant that has all that a scene has is at most a few per cent slower than its own.
macro_rules! specialise {
    ($bits:expr, $HAS:ident => $body:expr) => {{
        use etendue_core::has::{ALL, CURVED, INFINITE, LOBES};
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
pub(crate) use specialise;
