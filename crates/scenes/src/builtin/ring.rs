//! A metal ring on a floor, with the cardioid of light inside it.

use super::{
    Builtin, Parameter, ParameterKind, Values,
    parts::{Stage, grey, mirror},
};
use crate::LoadedScene;
use etendue_core::geometry::Mesh;
use glam::{DVec3, Vec3};

pub(super) const BUILTIN: Builtin = Builtin {
    name: "ring",
    summary: "metal ring on a floor by a small light: the cardioid caustic",
    parameters: &[
        Parameter {
            name: "light",
            summary: "half edge of the light, metres; its power stays the same",
            kind: ParameterKind::Number { default: 0.08, range: (0.001, 0.5) },
        },
        Parameter {
            name: "segments",
            summary: "flat pieces around the ring",
            kind: ParameterKind::Integer { default: 256, range: (8, 65536) },
        },
    ],
    build,
};

/// Tests a caustic by reflection: the light that the ring's inner wall throws on the floor, bounded by a cardioid's cusp.
/// A path tracer finds it by chance alone; photon maps and light tracing find it at once.
fn build(values: &Values) -> LoadedScene {
    let mut stage = Stage::new("ring", DVec3::new(0.0, 4.2, 2.6), DVec3::new(0.0, 0.0, 0.15), 35.0);
    let plaster = stage.lambert("plaster", [0.62, 0.6, 0.57]);
    let dark = stage.lambert("dark", [0.0; 3]);
    let brass = stage.material("brass", mirror([0.93, 0.76, 0.45]));
    stage.quad("floor", [[-7.0, 0.0, -7.0], [-7.0, 0.0, 7.0], [7.0, 0.0, 7.0], [7.0, 0.0, -7.0]], plaster);
    stage.mesh("ring", band(values.integer("segments"), 1.0, 1.06, 0.38), brass);

    let (place, aim) = (DVec3::new(0.0, 3.1, -3.0), DVec3::new(0.0, 0.0, 0.2));
    let normal = (aim - place).normalize();
    let half = values.number("light");
    let u = DVec3::X * half;
    let light = stage.rectangle("light", place, u, normal.cross(u), dark);
    light.emission = Some((grey(13.0 / (half * half))).into());
    stage.finish(10)
}

/// A band standing on the floor about the y axis: inner wall, outer wall and rim, each with its own normals.
fn band(segments: u32, inner: f32, outer: f32, height: f32) -> Mesh {
    let mut mesh = Mesh::default();
    // Each strip: two circles (radius, height) and the normal (radial, vertical) that both share; the first circle lies
    // to the right of the second when one walks counter-clockwise seen from outside.
    let strips = [
        ((inner, height), (inner, 0.0), (-1.0, 0.0)),
        ((outer, 0.0), (outer, height), (1.0, 0.0)),
        ((outer, height), (inner, height), (0.0, 1.0)),
    ];
    for (first, second, normal) in strips {
        let base = mesh.positions.len() as u32;
        for i in 0..segments {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(segments)).sin_cos();
            let at =
                |radial: f32, y: f32| Vec3::new((f64::from(radial) * cos) as f32, y, (f64::from(radial) * sin) as f32);
            mesh.positions.extend([at(first.0, first.1), at(second.0, second.1)]);
            mesh.normals.extend([at(normal.0, normal.1); 2]);
            let (here, next) = (base + 2 * i, base + 2 * ((i + 1) % segments));
            mesh.triangles.extend([[here, here + 1, next + 1], [here, next + 1, next]]);
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_agree_with_their_normals() {
        let mesh = band(16, 1.0, 1.1, 0.5);
        for t in &mesh.triangles {
            let p = t.map(|i| mesh.positions[i as usize]);
            let face = (p[1] - p[0]).cross(p[2] - p[0]);
            assert!(face.length() > 0.0);
            for i in t {
                assert!(face.normalize().dot(mesh.normals[*i as usize]) > 0.9);
            }
        }
    }
}
