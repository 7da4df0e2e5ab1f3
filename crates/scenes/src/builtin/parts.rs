//! What the built-in scenes are put together from.

use crate::{
    LoadedScene,
    placement::{look_at, rotation},
};
use etendue_core::{
    bsdf::{ConductorFresnel, Distribution, Roughness},
    camera::{CameraDescription, Projection},
    filter::Filter,
    geometry::Mesh,
    material::Material,
    rgb::Rgb,
    scene::{NamedMaterial, Object, ObjectShape, SceneDescription},
};
use glam::{DAffine3, DMat3, DVec3, UVec2, Vec2, Vec3};

/// Width and height of a built-in scene's image.
const RESOLUTION: u32 = 128;

/// A scene that is being built.
pub(super) struct Stage {
    pub(super) description: SceneDescription,
}

impl Stage {
    /// An empty scene, seen from `from` towards `to`, y up, with a horizontal field of view of `fov` degrees.
    pub(super) fn new(name: &str, from: DVec3, to: DVec3, fov: f64) -> Stage {
        let camera = CameraDescription {
            projection: Projection::Perspective { fov_x: fov.to_radians() },
            to_world: look_at(from, to, DVec3::Y).expect("a built-in scene's camera does not look straight up or down"),
            resolution: UVec2::splat(RESOLUTION),
            crop: None,
        };
        let description =
            SceneDescription { name: name.to_owned(), camera: Some(camera), ..SceneDescription::default() };
        Stage { description }
    }

    /// Adds a material that scatters on both sides.
    pub(super) fn material(&mut self, name: &str, material: Material) -> usize {
        self.description.materials.push(NamedMaterial { name: name.to_owned(), material, two_sided: true });
        self.description.materials.len() - 1
    }

    /// Adds a diffuse material that scatters on both sides.
    pub(super) fn lambert(&mut self, name: &str, reflectance: [f32; 3]) -> usize {
        self.material(name, Material::lambert(reflectance.into()))
    }

    fn object(&mut self, name: &str, shape: ObjectShape, to_world: DAffine3, material: usize) -> &mut Object {
        self.description.objects.push(Object {
            name: name.to_owned(),
            shape,
            to_world,
            material,
            emission: None,
            absorption: None,
        });
        self.description.objects.last_mut().expect("an object was just added")
    }

    /// Adds a flat quadrilateral, counter-clockwise seen from the side that its normal points to.
    ///
    /// Walls that share corners meet exactly, as their vertices are equal numbers.
    pub(super) fn quad(&mut self, name: &str, corners: [[f32; 3]; 4], material: usize) -> &mut Object {
        let mesh = Mesh {
            positions: corners.map(Vec3::from).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        self.mesh(name, mesh, material)
    }

    /// Adds the walls of the box from `min` to `max`, facing inwards; a wall without a material is left out.
    pub(super) fn room(&mut self, min: [f32; 3], max: [f32; 3], walls: RoomWalls) {
        let ([x0, y0, z0], [x1, y1, z1]) = (min, max);
        let wall = |stage: &mut Stage, name, corners, material: Option<usize>| {
            if let Some(material) = material {
                stage.quad(name, corners, material);
            }
        };
        wall(self, "floor", [[x0, y0, z0], [x0, y0, z1], [x1, y0, z1], [x1, y0, z0]], walls.floor);
        wall(self, "ceiling", [[x0, y1, z0], [x1, y1, z0], [x1, y1, z1], [x0, y1, z1]], walls.ceiling);
        wall(self, "left wall", [[x0, y0, z0], [x0, y1, z0], [x0, y1, z1], [x0, y0, z1]], walls.left);
        wall(self, "right wall", [[x1, y0, z0], [x1, y0, z1], [x1, y1, z1], [x1, y1, z0]], walls.right);
        wall(self, "back wall", [[x0, y0, z0], [x1, y0, z0], [x1, y1, z0], [x0, y1, z0]], walls.back);
        wall(self, "front wall", [[x0, y0, z1], [x0, y1, z1], [x1, y1, z1], [x1, y0, z1]], walls.front);
    }

    /// Adds a mesh.
    pub(super) fn mesh(&mut self, name: &str, mesh: Mesh, material: usize) -> &mut Object {
        self.object(name, ObjectShape::Mesh(mesh), DAffine3::IDENTITY, material)
    }

    /// Adds the parallelogram `center ± u ± v`, whose normal is `u x v`; `u` and `v` are at right angles.
    pub(super) fn rectangle(&mut self, name: &str, center: DVec3, u: DVec3, v: DVec3, material: usize) -> &mut Object {
        let axes = DMat3::from_cols(u, v, u.cross(v).normalize());
        let to_world = DAffine3::from_mat3_translation(axes, center);
        self.object(name, ObjectShape::Rectangle, to_world, material)
    }

    /// Adds a box about `center` of the given half edges, turned by `turn` degrees about the vertical.
    pub(super) fn cuboid(&mut self, name: &str, center: DVec3, half: DVec3, turn: f64, material: usize) -> &mut Object {
        let axes = rotation(DVec3::Y, turn) * DMat3::from_diagonal(half);
        let to_world = DAffine3::from_mat3_translation(axes, center);
        self.object(name, ObjectShape::Cube, to_world, material)
    }

    /// Adds a sphere.
    pub(super) fn sphere(&mut self, name: &str, center: DVec3, radius: f64, material: usize) -> &mut Object {
        let shape = ObjectShape::Sphere { center, radius, inverted: false };
        self.object(name, shape, DAffine3::IDENTITY, material)
    }

    /// The scene, to be rendered with a box filter.
    pub(super) fn finish(self, max_depth: u32) -> LoadedScene {
        LoadedScene {
            description: self.description,
            filter: Filter::Box,
            max_depth,
            roulette_depth: 5,
            samples: None,
            notes: Vec::new(),
            exact: None,
        }
    }
}

/// The materials of a room's walls: left is -x, back is -z.
#[derive(Clone, Copy, Default)]
pub(super) struct RoomWalls {
    pub(super) floor: Option<usize>,
    pub(super) ceiling: Option<usize>,
    pub(super) left: Option<usize>,
    pub(super) right: Option<usize>,
    pub(super) back: Option<usize>,
    pub(super) front: Option<usize>,
}

/// A smooth mirror.
pub(super) fn mirror(reflectance: [f32; 3]) -> Material {
    Material::conductor(ConductorFresnel::Constant(reflectance.into()), None)
}

/// A metal of GGX roughness with the same reflectance at every angle.
pub(super) fn rough_metal(reflectance: [f32; 3], alpha: f32) -> Material {
    Material::conductor(ConductorFresnel::Constant(reflectance.into()), Some(ggx(alpha)))
}

/// Smooth glass in vacuum.
pub(super) fn glass() -> Material {
    Material::dielectric(1.5, None)
}

/// The same GGX roughness in every direction.
pub(super) fn ggx(alpha: f32) -> Roughness {
    Roughness { distribution: Distribution::Ggx, alpha: Vec2::splat(alpha) }
}

/// A grey radiance.
pub(super) fn grey(radiance: f64) -> Rgb {
    Rgb::splat(radiance as f32)
}
