//! Meshes in Wavefront OBJ files.
//!
//! Read are `v`, `vn`, `vt` and `f` with positive or negative indices; polygons are cut into fans. Names, groups and
//! materials are passed over; curves, lines and points are refused.

use crate::{
    error::{Flaw, Place, abridged},
    normals::vertex_normals,
};
use etendue_core::geometry::Mesh;
use glam::{Vec2, Vec3};
use std::collections::HashMap;

/// The largest file that is read.
pub const LARGEST_FILE: u64 = u32::MAX as u64;

/// A corner of a face: indices of a position, a texture coordinate and a normal.
type Corner = (u32, Option<u32>, Option<u32>);

#[derive(Default)]
struct Reader {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    /// The vertex of the mesh that a corner became.
    vertices: HashMap<Corner, u32>,
    corners: Vec<Corner>,
    triangles: Vec<[u32; 3]>,
}

/// Reads a mesh; its indices are in range and its numbers finite. Each distinct corner of faces is one vertex.
///
/// If some corners have normals and others none, those without get the normal of the faces around.
///
/// # Errors
///
/// Anything that is wrong, with its line.
pub fn read(bytes: &[u8]) -> Result<Mesh, Flaw> {
    let mut reader = Reader::default();
    for (index, line) in bytes.split(|b| *b == b'\n').enumerate() {
        let flaw = |message| Flaw::new(Place::Line(index as u32 + 1), message);
        reader.statement(line).map_err(flaw)?;
    }
    Ok(reader.finish())
}

impl Reader {
    fn statement(&mut self, line: &[u8]) -> Result<(), String> {
        let line = line.split(|b| *b == b'#').next().unwrap_or_default().trim_ascii();
        let keyword_end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
        let (keyword, rest) = line.split_at(keyword_end);
        // Names may be in any encoding.
        if matches!(keyword, b"" | b"o" | b"g" | b"s" | b"usemtl" | b"mtllib") {
            return Ok(());
        }
        let rest = std::str::from_utf8(rest).map_err(|_| "the text is not UTF-8".to_owned())?;
        match keyword {
            // A weight or a colour may follow the position.
            b"v" => self.positions.push(Vec3::from(numbers::<3>(rest, &[3, 4, 6, 7])?)),
            b"vn" => self.normals.push(Vec3::from(numbers::<3>(rest, &[3])?)),
            b"vt" => self.uvs.push(Vec2::from(numbers::<2>(rest, &[1, 2, 3])?)),
            b"f" => return self.face(rest),
            other => {
                let name = String::from_utf8_lossy(&other[..other.len().min(40)]).into_owned();
                return Err(format!("the statement `{name}` is not supported"));
            }
        }
        Ok(())
    }

    fn face(&mut self, text: &str) -> Result<(), String> {
        let mut corners = text.split_ascii_whitespace();
        let mut corner = |reader: &mut Reader| corners.next().map(|word| reader.corner(word)).transpose();
        let (Some(first), Some(mut previous)) = (corner(self)?, corner(self)?) else {
            return Err("a face has fewer than 3 vertices".to_owned());
        };
        let mut next = corner(self)?.ok_or("a face has fewer than 3 vertices")?;
        loop {
            self.triangles.push([first, previous, next]);
            previous = next;
            match corner(self)? {
                Some(vertex) => next = vertex,
                None => return Ok(()),
            }
        }
    }

    /// The vertex of a corner `position/uv/normal`, of which the last two may be missing.
    fn corner(&mut self, word: &str) -> Result<u32, String> {
        let mut parts = word.split('/');
        let position = resolve(parts.next(), self.positions.len(), "vertex")?;
        let position = position.ok_or_else(|| format!("`{}` has no vertex", abridged(word)))?;
        let uv = resolve(parts.next(), self.uvs.len(), "texture coordinate")?;
        let normal = resolve(parts.next(), self.normals.len(), "normal")?;
        if parts.next().is_some() {
            return Err(format!("`{}` has more than three indices", abridged(word)));
        }
        let corner = (position, uv, normal);
        Ok(*self.vertices.entry(corner).or_insert_with(|| {
            self.corners.push(corner);
            self.corners.len() as u32 - 1
        }))
    }

    fn finish(self) -> Mesh {
        let Reader { positions, normals, uvs, corners, triangles, .. } = self;
        let at = |i: u32| i as usize;
        let mut mesh = Mesh {
            colors: Vec::new(),
            positions: corners.iter().map(|c| positions[at(c.0)]).collect(),
            normals: Vec::new(),
            uvs: Vec::new(),
            triangles,
        };
        if corners.iter().any(|c| c.1.is_some()) {
            mesh.uvs = corners.iter().map(|c| c.1.map_or(Vec2::ZERO, |i| uvs[at(i)])).collect();
        }
        if corners.iter().all(|c| c.2.is_none()) {
            return mesh;
        }
        let fallback = if corners.iter().any(|c| c.2.is_none()) { vertex_normals(&mesh) } else { Vec::new() };
        let normal = |(i, c): (usize, &Corner)| c.2.map_or_else(|| fallback[i], |n| normals[at(n)]);
        mesh.normals = corners.iter().enumerate().map(normal).collect();
        mesh
    }
}

/// An index counted from 1, or backwards from -1, as one from 0; none if it is left out.
fn resolve(part: Option<&str>, count: usize, what: &str) -> Result<Option<u32>, String> {
    let Some(part) = part.filter(|p| !p.is_empty()) else { return Ok(None) };
    let index: i64 = part.parse().map_err(|_| format!("`{}` is not an index", abridged(part)))?;
    let from_zero = if index < 0 { count as i64 + index } else { index - 1 };
    if !(0..count as i64).contains(&from_zero) {
        return Err(format!("the {what} {index} is not among the {count} so far"));
    }
    Ok(Some(from_zero as u32))
}

/// The first `N` numbers of a text that has as many as one of `counts`; missing ones are 0.
fn numbers<const N: usize>(text: &str, counts: &[usize]) -> Result<[f32; N], String> {
    let mut out = [0.0; N];
    let mut count = 0;
    for word in text.split_ascii_whitespace() {
        let value: f32 = word.parse().map_err(|_| format!("`{}` is not a number", abridged(word)))?;
        if !value.is_finite() {
            return Err(format!("`{}` is not a finite number", abridged(word)));
        }
        if let Some(slot) = out.get_mut(count) {
            *slot = value;
        }
        count += 1;
    }
    if !counts.contains(&count) {
        return Err(format!("{count} numbers where {} belong", counts[0]));
    }
    Ok(out)
}
