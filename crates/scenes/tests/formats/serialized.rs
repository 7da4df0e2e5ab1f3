//! Containers of meshes: both versions, both precisions, several shapes; what is damaged is refused.

use crate::serialized_writer::{LAYOUTS, container, contents, file, shape};
use etendue_core::{geometry::Mesh, rgb::Rgb};
use etendue_scenes::{Flaw, Place, serialized::read};
use glam::{Vec2, Vec3};

const FACE_NORMALS: u32 = 16;

fn pyramid() -> Mesh {
    let positions =
        [[0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [1.0, 2.25, 0.0], [0.0, 1.0, -0.5], [0.5, 0.5, 3.0]].map(Vec3::from);
    Mesh {
        positions: positions.to_vec(),
        normals: (0..5).map(|i| Vec3::new(0.25 * i as f32, 1.0, -0.5)).collect(),
        uvs: (0..5).map(|i| Vec2::new(0.125 * i as f32, 1.0 - 0.25 * i as f32)).collect(),
        colors: (0..5).map(|i| Rgb::new(0.125 * i as f32, 0.5, 1.0)).collect(),
        triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
    }
}

fn triangle() -> Mesh {
    Mesh { positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y], triangles: vec![[0, 1, 2]], ..Mesh::default() }
}

fn assert_same(a: &Mesh, b: &Mesh) {
    assert_eq!(
        (&a.positions, &a.normals, &a.uvs, &a.colors, &a.triangles),
        (&b.positions, &b.normals, &b.uvs, &b.colors, &b.triangles)
    );
}

fn refused(bytes: &[u8], index: usize) -> Flaw {
    read(bytes, index).expect_err("it was read")
}

#[test]
fn every_layout_is_read() {
    for layout in LAYOUTS {
        let bytes = file(&[triangle(), pyramid(), Mesh::default(), triangle()], layout);
        for (index, expected) in [triangle(), pyramid(), Mesh::default(), triangle()].iter().enumerate() {
            assert_same(&read(&bytes, index).unwrap(), expected);
        }
        let flaw = refused(&bytes, 4);
        assert_eq!(flaw.message, "the shape 4 is not among its 4, counted from 0");
    }
}

/// Flags that name neither precision mean single.
#[test]
fn single_precision_need_not_be_named() {
    for layout in LAYOUTS.into_iter().filter(|layout| !layout.double) {
        let mut inside = contents(&pyramid(), layout, 0);
        let flags = u32::from_le_bytes([inside[0], inside[1], inside[2], inside[3]]);
        inside[..4].copy_from_slice(&(flags & !0x3000).to_le_bytes());
        let bytes = container(&[shape(&inside, layout.version)], layout.version);
        assert_same(&read(&bytes, 0).unwrap(), &pyramid());
    }
}

#[test]
fn each_list_may_be_missing() {
    for layout in LAYOUTS {
        for missing in 0..8 {
            let mut mesh = pyramid();
            let mut drop_if = |bit: u32, f: fn(&mut Mesh)| {
                if missing & bit != 0 {
                    f(&mut mesh)
                }
            };
            drop_if(1, |m| m.normals.clear());
            drop_if(2, |m| m.uvs.clear());
            drop_if(4, |m| m.colors.clear());
            assert_same(&read(&file(std::slice::from_ref(&mesh), layout), 0).unwrap(), &mesh);
        }
    }
}

#[test]
fn more_than_one_block_is_read() {
    let mesh = Mesh {
        positions: (0..5000).map(|i| Vec3::new(i as f32, -1.0, 0.5)).collect(),
        triangles: (0..4998).map(|i| [i, i + 1, i + 2]).collect(),
        ..Mesh::default()
    };
    for layout in LAYOUTS {
        assert_same(&read(&file(std::slice::from_ref(&mesh), layout), 0).unwrap(), &mesh);
    }
}

/// Mitsuba 3.9.1 keeps the normals of such a shape, too (`has_vertex_normals`).
#[test]
fn the_flag_for_flat_shading_is_passed_over() {
    let layout = LAYOUTS[2];
    let bytes = container(&[shape(&contents(&pyramid(), layout, FACE_NORMALS), 4)], 4);
    assert_same(&read(&bytes, 0).unwrap(), &pyramid());
}

#[test]
fn what_stands_behind_the_triangles_is_passed_over() {
    let layout = LAYOUTS[3];
    let mut inside = contents(&pyramid(), layout, 0);
    inside.extend([7; 100]);
    assert_same(&read(&container(&[shape(&inside, 4)], 4), 0).unwrap(), &pyramid());
}

