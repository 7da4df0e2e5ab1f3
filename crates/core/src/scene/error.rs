//! What can be wrong with a scene.

use crate::camera::CameraError;
use std::fmt;
use thiserror::Error;

/// Why a scene is refused. Once a scene is built, rendering it cannot fail.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SceneError {
    /// There is nothing to see it with.
    #[error("scene '{scene}': it has no camera")]
    NoCamera {
        /// Name of the scene.
        scene: String,
    },
    /// The camera is not one.
    #[error("camera: {0}")]
    Camera(#[from] CameraError),
    /// Something named is wrong.
    #[error("{kind} '{name}': {problem}")]
    Item {
        /// What sort of thing it is.
        kind: Kind,
        /// Its name.
        name: String,
        /// What is wrong with it.
        problem: Problem,
    },
}

/// The sorts of things a scene consists of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A shape with its material.
    Object,
    /// A material.
    Material,
    /// A light without an extent.
    Light,
    /// The light from infinity.
    Environment,
    /// A group of shapes.
    Group,
    /// A placement of a group.
    Instance,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Kind::Object => "object",
            Kind::Material => "material",
            Kind::Light => "light",
            Kind::Environment => "environment",
            Kind::Group => "group",
            Kind::Instance => "instance",
        })
    }
}

/// What is wrong.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum Problem {
    /// A number is NaN or infinite, or becomes so in the world.
    #[error("{what} {index} is not finite")]
    NotFinite {
        /// Which list.
        what: &'static str,
        /// Where in the list.
        index: usize,
    },
    /// An index points beyond its list.
    #[error("{what} {index} refers to {target}, of which there are {count}")]
    IndexOutOfRange {
        /// What refers.
        what: &'static str,
        /// Where in its list.
        index: usize,
        /// What it refers to.
        target: String,
        /// How many of those there are.
        count: usize,
    },
    /// A list that goes with the vertices has another length.
    #[error("{count} {what} for {vertices} vertices")]
    WrongCount {
        /// Which list.
        what: &'static str,
        /// Its length.
        count: usize,
        /// The number of vertices.
        vertices: usize,
    },
    /// A number lies outside its range.
    #[error("{what} is {value}, which is not {expected}")]
    OutOfRange {
        /// Which number.
        what: &'static str,
        /// What it is.
        value: f64,
        /// What it should be.
        expected: &'static str,
    },
    /// A transform cannot be undone.
    #[error("its transform is singular")]
    SingularTransform,
    /// A sphere or disk would become an ellipsoid or an ellipse.
    #[error("its transform does not scale {0} uniformly")]
    NonUniformScale(&'static str),
    /// A member of a mixture, or what a mask is on, is a mixture or a mask.
    #[error("mixtures and masks hold neither mixtures nor masks")]
    NestedMixture,
    /// A relief inside a mixture, a mask or another relief.
    #[error("a bump or normal map inside another, a mixture or a mask")]
    NestedRelief,
    /// A light stands in a group.
    #[error("object '{0}' emits light, which an instanced object cannot do yet")]
    EmitterInGroup(String),
    /// More of something than 32-bit indices can count.
    #[error("too many primitives: {0}")]
    TooMany(usize),
    /// Something else, said by its own check.
    #[error("{0}")]
    Other(String),
}
