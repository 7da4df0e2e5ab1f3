//! Shapes, groups of shapes and their instances.

use super::{Import, ahead::MeshFile, emitter::area_radiance, medium::absorption, plugin::Plugin, tree::Node};
use crate::{cube::inward_cube, error::LoadError, normals::vertex_normals, tessellate::tessellated};
use etendue_core::{
    geometry::Mesh,
    scene::{Group, GroupInstance, Object, ObjectShape},
};
use glam::{DAffine3, DVec3, Vec2, Vec3};

const KINDS: [&str; 11] =
    ["rectangle", "cube", "sphere", "disk", "cylinder", "obj", "ply", "serialized", "shapegroup", "instance", "merge"];

impl<'d> Import<'_, 'd> {
    /// Adds a shape of the scene.
    pub(super) fn shape(&mut self, node: Node<'d>) -> Result<(), LoadError> {
        let plugin = Plugin::new(self.reader, node)?;
        match plugin.kind {
            "shapegroup" => self.group(&plugin).map(drop),
            "instance" => self.instance(&plugin),
            "merge" => {
                for (inner, place) in plugin.nested("shape") {
                    if Plugin::new(self.reader, inner)?.kind == "merge" {
                        return Err(place.error("a `merge` inside another is not supported"));
                    }
                    self.shape(inner)?;
                }
                plugin.finish()
            }
            _ => {
                let object = self.object(&plugin)?;
                self.description.objects.push(object);
                Ok(())
            }
        }
    }

    /// The index of a group of shapes, which is read once.
    fn group(&mut self, plugin: &Plugin<'_, 'd>) -> Result<usize, LoadError> {
        if let Some(index) = self.groups.get(&plugin.node.key()) {
            return Ok(*index);
        }
        let mut objects = Vec::new();
        for (node, place) in plugin.nested("shape") {
            let inner = Plugin::new(self.reader, node)?;
            if matches!(inner.kind, "shapegroup" | "instance") {
                let error = place.error(format!("a group of shapes holds no `{}`", inner.kind));
                self.reader.forgive(error, "it is left out")?;
                continue;
            }
            let object = self.object(&inner);
            let Some(object) = self.reader.forgiven(object, "the shape is left out")? else { continue };
            if object.emission.is_some() {
                let error = place.error("a shape in a group emits light, which is not supported");
                self.reader.forgive(error, "it is left out")?;
                continue;
            }
            objects.push(object);
        }
        plugin.transform("to_world")?.map_or(Ok(()), |_| {
            let error = plugin.error_at("to_world", "a group of shapes has no place of its own; its instances have");
            self.reader.forgive(error, "it is passed over")
        })?;
        plugin.finish()?;
        self.description.groups.push(Group { name: plugin.node.called(), objects });
        let index = self.description.groups.len() - 1;
        self.groups.insert(plugin.node.key(), index);
        Ok(index)
    }

    fn instance(&mut self, plugin: &Plugin<'_, 'd>) -> Result<(), LoadError> {
        let to_world = plugin.to_world()?;
        let [(node, place)] = plugin.nested("shape")[..] else {
            return Err(plugin.error("the shape type `instance` needs one group of shapes"));
        };
        let group = Plugin::new(self.reader, node)?;
        if group.kind != "shapegroup" {
            return Err(place.error(format!("an instance is of a `shapegroup`, not of a `{}`", group.kind)));
        }
        let group = self.group(&group)?;
        plugin.finish()?;
        self.description.instances.push(GroupInstance { group, to_world });
        Ok(())
    }

    /// A shape with its material and, for a light, what it emits.
    fn object(&mut self, plugin: &Plugin<'_, 'd>) -> Result<Object, LoadError> {
        let name = plugin.node.called();
        let mut to_world = plugin.to_world()?;
        let flip = plugin.boolean("flip_normals")?.unwrap_or(false);
        // Of use for derivatives only.
        plugin.float("silhouette_sampling_weight")?;
        let mut shape = match plugin.kind {
            "rectangle" | "disk" => {
                if flip {
                    // Mitsuba mirrors z, which leaves the shape and turns its normal.
                    to_world *= DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0));
                }
                if plugin.kind == "disk" { ObjectShape::Disk } else { ObjectShape::Rectangle }
            }
            "cube" => {
                // Its faces are flat whatever this says.
                plugin.boolean("face_normals")?;
                if flip { ObjectShape::Mesh(inward_cube(1.0)) } else { ObjectShape::Cube }
            }
            "sphere" => {
                let radius = plugin.positive("radius")?.unwrap_or(1.0);
                let center = plugin.vector("center")?.unwrap_or(DVec3::ZERO);
                // In Mitsuba a reflection turns a sphere's normals, unlike other shapes'.
                let reflected = to_world.matrix3.determinant() < 0.0;
                if reflected {
                    self.reader.note(format!("{name}: its transform reflects, which turns a sphere's normals"));
                }
                ObjectShape::Sphere { center, radius, inverted: flip != reflected }
            }
            "cylinder" => {
                let from = plugin.vector("p0")?.unwrap_or(DVec3::ZERO);
                let to = plugin.vector("p1")?.unwrap_or(DVec3::Z);
                let radius = plugin.positive("radius")?.unwrap_or(1.0);
                if from == to {
                    return Err(plugin.error("the ends `p0` and `p1` of the cylinder are the same"));
                }
                ObjectShape::Cylinder { from, to, radius, inverted: flip }
            }
            "obj" => ObjectShape::Mesh(mesh(plugin, MeshFile::Obj, flip, &to_world)?),
            "ply" => ObjectShape::Mesh(mesh(plugin, MeshFile::Ply, flip, &to_world)?),
            "serialized" => {
                let index = plugin.integer("shape_index", 0..=i64::from(u32::MAX))?.unwrap_or(0);
                ObjectShape::Mesh(mesh(plugin, MeshFile::Serialized(index as usize), flip, &to_world)?)
            }
            _ => return Err(plugin.unknown_kind(&KINDS)),
        };
        if !shape.stays_itself(&to_world)
            && let Some(mesh) = tessellated(&shape)
        {
            self.reader.note(format!("{name}: its transform scales unevenly; a fine mesh stands for it"));
            shape = ObjectShape::Mesh(mesh);
        }
        let emitter = plugin.single("emitter")?;
        let met = self.reader.images.vertex_colors();
        let emission = match emitter {
            Some(emitter) => {
                let read = area_radiance(self.reader, emitter);
                self.reader.forgiven(read, "it emits nothing")?
            }
            None => None,
        };
        let emits_colors = self.reader.images.vertex_colors() > met;
        let material = self.materials.of_shape(plugin.single("bsdf")?, &name, emission.is_some())?;
        if material.vertex_colors || emits_colors {
            self.check_colors(plugin, &mut shape, material.vertex_colors)?;
        }
        let absorption = absorption(plugin)?;
        plugin.finish()?;
        Ok(Object { name, shape, to_world, material: material.index, emission, absorption })
    }

    /// A material or light that takes vertex colours needs some, a material such as a surface may have.
    fn check_colors(&self, plugin: &Plugin<'_, 'd>, shape: &mut ObjectShape, reflects: bool) -> Result<(), LoadError> {
        let ObjectShape::Mesh(mesh) = shape else {
            let error = plugin.error(format!("a `{}` has no vertex colours, which its texture asks for", plugin.kind));
            return self.reader.forgive(error, "they count as white");
        };
        if mesh.colors.is_empty() && !mesh.positions.is_empty() {
            let error = plugin.error("the mesh has no vertex colours, which its texture asks for");
            return self.reader.forgive(error, "they count as white");
        }
        let above = mesh.colors.iter().filter(|c| c.max_element() > 1.0).count();
        if reflects && above > 0 {
            mesh.colors.iter_mut().for_each(|c| *c = c.map(|v| v.min(1.0)));
            self.reader
                .note(format!("{}: {above} vertex colours are above 1 and are moved there", plugin.node.called()));
        }
        Ok(())
    }
}

