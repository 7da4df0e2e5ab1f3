//! The outside of meshes, as in Mitsuba 3.9.1; round shapes that are scaled unevenly.

use crate::files::{Folder, LENIENT};
use etendue_core::{
    geometry::Mesh,
    scene::{ObjectShape, Scene},
};
use glam::DVec3;

/// A tetrahedron about the origin, wound outwards or inwards, with normals outwards, inwards or none.
fn tetrahedron(wound_outwards: bool, normals: Option<f64>) -> String {
    let corners = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]];
    let mut text = String::new();
    for c in corners {
        let [x, y, z] = c;
        text += &format!("v {x} {y} {z}\n");
    }
    for [x, y, z] in corners.into_iter().filter(|_| normals.is_some()) {
        let n = normals.unwrap_or_default();
        text += &format!("vn {} {} {}\n", n * f64::from(x), n * f64::from(y), n * f64::from(z));
    }
    for [a, b, c] in [[1, 2, 3], [1, 4, 2], [1, 3, 4], [2, 4, 3]] {
        let [a, b, c] = if wound_outwards { [a, b, c] } else { [a, c, b] };
        text += &match normals {
            Some(_) => format!("f {a}//{a} {b}//{b} {c}//{c}\n"),
            None => format!("f {a} {b} {c}\n"),
        };
    }
    text
}

fn loaded(obj: &str, parameters: &str, scale: &str) -> (etendue_scenes::LoadedScene, Mesh) {
    let place = format!("<transform name=\"to_world\"><scale value=\"{scale}\"/></transform>");
    let shape = format!("<shape type=\"obj\"><string name=\"filename\" value=\"t.obj\"/>{parameters}{place}</shape>");
    let loaded = Folder::new().with("t.obj", obj).scene(&shape).load_with(LENIENT);
    let ObjectShape::Mesh(mesh) = loaded.description.objects[0].shape.clone() else { panic!("a mesh") };
    (loaded, mesh)
}

/// Six times the signed volume in the world: positive where faces look outwards. The scene turns the winding where a
/// transform mirrors.
fn volume(loaded: &etendue_scenes::LoadedScene, mesh: &Mesh) -> f64 {
    let to_world = loaded.description.objects[0].to_world;
    let mirrored = to_world.matrix3.determinant().signum();
    let at = |i: u32| to_world.transform_point3(mesh.positions[i as usize].as_dvec3());
    mesh.triangles.iter().map(|[a, b, c]| mirrored * at(*a).dot(at(*b).cross(at(*c)))).sum()
}

#[test]
fn vertex_normals_decide_which_side_is_out() {
    let mut seen = 0;
    for (wound, normals, flat, flip, scale) in [true, false].into_iter().flat_map(|wound| {
        [Some(1.0), Some(-1.0), None].into_iter().flat_map(move |normals| {
            [true, false].into_iter().flat_map(move |flat| {
                [true, false].into_iter().flat_map(move |flip| {
                    ["1,1,1", "-1,1,1", "1,2,-.5"].map(move |scale| (wound, normals, flat, flip, scale))
                })
            })
        })
    }) {
        let parameters = format!(
            "<boolean name=\"face_normals\" value=\"{flat}\"/><boolean name=\"flip_normals\" value=\"{flip}\"/>"
        );
        let (loaded, mesh) = loaded(&tetrahedron(wound, normals), &parameters, scale);
        let mirrored = scale.contains('-');
        let kept = normals.filter(|_| !flat);
        // Without normals, Mitsuba winds what it has placed in the world.
        let outwards = kept.map_or(wound != mirrored, |n| n > 0.0) != flip;
        let what = format!("wound outwards {wound}, normals {normals:?}, flat {flat}, flipped {flip}, scaled {scale}");
        assert_eq!(volume(&loaded, &mesh) > 0.0, outwards, "{what}");
        for (t, n) in mesh.triangles.iter().flat_map(|t| t.map(|i| (t, i))).filter(|_| !mesh.normals.is_empty()) {
            let side = mesh.normals[n as usize].dot(mesh.positions[n as usize]) > 0.0;
            // Normals are those of the file's space, where a mirrored winding is the other way round.
            assert_eq!(side, outwards, "{what}: {t:?}");
        }
        let noted = loaded.notes.iter().any(|n| n.contains("its transform reflects"));
        assert_eq!(noted, mirrored && kept.is_none(), "{what}: {:?}", loaded.notes);
        Scene::new(&loaded.description).expect("a valid scene");
        seen += 1;
    }
    assert_eq!(seen, 72);
}

