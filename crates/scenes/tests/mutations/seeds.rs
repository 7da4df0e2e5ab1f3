//! Sound inputs that mutations start from.

use crate::{
    build::{File, triangle},
    serialized_writer::{LAYOUTS, file},
};
use etendue_core::geometry::Mesh;
use glam::{Vec2, Vec3};
use serde_json::json;

/// The parsers, each with its seeds.
pub(crate) fn all() -> Vec<(&'static str, Vec<Vec<u8>>)> {
    vec![
        ("ply", ply()),
        ("obj", obj()),
        ("serialized", serialized()),
        ("gltf", gltf()),
        ("exr", exr()),
        ("hdr", hdr()),
        ("xml", xml()),
    ]
}

pub(crate) fn ply() -> Vec<Vec<u8>> {
    let ascii = "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                 property float nx\nproperty float ny\nproperty float nz\nproperty double u\nproperty double v\n\
                 property uchar red\nelement face 2\nproperty list uchar int vertex_indices\nelement edge 1\n\
                 property list ushort short more\nend_header\n0 0 0 0 0 1 0 0 255\n1 0 0 0 0 1 1 0 1\n1 1 .5 0 0 1 1 1 2\n\
                 0 1 0 0 0 1 0 1e0 3\n4 0 1 2 3\n3 0 2 3\n2 7 -8\n";
    let binary = |big: bool| {
        let order = if big { "big" } else { "little" };
        let mut out = format!(
            "ply\nformat binary_{order}_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             property short s\nproperty char t\nelement face 2\nproperty list uint uint vertex_index\nproperty uchar f\nend_header\n"
        )
        .into_bytes();
        let mut push = |bytes: &[u8]| match big {
            true => out.extend(bytes.iter().rev()),
            false => out.extend(bytes),
        };
        for i in 0..3u16 {
            for c in [0.0, f32::from(i), 2.5] {
                push(&c.to_le_bytes());
            }
            push(&i.to_le_bytes());
            push(&[1]);
        }
        for corners in [&[0u32, 1, 2][..], &[2, 1, 0, 0]] {
            push(&(corners.len() as u32).to_le_bytes());
            corners.iter().for_each(|c| push(&c.to_le_bytes()));
            push(&[9]);
        }
        out
    };
    vec![ascii.into(), binary(false), binary(true)]
}

pub(crate) fn obj() -> Vec<Vec<u8>> {
    vec![
        b"# a quad\nmtllib a.mtl\no thing\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0 .1 .2 .3\nv 0 1 -2e-1\nvt 0 0\nvt 1 0 0\nvt .5\n\
          vn 0 0 1\nvn 0 1 0\ng a\nusemtl b\ns off\nf 1/1/1 2/2/1 3/3/2 4/1/2\nf -4 -3 -2\nf 1//1 2//2 3//1\nf 1/1 2/2 3/3\n"
            .to_vec(),
        b"v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n".to_vec(),
    ]
}

