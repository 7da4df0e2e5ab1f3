//! Meshes in PLY files: ASCII and binary of either byte order.
//!
//! Of the element `vertex`, `x y z`, `nx ny nz`, `u v` (or `s t`) and the colour `r g b` (or `red green blue`) are read; of the
//! element `face`, the list `vertex_indices` (or `vertex_index`), whose polygons are cut into fans. Everything else is passed
//! over. Colours are linear; one of whole numbers is 1 at the largest number of its type.

use crate::error::{Flaw, Place};
use etendue_core::{geometry::Mesh, rgb::Rgb};
use glam::{Vec2, Vec3};

/// The largest file that is read.
pub const LARGEST_FILE: u64 = u32::MAX as u64;

#[derive(Clone, Copy, PartialEq)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn from_name(name: &str) -> Option<Scalar> {
        Some(match name {
            "char" | "int8" => Scalar::I8,
            "uchar" | "uint8" => Scalar::U8,
            "short" | "int16" => Scalar::I16,
            "ushort" | "uint16" => Scalar::U16,
            "int" | "int32" => Scalar::I32,
            "uint" | "uint32" => Scalar::U32,
            "float" | "float32" => Scalar::F32,
            "double" | "float64" => Scalar::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::F64 => 8,
        }
    }

    /// The largest value of a colour's component.
    fn full(self) -> f64 {
        match self {
            Scalar::I8 => f64::from(i8::MAX),
            Scalar::U8 => f64::from(u8::MAX),
            Scalar::I16 => f64::from(i16::MAX),
            Scalar::U16 => f64::from(u16::MAX),
            Scalar::I32 => f64::from(i32::MAX),
            Scalar::U32 => f64::from(u32::MAX),
            Scalar::F32 | Scalar::F64 => 1.0,
        }
    }

    fn is_whole(self) -> bool {
        !matches!(self, Scalar::F32 | Scalar::F64)
    }
}

#[derive(Clone, Copy)]
enum Kind {
    Scalar(Scalar),
    List { count: Scalar, item: Scalar },
}

struct Property {
    name: String,
    kind: Kind,
}

struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
    line: u32,
}

#[derive(Clone, Copy, PartialEq)]
enum Format {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// Reads a mesh; its indices are in range and its numbers finite.
///
/// Memory stays within a small multiple of the file's size whatever its header claims.
///
/// # Errors
///
/// Anything that is wrong, with its line or, in a binary file, its byte.
pub fn read(bytes: &[u8]) -> Result<Mesh, Flaw> {
    let (format, elements, mut body) = header(bytes)?;
    let vertices = single(&elements, "vertex")?.count;
    single(&elements, "face")?;
    let mut mesh = Mesh::default();
    for element in &elements {
        // Each record takes at least this many bytes, in ASCII one a number.
        let smallest: usize = element.properties.iter().map(|p| p.kind.smallest(format)).sum();
        if element.count.saturating_mul(smallest as u64) > body.remaining() as u64 {
            let message = format!(
                "the header claims {} records of `{}`, more than the file has room for",
                element.count, element.name
            );
            return Err(Flaw::new(Place::Line(element.line), message));
        }
        match element.name.as_str() {
            "vertex" => read_vertices(element, &mut body, &mut mesh)?,
            "face" => read_faces(element, vertices, &mut body, &mut mesh)?,
            _ if smallest == 0 => {}
            _ => {
                for _ in 0..element.count {
                    for property in &element.properties {
                        body.skip(property.kind)?;
                    }
                }
            }
        }
    }
    Ok(mesh)
}

fn single<'e>(elements: &'e [Element], name: &str) -> Result<&'e Element, Flaw> {
    let mut found = elements.iter().filter(|e| e.name == name);
    let first = found.next().ok_or_else(|| Flaw::new(Place::Whole, format!("the header has no element `{name}`")))?;
    match found.next() {
        Some(second) => Err(Flaw::new(Place::Line(second.line), format!("a second element `{name}`"))),
        None => Ok(first),
    }
}

impl Kind {
    fn smallest(self, format: Format) -> usize {
        match (format, self) {
            (Format::Ascii, _) => 1,
            (_, Kind::Scalar(scalar)) => scalar.size(),
            (_, Kind::List { count, .. }) => count.size(),
        }
    }
}

