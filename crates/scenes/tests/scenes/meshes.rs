//! Mesh files and images: what is read, and what is said when it is wrong.

use etendue_core::{geometry::Mesh, rgb::Rgb};
use etendue_scenes::{Flaw, Place, image_file::read_exr, obj, ply};
use glam::{Vec2, Vec3};
use std::io::Cursor;

const QUAD: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.5], [0.0, 1.0, 0.5]];

fn expected_quad() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    (QUAD.map(Vec3::from).to_vec(), vec![[0, 1, 2], [0, 2, 3]])
}

/// A quadrilateral as a binary PLY, with properties between those that count.
pub(crate) fn binary_ply(big: bool) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let mut out = format!(
        "ply\nformat binary_{order}_endian 1.0\ncomment made by hand\nelement camera 1\nproperty list uchar short view\n\
         element vertex 4\nproperty double x\nproperty float y\nproperty uchar quality\nproperty float z\n\
         property float s\nproperty float t\nelement face 1\nproperty float area\n\
         property list ushort uint vertex_index\nend_header\n"
    )
    .into_bytes();
    fn put<const N: usize>(out: &mut Vec<u8>, big: bool, mut little_endian: [u8; N]) {
        if big {
            little_endian.reverse();
        }
        out.extend(little_endian);
    }
    out.push(2);
    put(&mut out, big, 7i16.to_le_bytes());
    put(&mut out, big, 8i16.to_le_bytes());
    for [x, y, z] in QUAD {
        put(&mut out, big, f64::from(x).to_le_bytes());
        put(&mut out, big, y.to_le_bytes());
        out.push(200);
        put(&mut out, big, z.to_le_bytes());
        put(&mut out, big, x.to_le_bytes());
        put(&mut out, big, y.to_le_bytes());
    }
    put(&mut out, big, 1f32.to_le_bytes());
    put(&mut out, big, 4u16.to_le_bytes());
    for i in 0..4u32 {
        put(&mut out, big, i.to_le_bytes());
    }
    out
}

pub(crate) const ASCII_PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
     property float z\nproperty float nx\nproperty float ny\nproperty float nz\nelement face 2\n\
     property list uchar int vertex_indices\nend_header\n0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 .5 0 0 1\n0 1 .5 0 0 1\n3 0 1 2\n3 0 2 3\n";

pub(crate) const OBJ: &str = "# a quadrilateral\nmtllib none.mtl\no quad\nv 0 0 0\nv 1 0 0 1\nv 1 1 .5\nv 0 1 .5\nvt 0 0\nvt 1 0\n\
     vt 1 1\nvt 0 1 0\nvn 0 0 1\nusemtl grey\ns off\nf 1/1/1 2/2/1 -2/-2/-1 4/4/1 # all corners\n";

#[test]
fn ply_of_every_format() {
    let (positions, triangles) = expected_quad();
    for big in [false, true] {
        let mesh = ply::read(&binary_ply(big)).unwrap();
        assert_eq!((mesh.positions, mesh.triangles), (positions.clone(), triangles.clone()));
        assert_eq!(mesh.uvs, QUAD.map(|p| Vec2::new(p[0], p[1])));
        assert!(mesh.normals.is_empty());
    }
    let mesh = ply::read(ASCII_PLY.as_bytes()).unwrap();
    assert_eq!((mesh.positions, mesh.triangles, mesh.normals), (positions, triangles, vec![Vec3::Z; 4]));
    let dos = ASCII_PLY.replace('\n', "\r\n");
    assert_eq!(ply::read(dos.as_bytes()).unwrap().positions.len(), 4);
}

#[test]
fn ply_index_types() {
    for kind in
        ["char", "uchar", "short", "ushort", "int", "uint", "int8", "uint8", "int16", "uint16", "int32", "uint32"]
    {
        let text = ASCII_PLY.replace("uchar int", &format!("uint {kind}"));
        assert_eq!(ply::read(text.as_bytes()).unwrap().triangles.len(), 2, "{kind}");
    }
}

