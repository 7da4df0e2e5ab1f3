//! Meshes: the vertices that a primitive's triangles use.

use super::{MOST_TRIANGLES, Notes, accessor::Accessor, data::Buffers, flaw, item, valid};
use crate::{error::Flaw, normals::vertex_normals};
use etendue_core::{geometry::Mesh, rgb::Rgb};
use glam::{Vec2, Vec3};
use gltf_json::{
    Root,
    mesh::{Mode, Primitive, Semantic},
    validation::Checked,
};
use std::collections::HashMap;

/// A primitive with what its material does not ask for left out.
pub(super) struct Geometry<'d> {
    root: &'d Root,
    buffers: &'d Buffers<'d>,
    primitive: &'d Primitive,
    /// Where it stands, for messages.
    place: String,
    /// The vertices of its triangles as the file counts them.
    triangles: Vec<[u32; 3]>,
}

impl<'d> Geometry<'d> {
    /// The triangles of a primitive; none if it has none.
    pub(super) fn open(
        root: &'d Root,
        buffers: &'d Buffers,
        (mesh, index): (usize, usize),
        notes: &mut Notes,
    ) -> Result<Option<Geometry<'d>>, Flaw> {
        let place = format!("meshes[{mesh}].primitives[{index}]");
        let primitive = item(&item(&root.meshes, "meshes", mesh)?.primitives, "primitives", index)?;
        let mode = valid(&primitive.mode, || place.clone())?;
        let Some(positions) = attribute(primitive, Semantic::Positions) else {
            notes.add(format!("{place} has no positions and is left out"));
            return Ok(None);
        };
        if primitive.targets.as_ref().is_some_and(|t| !t.is_empty()) {
            notes.add("morph targets are left out");
        }
        let vertices = item(&root.accessors, "accessors", positions)?.count.0;
        // Corners are counted before they are looked up: many primitives may name one long list.
        let count = match primitive.indices {
            Some(index) => item(&root.accessors, "accessors", index.value())?.count.0,
            None => vertices,
        };
        if count > 3 * MOST_TRIANGLES as u64 {
            return Err(flaw(format!("{place}: it has more than {MOST_TRIANGLES} triangles")));
        }
        let order = |count: usize| match mode {
            Mode::Triangles => Some((0..count / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect::<Vec<_>>()),
            // Every second triangle of a strip turns the other way round [glTF 2.0, sec. 3.7.2.1].
            Mode::TriangleStrip => {
                Some((0..count.saturating_sub(2)).map(|i| [i, i + 1 + i % 2, i + 2 - i % 2]).collect())
            }
            Mode::TriangleFan => Some((0..count.saturating_sub(2)).map(|i| [i + 1, i + 2, 0]).collect()),
            Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => None,
        };
        // Opened first, so that its claim is known to be true.
        let vertices = Accessor::open(root, buffers, positions)?.count;
        let triangles = match primitive.indices {
            None => order(vertices).map(|all| all.into_iter().map(|t| t.map(|i| i as u32)).collect::<Vec<_>>()),
            Some(index) => {
                let indices = Accessor::open(root, buffers, index.value())?;
                let mut wrong = None;
                let mut vertex = |corner: usize| {
                    let vertex = indices.whole(corner).filter(|v| (*v as usize) < vertices);
                    vertex.unwrap_or_else(|| {
                        wrong = wrong.or(Some(corner));
                        0
                    })
                };
                let triangles = order(indices.count).map(|all| all.into_iter().map(|t| t.map(&mut vertex)).collect());
                if let Some(corner) = wrong {
                    let message =
                        format!("{place}: its index {corner} is none of a vertex, of which there are {vertices}");
                    return Err(flaw(message));
                }
                triangles
            }
        };
        let Some(triangles) = triangles else {
            notes.add(format!("{place} consists of points or lines and is left out"));
            return Ok(None);
        };
        Ok((!triangles.is_empty()).then_some(Geometry { root, buffers, primitive, place, triangles }))
    }

    /// How many triangles it has.
    pub(super) fn triangles(&self) -> usize {
        self.triangles.len()
    }

