//! Film files: a render's sums without a loss, so that it can be resumed, and rendered in parts.
//!
//! Layout, all numbers little-endian: the 16 bytes `etendue film 1\r\n`; `u32` length of the header; the header, JSON; for each
//! pixel, row by row from the top, three `i128` sums, three `i128` sums of squares and a `u32` count; the `u64` FNV-1a
//! hash of everything before it.

use crate::{
    clock::Cost,
    error::Error,
    files::{read_whole, write_whole},
    hash::Fnv,
    job::ImageKey,
};
use etendue_core::{
    film::{Film, PixelSums},
    filter::Filter,
    statistics::render::{Rays, RenderStatistics},
};
use serde::{Deserialize, Serialize};
use std::{
    io::Write,
    path::{Path, PathBuf},
};

/// How a film file begins.
const MAGIC: &[u8; 16] = b"etendue film 1\r\n";
/// Bytes of a pixel.
const PIXEL_BYTES: usize = 6 * size_of::<i128>() + size_of::<u32>();

/// Passes `first..end` with a seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Run {
    /// Seed.
    pub seed: u64,
    /// First pass.
    pub first: u32,
    /// One past the last pass.
    pub end: u32,
}

/// Counts of rays by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RayCounts {
    /// From the camera.
    pub camera: u64,
    /// Continuing a path.
    pub scatter: u64,
    /// Testing visibility.
    pub shadow: u64,
    /// From a light.
    pub light: u64,
}

impl RayCounts {
    /// All of them.
    pub fn total(&self) -> u64 {
        self.camera + self.scatter + self.shadow + self.light
    }

    fn add(&mut self, o: RayCounts) {
        self.camera += o.camera;
        self.scatter += o.scatter;
        self.shadow += o.shadow;
        self.light += o.light;
    }
}

impl From<Rays> for RayCounts {
    fn from(r: Rays) -> RayCounts {
        RayCounts { camera: r.camera, scatter: r.scatter, shadow: r.shadow, light: r.light }
    }
}

/// What passes cost and counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// Building.
    pub build: Cost,
    /// The passes alone.
    pub passes: Cost,
    /// Rays.
    pub rays: RayCounts,
    /// Rejected samples.
    pub rejected: u64,
}

impl Tally {
    /// That of a technique at work.
    pub fn new(build: Cost, passes: Cost, statistics: &RenderStatistics) -> Tally {
        Tally { build, passes, rays: statistics.rays.into(), rejected: statistics.rejected }
    }

    /// Adds another.
    pub fn add(&mut self, o: &Tally) {
        self.build += o.build;
        self.passes += o.passes;
        self.rays.add(o.rays);
        self.rejected += o.rejected;
    }

    /// Building and passes.
    pub fn total(&self) -> Cost {
        let mut total = self.build;
        total += self.passes;
        total
    }
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum FilterForm {
    Box,
    Tent { radius: f32 },
    Gaussian { stddev: f32 },
}

#[derive(Serialize, Deserialize)]
struct Header {
    key: ImageKey,
    filter: FilterForm,
    runs: Vec<Run>,
    tally: Tally,
}

/// A film with what it is of.
#[derive(Clone, Debug)]
pub struct FilmFile {
    /// What the image is of.
    pub key: ImageKey,
    /// The passes in it: in order, apart, and as few runs as can be.
    pub runs: Vec<Run>,
    /// What they cost.
    pub tally: Tally,
    /// Their sums.
    pub film: Film,
}

impl FilmFile {
    /// Number of passes.
    pub fn passes(&self) -> u32 {
        self.runs.iter().map(|r| r.end - r.first).sum()
    }

    /// Writes the file, whole or not at all.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let filter = match self.film.filter() {
            Filter::Box => FilterForm::Box,
            Filter::Tent { radius } => FilterForm::Tent { radius },
            Filter::Gaussian { stddev } => FilterForm::Gaussian { stddev },
        };
        let header = Header { key: self.key.clone(), filter, runs: self.runs.clone(), tally: self.tally };
        let header = serde_json::to_vec(&header).expect("the header has string keys alone");
        let mut bytes = Vec::with_capacity(MAGIC.len() + 12 + header.len() + self.film.raw().len() * PIXEL_BYTES);
        bytes.extend_from_slice(MAGIC);
        bytes.extend_from_slice(&(header.len() as u32).to_le_bytes());
        bytes.extend_from_slice(&header);
        for p in self.film.raw() {
            p.sum.iter().chain(&p.squares).for_each(|s| bytes.extend_from_slice(&s.to_le_bytes()));
            bytes.extend_from_slice(&p.count.to_le_bytes());
        }
        let hash = Fnv::of(&bytes).value();
        bytes.extend_from_slice(&hash.to_le_bytes());
        write_whole(path, |w| w.write_all(&bytes))
    }

    /// Reads a file.
    pub fn read(path: &Path) -> Result<FilmFile, Error> {
        decode(&read_whole(path)?).map_err(|reason| Error::Content { path: path.into(), reason })
    }

    /// Adds the passes of another film, exactly.
    pub fn merge(&mut self, other: &FilmFile) -> Result<(), String> {
        if let Some(difference) = self.key.difference(&other.key) {
            return Err(format!("is of something else: {difference}"));
        }
        let mut runs: Vec<Run> = self.runs.iter().chain(&other.runs).copied().collect();
        runs.sort_unstable();
        let mut joined: Vec<Run> = Vec::new();
        for run in runs {
            match joined.last_mut() {
                Some(last) if last.seed == run.seed && run.first < last.end => {
                    let seed = run.seed;
                    return Err(format!("pass {} of seed {seed} is in it and in another film already", run.first));
                }
                Some(last) if last.seed == run.seed && run.first == last.end => last.end = run.end,
                _ => joined.push(run),
            }
        }
        self.film.merge(&other.film).map_err(|e| e.to_string())?;
        self.runs = joined;
        self.tally.add(&other.tally);
        Ok(())
    }
}

