//! What a photon carries.

use crate::octahedral::Octahedral;
use etendue_core::{rgb::Rgb, technique::Part};

/// A photon as it is stored, 24 bytes; its place is the tree's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photon {
    /// Flux in watts.
    pub power: Rgb,
    /// Where it came from: the direction away from the surface, back along its way.
    pub wi: Octahedral,
    /// The surface's geometric normal on the side that it arrived on.
    pub normal: Octahedral,
    history: u32,
}

/// What happened to a photon on its way to where it is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PhotonHistory {
    /// Edges from the light.
    pub depth: u32,
    /// Whether any scattering on the way was by a lobe that is no delta.
    pub rough: bool,
    /// Whether the first scattering was by a delta lobe.
    pub delta_first: bool,
    /// Whether it comes from the environment.
    pub environment: bool,
}

const ROUGH: u32 = 1 << 31;
const DELTA_FIRST: u32 = 1 << 30;
const ENVIRONMENT: u32 = 1 << 29;

impl Photon {
    /// A photon.
    pub fn new(power: Rgb, wi: Octahedral, normal: Octahedral, history: PhotonHistory) -> Photon {
        let flag = |set, bit| if set { bit } else { 0 };
        let flags = flag(history.rough, ROUGH)
            | flag(history.delta_first, DELTA_FIRST)
            | flag(history.environment, ENVIRONMENT);
        Photon { power, wi, normal, history: flags | history.depth.min(ENVIRONMENT - 1) }
    }

    /// What happened to it.
    #[inline]
    pub fn history(&self) -> PhotonHistory {
        PhotonHistory {
            depth: self.history & (ENVIRONMENT - 1),
            rough: self.history & ROUGH != 0,
            delta_first: self.history & DELTA_FIRST != 0,
            environment: self.history & ENVIRONMENT != 0,
        }
    }
}

impl PhotonHistory {
    /// The part of the light that a path belongs to which leads from the camera to the photon, scattered by lobes that are no
    /// delta at the photon's place and at `rough` places before.
    #[inline]
    pub fn part(self, rough: u32) -> Part {
        match (self.delta_first, rough > 0 || self.rough) {
            (true, _) => Part::Caustic,
            (_, true) => Part::Indirect,
            (_, false) if self.environment => Part::Environment,
            _ => Part::Direct,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn what_happened_is_kept() {
        assert_eq!(size_of::<Photon>(), 24);
        for bits in 0..8 {
            for depth in [1, 2, 77, 1 << 20] {
                let history = PhotonHistory {
                    depth,
                    rough: bits & 1 != 0,
                    delta_first: bits & 2 != 0,
                    environment: bits & 4 != 0,
                };
                let up = Octahedral::new(Vec3::Y);
                assert_eq!(Photon::new(Rgb::WHITE, up, up, history).history(), history);
            }
        }
    }
}
