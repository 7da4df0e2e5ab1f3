//! Cameras: those of the file, and the one for a file without.

use super::{flaw, item, valid};
use crate::{error::Flaw, placement::look_at};
use etendue_core::{
    camera::{CameraDescription, Projection},
    scene::{Object, ObjectShape, SceneDescription},
};
use glam::{DAffine3, DVec3, UVec2};
use gltf_json::{Root, camera::Type};
use std::f64::consts::PI;

/// Pixels along the longer side of an image, and the shape of one that is not said.
const LONGER_SIDE: f64 = 1024.0;
const ASPECT: f64 = 4.0 / 3.0;

/// How much of the image's width and height a scene without a camera fills at most.
const MARGIN: f64 = 0.9;

/// The camera of a node.
pub(super) fn camera(root: &Root, index: usize, to_world: &DAffine3) -> Result<CameraDescription, Flaw> {
    let camera = item(&root.cameras, "cameras", index)?;
    let wrong = |what: &str| flaw(format!("cameras[{index}]: {what}"));
    let missing = || wrong("it lacks what its type says");
    let positive = |value: f64| value.is_finite() && value > 0.0;
    let (projection, aspect) = match valid(&camera.type_, || format!("cameras[{index}]"))? {
        Type::Perspective => {
            let perspective = camera.perspective.as_ref().ok_or_else(missing)?;
            let aspect = perspective.aspect_ratio.map_or(ASPECT, f64::from);
            let fov_x = 2.0 * ((0.5 * f64::from(perspective.yfov)).tan() * aspect).atan();
            if !(positive(aspect)
                && perspective.yfov > 0.0
                && perspective.yfov < PI as f32
                && fov_x > 0.0
                && fov_x < PI)
            {
                return Err(wrong("its field of view is not between 0 and 180 degrees"));
            }
            (Projection::Perspective { fov_x }, aspect)
        }
        Type::Orthographic => {
            let orthographic = camera.orthographic.as_ref().ok_or_else(missing)?;
            let (width, height) = (f64::from(orthographic.xmag).abs(), f64::from(orthographic.ymag).abs());
            if !(positive(width) && positive(height)) {
                return Err(wrong("what it sees has no size"));
            }
            (Projection::Orthographic { width: 2.0 * width }, width / height)
        }
    };
    // It looks along its -z, with +y up.
    let forward = to_world.transform_vector3(DVec3::NEG_Z);
    let origin = to_world.translation;
    let placed =
        forward.try_normalize().and_then(|f| look_at(origin, origin + f, to_world.transform_vector3(DVec3::Y)));
    let to_world = placed.ok_or_else(|| wrong("its node gives it no direction"))?;
    Ok(CameraDescription { projection, to_world, resolution: resolution(aspect), crop: None })
}

fn resolution(aspect: f64) -> UVec2 {
    let side = |pixels: f64| pixels.round().clamp(1.0, LONGER_SIDE) as u32;
    UVec2::new(side(LONGER_SIDE * aspect.min(1.0)), side(LONGER_SIDE / aspect.max(1.0)))
}

/// A camera that sees all of a scene from the front, above, and right; none if there is nothing of finite size to see.
pub(super) fn default_camera(scene: &SceneDescription) -> Option<CameraDescription> {
    let mut bounds = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let mut add = |object: &Object, place: &DAffine3| {
        let ObjectShape::Mesh(mesh) = &object.shape else { return };
        let to_world = *place * object.to_world;
        for p in mesh.positions.iter().map(|p| to_world.transform_point3(p.as_dvec3())) {
            bounds = (bounds.0.min(p), bounds.1.max(p));
        }
    };
    scene.objects.iter().for_each(|object| add(object, &DAffine3::IDENTITY));
    for instance in &scene.instances {
        scene.groups[instance.group].objects.iter().for_each(|object| add(object, &instance.to_world));
    }
    let (low, high) = bounds;
    if !(low.is_finite() && high.is_finite()) {
        return None;
    }
    let middle = (low + high) * 0.5;
    let towards = DVec3::new(0.5, 0.4, 1.0).normalize();
    let turned = look_at(towards, DVec3::ZERO, DVec3::Y)?.matrix3;
    let fov_x = 40f64.to_radians();
    // What is seen at a distance of 1 to each side and above, but for a margin.
    let side = MARGIN * (0.5 * fov_x).tan();
    let above = side / ASPECT;
    // How far back each corner of the bounds drives the camera.
    let distance = (0..8).map(|i| {
        let pick = |bit: i32, low: f64, high: f64| if i & bit == 0 { low } else { high };
        let corner = DVec3::new(pick(1, low.x, high.x), pick(2, low.y, high.y), pick(4, low.z, high.z));
        let seen = turned.transpose() * (corner - middle);
        (seen.x.abs() / side).max(seen.y.abs() / above) - seen.z
    });
    let distance = distance.fold(0.0, f64::max);
    // A point is seen from a distance of 1.
    let distance = if distance > 0.0 { distance } else { 1.0 };
    let to_world = DAffine3::from_mat3_translation(turned, middle + towards * distance);
    let projection = Projection::Perspective { fov_x };
    Some(CameraDescription { projection, to_world, resolution: resolution(ASPECT), crop: None })
}
