//! Validates a description's shapes and places them in the world.

use super::{
    description::{Object, ObjectShape},
    error::{Kind, Problem, SceneError},
};
use crate::{
    geometry::{Axes, Cylinder, Disk, Mesh, Shape, Sphere},
    rgb::Rgb,
};
use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3};

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

/// A square face by its corners, counter-clockwise, and the directions in which the texture coordinates grow: by 1 over
/// its edge of 2, from 0.
struct Face {
    corners: [DVec3; 4],
    uv: [DVec3; 2],
}

fn quads(faces: &[Face]) -> (Vec<DVec3>, Vec<Vec2>, Vec<[u32; 3]>) {
    let (mut positions, mut uvs, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for face in faces {
        let first = positions.len() as u32;
        positions.extend_from_slice(&face.corners);
        uvs.extend(face.corners.map(|p| {
            let [u, v] = face.uv.map(|along| 0.5 + 0.5 * p.dot(along));
            Vec2::new(u as f32, v as f32)
        }));
        triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    (positions, uvs, triangles)
}

fn square() -> [DVec3; 4] {
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec3::new(x, y, 0.0))
}

fn rectangle_face() -> Face {
    Face { corners: square(), uv: [DVec3::X, DVec3::Y] }
}

fn cube_faces() -> [Face; 6] {
    // Each face is the square moved to z = 1 and turned by a rotation that takes +z to the face's normal.
    let turn = |x: DVec3, y: DVec3, uv| Face { corners: square().map(|p| x * p.x + y * p.y + x.cross(y)), uv };
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    // The texture coordinates are those of Mitsuba 3.9.1, on each face left-handed as seen from outside.
    [
        turn(x, y, [y, x]),
        turn(y, x, [-y, x]),
        turn(y, z, [y, -z]),
        turn(z, y, [y, z]),
        turn(z, x, [-x, -z]),
        turn(x, z, [z, x]),
    ]
}

/// What an object's shape is before rounding: what the world's bounds are taken from.
pub(super) enum Placed {
    /// Positions in the world, the rest as the mesh has it.
    Mesh { positions: Vec<DVec3>, normals: Vec<Vec3>, uvs: Vec<Vec2>, colors: Vec<Rgb>, triangles: Vec<[u32; 3]> },
    /// A sphere in the world.
    Sphere { center: DVec3, radius: f64, inverted: bool, axes: Axes },
    /// A disk in the world; its normal is the last of the axes.
    Disk { center: DVec3, radius: f64, axes: Axes },
    /// A cylinder in the world.
    Cylinder { from: DVec3, axis: DVec3, radius: f64, inverted: bool, axes: Axes },
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
            Placed::Cylinder { from, axis, radius, .. } => {
                let to = *from + *axis;
                (from.min(to) - DVec3::splat(*radius), from.max(to) + DVec3::splat(*radius))
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
            Placed::Sphere { center, radius, inverted, axes } => {
                let center = round_center(center - middle, radius)?;
                Shape::Sphere(Sphere { center, radius: radius as f32, inverted }, axes)
            }
            Placed::Disk { center, radius, axes } => {
                let center = round_center(center - middle, radius)?;
                Shape::Disk(Disk { center, normal: axes.z, radius: radius as f32 }, axes)
            }
            Placed::Cylinder { from, axis, radius, inverted, axes } => {
                let from = round_center(from - middle, radius)?;
                let axis = axis.as_vec3();
                if !axis.length_squared().is_normal() {
                    let value = f64::from(axis.length());
                    return Err(out_of_range("length of the axis in the world", value));
                }
                Shape::Cylinder(Cylinder { from, axis, radius: radius as f32, inverted }, axes)
            }
        };
        Ok(shape)
    }
}

/// A point in single precision, where a radius about it is a normal number, too.
fn round_center(center: DVec3, radius: f64) -> Result<Vec3, Problem> {
    let (center, radius) = (center.as_vec3(), radius as f32);
    if center.is_finite() && radius.is_normal() && radius > 0.0 {
        Ok(center)
    } else {
        Err(out_of_range("radius in the world", f64::from(radius)))
    }
}

fn out_of_range(what: &'static str, value: f64) -> Problem {
    Problem::OutOfRange { what, value, expected: "a positive single-precision number" }
}

/// The axes of a transform that scales them alike.
fn axes(matrix: DMat3) -> Axes {
    let x = matrix.x_axis.normalize();
    let y = (matrix.y_axis - x * x.dot(matrix.y_axis)).normalize();
    let z = x.cross(y) * matrix.determinant().signum();
    Axes { x: x.as_vec3(), y: y.as_vec3(), z: z.as_vec3() }
}