#[test]
fn ply_flaws_have_their_place() {
    for (from, to, place, message) in [
        ("3 0 2 3", "3 0 2 4", Place::Line(18), "a face has the vertex 4 of 4"),
        ("3 0 2 3", "3 0 2 -1", Place::Line(18), "a face has the vertex -1 of 4"),
        ("3 0 2 3", "3 0 2", Place::Line(19), "the file ends too early"),
        ("3 0 2 3", "2 0 2", Place::Line(18), "a face has 2 vertices"),
        ("3 0 2 3", "9 0 2", Place::Line(18), "a list claims 9 items, which the file has no room for"),
        ("1 1 .5 0", "1 nan .5 0", Place::Line(15), "the vertex's y is not a finite number"),
        ("1 1 .5 0", "1 1e39 .5 0", Place::Line(15), "the vertex's y is not a finite number"),
        ("1 1 .5 0", "1 one .5 0", Place::Line(15), "`one` is not a number of its property's type"),
        (
            "element face 2",
            "element face 99999999999",
            Place::Line(10),
            "the header claims 99999999999 records of `face`, more than the file has room for",
        ),
        ("element face 2", "element face -2", Place::Line(10), "`-2` is not a number of records"),
        ("element face 2", "element faces 2", Place::Whole, "the header has no element `face`"),
        ("element face 2", "element vertex 2", Place::Line(10), "a second element `vertex`"),
        ("property float z", "property float w", Place::Line(3), "the vertices lack x, y or z"),
        ("property float z", "property real z", Place::Line(6), "the type `real` is not known"),
        ("list uchar int", "list float int", Place::Line(11), "the length of a list is not of a whole type"),
        (
            "list uchar int",
            "list uchar float",
            Place::Line(10),
            "the faces' vertex indices are not a list of whole numbers",
        ),
        ("ascii 1.0", "ascii 2.0", Place::Line(2), "the header has the line `format ascii 2.0`, which is not known"),
        ("ply\n", "plx\n", Place::Line(1), "not a PLY file"),
        ("end_header", "end_heading", Place::Line(12), "the header has the line `end_heading`, which is not known"),
    ] {
        let text = ASCII_PLY.replacen(from, to, 1);
        assert_ne!(text, ASCII_PLY);
        assert_eq!(ply::read(text.as_bytes()).unwrap_err(), Flaw { place, message: message.to_owned() }, "{to}");
    }
    let mut short = binary_ply(false);
    short.truncate(short.len() - 3);
    let flaw = ply::read(&short).unwrap_err();
    assert_eq!(flaw.message, "a list claims 4 items, which the file has no room for");
    // After the length of the list, of which 13 bytes are left.
    assert_eq!(flaw.place, Place::Byte(short.len() as u64 - 13));
}

#[test]
fn ply_colours() {
    let with = |kind: &str, names: [&str; 3], values: &str| {
        let properties: String = names.iter().map(|n| format!("property {kind} {n}\n")).collect();
        let text = ASCII_PLY.replace("element face", &format!("{properties}element face"));
        let vertices = text.split_once("end_header\n").unwrap().1.lines().take(4);
        let body: String = vertices.map(|line| format!("{line} {values}\n")).collect();
        let header = text.split_once("end_header\n").unwrap().0;
        ply::read(format!("{header}end_header\n{body}3 0 1 2\n3 0 2 3\n").as_bytes())
    };
    let (short, long) = (["r", "g", "b"], ["red", "green", "blue"]);
    assert_eq!(with("float", short, ".1 .2 3").unwrap().colors, vec![Rgb::new(0.1, 0.2, 3.0); 4]);
    assert_eq!(with("uchar", long, "255 0 51").unwrap().colors, vec![Rgb::new(1.0, 0.0, 0.2); 4]);
    assert_eq!(with("ushort", long, "65535 0 0").unwrap().colors, vec![Rgb::new(1.0, 0.0, 0.0); 4]);
    assert!(with("float", ["r", "g", "y"], "1 1 1").unwrap().colors.is_empty());
    let flaw = with("float", short, "1 -1 1").unwrap_err();
    assert_eq!((flaw.place, flaw.message.as_str()), (Place::Line(16), "the vertex's g is negative"));
}