/// Faces decide one by one; the texture coordinates that stand for missing ones stay at the corners of the file.
#[test]
fn single_faces_are_turned_and_keep_their_coordinates() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 2//1 3//1 4//1\n";
    let (_, mesh) = loaded(text, "", "1,1,1");
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        assert!((b - a).cross(c - a).z > 0.0);
    }
    let uv = |x: f32, y: f32, t: [u32; 3]| {
        let at = |i: &u32| mesh.positions[*i as usize].truncate() == glam::Vec2::new(x, y);
        t.iter().find(|i| at(i)).map(|i| mesh.uvs[*i as usize].to_array())
    };
    // Corners 2, 3, 4 of the file are its barycentrics' (0, 0), (1, 0), (0, 1).
    let second = mesh.triangles[1];
    assert_eq!(
        [uv(1.0, 0.0, second), uv(0.0, 1.0, second), uv(1.0, 1.0, second)],
        [Some([0.0, 0.0]), Some([1.0, 0.0]), Some([0.0, 1.0])]
    );
}

/// Ellipses, ellipsoids and slanted cylinders are fine meshes with a note; a longer cylinder stays one.
#[test]
fn round_shapes_are_scaled_unevenly() {
    let load = |kind: &str, inner: &str, transform: &str| {
        let shape = format!(
            "<shape type=\"{kind}\">{inner}<transform name=\"to_world\">{transform}</transform></shape>\
             <emitter type=\"constant\"/>"
        );
        let loaded = Folder::new().scene(&shape).load();
        let scene = Scene::new(&loaded.description).expect("a valid scene");
        (loaded, scene)
    };
    let (longer, _) = load("cylinder", "", "<scale value=\".5,.5,2\"/><rotate y=\"1\" angle=\"90\"/>");
    assert!(longer.notes.is_empty() && matches!(longer.description.objects[0].shape, ObjectShape::Cylinder { .. }));

    let area = |loaded: &etendue_scenes::LoadedScene| {
        let object = &loaded.description.objects[0];
        let ObjectShape::Mesh(mesh) = &object.shape else { panic!("a mesh") };
        let at = |i: u32| object.to_world.transform_point3(mesh.positions[i as usize].as_dvec3());
        let cross = |t: &[u32; 3]| (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0]));
        let normals = object.to_world.matrix3.inverse().transpose();
        for t in &mesh.triangles {
            let sum: DVec3 = t.iter().map(|i| mesh.normals[*i as usize].as_dvec3()).sum();
            let side = cross(t).dot(normals * sum) * object.to_world.matrix3.determinant();
            assert!(side > 0.0, "a face looks away from its normals");
        }
        mesh.triangles.iter().map(|t| 0.5 * cross(t).length()).sum::<f64>()
    };
    use std::f64::consts::PI;
    // The surface of an oblate spheroid with axes 2, 2, 1.
    let e = 0.75f64.sqrt();
    let spheroid = 2.0 * PI * 4.0 * (1.0 + (1.0 - e * e) / e * e.atanh());
    for (kind, inner, transform, expected) in [
        ("disk", "", "<scale value=\"1,1.5,1\"/>", 1.5 * PI),
        ("disk", "", "<scale value=\"-2,1.5,1\"/>", 3.0 * PI),
        ("sphere", "", "<scale value=\"2,2,1\"/>", spheroid),
        ("sphere", "<boolean name=\"flip_normals\" value=\"true\"/>", "<scale value=\"2,-2,1\"/>", spheroid),
    ] {
        let (loaded, _) = load(kind, inner, transform);
        let found = area(&loaded);
        assert!((found / expected - 1.0).abs() < 3e-4, "{kind} {transform}: {found}, not {expected}");
        assert!(loaded.notes.iter().any(|n| n.contains("scales unevenly")), "{:?}", loaded.notes);
    }
    // An elliptic section: its circumference is that of the ellipse with axes 1 and 2, by Ramanujan's second formula.
    let h: f64 = 1.0 / 9.0;
    let around = PI * 3.0 * (1.0 + 3.0 * h / (10.0 + (4.0 - 3.0 * h).sqrt()));
    let (loaded, _) = load("cylinder", "", "<scale value=\"2,1,1\"/>");
    assert!((area(&loaded) / around - 1.0).abs() < 3e-4, "{} not {around}", area(&loaded));
}
