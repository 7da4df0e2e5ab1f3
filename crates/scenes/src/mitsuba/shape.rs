//! Shapes.

use super::{Import, emitter::area_radiance, plugin::Plugin};
use crate::{
    cube::inward_cube,
    error::{LoadError, read_file},
    normals::vertex_normals,
    obj, ply,
};
use etendue_core::{
    geometry::Mesh,
    scene::{Object, ObjectShape},
};
use glam::{DAffine3, DVec3, Vec3};
use roxmltree::Node;

const KINDS: [&str; 6] = ["rectangle", "cube", "sphere", "disk", "obj", "ply"];

impl<'d> Import<'_, 'd> {
    /// Adds a shape with its material and, for a light, what it emits.
    pub(super) fn shape(&mut self, node: Node<'d, 'd>) -> Result<(), LoadError> {
        let plugin = Plugin::new(self.reader, node)?;
        let name = match node.attribute("id") {
            Some(id) => id.to_owned(),
            None => format!("{} in line {}", plugin.kind, self.reader.line(node)),
        };
        let mut to_world = plugin.to_world()?;
        let flip = plugin.boolean("flip_normals")?.unwrap_or(false);
        let shape = match plugin.kind.as_str() {
            "rectangle" | "disk" => {
                if flip {
                    // Mitsuba mirrors z, which leaves the shape and turns its normal.
                    to_world *= DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0));
                }
                if plugin.kind == "disk" { ObjectShape::Disk } else { ObjectShape::Rectangle }
            }
            "cube" if flip => ObjectShape::Mesh(inward_cube(1.0)),
            "cube" => ObjectShape::Cube,
            "sphere" => {
                let radius = plugin.positive("radius")?.unwrap_or(1.0);
                let center = plugin.vector("center")?.unwrap_or(DVec3::ZERO);
                // In Mitsuba a reflection turns a sphere's normals, unlike other shapes'.
                let reflected = to_world.matrix3.determinant() < 0.0;
                if reflected {
                    self.notes.push(format!("{name}: its transform reflects, which turns a sphere's normals"));
                }
                ObjectShape::Sphere { center, radius, inverted: flip != reflected }
            }
            "obj" | "ply" => ObjectShape::Mesh(mesh(&plugin, flip)?),
            _ => return Err(plugin.unknown_kind(&KINDS)),
        };
        let material = self.materials.of_shape(plugin.single("bsdf")?, &name)?;
        let emission = match plugin.single("emitter")? {
            Some(emitter) => Some(area_radiance(self.reader, emitter)?.into()),
            None => None,
        };
        plugin.finish()?;
        self.description.objects.push(Object { name, shape, to_world, material, emission, absorption: None });
        Ok(())
    }
}

/// A mesh from a file, with the normals that Mitsuba would give it; a normal of zero length gives way to a computed one.
fn mesh(plugin: &Plugin, flip: bool) -> Result<Mesh, LoadError> {
    let path = plugin.file("filename")?;
    let is_obj = plugin.kind == "obj";
    let bytes = read_file(&path, if is_obj { obj::LARGEST_FILE } else { ply::LARGEST_FILE })?;
    let read = if is_obj { obj::read(&bytes) } else { ply::read(&bytes) };
    let mut mesh = read.map_err(|flaw| flaw.of(&path))?;
    if plugin.boolean("face_normals")?.unwrap_or(false) {
        mesh.normals.clear();
    } else if mesh.normals.is_empty() {
        mesh.normals = vertex_normals(&mesh);
    } else if mesh.normals.contains(&Vec3::ZERO) {
        let fallback = vertex_normals(&mesh);
        mesh.normals.iter_mut().zip(fallback).filter(|(n, _)| **n == Vec3::ZERO).for_each(|(n, f)| *n = f);
    }
    // Mitsuba's default is to flip for OBJ alone.
    if plugin.boolean("flip_tex_coords")?.unwrap_or(is_obj) {
        mesh.uvs.iter_mut().for_each(|uv| uv.y = 1.0 - uv.y);
    }
    if flip {
        mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        mesh.normals.iter_mut().for_each(|n| *n = -*n);
    }
    Ok(mesh)
}
