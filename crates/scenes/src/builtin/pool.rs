//! A house with a swimming pool under sun and sky.

use super::{Builtin, Parameter, ParameterKind, Values, parts::Stage, sky::sky_image};
use crate::LoadedScene;
use etendue_core::{
    geometry::Mesh,
    lights::environment::{Environment, Rows},
    material::Material,
    rgb::Rgb,
};
use glam::{DMat3, DVec2, DVec3, Vec3};
use std::{f64::consts::TAU, sync::Arc};

pub(super) const BUILTIN: Builtin = Builtin {
    name: "pool",
    summary: "house with a swimming pool under sun and sky: caustics of waves under water and on the wall",
    parameters: &[
        Parameter {
            name: "waves",
            summary: "height of the waves over the default",
            kind: ParameterKind::Number { default: 1.0, range: (0.0, 5.0) },
        },
        Parameter {
            name: "grid",
            summary: "squares along the longer side of the water",
            kind: ParameterKind::Integer { default: 160, range: (8, 2048) },
        },
    ],
    build,
};

/// Half sides of the pool, metres, and its depth below the ground; the water stands a little lower than the ground.
const HALF: DVec2 = DVec2::new(2.0, 3.4);
const DEPTH: f32 = 1.5;
const LEVEL: f64 = -0.12;

/// Waves: direction, length in metres, height, phase.
const WAVES: [(f64, f64, f64, f64); 5] = [
    (0.3, 1.9, 0.016, 0.4),
    (1.4, 1.1, 0.009, 1.9),
    (2.5, 0.75, 0.006, 3.1),
    (-0.6, 0.52, 0.0036, 5.0),
    (4.1, 0.36, 0.002, 2.2),
];

/// Tests caustics in the open, where little of the light that comes in meets what casts them, seen through the refracting
/// surface that has cast them.
fn build(values: &Values) -> LoadedScene {
    let mut stage = Stage::new("pool", DVec3::new(4.6, 3.2, 6.6), DVec3::new(-0.5, -0.2, -0.6), 48.0);
    let lawn = stage.lambert("lawn", [0.16, 0.24, 0.07]);
    let stone = stage.lambert("stone", [0.55, 0.52, 0.47]);
    let tile = stage.lambert("tile", [0.55, 0.72, 0.78]);
    let plaster = stage.lambert("plaster", [0.75, 0.73, 0.7]);
    let timber = stage.lambert("timber", [0.3, 0.19, 0.11]);
    let water = stage.material("water", Material::dielectric(1.33, None));
    let pane = stage.material(
        "pane",
        Material::ThinDielectric { eta: 1.5, reflectance: Rgb::WHITE.into(), transmittance: Rgb::WHITE.into() },
    );

    let (x, z) = (HALF.x as f32, HALF.y as f32);
    frame(&mut stage, "edge", [x, z], [x + 0.6, z + 0.6], stone);
    frame(&mut stage, "lawn", [x + 0.6, z + 0.6], [16.0, 16.0], lawn);
    let d = -DEPTH;
    stage.quad("bottom", [[-x, d, -z], [-x, d, z], [x, d, z], [x, d, -z]], tile);
    stage.quad("left side", [[-x, d, -z], [-x, 0.0, -z], [-x, 0.0, z], [-x, d, z]], tile);
    stage.quad("right side", [[x, d, -z], [x, d, z], [x, 0.0, z], [x, 0.0, -z]], tile);
    stage.quad("far side", [[-x, d, -z], [x, d, -z], [x, 0.0, -z], [-x, 0.0, -z]], tile);
    stage.quad("near side", [[-x, d, z], [-x, 0.0, z], [x, 0.0, z], [x, d, z]], tile);
    stage.mesh("water", surface(values.integer("grid"), values.number("waves")), water);

    // The house stands beyond the left side, with a pane and a roof that juts out.
    stage.cuboid("house", DVec3::new(-5.2, 1.4, -1.0), DVec3::new(2.0, 1.4, 4.0), 0.0, plaster);
    stage.cuboid("roof", DVec3::new(-5.0, 2.88, -1.0), DVec3::new(2.5, 0.08, 4.4), 0.0, timber);
    stage.cuboid("post", DVec3::new(-2.75, 1.4, 3.2), DVec3::new(0.07, 1.4, 0.07), 0.0, timber);
    stage.quad("screen", [[-2.9, 0.0, -4.4], [-1.3, 0.0, -4.4], [-1.3, 1.9, -4.4], [-2.9, 1.9, -4.4]], pane);
    stage.cuboid("bench", DVec3::new(0.4, 0.22, -4.7), DVec3::new(0.9, 0.22, 0.25), 8.0, timber);

    stage.description.environment = Some(Environment::LatLong {
        image: Arc::new(sky_image(1024, 52.0, 4.0)),
        scale: 1.0,
        // The sun stands behind the camera's right shoulder, so that the waves throw light on the left side and the house.
        to_world: DMat3::from_rotation_y(1.9),
        rows: Rows::Centred,
    });
    stage.finish(12)
}

/// Four flat quadrilaterals about a rectangular hole, on the ground.
fn frame(stage: &mut Stage, name: &str, [x, z]: [f32; 2], [far_x, far_z]: [f32; 2], material: usize) {
    let at = |x: f32, z: f32| Vec3::new(x, 0.0, z);
    let positions =
        [(x, z), (far_x, far_z)].into_iter().flat_map(|(x, z)| [at(-x, -z), at(-x, z), at(x, z), at(x, -z)]).collect();
    let triangles = (0..4u32)
        .flat_map(|i| {
            let next = (i + 1) % 4;
            [[i, i + 4, next + 4], [i, next + 4, next]]
        })
        .collect();
    stage.mesh(name, Mesh { positions, triangles, ..Mesh::default() }, material);
}

/// The water, from side to side.
fn surface(grid: u32, height: f64) -> Mesh {
    let columns = (f64::from(grid) * HALF.x / HALF.y).ceil() as u32;
    let mut mesh = Mesh::default();
    for row in 0..=grid {
        for column in 0..=columns {
            let share = DVec2::new(f64::from(column) / f64::from(columns), f64::from(row) / f64::from(grid));
            let at = HALF * (share * 2.0 - 1.0);
            let (mut y, mut slope) = (LEVEL, DVec2::ZERO);
            for (angle, length, amplitude, phase) in WAVES {
                let wave = DVec2::from_angle(angle) * (TAU / length);
                let (sin, cos) = (wave.dot(at) + phase).sin_cos();
                y += height * amplitude * sin;
                slope += wave * (height * amplitude * cos);
            }
            mesh.positions.push(DVec3::new(at.x, y, at.y).as_vec3());
            mesh.normals.push(DVec3::new(-slope.x, 1.0, -slope.y).normalize().as_vec3());
        }
    }
    for row in 0..grid {
        for column in 0..columns {
            let first = row * (columns + 1) + column;
            let below = first + columns + 1;
            mesh.triangles.extend([[first, below, below + 1], [first, below + 1, first + 1]]);
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_water_faces_up_and_its_normals_fit() {
        let mesh = surface(40, 1.0);
        for t in &mesh.triangles {
            let p = t.map(|i| mesh.positions[i as usize]);
            let face = (p[1] - p[0]).cross(p[2] - p[0]).normalize();
            assert!(face.y > 0.9);
            assert!(t.iter().all(|i| mesh.normals[*i as usize].dot(face) > 0.97));
        }
    }
}
