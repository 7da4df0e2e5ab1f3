//! Meshes in Wavefront OBJ files.
//!
//! `v`, `vn`, `vt` and `f` are read, with positive or negative indices; polygons are cut into fans. Names, groups and
//! materials are passed over. So is what has no surface, with a note: points, lines, curves, and faces of fewer than three
//! corners. A backslash at the end of a line continues it.

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
    /// Statements that were passed over: their name, how many, and the line of the first.
    passed_over: Vec<(String, usize, u32)>,
}

/// Statements of the format without a surface: points, lines, free-form curves and surfaces, and what belongs to them.
const NO_SURFACE: [&str; 29] = [
    "p",
    "l",
    "vp",
    "cstype",
    "deg",
    "bmat",
    "step",
    "curv",
    "curv2",
    "surf",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "mg",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "maplib",
    "usemap",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
    "call",
];

/// Reads a mesh; its indices are in range and its numbers finite. Each distinct corner of faces is one vertex.
///
/// If some corners have normals and others none, those without get the normal of the faces around.
///
/// # Errors
///
/// Anything that is wrong, with its line.
pub fn read(bytes: &[u8]) -> Result<Mesh, Flaw> {
    read_with_notes(bytes).map(|(mesh, _)| mesh)
}

/// [`read`], with a note for each kind of statement that was passed over.
///
/// # Errors
///
/// Anything that is wrong, with its line.
pub fn read_with_notes(bytes: &[u8]) -> Result<(Mesh, Vec<String>), Flaw> {
    let mut reader = Reader::default();
    let mut continued: Vec<u8> = Vec::new();
    for (index, line) in bytes.split(|b| *b == b'\n').enumerate() {
        let number = index as u32 + 1;
        let flaw = |message| Flaw::new(Place::Line(number), message);
        if let Some(begin) = line.trim_ascii_end().strip_suffix(b"\\") {
            continued.extend_from_slice(begin);
            continued.push(b' ');
        } else if continued.is_empty() {
            reader.statement(line, number).map_err(flaw)?;
        } else {
            continued.extend_from_slice(line);
            reader.statement(&std::mem::take(&mut continued), number).map_err(flaw)?;
        }
    }
    let notes = reader.passed_over.iter().map(|(what, count, line)| match count {
        1 => format!("line {line}: {what} is passed over; it has no surface"),
        _ => format!("line {line} and others: {count} times {what} is passed over; it has no surface"),
    });
    let notes = notes.collect();
    Ok((reader.finish(), notes))
}

impl Reader {
    fn statement(&mut self, line: &[u8], number: u32) -> Result<(), String> {
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
            b"f" => return self.face(rest, number),
            other if NO_SURFACE.iter().any(|name| name.as_bytes() == other) => {
                self.pass_over(format!("`{}`", String::from_utf8_lossy(other)), number);
            }
            other => {
                let name = String::from_utf8_lossy(&other[..other.len().min(40)]).into_owned();
                return Err(format!("the statement `{name}` is not supported"));
            }
        }
        Ok(())
    }

    fn pass_over(&mut self, what: String, line: u32) {
        match self.passed_over.iter_mut().find(|(name, ..)| *name == what) {
            Some((_, count, _)) => *count += 1,
            None => self.passed_over.push((what, 1, line)),
        }
    }

    fn face(&mut self, text: &str, line: u32) -> Result<(), String> {
        let mut corners = text.split_ascii_whitespace();
        let mut corner = |reader: &mut Reader| corners.next().map(|word| reader.corner(word)).transpose();
        let (first, second, third) = (corner(self)?, corner(self)?, corner(self)?);
        let (Some(first), Some(mut previous), Some(mut next)) = (first, second, third) else {
            self.pass_over("a face of fewer than 3 corners".to_owned(), line);
            return Ok(());
        };
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
