//! What is wrong is refused, and says where.

use super::{U8, U32, triangle};
use etendue_scenes::{LoadOptions, Place, gltf::read, load_with};
use serde_json::{Value, json};

/// The flaw of a triangle in which something is changed.
fn changed(pointer: &str, value: Value) -> String {
    let mut file = triangle(json!({}));
    let (parent, name) = pointer.rsplit_once('/').unwrap();
    match file.json.pointer_mut(parent).unwrap() {
        Value::Array(list) => list[name.parse::<usize>().unwrap()] = value,
        object => object[name] = value,
    }
    file.flaw()
}

#[test]
fn what_points_beyond_lists_is_refused() {
    for (pointer, list) in [
        ("/scenes/0/nodes/0", "nodes"),
        ("/nodes/0/mesh", "meshes"),
        ("/nodes/0/camera", "cameras"),
        ("/meshes/0/primitives/0/material", "materials"),
        ("/meshes/0/primitives/0/indices", "accessors"),
        ("/meshes/0/primitives/0/attributes/POSITION", "accessors"),
        ("/accessors/0/bufferView", "bufferViews"),
        ("/bufferViews/0/buffer", "buffers"),
    ] {
        let message = changed(pointer, json!(77));
        assert!(message.starts_with(&format!("{list}[77] is asked for, and there are ")), "{pointer}: {message}");
    }
    assert!(changed("/scene", json!(3)).starts_with("scenes[3]"));
    assert!(changed("/nodes/0/children", json!([1])).starts_with("nodes[1]"));
}

#[test]
fn what_reaches_beyond_its_bytes_is_refused() {
    let most = u64::MAX;
    for (pointer, value, expected) in [
        ("/bufferViews/0/byteLength", json!(10_000), "bufferViews[0]: it reaches beyond its buffer's end"),
        ("/bufferViews/0/byteOffset", json!(most), "bufferViews[0]: it reaches beyond its buffer's end"),
        ("/accessors/0/count", json!(4), "accessors[0]: it reaches beyond its buffer view's end"),
        ("/accessors/0/byteOffset", json!(1), "accessors[0]: it reaches beyond its buffer view's end"),
        ("/accessors/0/byteOffset", json!(most), "accessors[0]: it reaches beyond its buffer view's end"),
        ("/bufferViews/0/byteStride", json!(13), "accessors[0]: it reaches beyond its buffer view's end"),
        ("/bufferViews/0/byteStride", json!(most), "accessors[0]: it reaches beyond its buffer view's end"),
        ("/accessors/0/count", json!(1u64 << 40), "meshes[0].primitives[0]: it has more than 134217728 triangles"),
        ("/accessors/0/type", json!("VEC4"), "accessors[0]: it reaches beyond its buffer view's end"),
        ("/accessors/0/type", json!("MAT3"), "accessors[0]: matrices have no use here"),
        ("/accessors/0/type", json!("VEC5"), "accessors[0]: the value is none of those that are known"),
        ("/accessors/0/componentType", json!(1), "accessors[0]: the value is none of those that are known"),
    ] {
        assert_eq!(changed(pointer, value.clone()), expected, "{pointer} {value}");
    }
    let mut file = triangle(json!({}));
    file.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    assert_eq!(file.flaw(), "accessors[0]: one without a buffer view is not supported");
}

#[test]
fn wrong_vertices_are_refused() {
    let mut file = triangle(json!({}));
    let indices = file.accessor(&[0, 1, 3], U8, "SCALAR", 3);
    file.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
    assert_eq!(file.flaw(), "meshes[0].primitives[0]: its index 2 is none of a vertex, of which there are 3");
    file.json["accessors"][indices]["componentType"] = json!(5120);
    assert_eq!(file.flaw(), "meshes[0].primitives[0]: its index 0 is none of a vertex, of which there are 3");

    let mut file = triangle(json!({}));
    let positions = file.floats(&[[0.0, f32::NAN, 0.0], [1.0; 3], [2.0; 3]]);
    file.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(positions);
    assert_eq!(file.flaw(), "meshes[0].primitives[0]: one of its positions is not finite");

    let mut file = triangle(json!({}));
    let normals = file.floats(&[[0.0, 1.0, 0.0]; 2]);
    file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(normals);
    assert_eq!(file.flaw(), "meshes[0].primitives[0]: 2 Normals for 3 vertices");
}

