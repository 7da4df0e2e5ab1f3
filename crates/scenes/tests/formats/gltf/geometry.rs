//! Meshes and the hierarchy of nodes.

use super::{F32, File, I16, U8, U16, U32, mesh, triangle};
use etendue_core::{geometry::Mesh, rgb::Rgb};
use glam::{DAffine3, DVec3, Vec2, Vec3};
use serde_json::json;

/// The corners of each triangle, which says the same however vertices are numbered.
fn corners(mesh: &Mesh) -> Vec<[Vec3; 3]> {
    mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize])).collect()
}

/// Vertices on a line, so that x tells them apart.
fn numbered(count: usize) -> Vec<[f32; 3]> {
    (0..count).map(|i| [i as f32, (i * i) as f32, 0.0]).collect()
}

fn shape_of(mode: u32, vertices: usize, indices: Option<(&[u8], u32, usize)>) -> Vec<[f32; 3]> {
    let mut file = File::new();
    let positions = file.floats(&numbered(vertices));
    let mut primitive = json!({"attributes": {"POSITION": positions}, "mode": mode});
    if let Some((bytes, kind, count)) = indices {
        primitive["indices"] = json!(file.accessor(bytes, kind, "SCALAR", count));
    }
    let index = file.mesh(primitive);
    file.node(json!({"mesh": index}));
    let scene = file.scene();
    let triangles = corners(mesh(&scene.description.objects[0]));
    triangles.iter().map(|t| t.map(|p| p.x)).collect()
}

#[test]
fn triangles_strips_and_fans_are_read() {
    assert_eq!(shape_of(4, 7, None), [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]);
    assert_eq!(shape_of(5, 5, None), [[0.0, 1.0, 2.0], [1.0, 3.0, 2.0], [2.0, 3.0, 4.0]]);
    assert_eq!(shape_of(6, 5, None), [[1.0, 2.0, 0.0], [2.0, 3.0, 0.0], [3.0, 4.0, 0.0]]);
}

#[test]
fn indices_of_every_size_are_read() {
    let order = [3u32, 1, 4, 4, 1, 0];
    let expected = [[3.0, 1.0, 4.0], [4.0, 1.0, 0.0]];
    let bytes = |width: usize| -> Vec<u8> { order.iter().flat_map(|i| i.to_le_bytes()[..width].to_vec()).collect() };
    assert_eq!(shape_of(4, 5, Some((&bytes(1), U8, 6))), expected);
    assert_eq!(shape_of(4, 5, Some((&bytes(2), U16, 6))), expected);
    assert_eq!(shape_of(4, 5, Some((&bytes(4), U32, 6))), expected);
}

#[test]
fn vertices_that_no_triangle_uses_are_dropped() {
    let mut file = File::new();
    let positions = file.floats(&numbered(100));
    let normals = file.floats(&(0..100).map(|i| [0.0, i as f32, 1.0]).collect::<Vec<_>>());
    let first = file.accessor(&[90, 5, 7, 7, 5, 20], U8, "SCALAR", 6);
    let second = file.accessor(&[1, 2, 3], U8, "SCALAR", 3);
    let attributes = json!({"POSITION": positions, "NORMAL": normals});
    let primitives =
        json!([{"attributes": attributes, "indices": first}, {"attributes": attributes, "indices": second}]);
    let index = file.push("meshes", json!({"primitives": primitives}));
    file.node(json!({"mesh": index, "name": "thing"}));
    let scene = file.scene().description;
    let names: Vec<_> = scene.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["thing/0", "thing/1"]);
    let m = mesh(&scene.objects[0]);
    assert_eq!(m.positions.iter().map(|p| p.x).collect::<Vec<_>>(), [90.0, 5.0, 7.0, 20.0]);
    assert_eq!(m.normals.iter().map(|n| n.y).collect::<Vec<_>>(), [90.0, 5.0, 7.0, 20.0]);
    assert_eq!(m.triangles, [[0, 1, 2], [2, 1, 3]]);
    assert_eq!(mesh(&scene.objects[1]).positions.len(), 3);
}

