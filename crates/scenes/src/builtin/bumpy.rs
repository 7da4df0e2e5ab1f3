//! Things whose normals are interpolated over coarse faces, lit from several sides.

use super::{
    Builtin, Parameter, ParameterKind, Values,
    parts::{Stage, glass, rough_metal},
};
use crate::LoadedScene;
use etendue_core::{geometry::Mesh, rgb::Rgb};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

pub(super) const BUILTIN: Builtin = Builtin {
    name: "bumpy",
    summary: "coarse meshes with interpolated normals, lit from several sides: paths from both ends must correct for them alike",
    parameters: &[
        Parameter {
            name: "rings",
            summary: "rows of faces from pole to pole of each ball; twice as many go around",
            kind: ParameterKind::Integer { default: 12, range: (4, 512) },
        },
        Parameter {
            name: "bumps",
            summary: "height of the bumps over the radius",
            kind: ParameterKind::Number { default: 0.12, range: (0.0, 0.3) },
        },
    ],
    build,
};

/// Tests shading normals that differ from the faces', on diffuse, glossy and refracting surfaces: light is scattered as if
/// the surface were smooth, and a path from a light needs a factor that one from the camera does not
/// [Veach 1997, sec. 5.3]. One light stands behind, for the rims.
fn build(values: &Values) -> LoadedScene {
    let mut stage = Stage::new("bumpy", DVec3::new(0.0, 1.9, 4.6), DVec3::new(0.0, 0.55, 0.0), 40.0);
    let floor = stage.lambert("floor", [0.5, 0.48, 0.45]);
    let wall = stage.lambert("wall", [0.3, 0.34, 0.4]);
    let clay = stage.lambert("clay", [0.72, 0.62, 0.55]);
    let dark = stage.lambert("dark", [0.0; 3]);
    let bronze = stage.material("bronze", rough_metal([0.8, 0.58, 0.36], 0.25));
    let glass = stage.material("glass", glass());
    stage.quad("floor", [[-4.0, 0.0, -3.2], [-4.0, 0.0, 3.0], [4.0, 0.0, 3.0], [4.0, 0.0, -3.2]], floor);
    stage.quad("wall", [[-4.0, 0.0, -3.2], [4.0, 0.0, -3.2], [4.0, 3.5, -3.2], [-4.0, 3.5, -3.2]], wall);
    let (rings, bumps) = (values.integer("rings"), values.number("bumps"));
    stage.mesh("clay ball", ball(DVec3::new(-1.15, 0.62, 0.0), 0.55, rings, bumps), clay);
    stage.mesh("bronze ball", ball(DVec3::new(0.1, 0.62, -0.55), 0.55, rings, bumps), bronze);
    stage.mesh("glass ball", ball(DVec3::new(1.2, 0.62, 0.15), 0.55, rings, 0.3 * bumps), glass);
    // Smooth in all but its faces, and so coarse that its outline is seen: its normals are farthest from the faces'.
    stage.mesh("small ball", ball(DVec3::new(0.05, 0.33, 0.85), 0.32, 4, 0.0), clay);
    for (name, place, radius, radiance) in [
        ("light from the left", DVec3::new(-2.6, 2.4, 1.2), 0.3, Rgb::new(24.0, 16.0, 9.0)),
        ("light from the right", DVec3::new(2.7, 2.2, 0.6), 0.35, Rgb::new(8.0, 12.0, 18.0)),
        ("light from behind", DVec3::new(0.5, 2.1, -2.5), 0.3, Rgb::new(16.0, 16.0, 16.0)),
    ] {
        stage.sphere(name, place, radius, dark).emission = Some(radiance.into());
    }
    stage.finish(12)
}

/// A ball of radius `radius` with bumps of `bumps` times that, in `rings` rows of faces, with the normals of the surface that
/// the faces stand for.
fn ball(center: DVec3, radius: f64, rings: u32, bumps: f64) -> Mesh {
    let around = 2 * rings;
    let direction = |theta: f64, phi: f64| DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
    // Five bumps around and three from pole to pole, none at the poles.
    let place = |theta: f64, phi: f64| {
        let bump = (3.0 * theta).sin() * theta.sin().powi(2) * (5.0 * phi).cos();
        direction(theta, phi) * radius * (1.0 + bumps * bump)
    };
    let mut mesh = Mesh::default();
    let mut vertex = |theta: f64, phi: f64| {
        const STEP: f64 = 1e-4;
        let by_theta = place(theta + STEP, phi) - place(theta - STEP, phi);
        let by_phi = place(theta, phi + STEP) - place(theta, phi - STEP);
        let pole = theta == 0.0 || theta == PI;
        let normal = if pole { direction(theta, phi) } else { by_phi.cross(by_theta).normalize() };
        mesh.positions.push((center + place(theta, phi)).as_vec3());
        mesh.normals.push(normal.as_vec3());
    };
    vertex(0.0, 0.0);
    for row in 1..rings {
        for column in 0..around {
            vertex(PI * f64::from(row) / f64::from(rings), TAU * f64::from(column) / f64::from(around));
        }
    }
    vertex(PI, 0.0);
    let last = (rings - 1) * around + 1;
    let at = |row: u32, column: u32| match row {
        0 => 0,
        row if row == rings => last,
        row => 1 + (row - 1) * around + column % around,
    };
    for row in 0..rings {
        for column in 0..around {
            let [a, b] = [at(row, column), at(row, column + 1)];
            let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
            if row > 0 {
                mesh.triangles.push([a, b, d]);
            }
            if row + 1 < rings {
                mesh.triangles.push([a, d, c]);
            }
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn balls_are_closed_and_their_normals_point_outwards() {
        for (rings, bumps) in [(4, 0.0), (4, 0.3), (12, 0.12), (64, 0.3)] {
            let mesh = ball(DVec3::ZERO, 1.0, rings, bumps);
            assert_eq!(mesh.triangles.len() as u32, 4 * rings * (rings - 1));
            let mut edges = std::collections::HashMap::new();
            for t in &mesh.triangles {
                let p = t.map(|i| mesh.positions[i as usize]);
                let face: Vec3 = (p[1] - p[0]).cross(p[2] - p[0]);
                assert!(face.dot(p[0] + p[1] + p[2]) > 0.0, "{rings} {bumps}: {t:?}");
                for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                    *edges.entry((a.min(b), a.max(b))).or_insert(0) += if a < b { 1 } else { -1 };
                }
            }
            assert!(edges.values().all(|sum| *sum == 0));
            for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
                assert!((n.length() - 1.0).abs() < 1e-5 && n.dot(*p) > 0.3, "{rings} {bumps}: {p} {n}");
            }
        }
    }
}