fn header(bytes: &[u8]) -> Result<(Format, Vec<Element>, Body<'_>), Flaw> {
    let mut format = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut at = 0;
    let mut line = 0;
    loop {
        line += 1;
        let flaw = |message: String| Flaw::new(Place::Line(line), message);
        let rest = &bytes[at..];
        let Some(end) = rest.iter().position(|b| *b == b'\n') else {
            return Err(flaw(if line == 1 { "not a PLY file" } else { "the header has no end" }.to_owned()));
        };
        at += end + 1;
        let text = String::from_utf8_lossy(&rest[..end]);
        let words: Vec<&str> = text.split_ascii_whitespace().collect();
        if line == 1 {
            if words != ["ply"] {
                return Err(flaw("not a PLY file".to_owned()));
            }
            continue;
        }
        match words.as_slice() {
            [] | ["comment" | "obj_info", ..] => {}
            ["format", kind, "1.0"] if format.is_none() => {
                format = Some(match *kind {
                    "ascii" => Format::Ascii,
                    "binary_little_endian" => Format::LittleEndian,
                    "binary_big_endian" => Format::BigEndian,
                    other => return Err(flaw(format!("the format `{other}` is not known"))),
                });
            }
            ["element", name, count] => {
                let count = count.parse().map_err(|_| flaw(format!("`{count}` is not a number of records")))?;
                elements.push(Element { name: (*name).to_owned(), count, properties: Vec::new(), line });
            }
            ["property", rest @ ..] => {
                let element = elements.last_mut().ok_or_else(|| flaw("a property before any element".to_owned()))?;
                element.properties.push(property(rest).map_err(flaw)?);
            }
            ["end_header"] => {
                let format = format.ok_or_else(|| flaw("the header has no format".to_owned()))?;
                return Ok((format, elements, Body { bytes, at, line: line + 1, format }));
            }
            _ => return Err(flaw(format!("the header has the line `{}`, which is not known", text.trim()))),
        }
    }
}

fn property(words: &[&str]) -> Result<Property, String> {
    let scalar = |name: &str| Scalar::from_name(name).ok_or_else(|| format!("the type `{name}` is not known"));
    match words {
        ["list", count, item, name] => {
            let (count, item) = (scalar(count)?, scalar(item)?);
            if !count.is_whole() {
                return Err("the length of a list is not of a whole type".to_owned());
            }
            Ok(Property { name: (*name).to_owned(), kind: Kind::List { count, item } })
        }
        [kind, name] if *kind != "list" => Ok(Property { name: (*name).to_owned(), kind: Kind::Scalar(scalar(kind)?) }),
        _ => Err("a property has a type and a name".to_owned()),
    }
}

/// What follows the header.
struct Body<'b> {
    bytes: &'b [u8],
    at: usize,
    /// The line of `at`, counted in ASCII files only.
    line: u32,
    format: Format,
}

