//! Writes serialized containers.

use etendue_core::geometry::Mesh;
use flate2::{Compression, write::ZlibEncoder};
use std::io::Write;

const NORMALS: u32 = 1;
const UVS: u32 = 2;
const COLORS: u32 = 8;

/// How a shape is written.
#[derive(Clone, Copy)]
pub(crate) struct Layout {
    pub(crate) version: u16,
    pub(crate) double: bool,
}

pub(crate) const LAYOUTS: [Layout; 4] = [
    Layout { version: 3, double: false },
    Layout { version: 3, double: true },
    Layout { version: 4, double: false },
    Layout { version: 4, double: true },
];

/// What is deflated of a shape.
pub(crate) fn contents(mesh: &Mesh, layout: Layout, extra_flags: u32) -> Vec<u8> {
    let has = |flag: u32, empty: bool| if empty { 0 } else { flag };
    let precision = if layout.double { 0x2000 } else { 0x1000 };
    let flags =
        has(NORMALS, mesh.normals.is_empty()) | has(UVS, mesh.uvs.is_empty()) | has(COLORS, mesh.colors.is_empty());
    let mut out = (flags | precision | extra_flags).to_le_bytes().to_vec();
    if layout.version == 4 {
        out.extend(b"a shape\0");
    }
    out.extend((mesh.positions.len() as u64).to_le_bytes());
    out.extend((mesh.triangles.len() as u64).to_le_bytes());
    let vectors = [&mesh.positions, &mesh.normals].into_iter().flatten().flat_map(|v| v.to_array());
    let uvs = mesh.uvs.iter().flat_map(|v| v.to_array());
    for number in vectors.chain(uvs).chain(mesh.colors.iter().flat_map(|c| c.to_array())) {
        match layout.double {
            true => out.extend(f64::from(number).to_le_bytes()),
            false => out.extend(number.to_le_bytes()),
        }
    }
    out.extend(mesh.triangles.iter().flatten().flat_map(|i| i.to_le_bytes()));
    out
}

pub(crate) fn shape(contents: &[u8], version: u16) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(contents).unwrap();
    let mut out = 0x041Cu16.to_le_bytes().to_vec();
    out.extend(version.to_le_bytes());
    out.extend(encoder.finish().unwrap());
    out
}

pub(crate) fn container(shapes: &[Vec<u8>], version: u16) -> Vec<u8> {
    let mut out = Vec::new();
    let mut offsets = Vec::new();
    for shape in shapes {
        offsets.push(out.len());
        out.extend(shape);
    }
    for offset in offsets {
        match version {
            3 => out.extend((offset as u32).to_le_bytes()),
            _ => out.extend((offset as u64).to_le_bytes()),
        }
    }
    out.extend((shapes.len() as u32).to_le_bytes());
    out
}

pub(crate) fn file(meshes: &[Mesh], layout: Layout) -> Vec<u8> {
    let shapes: Vec<_> = meshes.iter().map(|m| shape(&contents(m, layout, 0), layout.version)).collect();
    container(&shapes, layout.version)
}
