//! Scattering at a vertex in the world: the BSDF in its shading frame, with what shading normals and reliefs change.
//!
//! A direction `w` is looked up as `T(w)`: `w` where the shading normal `ns` and the geometric normal `ng` see it on the same
//! side, its antipode `-w` elsewhere. `T` is its own inverse, preserves solid angles and `|w.ns|`, and puts `T(w)` on that
//! side of `ns` on which `w` is of `ng`. So the surface itself decides what reflects and what transmits, every direction has
//! a value, and the adjoint of [Veach 1997, eq. 5.19] stays one: `f(wo, wi) = f_s(T wo, T wi)`, sampled as `T` of what
//! `f_s` samples from `T wo`, with the same density.

use super::{SurfaceVertex, frame_about, transmittance};
use crate::{
    bsdf::{BsdfSample, TransportMode, shading_correction},
    frame::Frame,
    geometry::Surface,
    has,
    relief::Tilt,
    rgb::Rgb,
    scene::Scene,
    warp::{ONE_MINUS_EPSILON, cosine_hemisphere_pdf, sample_cosine_hemisphere},
};
use glam::{Vec2, Vec3};

/// Share of the samples of a path from a light that are taken with a relief's other normal: with which normal it is seen
/// depends on the direction to the viewer, which is known only once it is sampled.
const TURNED: f32 = 0.25;

/// Share of the samples of a path from a light that follow the cosine to the geometric normal, where the surface is a
/// single Lambert lobe.
///
/// Such a path carries `f |wi.ng|`; sampled by `|wi.ns|` alone, its second moment diverges where `wi.ns` approaches 0.
const GEOMETRIC_LAMBERT: f32 = 0.5;

/// The same for lobes of which a part is diffuse.
const GEOMETRIC_MIXED: f32 = 0.25;

/// `T(w)` for the shading normal `ns` and the geometric normal `ng`; its own inverse.
#[inline]
pub(super) fn folded(w: Vec3, ns: Vec3, ng: Vec3) -> Vec3 {
    if w.dot(ns) * w.dot(ng) > 0.0 { w } else { -w }
}

/// `T(w)` in a frame about the shading normal, or about a relief's.
#[inline]
pub(super) fn local_of<const HAS: u32>(frame: &Frame, surface: &Surface, w: Vec3) -> Vec3 {
    let local = frame.to_local(w);
    // Without reliefs the frame stands on `ns`.
    let ns = if HAS & has::TEXTURES == 0 { local.z } else { w.dot(surface.ns) };
    if ns * w.dot(surface.ng) > 0.0 { local } else { -local }
}

impl SurfaceVertex {
    /// The transmittance of the straight segment of `distance` metres from here towards `wi`, nothing being between.
    #[inline]
    pub fn transmittance<const HAS: u32>(&self, scene: &Scene, wi: Vec3, distance: f32) -> Rgb {
        if HAS & has::MEDIA == 0 {
            return Rgb::WHITE;
        }
        transmittance(scene.medium_towards::<HAS>(&self.surface, self.wo, wi, self.medium), distance)
    }

    /// `T(w)` in the shading frame, for the world direction `w`.
    #[inline]
    fn local<const HAS: u32>(&self, w: Vec3) -> Vec3 {
        local_of::<HAS>(&self.frame, &self.surface, w)
    }

    /// The world direction whose `T` is `local` in the shading frame.
    #[inline]
    fn world<const HAS: u32>(&self, local: Vec3) -> Vec3 {
        let w = self.frame.to_world(local);
        let ns = if HAS & has::TEXTURES == 0 { local.z } else { w.dot(self.surface.ns) };
        if ns * w.dot(self.surface.ng) > 0.0 { w } else { -w }
    }

    /// Returns `true` if sampling a direction takes a number for the choice of a normal: on paths from lights, where the
    /// shading normal is not the geometric one.
    #[inline]
    pub(super) fn chooses_normal(&self, mode: TransportMode) -> bool {
        mode == TransportMode::Importance && (self.tilt.is_some() || self.frame.normal != self.surface.ng)
    }

    /// Share of samples that follow the cosine to the geometric normal.
    #[inline]
    fn geometric_share<const HAS: u32>(&self, mode: TransportMode) -> f32 {
        if mode == TransportMode::Radiance || self.frame.normal == self.surface.ng {
            0.0
        } else if HAS & has::LOBES == 0 || self.bsdf.is_lambert() {
            GEOMETRIC_LAMBERT
        } else if self.bsdf.has_diffuse() {
            GEOMETRIC_MIXED
        } else {
            0.0
        }
    }

    /// The density of both ways of sampling `wi`: `pdf_w` by the BSDF, and by the cosine to the geometric normal.
    #[inline]
    fn mixed_pdf(&self, share: f32, pdf_w: f32, wo: Vec3, wi: Vec3) -> f32 {
        if share == 0.0 {
            return pdf_w;
        }
        let (wo_ng, wi_ng) = (wo.dot(self.surface.ng), wi.dot(self.surface.ng));
        let cosine_pdf = if wo_ng * wi_ng > 0.0 { cosine_hemisphere_pdf(wi_ng.abs()) } else { 0.0 };
        (1.0 - share) * pdf_w + share * cosine_pdf
    }