#[test]
fn interleaved_vertices_are_read() {
    let mut file = File::new();
    let mut bytes = vec![7; 8];
    for i in 0..3u8 {
        for value in [f32::from(i), 1.0, 2.0] {
            bytes.extend(value.to_le_bytes());
        }
        bytes.extend([i * 51, 255, 0, 9]);
    }
    let view = file.view(&bytes);
    file.json["bufferViews"][view]["byteStride"] = json!(16);
    let of = |offset: usize, kind: u32, shape: &str| json!({"bufferView": view, "byteOffset": offset, "componentType": kind, "type": shape, "count": 3});
    let positions = file.push("accessors", of(8, F32, "VEC3"));
    let mut colours = of(20, U8, "VEC3");
    colours["normalized"] = json!(true);
    let colours = file.push("accessors", colours);
    let index = file.mesh(json!({"attributes": {"POSITION": positions, "COLOR_0": colours}}));
    file.node(json!({"mesh": index}));
    let scene = file.scene().description;
    let m = mesh(&scene.objects[0]);
    assert_eq!(m.positions, [0.0, 1.0, 2.0].map(|x| Vec3::new(x, 1.0, 2.0)));
    assert_eq!(m.colors, [0.0, 0.2, 0.4].map(|r| Rgb::new(r, 1.0, 0.0)));
}

#[test]
fn quantized_and_sparse_vertices_are_read() {
    let mut file = File::new();
    let numbers = |values: &[i16]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let positions = file.accessor(&numbers(&[0, 0, 0, 100, 0, -7, 0, 200, 0]), I16, "VEC3", 3);
    let normals = file.accessor(&numbers(&[0, 0, 32767, 0, 0, -32768, 16384, 0, 0]), I16, "VEC3", 3);
    file.json["accessors"][normals]["normalized"] = json!(true);
    let indices = file.view(&[1]);
    let values = file.view(&numbers(&[5, 6, 7]));
    file.json["accessors"][positions]["sparse"] = json!({
        "count": 1,
        "indices": {"bufferView": indices, "componentType": U8},
        "values": {"bufferView": values},
    });
    let index = file.mesh(json!({"attributes": {"POSITION": positions, "NORMAL": normals}}));
    file.node(json!({"mesh": index}));
    file.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let scene = file.scene().description;
    let m = mesh(&scene.objects[0]);
    assert_eq!(m.positions, [Vec3::ZERO, Vec3::new(5.0, 6.0, 7.0), Vec3::new(0.0, 200.0, 0.0)]);
    assert_eq!(m.normals, [Vec3::Z, -Vec3::Z, Vec3::X * (16384.0 / 32767.0)]);
}

#[test]
fn a_normal_of_no_length_gives_way() {
    let mut file = triangle(json!({}));
    let normals = file.floats(&[[1.0, 0.0, 0.0], [0.0; 3], [0.0, 1.0, 0.0]]);
    file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(normals);
    assert_eq!(mesh(&file.scene().description.objects[0]).normals, [Vec3::X, Vec3::Z, Vec3::Y]);
}