/// A mesh from a file, with the normals that Mitsuba would give it; a normal of zero length gives way to a computed one.
fn mesh(plugin: &Plugin, kind: MeshFile, flip: bool, to_world: &DAffine3) -> Result<Mesh, LoadError> {
    let path = plugin.file("filename")?;
    let name = plugin.node.called();
    let (mut mesh, notes) = plugin.reader.ahead.mesh(kind, path.clone())?;
    for note in notes {
        plugin.reader.note(format!("{}: {note}", path.display()));
    }
    // Mitsuba's default is to flip for OBJ alone.
    if plugin.boolean("flip_tex_coords")?.unwrap_or(kind == MeshFile::Obj) {
        mesh.uvs.iter_mut().for_each(|uv| uv.y = 1.0 - uv.y);
    }
    let flat = plugin.boolean("face_normals")?.unwrap_or(false);
    let own_normals = !flat && !mesh.normals.is_empty();
    if flat {
        mesh.normals.clear();
    } else if !own_normals {
        mesh.normals = vertex_normals(&mesh);
    } else if mesh.normals.contains(&Vec3::ZERO) {
        let fallback = vertex_normals(&mesh);
        mesh.normals.iter_mut().zip(fallback).filter(|(n, _)| **n == Vec3::ZERO).for_each(|(n, f)| *n = f);
    }
    let mirrored = to_world.matrix3.determinant() < 0.0;
    let mut turned = vec![false; mesh.triangles.len()];
    if own_normals {
        turned = against_normals(&mesh);
    } else if mirrored {
        // Mitsuba takes the winding of what it has placed in the world.
        plugin.reader.note(format!("{name}: its transform reflects, which turns a mesh without normals inside out"));
        turned.fill(true);
        mesh.normals.iter_mut().for_each(|n| *n = -*n);
    }
    if flip {
        turned.iter_mut().for_each(|turned| *turned = !*turned);
        mesh.normals.iter_mut().for_each(|n| *n = -*n);
    }
    // The scene winds the faces of a mirrored mesh once more.
    if mesh.uvs.is_empty() && turned.iter().any(|turned| *turned != mirrored) {
        mesh = with_barycentrics(&mesh);
    }
    for (triangle, _) in mesh.triangles.iter_mut().zip(turned).filter(|(_, turned)| *turned) {
        triangle.swap(1, 2);
    }
    Ok(mesh)
}