#[test]
fn sparse_indices_must_rise_and_stay_inside() {
    let sparse = |indices: &[u8], count: usize| {
        let mut file = triangle(json!({}));
        let indices = file.view(indices);
        let values = file.view(&[0; 36]);
        file.json["accessors"][0]["sparse"] = json!({
            "count": count, "indices": {"bufferView": indices, "componentType": U8}, "values": {"bufferView": values}
        });
        file
    };
    sparse(&[0, 2], 2).scene();
    for (indices, count) in [(&[2, 0][..], 2), (&[1, 1], 2), (&[0, 3], 2)] {
        assert!(sparse(indices, count).flaw().contains("sparse indices do not rise"));
    }
    assert!(sparse(&[0, 1, 2], 4).flaw().contains("reaches beyond"));
    let mut file = sparse(&[0; 16], 4);
    file.json["accessors"][0]["sparse"]["indices"]["componentType"] = json!(U32);
    assert!(file.flaw().contains("reaches beyond"), "{}", file.flaw());
}

#[test]
fn a_hierarchy_is_a_tree() {
    assert_eq!(changed("/nodes/0/children", json!([0])), "nodes[0] stands in the hierarchy twice");
    let mut file = triangle(json!({}));
    file.json["nodes"] = json!([{"children": [1]}, {"children": [2]}, {"children": [0]}]);
    assert_eq!(file.flaw(), "nodes[0] stands in the hierarchy twice");
    file.json["nodes"] = json!([{"children": [1, 2]}, {}, {"children": [1]}]);
    assert_eq!(file.flaw(), "nodes[1] stands in the hierarchy twice");
    // Without a scene, what is in a circle is nobody's root.
    file.json.as_object_mut().unwrap().remove("scenes");
    file.json["nodes"] = json!([{"children": [1]}, {"children": [0]}]);
    assert!(file.flaw().contains("neither a camera nor surfaces"));
}

#[test]
fn a_deep_hierarchy_is_read() {
    let mut file = triangle(json!({}));
    let nodes: Vec<Value> = (0..100_000).map(|i| json!({"children": [i + 1]})).collect();
    file.json["nodes"] = json!(nodes);
    file.json["nodes"].as_array_mut().unwrap().push(json!({"mesh": 0}));
    assert_eq!(file.scene().description.objects.len(), 1);
}

