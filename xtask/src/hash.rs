//! Hashes that stay the same from build to build: FNV-1a of 64 bits [Fowler, Noll, Vo 1991].

use etendue_scenes::LoadedScene;
use std::fmt::{self, Write};

/// A running FNV-1a hash. Formatting into it hashes the text.
#[derive(Clone, Copy, Debug)]
pub struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Fnv {
        Fnv(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    /// Goes on with some bytes.
    pub fn add(&mut self, bytes: &[u8]) {
        for &b in bytes {
            self.0 = (self.0 ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// The hash of some bytes.
    pub fn of(bytes: &[u8]) -> Fnv {
        let mut hash = Fnv::default();
        hash.add(bytes);
        hash
    }

    /// As a number.
    pub fn value(self) -> u64 {
        self.0
    }

    /// As 16 hexadecimal digits.
    pub fn hex(self) -> String {
        format!("{:016x}", self.0)
    }
}

impl Write for Fnv {
    fn write_str(&mut self, s: &str) -> fmt::Result {
        self.add(s.as_bytes());
        Ok(())
    }
}

/// The hash of everything that a scene's image depends on, except what a render is told beside the scene (size, depth).
///
/// It is taken of the `Debug` form of the description, which holds every vertex and texel with all its digits, and so
/// does not care where a file lies or how it is written. The scene's name and the camera's resolution are left out.
pub fn scene_hash(scene: &LoadedScene) -> String {
    let mut hash = Fnv::default();
    let d = &scene.description;
    let camera = d.camera.as_ref().map(|c| (&c.projection, &c.to_world));
    let sources = (&d.lights, &d.environment);
    let world = (&d.materials, &d.objects, &d.groups, &d.instances);
    write!(hash, "{camera:?}{world:?}{sources:?}{:?}{}", scene.filter, scene.roulette_depth)
        .expect("a hash takes any text");
    // As shares of the film, so that the same part at another size is the same.
    if let Some((camera, crop)) = d.camera.as_ref().and_then(|c| Some((c, c.crop?))) {
        let share = |v: glam::UVec2| v.as_vec2() / camera.resolution.as_vec2();
        write!(hash, "{}{}", share(crop.offset), share(crop.size)).expect("a hash takes any text");
    }
    hash.hex()
}

/// A seed drawn from another and an index: the finaliser of SplitMix64 [Steele, Lea and Flood 2014, fig. 15].
///
/// For one seed, different indices give different seeds.
pub fn derive_seed(seed: u64, index: u64) -> u64 {
    let mix = |mut z: u64| {
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    mix(mix(seed).wrapping_add(index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn fnv_matches_its_published_vectors() {
        assert_eq!(Fnv::of(b"").value(), 0xcbf2_9ce4_8422_2325);
        assert_eq!(Fnv::of(b"a").value(), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(Fnv::of(b"foobar").value(), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn derived_seeds_differ() {
        let seeds: HashSet<u64> = (0..50).flat_map(|s| (0..50).map(move |i| derive_seed(s, i))).collect();
        assert_eq!(seeds.len(), 2500);
    }

    #[test]
    fn the_hash_sees_the_scene_and_not_its_name_or_size() {
        let scene = || etendue_scenes::load("cornell").unwrap();
        let base = scene_hash(&scene());
        let mut other = scene();
        other.description.name = "another".into();
        other.description.camera.as_mut().unwrap().resolution.x += 1;
        assert_eq!(scene_hash(&other), base);
        let mut moved = scene();
        moved.description.camera.as_mut().unwrap().to_world.translation.x += 1e-12;
        assert_ne!(scene_hash(&moved), base);
        let mut filtered = scene();
        filtered.filter = etendue_core::filter::Filter::Gaussian { stddev: 0.51 };
        assert_ne!(scene_hash(&filtered), base);
    }
}