/// The mesh with the barycentric coordinates of each triangle as texture coordinates, which stand for missing ones: they
/// are those of the corners in the order of the file, however a face is turned.
fn with_barycentrics(mesh: &Mesh) -> Mesh {
    let corners = || mesh.triangles.iter().flatten().map(|i| *i as usize);
    let count = corners().count() as u32;
    let of = |normals: &[Vec3]| if normals.is_empty() { Vec::new() } else { corners().map(|i| normals[i]).collect() };
    Mesh {
        positions: of(&mesh.positions),
        normals: of(&mesh.normals),
        uvs: [Vec2::ZERO, Vec2::X, Vec2::Y].into_iter().cycle().take(count as usize).collect(),
        colors: if mesh.colors.is_empty() { Vec::new() } else { corners().map(|i| mesh.colors[i]).collect() },
        triangles: (0..count / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
    }
}

/// For each face, `true` if it looks away from its vertex normals, which decide, as in Mitsuba and pbrt.
fn against_normals(mesh: &Mesh) -> Vec<bool> {
    let is_against = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|i| mesh.positions[i as usize].as_dvec3());
        let sum: DVec3 = triangle.iter().map(|i| mesh.normals[*i as usize].as_dvec3().normalize_or_zero()).sum();
        (b - a).cross(c - a).dot(sum) < 0.0
    };
    mesh.triangles.iter().map(is_against).collect()
}
