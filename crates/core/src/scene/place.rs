//! Validates a description's shapes and places them in the world.

use super::{
    description::{Object, ObjectShape},
    error::{Kind, Problem, SceneError},
};
use crate::{
    geometry::{Disk, Mesh, Shape, Sphere},
    rgb::Rgb,
};
use glam::{DAffine3, DVec3, Vec2, Vec3};

/// Largest relative difference between the scales along two axes that still counts as uniform: transforms come from
/// text with six or seven digits.
const UNIFORM: f64 = 1e-4;

/// Wraps a problem with an object's name.
pub(super) fn object_error(object: &Object, problem: Problem) -> SceneError {
    SceneError::Item { kind: Kind::Object, name: object.name.clone(), problem }
}

/// Refuses transforms that are not finite or cannot be undone.
pub(super) fn check_transform(transform: &DAffine3) -> Result<(), Problem> {
    if !transform.is_finite() {
        return Err(Problem::NotFinite { what: "transform", index: 0 });
    }
    // The determinant is judged against the size of the columns: no absolute threshold.
    let m = transform.matrix3;
    let size = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
    let determinant = m.determinant();
    if size > 0.0 && determinant.abs() > 1e-12 * size { Ok(()) } else { Err(Problem::SingularTransform) }
}

/// The unit square, or the cube from -1 to 1.
fn quads(faces: &[[DVec3; 4]]) -> (Vec<DVec3>, Vec<Vec2>, Vec<[u32; 3]>) {
    let corner_uvs = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let (mut positions, mut uvs, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for face in faces {
        let first = positions.len() as u32;
        positions.extend_from_slice(face);
        uvs.extend_from_slice(&corner_uvs);
        triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    (positions, uvs, triangles)
}

fn rectangle_face() -> [DVec3; 4] {
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec3::new(x, y, 0.0))
}

fn cube_faces() -> Vec<[DVec3; 4]> {
    // Each face is the rectangle moved to z = 1 and turned by a rotation that takes +z to the face's normal.
    let turn = |x: DVec3, y: DVec3| rectangle_face().map(|p| x * p.x + y * p.y + x.cross(y));
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    vec![turn(x, y), turn(y, x), turn(y, z), turn(z, y), turn(z, x), turn(x, z)]
}

/// What an object's shape is before rounding: what the world's bounds are taken from.
pub(super) enum Placed {
    /// Positions in the world, the rest as the mesh has it.
    Mesh { positions: Vec<DVec3>, normals: Vec<Vec3>, uvs: Vec<Vec2>, colors: Vec<Rgb>, triangles: Vec<[u32; 3]> },
    /// A sphere in the world.
    Sphere { center: DVec3, radius: f64, inverted: bool },
    /// A disk in the world.
    Disk { center: DVec3, normal: DVec3, radius: f64 },
}

impl Placed {
    /// Smallest and largest corner.
    pub(super) fn bounds(&self) -> (DVec3, DVec3) {
        match self {
            Placed::Mesh { positions, .. } => {
                positions.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(*p), hi.max(*p)))
            }
            Placed::Sphere { center, radius, .. } | Placed::Disk { center, radius, .. } => {
                (*center - DVec3::splat(*radius), *center + DVec3::splat(*radius))
            }
        }
    }

    /// Moves the world's middle to the origin and rounds.
    pub(super) fn round(self, middle: DVec3) -> Result<Shape, Problem> {
        let shape = match self {
            Placed::Mesh { positions, normals, uvs, colors, triangles } => {
                let positions: Vec<Vec3> = positions.iter().map(|p| (*p - middle).as_vec3()).collect();
                if let Some(index) = positions.iter().position(|p| !p.is_finite()) {
                    return Err(Problem::NotFinite { what: "position in the world", index });
                }
                Shape::Mesh(Mesh { positions, normals, uvs, colors, triangles })
            }
            Placed::Sphere { center, radius, inverted } => {
                Shape::Sphere(Sphere { center: (center - middle).as_vec3(), radius: radius as f32, inverted })
            }
            Placed::Disk { center, normal, radius } => Shape::Disk(Disk {
                center: (center - middle).as_vec3(),
                normal: normal.as_vec3(),
                radius: radius as f32,
            }),
        };
        match &shape {
            Shape::Sphere(Sphere { center, radius, .. }) | Shape::Disk(Disk { center, radius, .. })
                if !(center.is_finite() && radius.is_normal() && *radius > 0.0) =>
            {
                Err(Problem::OutOfRange {
                    what: "radius in the world",
                    value: f64::from(*radius),
                    expected: "a positive single-precision number",
                })
            }
            _ => Ok(shape),
        }
    }
}

fn check_mesh(mesh: &Mesh) -> Result<(), Problem> {
    let vertices = mesh.positions.len();
    let finite = |what, bad: Option<usize>| match bad {
        Some(index) => Err(Problem::NotFinite { what, index }),
        None => Ok(()),
    };
    finite("position", mesh.positions.iter().position(|p| !p.is_finite()))?;
    finite("normal", mesh.normals.iter().position(|n| !n.is_finite()))?;
    finite("colour", mesh.colors.iter().position(|c| !c.is_valid()))?;
    finite("texture coordinate", mesh.uvs.iter().position(|t| !t.is_finite()))?;
    for (what, count) in
        [("normals", mesh.normals.len()), ("texture coordinates", mesh.uvs.len()), ("colours", mesh.colors.len())]
    {
        if count != 0 && count != vertices {
            return Err(Problem::WrongCount { what, count, vertices });
        }
    }
    for (index, triangle) in mesh.triangles.iter().enumerate() {
        if let Some(v) = triangle.iter().find(|v| **v as usize >= vertices) {
            let target = format!("vertex {v}");
            return Err(Problem::IndexOutOfRange { what: "triangle", index, target, count: vertices });
        }
    }
    Ok(())
}

