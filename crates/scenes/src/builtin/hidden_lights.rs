//! A room with three lamps whose light comes out of shades.

use super::{
    Builtin, Parameter, ParameterKind, Values,
    parts::{RoomWalls, Stage, glass, rough_metal},
};
use crate::LoadedScene;
use etendue_core::{
    geometry::Mesh,
    rgb::Rgb,
    scene::{DeltaLight, LightDescription},
};
use glam::DVec3;

pub(super) const BUILTIN: Builtin = Builtin {
    name: "hidden-lights",
    summary: "lamps in shades: an uplight, a spot on a wall, a lamp over a glass ball; light that paths from the camera hardly find",
    parameters: &[Parameter {
        name: "light",
        summary: "half edge of the lamp over the table, metres; its power stays the same",
        kind: ParameterKind::Number { default: 0.025, range: (0.001, 0.08) },
    }],
    build,
};

/// Flat pieces around a shade.
const SEGMENTS: u32 = 24;

/// Tests light of which all but a little has been scattered once before it reaches what the camera sees, in the spirit of the
/// scene for bidirectional path tracing in [Veach 1997, sec. 10.3]: the floor lamp is seen from a patch of the ceiling alone,
/// the spot makes one bright place on a wall, and the lamp over the table shines on it through a glass ball.
fn build(values: &Values) -> LoadedScene {
    let mut stage = Stage::new("hidden-lights", DVec3::new(0.1, 1.45, 3.2), DVec3::new(0.0, 1.12, -1.0), 50.0);
    let plaster = stage.lambert("plaster", [0.72, 0.7, 0.66]);
    let clay = stage.lambert("clay", [0.6, 0.34, 0.22]);
    let planks = stage.lambert("planks", [0.42, 0.3, 0.2]);
    let cloth = stage.lambert("cloth", [0.16, 0.26, 0.4]);
    let enamel = stage.lambert("enamel", [0.6, 0.6, 0.58]);
    let dark = stage.lambert("dark", [0.0; 3]);
    let brass = stage.material("brass", rough_metal([0.84, 0.68, 0.4], 0.15));
    let glass = stage.material("glass", glass());
    let walls = RoomWalls {
        floor: Some(planks),
        ceiling: Some(plaster),
        left: Some(clay),
        right: Some(plaster),
        back: Some(plaster),
        front: Some(plaster),
    };
    stage.room([-1.9, 0.0, -2.0], [1.9, 2.5, 3.4], walls);

    // The floor lamp: its rim is above the eye, its light at the bottom of the bowl.
    let lamp = DVec3::new(-1.2, 1.66, -1.2);
    stage.cuboid("pole", DVec3::new(lamp.x, 0.82, lamp.z), DVec3::new(0.02, 0.82, 0.02), 0.0, brass);
    stage.mesh("bowl", shade(lamp - DVec3::Y * 0.02, DVec3::Y * 0.24, 0.06, 0.2), brass);
    let light = stage.rectangle("floor lamp", lamp, DVec3::Z * 0.04, DVec3::X * 0.04, dark);
    light.emission = Some(Rgb::new(1300.0, 1150.0, 900.0).into());

    // The spot: its cone lies within that of its shade, which points at the back wall.
    let (place, aim) = (DVec3::new(1.72, 1.55, -0.55), DVec3::new(0.75, 1.75, -2.0));
    let axis = (aim - place).normalize();
    stage.mesh("spot's shade", shade(place - axis * 0.04, axis * 0.2, 0.02, 0.1), enamel);
    stage.cuboid("bracket", DVec3::new(1.82, 1.53, -0.45), DVec3::new(0.08, 0.02, 0.02), 0.0, brass);
    let spot = DeltaLight::Spot {
        position: place,
        direction: axis,
        intensity: Rgb::new(5.0, 5.6, 7.0),
        beam: 10f64.to_radians(),
        cutoff: 14f64.to_radians(),
        image: None,
    };
    stage.description.lights.push(LightDescription { name: "spot".into(), kind: spot });

    // The table and its lamp.
    let table = DVec3::new(0.35, 0.7, -0.35);
    stage.cuboid("table top", table - DVec3::Y * 0.02, DVec3::new(0.6, 0.02, 0.45), 8.0, plaster);
    for (i, (x, z)) in [(-0.5, -0.35), (0.5, -0.35), (-0.5, 0.35), (0.5, 0.35)].into_iter().enumerate() {
        let place = DVec3::new(table.x + x, 0.34, table.z + z);
        stage.cuboid(&format!("table leg {}", i + 1), place, DVec3::new(0.025, 0.34, 0.025), 8.0, brass);
    }
    stage.sphere("glass ball", table + DVec3::new(-0.06, 0.19, 0.08), 0.17, glass);
    stage.cuboid("book", table + DVec3::new(0.33, 0.03, -0.12), DVec3::new(0.13, 0.03, 0.18), -25.0, cloth);
    let lamp = table + DVec3::new(0.06, 0.95, -0.02);
    stage.mesh("shade", shade(lamp + DVec3::Y * 0.03, DVec3::NEG_Y * 0.25, 0.12, 0.2), cloth);
    stage.cuboid("cord", lamp + DVec3::Y * 0.44, DVec3::new(0.006, 0.41, 0.006), 0.0, brass);
    let half = values.number("light");
    let light = stage.rectangle("table lamp", lamp, DVec3::X * half, DVec3::Z * half, dark);
    light.emission = Some((Rgb::new(1.0, 0.82, 0.6) * (0.17 / (half * half)) as f32).into());
    stage.finish(16)
}