/// The scale of a transform that is nothing but a scale, a rotation and perhaps a reflection.
fn uniform_scale(matrix: DMat3) -> Option<f64> {
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let scale = columns[0].length();
    let alike = columns.iter().all(|c| (c.length() - scale).abs() <= UNIFORM * scale);
    let orthogonal = [(0, 1), (1, 2), (2, 0)].iter().all(|&(i, j)| perpendicular(columns[i], columns[j]));
    (alike && orthogonal).then_some(scale)
}

/// Returns `true` if two vectors are at right angles, as far as transforms are exact.
fn perpendicular(a: DVec3, b: DVec3) -> bool {
    a.dot(b).abs() <= UNIFORM * a.length() * b.length()
}

fn check_radius(radius: f64) -> Result<(), Problem> {
    if radius.is_finite() && radius > 0.0 {
        Ok(())
    } else {
        Err(Problem::OutOfRange { what: "radius", value: radius, expected: "positive and finite" })
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

impl ObjectShape {
    /// Returns `false` for a sphere, disk or cylinder that the transform makes something else: an ellipsoid, an ellipse, a
    /// cylinder of elliptic or slanted section. A scene refuses those.
    pub fn stays_itself(&self, to_world: &DAffine3) -> bool {
        matches!(self, ObjectShape::Mesh(_)) || !matches!(place_shape(self, to_world), Err(Problem::NonUniformScale(_)))
    }
}

/// Validates an object's shape and places it in the world.
pub(super) fn place(object: &Object) -> Result<Placed, Problem> {
    place_shape(&object.shape, &object.to_world)
}

fn place_shape(shape: &ObjectShape, transform: &DAffine3) -> Result<Placed, Problem> {
    check_transform(transform)?;
    let matrix = transform.matrix3;
    let mirrored = matrix.determinant() < 0.0;
    // A mirroring transform turns the winding around, and with it what "outside" means; normals do not mirror so.
    let wind = |t: [u32; 3]| if mirrored { [t[0], t[2], t[1]] } else { t };
    let place_quads = |faces: &[Face]| {
        let (positions, uvs, triangles) = quads(faces);
        Placed::Mesh {
            positions: positions.iter().map(|p| transform.transform_point3(*p)).collect(),
            normals: Vec::new(),
            uvs,
            colors: Vec::new(),
            triangles: triangles.into_iter().map(wind).collect(),
        }
    };
    match shape {
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
        ObjectShape::Rectangle => Ok(place_quads(&[rectangle_face()])),
        ObjectShape::Cube => Ok(place_quads(&cube_faces())),
        ObjectShape::Sphere { center, radius, inverted } => {
            if !center.is_finite() {
                return Err(Problem::NotFinite { what: "centre", index: 0 });
            }
            check_radius(*radius)?;
            let scale = uniform_scale(matrix).ok_or(Problem::NonUniformScale("a sphere"))?;
            Ok(Placed::Sphere {
                center: transform.transform_point3(*center),
                radius: radius * scale,
                inverted: *inverted,
                axes: axes(matrix),
            })
        }
        ObjectShape::Cylinder { from, to, radius, inverted } => {
            for (index, end) in [from, to].into_iter().enumerate() {
                if !end.is_finite() {
                    return Err(Problem::NotFinite { what: "end", index });
                }
            }
            check_radius(*radius)?;
            let along = *to - *from;
            let direction = along.try_normalize().ok_or(Problem::OutOfRange {
                what: "distance between its ends",
                value: along.length(),
                expected: "positive and finite",
            })?;
            // The angle is zero where Mitsuba has it.
            let about = Axes::about(direction.as_vec3());
            let [x, y, axis] = [about.x.as_dvec3(), about.y.as_dvec3(), direction].map(|v| matrix * v);
            // Longer or shorter it stays a cylinder, but not with an ellipse or aslant.
            let scale = x.length();
            let alike = (y.length() - scale).abs() <= UNIFORM * scale;
            if !alike || [(x, y), (x, axis), (y, axis)].iter().any(|(a, b)| !perpendicular(*a, *b)) {
                return Err(Problem::NonUniformScale("a cylinder"));
            }
            let turned = |v: DVec3| v.normalize().as_vec3();
            Ok(Placed::Cylinder {
                from: transform.transform_point3(*from),
                axis: matrix * along,
                radius: radius * scale,
                inverted: *inverted,
                axes: Axes { x: turned(x), y: turned(y), z: turned(axis) },
            })
        }
        ObjectShape::Disk => {
            let (x, y) = (matrix.x_axis, matrix.y_axis);
            let alike = (x.length() - y.length()).abs() <= UNIFORM * x.length();
            if !alike || !perpendicular(x, y) {
                return Err(Problem::NonUniformScale("a disk"));
            }
            Ok(Placed::Disk { center: transform.translation, radius: x.length(), axes: axes(matrix) })
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