fn pyramid() -> Mesh {
    let positions = [[0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [1.0, 2.25, 0.0], [0.5, 0.5, 3.0]].map(Vec3::from);
    Mesh {
        positions: positions.to_vec(),
        normals: vec![Vec3::Y; 4],
        uvs: vec![Vec2::X; 4],
        triangles: vec![[0, 1, 3], [1, 2, 3]],
        ..Mesh::default()
    }
}

pub(crate) fn serialized() -> Vec<Vec<u8>> {
    let bare = Mesh { normals: Vec::new(), uvs: Vec::new(), ..pyramid() };
    LAYOUTS.iter().map(|layout| file(&[pyramid(), bare.clone()], *layout)).collect()
}

pub(crate) fn gltf() -> Vec<Vec<u8>> {
    let mut textured = triangle(json!({
        "name": "m", "alphaMode": "MASK", "alphaCutoff": 0.5, "doubleSided": true, "emissiveFactor": [1, 0.5, 0],
        "pbrMetallicRoughness": {
            "baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.5, 1], "rotation": 1}}},
            "metallicRoughnessTexture": {"index": 0}, "baseColorFactor": [1, 1, 0.5, 0.9], "roughnessFactor": 0.5
        },
        "normalTexture": {"index": 0, "scale": 0.5},
        "emissiveTexture": {"index": 0},
        "extensions": {
            "KHR_materials_emissive_strength": {"emissiveStrength": 2}, "KHR_materials_ior": {"ior": 1.3},
            "KHR_materials_transmission": {"transmissionFactor": 0.5}, "KHR_materials_unlit": {},
            "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [0.5, 1, 0]},
            "KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.1},
            "KHR_materials_sheen": {"sheenColorFactor": [0.1, 0.2, 0.3]}
        }
    }));
    textured.texture(2, &[[255, 0, 9, 255], [0, 70, 255, 0]]);
    textured.json["textures"][0]["sampler"] = json!(0);
    textured.json["samplers"] = json!([{"magFilter": 9728, "wrapS": 33071, "wrapT": 10497}]);

    let mut placed = File::new();
    let positions = placed.floats(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 1.0]]);
    let normals = placed.floats(&[[0.0f32, 0.0, 1.0]; 4]);
    let colours = placed.floats(&[[1.0, 0.5, 0.25, 1.0], [0.0; 4], [1.0; 4], [0.5; 4]]);
    let indices = placed.accessor(&[0, 0, 1, 0, 2, 0, 3, 0], crate::build::U16, "SCALAR", 4);
    let sparse = placed.view(&[1]);
    let values = placed.view(&[0; 12]);
    placed.json["accessors"][positions]["sparse"] = json!({
        "count": 1, "indices": {"bufferView": sparse, "componentType": crate::build::U8}, "values": {"bufferView": values}
    });
    let attributes = json!({"POSITION": positions, "NORMAL": normals, "COLOR_0": colours});
    let mesh = placed.push("meshes", json!({"name": "mesh", "primitives": [
        {"attributes": attributes, "indices": indices, "mode": 5}, {"attributes": attributes, "mode": 6}, {"attributes": attributes}
    ]}));
    placed.node(json!({"mesh": mesh, "translation": [1, 2, 3], "rotation": [0, 0.6, 0, 0.8], "scale": [1, -2, 3]}));
    let child = placed.push("nodes", json!({"mesh": mesh, "name": "child"}));
    let matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1];
    placed.node(json!({"matrix": matrix, "children": [child]}));
    placed.node(json!({"camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}}));
    placed.node(json!({"camera": 1, "extensions": {"KHR_lights_punctual": {"light": 1}}}));
    placed.json["cameras"] = json!([
        {"type": "perspective", "perspective": {"yfov": 0.8, "aspectRatio": 1.5, "znear": 0.1, "zfar": 100}},
        {"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 1, "znear": 0, "zfar": 10}}
    ]);
    placed.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "color": [1, 0.5, 0], "intensity": 5, "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.4}},
        {"type": "directional", "name": "sun"}
    ]}});
    placed.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    vec![textured.text(), textured.binary(), placed.text(), placed.binary()]
}

pub(crate) fn exr() -> Vec<Vec<u8>> {
    use exr::prelude::{Compression, Encoding, Image, Layer, LayerAttributes, SpecificChannels, WritableImage};
    let write = |compression: Compression| {
        let channels = SpecificChannels::rgb(|at: exr::math::Vec2<usize>| (at.x() as f32, at.y() as f32, 0.5f32));
        let encoding = Encoding { compression, ..Encoding::SMALL_LOSSLESS };
        let layer = Layer::new((9, 7), LayerAttributes::default(), encoding, channels);
        let mut out = std::io::Cursor::new(Vec::new());
        Image::from_layer(layer).write().non_parallel().to_buffered(&mut out).expect("it cannot be written");
        out.into_inner()
    };
    use Compression::{PIZ, PXR24, RLE, Uncompressed, ZIP1, ZIP16};
    [Uncompressed, RLE, ZIP1, ZIP16, PIZ, PXR24].map(write).to_vec()
}

pub(crate) fn hdr() -> Vec<Vec<u8>> {
    let head =
        |width: usize| format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=1.5\n\n-Y 4 +X {width}\n").into_bytes();
    let mut flat = head(3);
    flat.extend((0..4 * 3 * 4).map(|i| (i * 37) as u8));
    let mut packed = head(9);
    for row in 0..4u8 {
        packed.extend([2, 2, 0, 9]);
        for channel in 0..4 {
            // A run of five and four as they are.
            packed.extend([128 + 5, 120 + channel, 4, row, 2, 3, channel]);
        }
    }
    vec![flat, packed]
}

/// Files that scenes in XML may name.
pub(crate) fn beside_xml() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("m.ply", ply().swap_remove(0)),
        ("m.obj", obj().swap_remove(0)),
        ("m.serialized", serialized().swap_remove(2)),
        ("e.exr", exr().swap_remove(3)),
        ("e.hdr", hdr().swap_remove(1)),
        ("t.png", crate::build::png(2, &[[255, 0, 9, 255], [0, 70, 255, 0]])),
        ("i.xml", b"<scene version=\"3.0.0\"><bsdf type=\"diffuse\" id=\"i\"/></scene>".to_vec()),
    ]
}