/// Validates an object's shape and places it in the world.
pub(super) fn place(object: &Object) -> Result<Placed, Problem> {
    let transform = &object.to_world;
    check_transform(transform)?;
    let matrix = transform.matrix3;
    let mirrored = matrix.determinant() < 0.0;
    // A mirroring transform turns the winding around, and with it what "outside" means; normals do not mirror so.
    let wind = |t: [u32; 3]| if mirrored { [t[0], t[2], t[1]] } else { t };
    let place_quads = |faces: &[[DVec3; 4]]| {
        let (positions, uvs, triangles) = quads(faces);
        Placed::Mesh {
            positions: positions.iter().map(|p| transform.transform_point3(*p)).collect(),
            normals: Vec::new(),
            uvs,
            colors: Vec::new(),
            triangles: triangles.into_iter().map(wind).collect(),
        }
    };
    match &object.shape {
        ObjectShape::Mesh(mesh) => {
            check_mesh(mesh)?;
            // Normals go by the inverse transpose, up to scale the cofactors; [PBRT-4, sec. 3.9.3].
            let cofactors = matrix.inverse().transpose();
            Ok(Placed::Mesh {
                positions: mesh.positions.iter().map(|p| transform.transform_point3(p.as_dvec3())).collect(),
                normals: mesh
                    .normals
                    .iter()
                    .map(|n| (cofactors * n.as_dvec3()).normalize_or_zero().as_vec3())
                    .collect(),
                uvs: mesh.uvs.clone(),
                colors: mesh.colors.clone(),
                triangles: mesh.triangles.iter().map(|t| wind(*t)).collect(),
            })
        }
        ObjectShape::Cylinder { .. } => unimplemented!(),
        ObjectShape::Rectangle => Ok(place_quads(&[rectangle_face()])),
        ObjectShape::Cube => Ok(place_quads(&cube_faces())),
        ObjectShape::Sphere { center, radius, inverted } => {
            if !center.is_finite() {
                return Err(Problem::NotFinite { what: "centre", index: 0 });
            }
            if !(radius.is_finite() && *radius > 0.0) {
                return Err(Problem::OutOfRange { what: "radius", value: *radius, expected: "positive and finite" });
            }
            let scales = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(DVec3::length);
            let orthogonal =
                [(matrix.x_axis, matrix.y_axis), (matrix.y_axis, matrix.z_axis), (matrix.z_axis, matrix.x_axis)]
                    .iter()
                    .all(|(a, b)| a.dot(*b).abs() <= UNIFORM * a.length() * b.length());
            if !orthogonal || scales.iter().any(|s| (s - scales[0]).abs() > UNIFORM * scales[0]) {
                return Err(Problem::NonUniformScale("a sphere"));
            }
            Ok(Placed::Sphere {
                center: transform.transform_point3(*center),
                radius: radius * scales[0],
                inverted: *inverted,
            })
        }
        ObjectShape::Disk => {
            let (x, y) = (matrix.x_axis, matrix.y_axis);
            let alike = (x.length() - y.length()).abs() <= UNIFORM * x.length();
            if !alike || x.dot(y).abs() > UNIFORM * x.length() * y.length() {
                return Err(Problem::NonUniformScale("a disk"));
            }
            let normal = x.cross(y).normalize();
            Ok(Placed::Disk {
                center: transform.translation,
                normal: if mirrored { -normal } else { normal },
                radius: x.length(),
            })
        }
    }
}

/// The farthest coordinate from the world's middle: a tenth of what single precision holds, so that what is calculated with
/// boxes stays finite.
const FARTHEST: f64 = 1e37;

/// Refuses what reaches too far from the world's middle.
pub(super) fn check_reach((lo, hi): (DVec3, DVec3), middle: DVec3) -> Result<(), Problem> {
    // Nothing at all has bounds the wrong way round.
    if lo.cmpgt(hi).any() {
        return Ok(());
    }
    let value = (lo - middle).abs().max((hi - middle).abs()).max_element();
    if value <= FARTHEST {
        Ok(())
    } else {
        Err(Problem::OutOfRange { what: "distance from the world's middle", value, expected: "at most 1e37" })
    }
}

/// Bounds of several bounds together; of none, the wrong way round.
pub(super) fn union(all: impl Iterator<Item = (DVec3, DVec3)>) -> (DVec3, DVec3) {
    all.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), (a, b)| (lo.min(a), hi.max(b)))
}

/// Bounds of transformed bounds.
pub(super) fn transformed(transform: &DAffine3, (lo, hi): (DVec3, DVec3)) -> (DVec3, DVec3) {
    if lo.cmpgt(hi).any() {
        return (lo, hi);
    }
    let corner = |i: u32| {
        let pick = |bit: u32, lo: f64, hi: f64| if i & bit == 0 { lo } else { hi };
        transform.transform_point3(DVec3::new(pick(1, lo.x, hi.x), pick(2, lo.y, hi.y), pick(4, lo.z, hi.z)))
    };
    union((0..8).map(|i| (corner(i), corner(i))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cube_is_closed_and_its_normals_point_outwards() {
        let (positions, _, triangles) = quads(&cube_faces());
        assert_eq!(triangles.len(), 12);
        let mut volume = 0.0;
        for t in &triangles {
            let [a, b, c] = t.map(|v| positions[v as usize]);
            assert!((b - a).cross(c - a).dot(a) > 0.0);
            volume += a.dot(b.cross(c)) / 6.0;
        }
        assert!((volume - 8.0).abs() < 1e-12, "{volume}");
    }
}
