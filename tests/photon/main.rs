//! Photon mapping held against what must come out.

mod convergence;
mod identity;
mod leaks;
mod power;