/// Where the film of an image is kept: beside it, with the extension `film`.
pub fn film_path(image: &Path) -> PathBuf {
    image.with_extension("film")
}

fn decode(bytes: &[u8]) -> Result<FilmFile, String> {
    let truncated = || "is truncated: not a whole film file".to_owned();
    let rest = bytes.strip_prefix(MAGIC).ok_or("is not a film file")?;
    let (length, rest) = rest.split_first_chunk::<4>().ok_or_else(truncated)?;
    let length = u32::from_le_bytes(*length) as usize;
    let (header, rest) = rest.split_at_checked(length).ok_or_else(truncated)?;
    let (pixels, hash) = rest.split_last_chunk::<8>().ok_or_else(truncated)?;
    let header: Result<Header, _> = serde_json::from_slice(header);
    let whole = Fnv::of(&bytes[..bytes.len() - 8]).value() == u64::from_le_bytes(*hash);
    let header = header.map_err(|e| format!("is corrupt: its header is not valid ({e})"))?;
    let expected = u128::from(header.key.width) * u128::from(header.key.height) * PIXEL_BYTES as u128;
    if (pixels.len() as u128) < expected {
        return Err(truncated());
    }
    if !whole || pixels.len() as u128 != expected {
        return Err("is corrupt: its checksum is wrong".into());
    }
    let number = |pixel: &[u8], i: usize| {
        let bytes = pixel[16 * i..16 * i + 16].first_chunk().expect("a slice of sixteen bytes");
        i128::from_le_bytes(*bytes)
    };
    let sums = |pixel: &[u8]| PixelSums {
        sum: [0, 1, 2].map(|i| number(pixel, i)),
        squares: [3, 4, 5].map(|i| number(pixel, i)),
        count: u32::from_le_bytes(*pixel[96..].first_chunk().expect("four bytes are left")),
    };
    let filter = match header.filter {
        FilterForm::Box => Filter::Box,
        FilterForm::Tent { radius } => Filter::Tent { radius },
        FilterForm::Gaussian { stddev } => Filter::Gaussian { stddev },
    };
    if header.runs.iter().any(|r| r.first >= r.end) {
        return Err("is corrupt: it has a run without a pass".into());
    }
    let pixels = pixels.chunks_exact(PIXEL_BYTES).map(sums).collect();
    let film = Film::from_raw(header.key.size(), filter, pixels).map_err(|e| format!("is corrupt: {e}"))?;
    Ok(FilmFile { key: header.key, runs: header.runs, tally: header.tally, film })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    fn sample(seed: u64, first: u32, end: u32) -> FilmFile {
        let size = UVec2::new(3, 2);
        let filter = Filter::Tent { radius: 1.25 };
        let pixel = |i: i128| PixelSums {
            sum: [i << 70, 5, i128::MAX >> 3],
            squares: [1, i << 90, i128::MAX >> 3],
            count: end - first,
        };
        let key = ImageKey {
            scene: "s".into(),
            scene_hash: "00ff".into(),
            technique: "t".into(),
            knobs: [("k".to_owned(), 0.1)].into(),
            sampler: "independent".into(),
            parts: vec!["direct".into()],
            width: size.x,
            height: size.y,
            depth: u32::MAX,
        };
        let cost = Cost { seconds: 0.1, cpu_seconds: 0.2 };
        let rays = RayCounts { camera: 6, ..RayCounts::default() };
        FilmFile {
            key,
            runs: vec![Run { seed, first, end }],
            tally: Tally { build: cost, passes: cost, rays, rejected: 1 },
            film: Film::from_raw(size, filter, (0..6).map(pixel).collect()).unwrap(),
        }
    }

    #[test]
    fn round_trip() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.film");
        let film = sample(u64::MAX, 3, 9);
        film.write(&path).unwrap();
        let read = FilmFile::read(&path).unwrap();
        assert_eq!(read.film, film.film);
        assert_eq!((read.key, read.runs, read.tally), (film.key, film.runs, film.tally));
    }

    #[test]
    fn any_cut_and_any_flipped_bit_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.film");
        sample(1, 0, 4).write(&path).unwrap();
        let good = std::fs::read(&path).unwrap();
        for cut in 0..good.len() {
            assert!(decode(&good[..cut]).is_err(), "cut at {cut}");
        }
        assert!(decode(&good[..good.len() - 101]).unwrap_err().contains("truncated"));
        for i in 0..good.len() {
            let mut bad = good.clone();
            bad[i] ^= 1 << (i % 8);
            assert!(decode(&bad).is_err(), "byte {i}");
        }
    }

    #[test]
    fn runs_are_joined_and_overlaps_refused() {
        let mut film = sample(1, 0, 4);
        let error = film.merge(&sample(1, 3, 6)).unwrap_err();
        assert!(error.contains("pass 3 of seed 1"), "{error}");
        assert_eq!(film.passes(), 4);
        film.merge(&sample(2, 0, 4)).unwrap();
        film.merge(&sample(1, 4, 6)).unwrap();
        assert_eq!(film.runs, [Run { seed: 1, first: 0, end: 6 }, Run { seed: 2, first: 0, end: 4 }]);
        assert_eq!(film.tally.rejected, 3);
        let mut deeper = sample(3, 0, 1);
        deeper.key.depth = 2;
        assert!(film.merge(&deeper).unwrap_err().contains("depth"));
    }
}
