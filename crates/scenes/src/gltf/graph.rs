//! The hierarchy of nodes: what stands where.

use super::{
    MOST_TRIANGLES, Notes,
    camera::{camera, default_camera},
    data::Buffers,
    document::Document,
    flaw, item,
    light::light,
    material::{Materials, Surface},
    mesh::Geometry,
    texture::Textures,
};
use crate::{
    error::{Flaw, abridged},
    folders::Folders,
};
use etendue_core::{
    geometry::Mesh,
    lights::environment::Environment,
    rgb::Rgb,
    scene::{Group, GroupInstance, Object, ObjectShape, SceneDescription},
};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use gltf_json::{Root, scene::Node};
use std::collections::{HashMap, HashSet};

/// A node of the scene with its place in the world.
struct Placed<'d> {
    index: usize,
    node: &'d Node,
    to_world: DAffine3,
}

/// The scene of a file.
pub(super) fn scene(
    document: &Document,
    buffers: &Buffers,
    folders: Option<&Folders>,
    notes: &mut Notes,
) -> Result<SceneDescription, Flaw> {
    let root = &document.root;
    let nodes = nodes(root, notes)?;
    let mut scene = SceneDescription::default();
    let mut builder = Builder {
        root,
        buffers,
        materials: Materials::new(root, Textures::new(root, buffers, folders)),
        triangles: 0,
        names: HashMap::new(),
    };
    builder.meshes(&nodes, &mut scene, notes)?;
    scene.materials = builder.materials.list;

    for placed in &nodes {
        if let Some(index) = placed.node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref()) {
            let light = light(root, index.light.value(), &placed.to_world, &name_of(placed), notes)?;
            scene.lights.push(light);
        }
        if let Some(index) = placed.node.camera {
            match &scene.camera {
                None => scene.camera = Some(camera(root, index.value(), &placed.to_world)?),
                Some(_) => notes.add("the first of several cameras is taken"),
            }
        }
    }
    if scene.objects.is_empty() && scene.instances.is_empty() {
        notes.add("the scene has no surfaces");
    }
    if scene.camera.is_none() {
        let camera =
            default_camera(&scene).ok_or_else(|| flaw("the scene has neither a camera nor surfaces to see"))?;
        scene.camera = Some(camera);
        notes.add("the scene has no camera; it is seen from the front, above, and right");
    }
    if scene.lights.is_empty() && scene.objects.iter().all(|o| o.emission.is_none()) {
        scene.environment = Some(Environment::Constant(Rgb::WHITE));
        notes.add("the scene has no light; its environment is white");
    }
    Ok(scene)
}

/// The nodes of the scene that the file shows, parents first.
fn nodes<'d>(root: &'d Root, notes: &mut Notes) -> Result<Vec<Placed<'d>>, Flaw> {
    let mut roots: Vec<usize> = match (root.scene, root.scenes.first()) {
        (Some(index), _) => item(&root.scenes, "scenes", index.value())?.nodes.iter().map(|n| n.value()).collect(),
        (None, Some(first)) => first.nodes.iter().map(|n| n.value()).collect(),
        (None, None) => {
            // Without a scene, all that is nobody's child.
            let children: HashSet<usize> =
                root.nodes.iter().flat_map(|n| n.children.iter().flatten()).map(|n| n.value()).collect();
            (0..root.nodes.len()).filter(|i| !children.contains(i)).collect()
        }
    };
    if root.scenes.len() > 1 {
        notes.add(format!("one of {} scenes is shown", root.scenes.len()));
    }
    if !root.animations.is_empty() {
        notes.add("animations are left out");
    }
    roots.reverse();
    let mut open: Vec<(usize, DAffine3)> = roots.into_iter().map(|i| (i, DAffine3::IDENTITY)).collect();
    let mut seen = vec![false; root.nodes.len()];
    let mut placed = Vec::new();
    while let Some((index, parent)) = open.pop() {
        let node = item(&root.nodes, "nodes", index)?;
        if std::mem::replace(&mut seen[index], true) {
            return Err(flaw(format!("nodes[{index}] stands in the hierarchy twice")));
        }
        let to_world = parent * transform(node, index)?;
        if !to_world.is_finite() {
            return Err(flaw(format!("nodes[{index}]: its transform is not finite in the world")));
        }
        if node.skin.is_some() {
            notes.add("skins are left out; what they move stands as it was modelled");
        }
        let children = node.children.iter().flatten().rev();
        open.extend(children.map(|child| (child.value(), to_world)));
        placed.push(Placed { index, node, to_world });
    }
    Ok(placed)
}

/// From a node's space to its parent's.
fn transform(node: &Node, index: usize) -> Result<DAffine3, Flaw> {
    if let Some(m) = node.matrix {
        let column = |i: usize| DVec3::new(f64::from(m[4 * i]), f64::from(m[4 * i + 1]), f64::from(m[4 * i + 2]));
        if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
            return Err(flaw(format!("nodes[{index}]: its matrix is not affine")));
        }
        let linear = DMat3::from_cols(column(0), column(1), column(2));
        return Ok(DAffine3::from_mat3_translation(linear, column(3)));
    }
    let vector = |v: [f32; 3]| DVec3::from(v.map(f64::from));
    let rotation = node.rotation.map_or(DQuat::IDENTITY, |q| DQuat::from_array(q.0.map(f64::from)));
    let length = rotation.length();
    if !(length.is_finite() && length > 0.0) {
        return Err(flaw(format!("nodes[{index}]: its rotation is none")));
    }
    Ok(DAffine3::from_scale_rotation_translation(
        node.scale.map_or(DVec3::ONE, vector),
        rotation.normalize(),
        node.translation.map_or(DVec3::ZERO, vector),
    ))
}