#[test]
fn obj_corners_are_merged() {
    let mesh = obj::read(OBJ.as_bytes()).unwrap();
    let (positions, triangles) = expected_quad();
    assert_eq!((mesh.positions, mesh.triangles), (positions, triangles));
    assert_eq!(mesh.normals, vec![Vec3::Z; 4]);
    assert_eq!(mesh.uvs, QUAD.map(|p| Vec2::new(p[0], p[1])));
    // The same position with two normals is two vertices; with one, a single one.
    let two = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nvn 1 0 0\nf 1//1 2//1 3//1\nf 1//2 3//2 4//2\nf 1//1 2//1 4//1\n";
    let mesh = obj::read(two.as_bytes()).unwrap();
    assert_eq!(mesh.positions.len(), 7);
    assert_eq!(mesh.triangles, vec![[0, 1, 2], [3, 4, 5], [0, 1, 6]]);
}

#[test]
fn obj_corners_without_a_normal_get_that_of_their_faces() {
    let mixed = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nf 1//1 2 3\n";
    let mesh = obj::read(mixed.as_bytes()).unwrap();
    assert_eq!(mesh.normals, vec![Vec3::X, Vec3::Z, Vec3::Z]);
    let none = obj::read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3".as_bytes()).unwrap();
    assert!(none.normals.is_empty() && none.uvs.is_empty());
}