#[test]
fn wrong_transforms_are_refused() {
    assert_eq!(changed("/nodes/0/rotation", json!([0, 0, 0, 0])), "nodes[0]: its rotation is none");
    let matrix = [1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
    assert_eq!(changed("/nodes/0/matrix", json!(matrix)), "nodes[0]: its matrix is not affine");
    assert_eq!(changed("/nodes/0/scale", json!([1e39, 1, 1])), "not the JSON of a glTF file: number out of range");
    let mut file = triangle(json!({}));
    let nodes: Vec<Value> = (0..12).map(|i| json!({"scale": [1e30, 1, 1], "children": [i + 1]})).collect();
    file.json["nodes"] = json!(nodes);
    assert_eq!(file.flaw(), "nodes[10]: its transform is not finite in the world");
}

#[test]
fn required_extensions_are_known_or_refused() {
    let message = changed("/extensionsRequired", json!(["KHR_texture_transform", "KHR_draco_mesh_compression"]));
    assert_eq!(message, "the file requires the extension `KHR_draco_mesh_compression`, which is not supported");
    let mut file = triangle(json!({}));
    file.json["extensionsRequired"] = json!(etendue_scenes::gltf::EXTENSIONS);
    file.scene();
    file.json["extensionsRequired"] = json!(["KHR_none"]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.gltf");
    std::fs::write(&path, file.text()).unwrap();
    let with = |lenient| load_with(path.to_str().unwrap(), LoadOptions { lenient, ..LoadOptions::default() });
    assert!(with(false).is_err());
    assert_eq!(with(true).unwrap().notes[0], "what the extension `KHR_none` adds is left out");
}

#[test]
fn buffers_are_found_or_refused() {
    let mut json = triangle(json!({})).json;
    let flaw = |json: &Value| read(&serde_json::to_vec(json).unwrap()).unwrap_err().message;
    json["buffers"] = json!([{"byteLength": 36}]);
    assert_eq!(flaw(&json), "buffers[0]: it has neither a URI nor bytes in the file");
    json["buffers"] = json!([{"byteLength": 36, "uri": "data:;base64,AAAA"}]);
    assert_eq!(flaw(&json), "buffers[0]: it claims 36 bytes, and there are 3");
    json["buffers"] = json!([{"byteLength": 36, "uri": "a.bin"}]);
    assert_eq!(flaw(&json), "buffers[0]: the file `a.bin` cannot be read: the scene has no folder");
    json["asset"]["version"] = json!("1.0");
    assert_eq!(flaw(&json), "glTF of the version `1.0`; 2.0 is read");
}

#[test]
fn wrong_json_says_where() {
    let flaw = read(b"{\n  \"asset\": {\"version\": 2}\n}").unwrap_err();
    assert_eq!(flaw.place, Place::Column(2, 24));
    assert!(flaw.message.starts_with("not the JSON of a glTF file: invalid type"), "{flaw}");
    for text in ["", "{", "[]", "{\"asset\": {}}", "null", "{\"asset\": {\"version\": \"2.0\"}, \"nodes\": 3}"] {
        assert!(read(text.as_bytes()).unwrap_err().message.starts_with("not the JSON"), "{text}");
    }
    let deep = "[".repeat(100_000);
    assert!(read(format!("{{\"extras\": {deep}").as_bytes()).is_err());
}

#[test]
fn damaged_binary_containers_are_refused() {
    let bytes = triangle(json!({})).binary();
    for length in 0..bytes.len() {
        assert!(read(&bytes[..length]).is_err(), "{length}");
    }
    let with = |at: usize, value: u32| {
        let mut bytes = bytes.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        read(&bytes).unwrap_err().message
    };
    assert_eq!(with(4, 1), "a binary container of the version 1; 2 is read");
    assert_eq!(with(8, 0), "the binary file has no JSON");
    assert!(with(8, u32::MAX).starts_with("the header claims 4294967295 bytes"));
    assert_eq!(with(12, u32::MAX), "a chunk reaches beyond the end");
    assert_eq!(with(16, 7), "the binary file has no JSON");
}

#[test]
fn files_outside_of_the_folder_are_refused() {
    let outer = tempfile::tempdir().unwrap();
    let folder = outer.path().join("scene");
    std::fs::create_dir(&folder).unwrap();
    std::fs::write(outer.path().join("a.bin"), [0; 100]).unwrap();
    std::fs::write(folder.join("b c.bin"), [0; 100]).unwrap();
    let mut file = triangle(json!({}));
    let path = folder.join("s.gltf");
    let mut naming = |uri: &str, outside_folder: bool| {
        file.json["buffers"] = json!([{"byteLength": 100, "uri": uri}]);
        std::fs::write(&path, serde_json::to_vec(&file.json).unwrap()).unwrap();
        load_with(path.to_str().unwrap(), LoadOptions { outside_folder, ..LoadOptions::default() })
    };
    naming("b%20c.bin", false).unwrap();
    let outside = naming("../a.bin", false).unwrap_err().to_string();
    assert!(outside.contains("the file `../a.bin` lies outside of the scene's folder, which is refused"), "{outside}");
    assert!(outside.contains("s.gltf: buffers[0]: "), "{outside}");
    naming("../a.bin", true).unwrap();
    assert!(naming("none.bin", false).unwrap_err().to_string().contains("cannot read the file `none.bin`"));
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(outer.path().join("a.bin"), folder.join("link.bin")).unwrap();
        assert!(naming("link.bin", false).unwrap_err().to_string().contains("lies outside"));
    }
}

#[test]
fn images_that_claim_too_much_are_refused() {
    let mut file = triangle(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    let mut png = super::png(2, &[[0; 4], [255; 4]]);
    // The size stands behind the signature and the chunk's header, whose checksum stands behind it.
    png[16..20].copy_from_slice(&40_000u32.to_be_bytes());
    png[20..24].copy_from_slice(&40_000u32.to_be_bytes());
    let checksum = crc(&png[12..29]);
    png[29..33].copy_from_slice(&checksum.to_be_bytes());
    let view = file.view(&png);
    file.json["images"] = json!([{"bufferView": view}]);
    file.json["textures"] = json!([{"source": 0}]);
    assert!(file.flaw().starts_with("images[0]: the header claims 40000 x 40000 texels"), "{}", file.flaw());
}

/// [ISO 3309], as PNG has it.
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| if crc & 1 == 1 { 0xEDB8_8320 ^ (crc >> 1) } else { crc >> 1 })
    })
}