pub(crate) fn xml() -> Vec<Vec<u8>> {
    let head = "<scene version=\"3.0.0\">\n<default name=\"spp\" value=\"4\"/>\n<integrator type=\"path\"><integer \
                name=\"max_depth\" value=\"3\"/></integrator>\n<sensor type=\"perspective\"><float name=\"fov\" \
                value=\"30\"/><string name=\"fov_axis\" value=\"y\"/><transform name=\"to_world\"><lookat \
                origin=\"0 0 4\" target=\"0 0 0\" up=\"0 1 0\"/></transform><film type=\"hdrfilm\"><integer \
                name=\"width\" value=\"64\"/><rfilter type=\"gaussian\"/></film><sampler type=\"independent\"><integer \
                name=\"sample_count\" value=\"$spp\"/></sampler></sensor>\n";
    let bodies = [
        "<bsdf type=\"twosided\" id=\"a\"><bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\".1 .2 .3\"/></bsdf>\
         </bsdf>\n<shape type=\"cube\"><ref id=\"a\"/><transform name=\"to_world\"><scale value=\"2\"/><rotate y=\"1\" \
         angle=\"30\"/><translate x=\"1\" y=\"-2\"/><matrix value=\"1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\"/></transform></shape>\n\
         <emitter type=\"constant\"/>\n",
        "<bsdf type=\"blendbsdf\" id=\"b\"><float name=\"weight\" value=\".3\"/><bsdf type=\"roughconductor\"><float \
         name=\"alpha\" value=\".2\"/><string name=\"distribution\" value=\"ggx\"/></bsdf><bsdf type=\"dielectric\"><float \
         name=\"int_ior\" value=\"1.5\"/></bsdf></bsdf><shape type=\"ply\"><string name=\"filename\" \
         value=\"m.ply\"/><ref id=\"b\"/></shape><shape type=\"obj\" id=\"o\"><string name=\"filename\" \
         value=\"m.obj\"/><emitter type=\"area\"><rgb name=\"radiance\" value=\"1,2,3\"/></emitter></shape><shape \
         type=\"sphere\"><point name=\"center\" x=\"1\" y=\"2\" z=\"3\"/><float name=\"radius\" value=\"2\"/><boolean \
         name=\"flip_normals\" value=\"true\"/></shape><emitter type=\"envmap\"><string name=\"filename\" \
         value=\"e.exr\"/><float name=\"scale\" value=\"2\"/></emitter><emitter type=\"spot\"><float \
         name=\"cutoff_angle\" value=\"25\"/></emitter><emitter type=\"point\"><point name=\"position\" value=\"1 2 \
         3\"/></emitter><emitter type=\"directional\"/>\n",
        "<shape type=\"serialized\"><string name=\"filename\" value=\"m.serialized\"/><integer name=\"shape_index\" \
         value=\"1\"/><bsdf type=\"roughplastic\"><texture type=\"bitmap\" name=\"diffuse_reflectance\"><string \
         name=\"filename\" value=\"t.png\"/><transform name=\"to_uv\"><scale x=\"2\" y=\"3\"/></transform></texture><string \
         name=\"distribution\" value=\"beckmann\"/></bsdf></shape><shape type=\"cylinder\"><point name=\"p0\" value=\"0 0 \
         0\"/><point name=\"p1\" value=\"0 0 2\"/></shape>\n",
        "<include filename=\"i.xml\"/><path value=\".\"/><shape type=\"shapegroup\" id=\"g\"><shape \
         type=\"rectangle\"><ref id=\"i\"/></shape></shape><shape type=\"instance\"><ref id=\"g\"/><transform \
         name=\"toWorld\"><translate value=\"1,2,3\"/></transform></shape><shape type=\"disk\"><bsdf \
         type=\"bumpmap\"><texture type=\"checkerboard\"><float \
         name=\"color0\" value=\".2\"/></texture><bsdf \
         type=\"mask\"><float name=\"opacity\" value=\".5\"/><bsdf type=\"principled\"><rgb \
         name=\"base_color\" value=\"#ff8000\"/><float name=\"metallic\" \
         value=\".5\"/></bsdf></bsdf></bsdf></shape>\n",
        "<shape type=\"sphere\"><bsdf type=\"conductor\"><string name=\"material\" value=\"Cu\"/></bsdf>\
         </shape><shape type=\"sphere\"><bsdf type=\"conductor\"><spectrum name=\"eta\" value=\"400:1.2,700:1.5\"/><spectrum \
         name=\"k\" value=\"3\"/></bsdf></shape>\n",
    ];
    bodies.iter().map(|body| format!("{head}{body}</scene>\n").into_bytes()).collect()
}