    /// Samples the next direction: returns it in the world, as a sample in some frame about the surface, and the factor
    /// that the weight lacks.
    #[inline]
    pub(super) fn sample<const HAS: u32>(
        &self,
        u_lobe: f32,
        u: Vec2,
        mode: TransportMode,
    ) -> Option<(Vec3, BsdfSample, f32)> {
        if HAS & has::TEXTURES != 0
            && let Some(tilt) = &self.tilt
        {
            return self.sample_tilted::<HAS>(tilt, u_lobe, u, mode);
        }
        let share = self.geometric_share::<HAS>(mode);
        if share > 0.0 {
            return self.sample_mixed::<HAS>(share, u_lobe, u, mode);
        }
        self.sample_bsdf::<HAS>(u_lobe, u, mode)
    }

    /// [`SurfaceVertex::sample`] by the BSDF alone.
    #[inline]
    fn sample_bsdf<const HAS: u32>(
        &self,
        u_lobe: f32,
        u: Vec2,
        mode: TransportMode,
    ) -> Option<(Vec3, BsdfSample, f32)> {
        let sample = self.bsdf.sample::<HAS>(self.wo_local, u_lobe, u, mode)?;
        let wi = self.world::<HAS>(sample.wi);
        let straight = goes_straight::<HAS>(&sample, self.wo_local);
        Some((wi, sample, if straight { 1.0 } else { self.correction::<HAS>(wi, sample.wi, mode) }))
    }

    /// [`SurfaceVertex::sample`] by the cosine to the geometric normal with the probability `share`, else by the BSDF.
    fn sample_mixed<const HAS: u32>(
        &self,
        share: f32,
        u_lobe: f32,
        u: Vec2,
        mode: TransportMode,
    ) -> Option<(Vec3, BsdfSample, f32)> {
        let (wi, sample) = if u_lobe < share {
            let local = sample_cosine_hemisphere(u);
            let up = Frame::from_normal(self.surface.ng).to_world(local);
            let wi = if self.wo.dot(self.surface.ng) < 0.0 { -up } else { up };
            (wi, BsdfSample { wi: self.local::<HAS>(wi), weight: Rgb::BLACK, pdf_w: 0.0, delta: false, eta: 1.0 })
        } else {
            // What is left of the number chooses the lobe.
            let u_lobe = ((u_lobe - share) / (1.0 - share)).min(ONE_MINUS_EPSILON);
            let (wi, sample, factor) = self.sample_bsdf::<HAS>(u_lobe, u, mode)?;
            if sample.delta {
                let kept = 1.0 - share;
                return Some((wi, BsdfSample { pdf_w: sample.pdf_w * kept, ..sample }, factor / kept));
            }
            (wi, sample)
        };
        let (f_cos, pdf_w) = self.eval_pdf::<HAS>(wi, mode);
        (pdf_w > 0.0).then(|| (wi, BsdfSample { weight: f_cos * (1.0 / pdf_w), pdf_w, ..sample }, 1.0))
    }

    /// The factor of shading normals for light going from or to `wi`, in the world and as [`SurfaceVertex::local`]; 0 where a
    /// relief's normal sees `wi` or `wo` on another side than the surface does.
    #[inline]
    fn correction<const HAS: u32>(&self, wi: Vec3, wi_local: Vec3, mode: TransportMode) -> f32 {
        if HAS & has::TEXTURES == 0 && mode == TransportMode::Radiance {
            // After `T` both normals see both directions on one side.
            return 1.0;
        }
        shading_correction(mode, self.wo.dot(self.surface.ng), self.wo_local.z, wi.dot(self.surface.ng), wi_local.z)
    }

    /// Scattered `f |cos wi|` towards the world direction `wi`, and the density of sampling it.
    #[inline]
    pub fn eval_pdf<const HAS: u32>(&self, wi: Vec3, mode: TransportMode) -> (Rgb, f32) {
        if HAS & has::TEXTURES != 0
            && let Some(tilt) = &self.tilt
        {
            return self.eval_pdf_tilted::<HAS>(tilt, wi, mode);
        }
        let wi_local = self.local::<HAS>(wi);
        let (f, pdf_w) = self.bsdf.eval_pdf::<HAS>(self.wo_local, wi_local, mode);
        let pdf_w = self.mixed_pdf(self.geometric_share::<HAS>(mode), pdf_w, self.wo, wi);
        (f * (wi_local.z.abs() * self.correction::<HAS>(wi, wi_local, mode)), pdf_w)
    }

    /// The density per steradian with which a walk the other way, that comes from the world direction `wi`, samples `wo`.
    /// `mode` is that of this walk; delta lobes count nothing.
    #[inline]
    pub fn pdf_reverse<const HAS: u32>(&self, wi: Vec3, mode: TransportMode) -> f32 {
        if HAS & has::TEXTURES != 0
            && let Some(tilt) = &self.tilt
        {
            return self.pdf_reverse_tilted::<HAS>(tilt, wi, mode);
        }
        let pdf_w = self.bsdf.eval_pdf::<HAS>(self.local::<HAS>(wi), self.wo_local, mode).1;
        self.mixed_pdf(self.geometric_share::<HAS>(mode.reversed()), pdf_w, wi, self.wo)
    }
}