#[test]
fn obj_polygons_are_fans() {
    let text = "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5\n";
    assert_eq!(obj::read(text.as_bytes()).unwrap().triangles, vec![[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
}

#[test]
fn obj_flaws_have_their_line() {
    for (line, message) in [
        ("f 1 2 4", "the vertex 4 is not among the 3 so far"),
        ("f 1 2 0", "the vertex 0 is not among the 3 so far"),
        ("f 1 2 -4", "the vertex -4 is not among the 3 so far"),
        ("f 1/1 2/1 3/1", "the texture coordinate 1 is not among the 0 so far"),
        ("f 1//1 2//1 3//1", "the normal 1 is not among the 0 so far"),
        ("f 1/// 2 3", "`1///` has more than three indices"),
        ("f a b c", "`a` is not an index"),
        ("f / / /", "`/` has no vertex"),
        ("v 1 2", "2 numbers where 3 belong"),
        ("v 1 2 inf", "`inf` is not a finite number"),
        ("vn 1 2 1e99", "`1e99` is not a finite number"),
        ("facet 0 1 1 2", "the statement `facet` is not supported"),
    ] {
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{line}\n");
        let expected = Flaw { place: Place::Line(4), message: message.to_owned() };
        assert_eq!(obj::read(text.as_bytes()).unwrap_err(), expected, "{line}");
    }
}

/// Statements of OBJ files that have no surface are passed over with a note; a backslash continues a line.
#[test]
fn obj_without_a_surface_is_noted() {
    let (mesh, notes) = obj::read_with_notes(
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\np 1\nf 1 2\nl 2 3\ncurv 0 1 1 2\nf 1 \\\n 2 \\\r\n 3\n",
    )
    .unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert_eq!(
        notes,
        [
            "line 4 and others: 2 times `l` is passed over; it has no surface",
            "line 5: `p` is passed over; it has no surface",
            "line 6: a face of fewer than 3 corners is passed over; it has no surface",
            "line 8: `curv` is passed over; it has no surface",
        ]
    );
}

/// An image in the memory of a file.
pub(crate) fn exr_bytes<T: exr::prelude::IntoSample>(
    width: usize,
    height: usize,
    texel: impl Sync + Fn(usize, usize) -> (T, T, T),
) -> Vec<u8> {
    use exr::prelude::{SpecificChannels, WritableImage};
    let channels = SpecificChannels::rgb(|at: exr::math::Vec2<usize>| texel(at.x(), at.y()));
    let mut out = Cursor::new(Vec::new());
    exr::prelude::Image::from_channels((width, height), channels).write().non_parallel().to_buffered(&mut out).unwrap();
    out.into_inner()
}

/// Channels of layers alone are named; red alone is no colour, wherever a grey image is looked for instead.
#[test]
fn layers_of_images_are_named() {
    use exr::prelude::{AnyChannel, AnyChannels, FlatSamples, Image, WritableImage};
    let file = |names: &[String]| {
        let channels = names.iter().map(|name| AnyChannel::new(name.as_str(), FlatSamples::F32(vec![0.5; 4])));
        let mut out = Cursor::new(Vec::new());
        let image = Image::from_channels((2, 2), AnyChannels::sort(channels.collect()));
        image.write().non_parallel().to_buffered(&mut out).unwrap();
        read_exr(&out.into_inner())
    };
    let message = |names: &[String]| file(names).unwrap_err().message;
    let start = "the image has no channels `R`, `G` and `B`, and no `Y`; it has ";
    let beauty = ["beauty.R", "beauty.G", "beauty.B"].map(str::to_owned);
    assert_eq!(message(&beauty), format!("{start}`beauty.B`, `beauty.G`, `beauty.R`"));
    let many: Vec<String> = (10..30).map(|i| format!("{i}.R")).collect();
    assert!(message(&many).ends_with("`21.R` and 8 more"), "{}", message(&many));
    assert_eq!(file(&["R", "Y"].map(str::to_owned)).unwrap().bitmap.texels[3], Rgb::splat(0.5));
}

#[test]
fn images_keep_values_beyond_half_range() {
    let image = read_exr(&exr_bytes(3, 2, |x, y| (1e6f32, x as f32, y as f32 * 3e38))).unwrap();
    assert_eq!((image.bitmap.width, image.bitmap.height, image.zeroed), (3, 2, 0));
    let texel = image.bitmap.texels[5];
    assert_eq!(texel.to_array(), [1e6, 2.0, 3e38]);
    let half = read_exr(&exr_bytes(3, 2, |x, y| {
        (exr::prelude::f16::from_f32(0.5), exr::prelude::f16::from_f32(x as f32), exr::prelude::f16::from_f32(y as f32))
    }))
    .unwrap();
    assert_eq!(half.bitmap.texels[5].to_array(), [0.5, 2.0, 1.0]);
}

#[test]
fn invalid_texels_are_zeroed_and_counted() {
    let bad = [f32::NAN, f32::INFINITY, -1.0, 4.0];
    let image = read_exr(&exr_bytes(4, 3, |x, y| (1f32, if y == 1 { bad[x] } else { 1.0 }, 1f32))).unwrap();
    assert_eq!(image.zeroed, 3);
    assert!(image.bitmap.texels.iter().all(|t| t.is_valid()));
    assert!(image.bitmap.texels[4..7].iter().all(|t| t.is_black()));
    assert_eq!(image.bitmap.texels[7].to_array(), [1.0, 4.0, 1.0]);
}

#[test]
fn a_huge_claim_is_refused_before_it_is_believed() {
    let mut bytes = exr_bytes(4, 4, |_, _| (1f32, 1f32, 1f32));
    let name = b"dataWindow\0box2i\0";
    let at = bytes.windows(name.len()).position(|w| w == name).unwrap() + name.len() + 4;
    // The window's last column and row.
    bytes[at + 8..at + 16].copy_from_slice(&[0xff, 0x3f, 0, 0, 0xff, 0x3f, 0, 0]);
    let flaw = read_exr(&bytes).unwrap_err();
    assert_eq!(flaw.message, "the header claims 16384 x 16384 texels; 67108864 is the most");
    bytes[at + 8..at + 16].copy_from_slice(&[0xff, 0x1f, 0, 0, 0xff, 0x1f, 0, 0]);
    let flaw = read_exr(&bytes).unwrap_err();
    assert!(flaw.message.starts_with("the header claims 8192 x 8192 texels, too many for "), "{}", flaw.message);
}

#[test]
fn an_empty_mesh_is_a_mesh() {
    let text = ASCII_PLY.split("0 0 0 0").next().unwrap().replace("vertex 4", "vertex 0").replace("face 2", "face 0");
    let Mesh { positions, triangles, .. } = ply::read(text.as_bytes()).unwrap();
    assert!(positions.is_empty() && triangles.is_empty());
    assert!(obj::read(b"").unwrap().triangles.is_empty());
}