fn name_of(placed: &Placed) -> String {
    placed.node.name.as_deref().map_or_else(|| format!("nodes[{}]", placed.index), str::to_owned)
}

/// Whether what is placed so has an extent in every direction.
fn is_regular(to_world: &DAffine3) -> bool {
    let m = to_world.matrix3;
    let size = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
    // As the core judges it.
    size.is_finite() && size > 0.0 && m.determinant().abs() > 1e-12 * size
}

/// A primitive's mesh with its material.
struct Part {
    mesh: Mesh,
    surface: Surface,
}

struct Builder<'d> {
    root: &'d Root,
    buffers: &'d Buffers<'d>,
    materials: Materials<'d>,
    /// How many triangles there are so far.
    triangles: usize,
    /// The names of objects so far, each with how often it was asked for.
    names: HashMap<String, usize>,
}

impl Builder<'_> {
    /// Places the meshes: as they are, or as a group if a mesh without lights stands in several places.
    fn meshes(&mut self, nodes: &[Placed], scene: &mut SceneDescription, notes: &mut Notes) -> Result<(), Flaw> {
        let mut places: Vec<Vec<&Placed>> = self.root.meshes.iter().map(|_| Vec::new()).collect();
        // By the first node of each, so that the order is that of the file.
        let mut order = Vec::new();
        for placed in nodes {
            let Some(mesh) = placed.node.mesh.map(|m| m.value()) else { continue };
            item(&self.root.meshes, "meshes", mesh)?;
            if !is_regular(&placed.to_world) {
                notes.add(format!("the node `{}` is flat or a point and is left out", abridged(&name_of(placed))));
                continue;
            }
            if places[mesh].is_empty() {
                order.push(mesh);
            }
            places[mesh].push(placed);
        }
        for mesh in order {
            let parts = self.parts(mesh, notes)?;
            let placed = &places[mesh];
            let emits = parts.iter().any(|p| p.surface.emission.is_some());
            if placed.len() > 1 && !emits && !parts.is_empty() {
                let mesh_name = self.root.meshes[mesh].name.clone().unwrap_or_else(|| format!("meshes[{mesh}]"));
                let name = self.unique(mesh_name);
                let objects = self.objects(parts, &name, DAffine3::IDENTITY);
                let group = scene.groups.len();
                scene.groups.push(Group { name, objects });
                scene.instances.extend(placed.iter().map(|p| GroupInstance { group, to_world: p.to_world }));
                continue;
            }
            let Some((last, others)) = placed.split_last() else { continue };
            for p in others {
                let copies = parts.iter().map(|p| Part { mesh: p.mesh.clone(), surface: p.surface.clone() }).collect();
                self.count(parts.iter().map(|p| p.mesh.triangles.len()).sum())?;
                let name = self.unique(name_of(p));
                scene.objects.extend(self.objects(copies, &name, p.to_world));
            }
            let name = self.unique(name_of(last));
            scene.objects.extend(self.objects(parts, &name, last.to_world));
        }
        Ok(())
    }

    /// The primitives of a mesh.
    fn parts(&mut self, mesh: usize, notes: &mut Notes) -> Result<Vec<Part>, Flaw> {
        let mut parts = Vec::new();
        for (index, primitive) in item(&self.root.meshes, "meshes", mesh)?.primitives.iter().enumerate() {
            let Some(geometry) = Geometry::open(self.root, self.buffers, (mesh, index), notes)? else { continue };
            self.count(geometry.triangles())?;
            let colored = geometry.is_coloured()?;
            let surface = self.materials.surface(primitive.material.map(|m| m.value()), colored, notes)?;
            let mesh = geometry.mesh(surface.uvs, surface.colors, notes)?;
            parts.push(Part { mesh, surface });
        }
        Ok(parts)
    }

    fn count(&mut self, triangles: usize) -> Result<(), Flaw> {
        self.triangles += triangles;
        match self.triangles > MOST_TRIANGLES {
            true => Err(flaw(format!("the scene has more than {MOST_TRIANGLES} triangles"))),
            false => Ok(()),
        }
    }

    fn objects(&mut self, parts: Vec<Part>, name: &str, to_world: DAffine3) -> Vec<Object> {
        let single = parts.len() == 1;
        let object = |(index, part): (usize, Part)| Object {
            name: if single { name.to_owned() } else { format!("{name}/{index}") },
            shape: ObjectShape::Mesh(part.mesh),
            to_world,
            material: part.surface.material,
            emission: part.surface.emission,
            absorption: part.surface.absorption,
        };
        parts.into_iter().enumerate().map(object).collect()
    }

    /// A name that no object has yet.
    fn unique(&mut self, name: String) -> String {
        let number = *self.names.entry(name.clone()).and_modify(|n| *n += 1).or_insert(1);
        match number {
            1 => name,
            // A name of this form might be there by itself.
            _ => self.unique(format!("{name} ({number})")),
        }
    }
}