    /// Whether it has vertex colours other than white.
    pub(super) fn is_coloured(&self) -> Result<bool, Flaw> {
        let colours = self.records(Semantic::Colors(0), &[3, 4])?;
        Ok(colours.is_some_and(|a| self.triangles.iter().flatten().any(|i| a.vector::<3>(*i as usize) != [1.0; 3])))
    }

    /// The mesh, with a set of texture coordinates if its material looks any up, and with its vertex colours times a factor.
    pub(super) fn mesh(&self, uvs: Option<u32>, colors: Option<Rgb>, notes: &mut Notes) -> Result<Mesh, Flaw> {
        // The vertices in use, in the order of their first one.
        let mut used: Vec<u32> = Vec::new();
        let mut places: HashMap<u32, u32> = HashMap::new();
        let mut place = |vertex: u32| {
            *places.entry(vertex).or_insert_with(|| {
                used.push(vertex);
                used.len() as u32 - 1
            })
        };
        let triangles = self.triangles.iter().map(|t| t.map(&mut place)).collect();
        let mut mesh = Mesh { triangles, ..Mesh::default() };
        if let Some(positions) = self.records(Semantic::Positions, &[3])? {
            mesh.positions = self.vectors(&positions, &used, "positions")?.into_iter().map(Vec3::from_array).collect();
        }
        if let Some(normals) = self.records(Semantic::Normals, &[3])? {
            mesh.normals = self.vectors(&normals, &used, "normals")?.into_iter().map(Vec3::from_array).collect();
            if mesh.normals.contains(&Vec3::ZERO) {
                let fallback = vertex_normals(&mesh);
                mesh.normals.iter_mut().zip(fallback).filter(|(n, _)| **n == Vec3::ZERO).for_each(|(n, f)| *n = f);
            }
        }
        if let Some(set) = uvs {
            mesh.uvs = match self.records(Semantic::TexCoords(set), &[2])? {
                // v grows downwards in glTF.
                Some(records) => {
                    let flipped = |[u, v]: [f32; 2]| Vec2::new(u, 1.0 - v);
                    self.vectors(&records, &used, "texture coordinates")?.into_iter().map(flipped).collect()
                }
                None => {
                    notes.add(format!(
                        "{} lacks the texture coordinates that its material uses; they are 0",
                        self.place
                    ));
                    vec![Vec2::ZERO; used.len()]
                }
            };
        }
        if let (Some(factor), Some(colours)) = (colors, self.records(Semantic::Colors(0), &[3, 4])?) {
            let tinted = |c: [f32; 3]| (Rgb::from(c) * factor).map(|c| c.clamp(0.0, 1.0));
            mesh.colors = self.vectors(&colours, &used, "colours")?.into_iter().map(tinted).collect();
        }
        Ok(mesh)
    }

    /// The accessor of an attribute, which has one of several widths.
    fn records(&self, semantic: Semantic, widths: &[usize]) -> Result<Option<Accessor<'d>>, Flaw> {
        let Some(index) = attribute(self.primitive, semantic.clone()) else { return Ok(None) };
        let accessor = Accessor::open(self.root, self.buffers, index)?;
        let vertices = match attribute(self.primitive, Semantic::Positions) {
            Some(positions) => item(&self.root.accessors, "accessors", positions)?.count.0,
            None => 0,
        };
        if (accessor.count as u64) < vertices {
            let message = format!("{}: {} {semantic:?} for {vertices} vertices", self.place, accessor.count);
            return Err(flaw(message));
        }
        if !widths.contains(&accessor.components) {
            return Err(flaw(format!("{}: {semantic:?} of {} numbers each", self.place, accessor.components)));
        }
        Ok(Some(accessor))
    }

    /// Finite vectors of vertices.
    fn vectors<const N: usize>(&self, accessor: &Accessor, used: &[u32], what: &str) -> Result<Vec<[f32; N]>, Flaw> {
        let vectors: Vec<[f32; N]> = used.iter().map(|i| accessor.vector(*i as usize)).collect();
        match vectors.iter().flatten().all(|v| v.is_finite()) {
            true => Ok(vectors),
            false => Err(flaw(format!("{}: one of its {what} is not finite", self.place))),
        }
    }
}

fn attribute(primitive: &Primitive, semantic: Semantic) -> Option<usize> {
    primitive.attributes.get(&Checked::Valid(semantic)).map(|index| index.value())
}
