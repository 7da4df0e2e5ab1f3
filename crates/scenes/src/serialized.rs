//! Meshes in Mitsuba's `.serialized` containers.
//!
//! A container holds several shapes one after another and ends with the byte at which each begins and their number
//! [Mitsuba 0.6 documentation, "Serialized mesh loader"]. Both versions in use are read, 3 and 4, in single and in double
//! precision; where the flags say neither, single is meant. The flag that asks for flat shading is passed over, as Mitsuba 3 does: the scene says `face_normals`.

use crate::error::{Flaw, Place};
use etendue_core::{geometry::Mesh, rgb::Rgb};
use flate2::bufread::ZlibDecoder;
use glam::{Vec2, Vec3};
use std::io::Read;

/// The largest file that is read.
pub const LARGEST_FILE: u64 = u32::MAX as u64;

const MAGIC: u16 = 0x041C;

/// What the flags of a shape say it has.
const NORMALS: u32 = 0x0001;
const UVS: u32 = 0x0002;
const COLORS: u32 = 0x0008;
const SINGLE: u32 = 0x1000;
const DOUBLE: u32 = 0x2000;

/// Deflation packs no more than this many bytes into one.
const MOST_INFLATED: u64 = 1032;

/// The longest name of a shape, in bytes.
const LONGEST_NAME: usize = 1 << 16;

/// How many records are inflated at a time.
const BLOCK: usize = 1 << 10;

/// Reads one shape of a container, counted from 0; its indices are in range and its numbers finite.
///
/// Memory stays within what the shape's counts imply, and these within what its compressed bytes can hold.
///
/// # Errors
///
/// Anything that is wrong, with the byte at which the shape begins.
pub fn read(bytes: &[u8], shape_index: usize) -> Result<Mesh, Flaw> {
    let (start, end) = locate(bytes, shape_index)?;
    let mut shape = Shape::open(&bytes[start..end], start)?;
    let version = shape.version;
    let flags = u32::from_le_bytes(shape.take()?);
    if version == 4 {
        shape.skip_name()?;
    }
    let double = match flags & (SINGLE | DOUBLE) {
        DOUBLE => true,
        // Files that say neither are of single precision.
        SINGLE | 0 => false,
        _ => return Err(shape.flaw("its flags say both single and double precision")),
    };
    let (vertices, triangles) = shape.counts(flags, double)?;

    let mut mesh = Mesh { positions: shape.vectors::<3, Vec3>(vertices, double, "position")?, ..Mesh::default() };
    let has = |flag: u32, count: usize| if flags & flag != 0 { count } else { 0 };
    mesh.normals = shape.vectors::<3, Vec3>(has(NORMALS, vertices), double, "normal")?;
    mesh.uvs = shape.vectors::<2, Vec2>(has(UVS, vertices), double, "texture coordinate")?;
    mesh.colors = shape.vectors::<3, Rgb>(has(COLORS, vertices), double, "colour")?;
    mesh.triangles = shape.triangles(vertices, triangles)?;
    shape.close()?;
    Ok(mesh)
}

/// Where a shape begins and ends at the latest, by the dictionary at the end of the file.
fn locate(bytes: &[u8], shape_index: usize) -> Result<(usize, usize), Flaw> {
    let flaw = |message: String| Flaw::new(Place::Whole, message);
    // The dictionary is of the version of the file's first shape.
    let entry = match version(bytes) {
        Some(3) => 4,
        Some(4) => 8,
        Some(other) => return Err(flaw(format!("a serialized container of the version {other}; 3 and 4 are read"))),
        None => return Err(flaw("not a serialized container".to_owned())),
    };
    let too_short = || flaw("the dictionary of shapes at its end is cut off".to_owned());
    let (rest, count) = bytes.split_last_chunk::<4>().ok_or_else(too_short)?;
    let count = u32::from_le_bytes(*count) as usize;
    let table = count.checked_mul(entry).and_then(|size| rest.len().checked_sub(size)).ok_or_else(too_short)?;
    if shape_index >= count {
        return Err(flaw(format!("the shape {shape_index} is not among its {count}, counted from 0")));
    }
    let place = table + shape_index * entry;
    let mut number = [0; 8];
    number[..entry].copy_from_slice(&rest[place..place + entry]);
    let start = u64::from_le_bytes(number);
    match usize::try_from(start) {
        Ok(start) if start < table => Ok((start, table)),
        _ => Err(Flaw::new(Place::Byte(place as u64), format!("the shape {shape_index} begins at {start}, outside"))),
    }
}

/// The version that a shape, or a container by its first shape, is of.
fn version(bytes: &[u8]) -> Option<u16> {
    let [a, b, c, d] = *bytes.first_chunk()?;
    (u16::from_le_bytes([a, b]) == MAGIC).then_some(u16::from_le_bytes([c, d]))
}

/// A shape that is being inflated.
struct Shape<'b> {
    inflated: ZlibDecoder<&'b [u8]>,
    /// Bytes that it has at most before they are inflated.
    compressed: u64,
    version: u16,
    start: u64,
}

