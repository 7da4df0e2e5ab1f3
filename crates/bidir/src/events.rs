//! What is told of a pair of paths.

use etendue_core::{
    lights::{DirectSample, EmissionSample},
    rgb::Rgb,
    technique::Part,
    walk::{Continuation, SurfaceVertex},
};
use glam::{Vec2, Vec3};

/// What happens while the two paths of a pixel are walked and joined. Who only wants an image listens to
/// [`Event::Contribution`]; the rest is for whoever looks into single paths.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// A walk leaves a light.
    Emission(&'a EmissionSample),
    /// A walk reaches a surface.
    Vertex(Side, &'a SurfaceVertex),
    /// It goes on from there.
    Step(Side, &'a Continuation),
    /// A strategy has made a path that carries light.
    Contribution(Contribution<'a>),
}

/// The end of a path that a walk starts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// A light.
    Light,
    /// The camera.
    Camera,
}

/// What a strategy contributes. The path has `s + t - 1` edges.
#[derive(Clone, Copy, Debug)]
pub struct Contribution<'a> {
    /// Vertices made from the light, the one on the light included.
    pub s: u32,
    /// Vertices made from the camera, the one on the lens included.
    pub t: u32,
    /// The part of the light that the path belongs to.
    pub part: Part,
    /// Its contribution if no other strategy made such paths.
    pub value: Rgb,
    /// Its share among all strategies, in `[0, 1]`.
    pub weight: f32,
    /// Where on the film it falls, for `t = 1`; the others belong to the pixel.
    pub film: Option<Vec2>,
    /// The sampled light, for `s = 1`.
    pub light: Option<&'a DirectSample>,
    /// The sampled point of the lens, for `t = 1`.
    pub lens: Option<Vec3>,
}