impl Body<'_> {
    fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    fn flaw(&self, message: impl Into<String>) -> Flaw {
        let place = if self.format == Format::Ascii { Place::Line(self.line) } else { Place::Byte(self.at as u64) };
        Flaw::new(place, message)
    }

    fn word(&mut self) -> Result<&str, Flaw> {
        while let Some(byte) = self.bytes.get(self.at).filter(|b| b.is_ascii_whitespace()) {
            self.line += u32::from(*byte == b'\n');
            self.at += 1;
        }
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        if length == 0 {
            return Err(self.flaw("the file ends too early"));
        }
        self.at += length;
        std::str::from_utf8(&rest[..length]).map_err(|_| self.flaw("not a number"))
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], Flaw> {
        let taken = self.bytes[self.at..].first_chunk::<N>().copied();
        let mut taken = taken.ok_or_else(|| self.flaw("the file ends too early"))?;
        self.at += N;
        if self.format == Format::BigEndian {
            taken.reverse();
        }
        Ok(taken)
    }

    /// A number of any type; every type but the 64-bit ones PLY has not fits.
    fn number(&mut self, scalar: Scalar) -> Result<f64, Flaw> {
        if self.format == Format::Ascii {
            let word = self.word()?;
            let number = if scalar.is_whole() { word.parse::<i64>().ok().map(|v| v as f64) } else { word.parse().ok() };
            let wrong =
                format!("`{}` is not a number of its property's type", word.chars().take(40).collect::<String>());
            return number.ok_or_else(|| self.flaw(wrong));
        }
        Ok(match scalar {
            Scalar::I8 => f64::from(i8::from_le_bytes(self.take()?)),
            Scalar::U8 => f64::from(u8::from_le_bytes(self.take()?)),
            Scalar::I16 => f64::from(i16::from_le_bytes(self.take()?)),
            Scalar::U16 => f64::from(u16::from_le_bytes(self.take()?)),
            Scalar::I32 => f64::from(i32::from_le_bytes(self.take()?)),
            Scalar::U32 => f64::from(u32::from_le_bytes(self.take()?)),
            Scalar::F32 => f64::from(f32::from_le_bytes(self.take()?)),
            Scalar::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    /// The length of a list, for which there is room.
    fn length(&mut self, count: Scalar, item: Scalar) -> Result<usize, Flaw> {
        let length = self.number(count)?;
        let smallest = if self.format == Format::Ascii { 1 } else { item.size() };
        if length < 0.0 || length * smallest as f64 > self.remaining() as f64 {
            return Err(self.flaw(format!("a list claims {length} items, which the file has no room for")));
        }
        Ok(length as usize)
    }

    fn skip(&mut self, kind: Kind) -> Result<(), Flaw> {
        match kind {
            Kind::Scalar(scalar) => self.number(scalar).map(drop),
            Kind::List { count, item } => {
                for _ in 0..self.length(count, item)? {
                    self.number(item)?;
                }
                Ok(())
            }
        }
    }
}

/// Where the numbers of a vertex go: position, normal, texture coordinates, colour.
const SLOTS: [&[&str]; 11] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx"],
    &["ny"],
    &["nz"],
    &["u", "s", "texture_u"],
    &["v", "t", "texture_v"],
    &["r", "red"],
    &["g", "green"],
    &["b", "blue"],
];
/// The first slot of a colour.
const COLOR: usize = 8;

fn read_vertices(element: &Element, body: &mut Body, mesh: &mut Mesh) -> Result<(), Flaw> {
    let scalar_slot = |property: &Property| match property.kind {
        Kind::Scalar(_) => SLOTS.iter().position(|names| names.contains(&property.name.as_str())),
        Kind::List { .. } => None,
    };
    let slots: Vec<Option<usize>> = element.properties.iter().map(scalar_slot).collect();
    let has = |range: std::ops::Range<usize>| range.clone().all(|slot| slots.contains(&Some(slot)));
    if !has(0..3) {
        return Err(Flaw::new(Place::Line(element.line), "the vertices lack x, y or z"));
    }
    let (normals, uvs, colors) = (has(3..6), has(6..8), has(COLOR..SLOTS.len()));
    let count = element.count as usize;
    mesh.positions.reserve_exact(count);
    mesh.normals.reserve_exact(if normals { count } else { 0 });
    mesh.uvs.reserve_exact(if uvs { count } else { 0 });
    mesh.colors.reserve_exact(if colors { count } else { 0 });
    for _ in 0..count {
        let mut values = [0f32; SLOTS.len()];
        for (property, slot) in element.properties.iter().zip(&slots) {
            match (property.kind, slot) {
                (Kind::Scalar(scalar), Some(slot)) => {
                    let number = body.number(scalar)?;
                    let color = *slot >= COLOR;
                    values[*slot] = if color { number / scalar.full() } else { number } as f32;
                    if !values[*slot].is_finite() {
                        return Err(body.flaw(format!("the vertex's {} is not a finite number", property.name)));
                    }
                    if color && values[*slot] < 0.0 {
                        return Err(body.flaw(format!("the vertex's {} is negative", property.name)));
                    }
                }
                (kind, _) => body.skip(kind)?,
            }
        }
        let [x, y, z, nx, ny, nz, u, v, r, g, b] = values;
        mesh.positions.push(Vec3::new(x, y, z));
        if normals {
            mesh.normals.push(Vec3::new(nx, ny, nz));
        }
        if uvs {
            mesh.uvs.push(Vec2::new(u, v));
        }
        if colors {
            mesh.colors.push(Rgb::new(r, g, b));
        }
    }
    Ok(())
}

fn read_faces(element: &Element, vertices: u64, body: &mut Body, mesh: &mut Mesh) -> Result<(), Flaw> {
    let is_indices = |p: &Property| matches!(p.name.as_str(), "vertex_indices" | "vertex_index");
    let flaw = |message: &str| Flaw::new(Place::Line(element.line), message);
    match element.properties.iter().filter(|p| is_indices(p)).map(|p| p.kind).collect::<Vec<_>>().as_slice() {
        [Kind::List { item, .. }] if item.is_whole() => {}
        [_] => return Err(flaw("the faces' vertex indices are not a list of whole numbers")),
        [] => return Err(flaw("the faces lack a list `vertex_indices`")),
        _ => return Err(flaw("the faces have two lists of vertex indices")),
    }
    for _ in 0..element.count {
        for property in &element.properties {
            let Kind::List { count, item } = property.kind else {
                body.skip(property.kind)?;
                continue;
            };
            if !is_indices(property) {
                body.skip(property.kind)?;
                continue;
            }
            let corners = body.length(count, item)?;
            if corners < 3 {
                return Err(body.flaw(format!("a face has {corners} vertices")));
            }
            let mut corner = || {
                let index = body.number(item)?;
                if !(0.0..vertices as f64).contains(&index) {
                    return Err(body.flaw(format!("a face has the vertex {index} of {vertices}")));
                }
                Ok(index as u32)
            };
            let (first, mut previous) = (corner()?, corner()?);
            for _ in 2..corners {
                let next = corner()?;
                mesh.triangles.push([first, previous, next]);
                previous = next;
            }
        }
    }
    Ok(())
}