impl<'b> Shape<'b> {
    fn open(bytes: &'b [u8], start: usize) -> Result<Shape<'b>, Flaw> {
        let start = start as u64;
        let flaw = |message: &str| Flaw::new(Place::Byte(start), message);
        let version = version(bytes).ok_or_else(|| flaw("no shape begins here"))?;
        if !matches!(version, 3 | 4) {
            return Err(flaw("the shape's version is neither 3 nor 4"));
        }
        let compressed = &bytes[4..];
        Ok(Shape { inflated: ZlibDecoder::new(compressed), compressed: compressed.len() as u64, version, start })
    }

    fn flaw(&self, message: impl Into<String>) -> Flaw {
        Flaw::new(Place::Byte(self.start), format!("the shape that begins here: {}", message.into()))
    }

    fn fill(&mut self, bytes: &mut [u8]) -> Result<(), Flaw> {
        self.inflated.read_exact(bytes).map_err(|e| match e.kind() {
            std::io::ErrorKind::UnexpectedEof => self.flaw("it ends too early"),
            _ => self.flaw(format!("it cannot be inflated: {e}")),
        })
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], Flaw> {
        let mut bytes = [0; N];
        self.fill(&mut bytes)?;
        Ok(bytes)
    }

    fn skip_name(&mut self) -> Result<(), Flaw> {
        for _ in 0..LONGEST_NAME {
            if self.take()? == [0] {
                return Ok(());
            }
        }
        Err(self.flaw(format!("its name is longer than {LONGEST_NAME} bytes")))
    }

    /// The numbers of vertices and triangles, for which there is room.
    fn counts(&mut self, flags: u32, double: bool) -> Result<(usize, usize), Flaw> {
        let vertices = u64::from_le_bytes(self.take()?);
        let triangles = u64::from_le_bytes(self.take()?);
        // More vertices than 32-bit indices can count have 64-bit ones.
        if vertices > u64::from(u32::MAX) {
            return Err(self.flaw(format!("it claims {vertices} vertices; {} is the most", u32::MAX)));
        }
        let numbers = [(NORMALS, 3), (UVS, 2), (COLORS, 3)].iter().filter(|(f, _)| flags & f != 0).map(|(_, n)| n);
        let vertex = (3 + numbers.sum::<u64>()) * if double { 8 } else { 4 };
        let size = u128::from(vertices) * u128::from(vertex) + u128::from(triangles) * 12;
        if size > u128::from(self.compressed) * u128::from(MOST_INFLATED) {
            let message = format!("it claims {vertices} vertices and {triangles} triangles, too many for its bytes");
            return Err(self.flaw(message));
        }
        Ok((vertices as usize, triangles as usize))
    }

    /// Records of `N` finite numbers.
    fn vectors<const N: usize, V: From<[f32; N]>>(
        &mut self,
        count: usize,
        double: bool,
        what: &str,
    ) -> Result<Vec<V>, Flaw> {
        let width = if double { 8 } else { 4 };
        let mut vectors = Vec::with_capacity(count);
        let mut block = vec![0; N * width * BLOCK.min(count)];
        while vectors.len() < count {
            let block = &mut block[..N * width * BLOCK.min(count - vectors.len())];
            self.fill(block)?;
            for record in block.chunks_exact(N * width) {
                let vector: [f32; N] = std::array::from_fn(|i| {
                    let number = &record[i * width..];
                    match double {
                        true => number.first_chunk().map_or(f32::NAN, |b| f64::from_le_bytes(*b) as f32),
                        false => number.first_chunk().map_or(f32::NAN, |b| f32::from_le_bytes(*b)),
                    }
                });
                if !vector.iter().all(|v| v.is_finite()) {
                    return Err(self.flaw(format!("the {what} {} is not finite", vectors.len())));
                }
                vectors.push(V::from(vector));
            }
        }
        Ok(vectors)
    }

    fn triangles(&mut self, vertices: usize, count: usize) -> Result<Vec<[u32; 3]>, Flaw> {
        let mut triangles = Vec::with_capacity(count);
        let mut block = vec![0; 12 * BLOCK.min(count)];
        while triangles.len() < count {
            let block = &mut block[..12 * BLOCK.min(count - triangles.len())];
            self.fill(block)?;
            for record in block.as_chunks::<4>().0.as_chunks::<3>().0 {
                let triangle = record.map(u32::from_le_bytes);
                if let Some(index) = triangle.iter().find(|i| **i as usize >= vertices) {
                    return Err(
                        self.flaw(format!("the triangle {} has the vertex {index} of {vertices}", triangles.len()))
                    );
                }
                triangles.push(triangle);
            }
        }
        Ok(triangles)
    }

    /// Looks at the checksum, which stands at the end; what some writer might put behind the triangles is passed over.
    fn close(mut self) -> Result<(), Flaw> {
        match std::io::copy(&mut self.inflated, &mut std::io::sink()) {
            Ok(_) => Ok(()),
            Err(e) => Err(self.flaw(format!("it is damaged: {e}"))),
        }
    }
}