/// With a relief. All of it happens after `T`, as if the surface's own shading normal were its geometric one.
impl SurfaceVertex {
    /// The vertex as seen with one normal of the relief.
    #[inline]
    fn seen_with<const HAS: u32>(&self, normal: Vec3) -> SurfaceVertex {
        let frame = frame_about::<HAS>(&self.bsdf, normal, &self.surface);
        SurfaceVertex { frame, wo_local: frame.to_local(self.folded(self.wo)), tilt: None, ..*self }
    }

    /// `T(w)` in the world.
    #[inline]
    fn folded(&self, w: Vec3) -> Vec3 {
        folded(w, self.surface.ns, self.surface.ng)
    }

    /// [`SurfaceVertex::eval_pdf`].
    fn eval_pdf_tilted<const HAS: u32>(&self, tilt: &Tilt, wi: Vec3, mode: TransportMode) -> (Rgb, f32) {
        match mode {
            TransportMode::Radiance => {
                let (f_cos, pdf_w) = SurfaceVertex { tilt: None, ..*self }.eval_pdf::<HAS>(wi, mode);
                (f_cos * tilt.shadowing(wi), pdf_w)
            }
            TransportMode::Importance => {
                let seen = tilt.seen_from(self.folded(wi));
                let (mut value, mut density) = (Rgb::BLACK, 0.0);
                let normals = tilt.normals(self.folded(self.wo));
                for (normal, share) in normals.into_iter().zip([1.0 - TURNED, TURNED]) {
                    let (f_cos, pdf_w) = self.seen_with::<HAS>(normal).eval_pdf::<HAS>(wi, mode);
                    density += share * pdf_w;
                    if normal == seen {
                        value = f_cos * tilt.shadowing(self.wo);
                    }
                }
                (value, density)
            }
        }
    }

    /// [`SurfaceVertex::pdf_reverse`].
    fn pdf_reverse_tilted<const HAS: u32>(&self, tilt: &Tilt, wi: Vec3, mode: TransportMode) -> f32 {
        let turned_round = SurfaceVertex { wo: wi, ..*self };
        match mode {
            TransportMode::Radiance => turned_round.eval_pdf_tilted::<HAS>(tilt, self.wo, TransportMode::Importance).1,
            TransportMode::Importance => {
                let seen = turned_round.seen_with::<HAS>(tilt.seen_from(self.folded(wi)));
                seen.eval_pdf::<HAS>(self.wo, TransportMode::Radiance).1
            }
        }
    }

    /// [`SurfaceVertex::sample`].
    fn sample_tilted<const HAS: u32>(
        &self,
        tilt: &Tilt,
        u_lobe: f32,
        u: Vec2,
        mode: TransportMode,
    ) -> Option<(Vec3, BsdfSample, f32)> {
        if mode == TransportMode::Radiance {
            let (wi, sample, factor) = SurfaceVertex { tilt: None, ..*self }.sample::<HAS>(u_lobe, u, mode)?;
            let straight = goes_straight::<HAS>(&sample, self.wo_local);
            return Some((wi, sample, if straight { factor } else { factor * tilt.shadowing(wi) }));
        }
        let [first, second] = tilt.normals(self.folded(self.wo));
        // What is left of the number chooses the lobe.
        let (normal, share, u_lobe) = if u_lobe < TURNED {
            (second, TURNED, u_lobe / TURNED)
        } else {
            (first, 1.0 - TURNED, (u_lobe - TURNED) / (1.0 - TURNED))
        };
        let vertex = self.seen_with::<HAS>(normal);
        let (wi, sample, factor) = vertex.sample::<HAS>(u_lobe.min(ONE_MINUS_EPSILON), u, mode)?;
        if sample.delta {
            // Of the two normals, one has this direction; the other does not scatter into it.
            if tilt.seen_from(self.folded(wi)) != normal {
                return None;
            }
            let straight = goes_straight::<HAS>(&sample, vertex.wo_local);
            let shadowing = if straight { 1.0 } else { tilt.shadowing(self.wo) };
            let sample = BsdfSample { pdf_w: sample.pdf_w * share, ..sample };
            return Some((wi, sample, factor * shadowing / share));
        }
        let (f_cos, pdf_w) = self.eval_pdf_tilted::<HAS>(tilt, wi, mode);
        (pdf_w > 0.0).then(|| (wi, BsdfSample { weight: f_cos * (1.0 / pdf_w), pdf_w, ..sample }, 1.0))
    }
}

/// Returns `true` for light that passes straight through a mask or a thin sheet: it has met no boundary with a normal.
#[inline]
fn goes_straight<const HAS: u32>(sample: &BsdfSample, wo_local: Vec3) -> bool {
    HAS & has::LOBES != 0 && sample.delta && sample.wi == -wo_local
}