#[test]
fn texture_coordinates_grow_upwards_and_are_read_when_used() {
    let plain = triangle(json!({})).scene().description;
    assert_eq!(mesh(&plain.objects[0]).uvs, []);
    let mut file = triangle(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    file.texture(2, &[[0, 0, 0, 255], [255; 4]]);
    assert_eq!(mesh(&file.scene().description.objects[0]).uvs, [Vec2::Y, Vec2::ONE, Vec2::ZERO]);
    // Another set.
    let second = file.floats(&[[0.5, 0.0], [0.5, 0.25], [0.0, 0.0]]);
    file.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = json!(second);
    file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = json!(1);
    let uvs = [Vec2::new(0.5, 1.0), Vec2::new(0.5, 0.75), Vec2::Y];
    assert_eq!(mesh(&file.scene().description.objects[0]).uvs, uvs);
    // One that is not there.
    file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = json!(2);
    let scene = file.scene();
    assert_eq!(mesh(&scene.description.objects[0]).uvs, [Vec2::ZERO; 3]);
    assert!(scene.notes[0].contains("lacks the texture coordinates"), "{:?}", scene.notes);
}

fn assert_near(a: DAffine3, b: DAffine3) {
    let distance = a.to_cols_array().iter().zip(b.to_cols_array()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(distance < 1e-6, "{a} is not {b}");
}

#[test]
fn transforms_are_composed() {
    let mut file = triangle(json!({}));
    // A quarter turn about y, of a quaternion that is not quite of length 1.
    let half = 0.7072f32;
    file.json["nodes"][0] = json!({
        "mesh": 0, "translation": [1, 2, 3], "rotation": [0, half, 0, half], "scale": [2, 3, 4]
    });
    let matrix = [0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 10, 20, 30, 1];
    file.json["nodes"].as_array_mut().unwrap().push(json!({"matrix": matrix, "children": [0]}));
    file.json["scenes"] = json!([{"nodes": []}, {"nodes": [1]}]);
    file.json["scene"] = json!(1);
    let scene = file.scene().description;
    let to_world = scene.objects[0].to_world;
    // (1, 0, 0) is scaled to (2, 0, 0), turned to (0, 0, -2), moved to (1, 2, 1); the matrix takes x to y, y to z, z to x.
    let at = |x: f64, y: f64, z: f64| to_world.transform_point3(DVec3::new(x, y, z));
    assert!((at(1.0, 0.0, 0.0) - DVec3::new(11.0, 21.0, 32.0)).length() < 1e-6, "{}", at(1.0, 0.0, 0.0));
    assert!((at(0.0, 0.0, 0.0) - DVec3::new(13.0, 21.0, 32.0)).length() < 1e-6, "{}", at(0.0, 0.0, 0.0));
    assert!((at(0.0, 1.0, 0.0) - DVec3::new(13.0, 21.0, 35.0)).length() < 1e-6, "{}", at(0.0, 1.0, 0.0));
}

#[test]
fn a_mesh_in_several_places_is_a_group() {
    let mut file = triangle(json!({}));
    file.json["meshes"][0]["name"] = json!("leaf");
    file.node(json!({"mesh": 0, "translation": [5, 0, 0]}));
    file.node(json!({"mesh": 0, "scale": [1, 1, -1]}));
    // Nothing that is flat can be seen from everywhere.
    file.node(json!({"mesh": 0, "scale": [1, 0, 1], "name": "pressed"}));
    let scene = file.scene();
    let d = &scene.description;
    assert_eq!((d.objects.len(), d.groups.len(), d.instances.len()), (0, 1, 3));
    assert_eq!((d.groups[0].name.as_str(), d.groups[0].objects[0].name.as_str()), ("leaf", "leaf"));
    assert_near(d.groups[0].objects[0].to_world, DAffine3::IDENTITY);
    assert_near(d.instances[0].to_world, DAffine3::IDENTITY);
    assert_near(d.instances[1].to_world, DAffine3::from_translation(DVec3::X * 5.0));
    assert_near(d.instances[2].to_world, DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0)));
    assert!(scene.notes.contains(&"the node `pressed` is flat or a point and is left out".to_owned()));
}

#[test]
fn a_light_in_several_places_is_copied() {
    let mut file = triangle(json!({"emissiveFactor": [1, 1, 1]}));
    file.json["nodes"][0]["name"] = json!("lamp");
    file.node(json!({"mesh": 0, "translation": [5, 0, 0], "name": "lamp"}));
    let d = file.scene().description;
    assert_eq!((d.objects.len(), d.groups.len(), d.instances.len()), (2, 0, 0));
    let names: Vec<_> = d.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["lamp", "lamp (2)"]);
    assert_near(d.objects[1].to_world, DAffine3::from_translation(DVec3::X * 5.0));
    assert!(d.objects.iter().all(|o| o.emission.is_some()) && d.environment.is_none());
}

#[test]
fn what_is_left_out_is_noted() {
    let mut file = triangle(json!({}));
    file.json["meshes"][0]["primitives"].as_array_mut().unwrap().extend([
        json!({"attributes": {"POSITION": 0}, "mode": 1}),
        json!({"attributes": {"TEXCOORD_0": 1}}),
        json!({"attributes": {"POSITION": 0}, "targets": [{"POSITION": 0}]}),
    ]);
    file.json["animations"] = json!([{"channels": [], "samplers": []}]);
    file.json["skins"] = json!([{"joints": [0]}]);
    file.json["nodes"][0]["skin"] = json!(0);
    file.json["extensionsUsed"] = json!(["KHR_materials_ior", "EXT_unheard_of"]);
    let scene = file.scene();
    assert_eq!(scene.description.objects.len(), 2);
    let notes = scene.notes.join("\n");
    for part in
        ["points or lines", "no positions", "morph targets", "animations", "skins", "EXT_unheard_of", "no camera"]
    {
        assert!(notes.contains(part), "{part}: {notes}");
    }
    assert!(!notes.contains("KHR_materials_ior"));
}