#[test]
fn every_truncation_is_refused() {
    for layout in LAYOUTS {
        let bytes = file(&[triangle(), pyramid()], layout);
        for length in 0..bytes.len() {
            refused(&bytes[..length], 1);
        }
    }
}

/// The checksum finds a change anywhere in what is deflated; where the change is in the dictionary or in a header, another
/// shape may be found.
#[test]
fn a_flipped_bit_gives_an_error_or_a_shape_of_the_file() {
    for layout in LAYOUTS {
        let bytes = file(&[triangle(), pyramid()], layout);
        let mut refusals = 0;
        for bit in 0..8 * bytes.len() {
            let mut changed = bytes.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            match read(&changed, 1) {
                Err(_) => refusals += 1,
                Ok(mesh) if mesh.positions.len() == 3 => assert_same(&mesh, &triangle()),
                Ok(mesh) => assert_same(&mesh, &pyramid()),
            }
        }
        assert!(refusals > 4 * bytes.len(), "{refusals} of {} bits", 8 * bytes.len());
    }
}

#[test]
fn claims_beyond_the_bytes_are_refused() {
    for layout in LAYOUTS {
        let counts_at = if layout.version == 4 { 12 } else { 4 };
        for (at, count) in [
            (0, 1 << 20),
            (8, 1 << 20),
            (0, u64::from(u32::MAX)),
            (0, 1 << 40),
            (8, 1 << 40),
            (0, u64::MAX),
            (8, u64::MAX),
        ] {
            let mut inside = contents(&pyramid(), layout, 0);
            inside[counts_at + at..][..8].copy_from_slice(&count.to_le_bytes());
            let flaw = refused(&container(&[shape(&inside, layout.version)], layout.version), 0);
            assert!(flaw.message.contains("it claims"), "{flaw}");
            assert_eq!(flaw.place, Place::Byte(0));
        }
    }
    for (version, count) in [(3, 2), (4, 2), (4, u32::MAX), (3, u32::MAX)] {
        let mut bytes = container(&[shape(&contents(&triangle(), LAYOUTS[0], 0), version)], version);
        let length = bytes.len();
        bytes[length - 4..].copy_from_slice(&count.to_le_bytes());
        refused(&bytes, 1);
    }
}

#[test]
fn wrong_contents_are_refused() {
    let layout = LAYOUTS[2];
    let message = |mesh: &Mesh| refused(&file(std::slice::from_ref(mesh), layout), 0).message;
    let mut mesh = pyramid();
    mesh.positions[3].y = f32::NAN;
    assert_eq!(message(&mesh), "the shape that begins here: the position 3 is not finite");
    mesh = pyramid();
    mesh.uvs[1].y = f32::INFINITY;
    assert_eq!(message(&mesh), "the shape that begins here: the texture coordinate 1 is not finite");
    mesh = pyramid();
    mesh.triangles[2] = [0, 5, 1];
    assert_eq!(message(&mesh), "the shape that begins here: the triangle 2 has the vertex 5 of 5");

    let mut inside = contents(&triangle(), layout, 0);
    inside[..4].copy_from_slice(&0x3000u32.to_le_bytes());
    let flaw = refused(&container(&[shape(&inside, 4)], 4), 0).message;
    assert!(flaw.ends_with("its flags say both single and double precision"), "{flaw}");

    // A number beyond single precision.
    let mut inside = contents(&triangle(), LAYOUTS[1], 0);
    inside[20..28].copy_from_slice(&1e300f64.to_le_bytes());
    assert!(refused(&container(&[shape(&inside, 3)], 3), 0).message.ends_with("the position 0 is not finite"));

    assert_eq!(refused(b"ply\nformat", 0).message, "not a serialized container");
    assert_eq!(
        refused(&container(&[shape(&[], 5)], 5), 0).message,
        "a serialized container of the version 5; 3 and 4 are read"
    );

    let unnamed = [0x00, 0x10, 0, 0].into_iter().chain([b'x'; 1 << 17]).collect::<Vec<u8>>();
    assert!(refused(&container(&[shape(&unnamed, 4)], 4), 0).message.ends_with("its name is longer than 65536 bytes"));

    let mut outside = file(&[triangle()], layout);
    let length = outside.len();
    outside[length - 12..length - 4].copy_from_slice(&(length as u64 - 12).to_le_bytes());
    let flaw = refused(&outside, 0);
    assert_eq!(flaw.place, Place::Byte(length as u64 - 12));
}