/// A cut cone, closed at its start: a ring of faces from a circle of radius `first` about `start` to one of radius `last`
/// about `start + axis`, which face outwards, and a cap.
fn shade(start: DVec3, axis: DVec3, first: f64, last: f64) -> Mesh {
    let (u, v) = axis.normalize().any_orthonormal_pair();
    let mut mesh = Mesh::default();
    for (center, radius) in [(start, first), (start + axis, last)] {
        for i in 0..SEGMENTS {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(SEGMENTS)).sin_cos();
            mesh.positions.push((center + (u * cos + v * sin) * radius).as_vec3());
        }
    }
    mesh.positions.push(start.as_vec3());
    for i in 0..SEGMENTS {
        let next = (i + 1) % SEGMENTS;
        let (a, b) = ([i, next], [SEGMENTS + i, SEGMENTS + next]);
        mesh.triangles.extend([[a[0], a[1], b[1]], [a[0], b[1], b[0]], [2 * SEGMENTS, a[1], a[0]]]);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load;
    use glam::Vec3;

    #[test]
    fn shades_are_closed_and_face_outwards() {
        let axis = DVec3::new(1.0, 2.0, -0.5);
        let mesh = shade(DVec3::ZERO, axis, 0.1, 0.3);
        let inside = (axis * 0.5).as_vec3();
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            assert!((b - a).cross(c - a).dot((a + b + c) / 3.0 - inside) > 0.0);
        }
    }

    #[test]
    fn the_camera_sees_into_no_shade() {
        let scene = load("hidden-lights").unwrap().description;
        let eye = scene.camera.as_ref().unwrap().to_world.translation.as_vec3();
        for (name, shade) in [("floor lamp", "bowl"), ("table lamp", "shade")] {
            let object = |name: &str| scene.objects.iter().find(|o| o.name == name).unwrap();
            let lamp = object(name).to_world.translation.as_vec3();
            let normal = object(name).to_world.matrix3.z_axis.as_vec3();
            let etendue_core::scene::ObjectShape::Mesh(mesh) = &object(shade).shape else { panic!("a mesh") };
            // The eye is not on the open side of the shade's mouth.
            let mouth: Vec<Vec3> = mesh.positions[SEGMENTS as usize..2 * SEGMENTS as usize].to_vec();
            assert!(mouth.iter().all(|p| (*p - lamp).dot(normal) > 0.0), "{name}");
            assert!(mouth.iter().all(|p| (eye - *p).dot(normal) < 0.0), "{name}");
        }
    }
}
