//! A region of an image in which errors are measured: where a part of the light is more than a share of it.

use crate::{
    error::Error,
    hash::derive_seed,
    job::{Job, Size, Wish},
    picture::Picture,
};
use etendue_core::technique::Part;
use std::{fmt, str::FromStr};

/// Passes that tell where a part of the light is.
const PASSES: u32 = 64;
/// Which of the seeds drawn from a study's seed is theirs: past those of the replicates and of the references.
const SEED_INDEX: u64 = (1 << 32) + 1;

/// The pixels of which a part of the light is more than a share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    part: Part,
    share: f32,
}

impl FromStr for Region {
    type Err = String;

    fn from_str(text: &str) -> Result<Region, String> {
        let (part, share) = text.split_once(':').ok_or("not PART:SHARE")?;
        let known = Part::ALL.map(Part::name).join(", ");
        let part = Part::ALL.into_iter().find(|p| p.name() == part);
        let part = part.ok_or_else(|| format!("the part of the light is not one of {known}"))?;
        let share = share.parse().ok().filter(|s: &f32| (0.0..1.0).contains(s));
        Ok(Region { part, share: share.ok_or("the share is not a number from 0 up to, but not, 1")? })
    }
}

impl fmt::Display for Region {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "where more than {} % of the light is {}", 100.0 * self.share, self.part.name())
    }
}

impl Region {
    /// Which pixels of a job's image are in it, given its reference.
    pub fn pixels(&self, job: &Job, reference: &Picture, seed: u64, threads: usize) -> Result<Vec<bool>, Error> {
        let wish = Wish {
            technique: etendue_bidir::BIDIR.name.into(),
            knobs: Vec::new(),
            sampler: "independent".into(),
            parts: vec![self.part.name().into()],
            size: Some(Size::Exact(job.key.size())),
            depth: Some(job.key.depth),
            load: job.load,
        };
        let mut engine = Job::load(&job.key.scene, &wish)?.build(threads, PASSES)?;
        let seed = derive_seed(seed, SEED_INDEX);
        (0..PASSES).for_each(|pass| engine.pass(seed, pass));
        let part = engine.film.mean_image();
        let above = |(part, all): (&etendue_core::rgb::Rgb, &etendue_core::rgb::Rgb)| {
            part.luminance() > self.share * all.luminance()
        };
        let inside: Vec<bool> = part.iter().zip(&reference.pixels).map(above).collect();
        if inside.contains(&true) {
            Ok(inside)
        } else {
            Err(Error::Input(format!("--region: there is no pixel in {} {self}", job.key.scene)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::wish;
    use etendue_core::rgb::Rgb;
    use etendue_scenes::LoadOptions;

    #[test]
    fn regions_are_parsed_and_named() {
        let region: Region = "caustic:0.25".parse().unwrap();
        assert_eq!(region, Region { part: Part::Caustic, share: 0.25 });
        assert_eq!(region.to_string(), "where more than 25 % of the light is caustic");
        for bad in ["caustic", "caustic:", "caustic:1", "caustic:-0.1", "caustic:NaN", "caustics:0.1", ":0.1", ""] {
            assert!(bad.parse::<Region>().is_err(), "{bad}");
        }
    }

    #[test]
    fn pixels_are_chosen_by_their_share_of_the_part() {
        let job = Job::load("ring", &wish(Some(Size::Longest(16)), None, LoadOptions::default())).unwrap();
        let image = |level: f32| Picture { size: job.key.size(), pixels: vec![Rgb::splat(level); 256] };
        let count = |share: f32, level: f32| {
            let pixels = Region { part: Part::Caustic, share }.pixels(&job, &image(level), 0, 1);
            pixels.map(|p| p.iter().filter(|inside| **inside).count())
        };
        let (any, much) = (count(0.0, 0.1).unwrap(), count(0.5, 0.1).unwrap());
        assert!(0 < much && much < any && any < 256, "{much} {any}");
        assert!(count(0.5, 1e6).is_err());
    }
}
