//! Materials and their textures.

use super::{F32, File, mesh, triangle};
use etendue_core::{
    material::{Material, Principled, Relief},
    rgb::Rgb,
    scene::{NamedMaterial, Object},
    texture::{Interpolation, Texture, TexturePoint, Wrap},
};
use glam::Vec2;
use image::{DynamicImage, ImageBuffer, ImageFormat, Luma, LumaA, Rgb as Pixel};
use serde_json::{Value, json};

/// The material of the only triangle, its object, and the notes.
fn read(file: &File) -> (NamedMaterial, Object, Vec<String>) {
    let scene = file.scene();
    let object = scene.description.objects[0].clone();
    (scene.description.materials[object.material].clone(), object, scene.notes)
}

fn material(json: Value) -> Material {
    read(&triangle(json)).0.material
}

fn principled(material: Material) -> Principled {
    match material {
        Material::Principled(p) => *p,
        other => panic!("{other:?}"),
    }
}

/// At the middle of a texel of a row, counted as in the image.
fn at<T: etendue_core::texture::Texel>(texture: &Texture<T>, u: f32) -> T {
    texture.at(&TexturePoint { uv: Vec2::new(u, 0.5), color: Rgb::WHITE })
}

fn srgb(byte: u8) -> f32 {
    let v = f64::from(f32::from(byte) / 255.0);
    (if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }) as f32
}

#[test]
fn factors_alone_are_constants() {
    let p = principled(material(json!({})));
    let defaults = (p.base_color, p.metallic, p.roughness, p.spec_trans, p.eta, p.clearcoat, p.sheen);
    assert_eq!(defaults, (Rgb::WHITE.into(), 1.0.into(), 1.0.into(), 0.0.into(), 1.5, 0.0.into(), 0.0.into()));
    let (named, object, _) = read(&triangle(json!({
        "name": "paint", "doubleSided": true, "extensions": {"KHR_materials_ior": {"ior": 1.25}},
        "pbrMetallicRoughness": {"baseColorFactor": [0.25, 0.5, 0.75, 0.1], "metallicFactor": 0.125, "roughnessFactor": 0.5}
    })));
    assert_eq!((named.name.as_str(), named.two_sided), ("paint", true));
    let p = principled(named.material);
    assert_eq!((p.base_color, p.metallic), (Rgb::new(0.25, 0.5, 0.75).into(), 0.125.into()));
    assert_eq!((p.roughness, p.eta), (0.5.into(), 1.25));
    assert!(object.emission.is_none() && object.absorption.is_none());
}

#[test]
fn a_primitive_without_a_material_has_the_default() {
    let mut file = triangle(json!({"name": "not used"}));
    file.json["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("material");
    let (named, ..) = read(&file);
    assert_eq!((named.name.as_str(), named.two_sided), ("default", false));
    assert_eq!(file.scene().description.materials.len(), 1);
}

#[test]
fn textures_are_multiplied_by_their_factors() {
    let mut file = triangle(json!({"pbrMetallicRoughness": {
        "baseColorFactor": [1, 0.5, 0.25, 1], "baseColorTexture": {"index": 0},
        "metallicFactor": 0.5, "roughnessFactor": 0.25, "metallicRoughnessTexture": {"index": 1},
    }}));
    file.texture(2, &[[255, 128, 10, 255], [0, 255, 255, 0]]);
    file.texture(2, &[[7, 51, 255, 0], [9, 255, 102, 0]]);
    let p = principled(read(&file).0.material);
    let near = |a: f32, b: f32| (a - b).abs() < 1e-6;
    let [left, right] = [0.25, 0.75].map(|u| at(&p.base_color, u));
    assert!(near(left.r, 1.0) && near(left.g, 0.5 * srgb(128)) && near(left.b, 0.25 * srgb(10)), "{left:?}");
    assert_eq!(right, Rgb::new(0.0, 0.5, 0.25));
    assert!(near(at(&p.roughness, 0.25), 0.05) && near(at(&p.roughness, 0.75), 0.25));
    assert!(near(at(&p.metallic, 0.25), 0.5) && near(at(&p.metallic, 0.75), 0.2));
}

#[test]
fn images_of_every_depth_and_format_are_read() {
    let mut file = triangle(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    let texel = |file: &File| at(&principled(read(file).0.material).base_color, 0.25);
    let mut encode = |image: DynamicImage, format: ImageFormat| {
        let mut out = std::io::Cursor::new(Vec::new());
        image.write_to(&mut out, format).unwrap();
        let view = file.view(&out.into_inner());
        file.json["images"] = json!([{"bufferView": view}]);
        file.json["textures"] = json!([{"source": 0}]);
        texel(&file)
    };
    let gray =
        encode(DynamicImage::ImageLuma8(ImageBuffer::from_fn(2, 1, |x, _| Luma([100 + x as u8]))), ImageFormat::Png);
    assert_eq!(gray, Rgb::splat(srgb(100)));
    let deep = ImageBuffer::from_fn(2, 1, |x, _| Pixel([x as u16 * 9, 257 * 100, 65535]));
    let deep = encode(DynamicImage::ImageRgb16(deep), ImageFormat::Png);
    assert!((deep.g - srgb(100)).abs() < 1e-6 && (deep.r, deep.b) == (0.0, 1.0), "{deep:?}");
    let alpha = ImageBuffer::from_fn(2, 1, |x, _| LumaA([50 + x as u8, 3]));
    assert_eq!(encode(DynamicImage::ImageLumaA8(alpha), ImageFormat::Png), Rgb::splat(srgb(50)));
    let jpeg = ImageBuffer::from_fn(16, 8, |x, _| Pixel([if x < 8 { 200 } else { 20 }; 3]));
    let jpeg = encode(DynamicImage::ImageRgb8(jpeg), ImageFormat::Jpeg);
    assert!((jpeg.g / srgb(200) - 1.0).abs() < 0.05, "{jpeg:?}");
}

#[test]
fn an_image_of_one_value_is_a_constant() {
    let mut file = triangle(json!({"alphaMode": "BLEND", "pbrMetallicRoughness": {
        "baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 0},
    }}));
    file.texture(2, &[[255, 51, 102, 255], [255, 51, 102, 255]]);
    let p = principled(read(&file).0.material);
    assert_eq!(p.base_color, Rgb::new(1.0, srgb(51), srgb(102)).into());
    assert_eq!((p.roughness, p.metallic), (0.2.into(), 0.4.into()));
}

#[test]
fn samplers_and_transforms_are_kept() {
    let transform = json!({"offset": [0.25, 0.5], "scale": [2, 4], "rotation": std::f64::consts::FRAC_PI_2});
    let mut file = triangle(json!({"pbrMetallicRoughness": {
        "baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": transform}},
    }}));
    file.texture(2, &[[0; 4], [255; 4]]);
    file.json["textures"][0]["sampler"] = json!(0);
    file.json["samplers"] = json!([{"magFilter": 9728, "wrapS": 33071, "wrapT": 33071}]);
    let (named, _, notes) = read(&file);
    let Texture::Bitmap { interpolation, wrap, to_uv, .. } = principled(named.material).base_color else { panic!() };
    assert_eq!((interpolation, wrap), (Interpolation::Nearest, Wrap::Clamp));
    // In the file's coordinates (u, v) goes to (0.25 + 4 v, 0.5 - 2 u); here v is turned round before and after.
    for (u, v) in [(0.0, 0.0), (0.3, 0.1), (0.9, 0.7)] {
        let expected = Vec2::new(0.25 + 4.0 * (1.0 - v), 1.0 - (0.5 - 2.0 * u));
        assert!((to_uv.transform_point2(Vec2::new(u, v)) - expected).length() < 1e-5);
    }
    assert_eq!(notes.len(), 2, "{notes:?}");

    file.json["samplers"] = json!([{"wrapS": 33648, "wrapT": 10497}]);
    let (named, _, notes) = read(&file);
    let Texture::Bitmap { interpolation, wrap, .. } = principled(named.material).base_color else { panic!() };
    assert_eq!((interpolation, wrap), (Interpolation::Bilinear, Wrap::Mirror));
    assert!(notes[0].contains("wraps its directions differently"));
}

#[test]
fn normal_maps_are_scaled_and_stand_outermost() {
    let transform = json!({"KHR_texture_transform": {"scale": [3, 3]}});
    let mut file = triangle(json!({
        "alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]},
        "normalTexture": {"index": 0, "scale": 2, "extensions": transform},
    }));
    file.texture(2, &[[255, 128, 255, 255], [0, 128, 255, 255]]);
    let Material::Relief { relief: Relief::NormalMap { normals, .. }, material } = read(&file).0.material else {
        panic!()
    };
    // x = 1, z = 1 before; x = 2 after: (2, 0, 1) / sqrt 5.
    let n = match &normals {
        Texture::Bitmap { bitmap, to_uv, .. } => {
            assert_eq!(to_uv.matrix2.x_axis.x, 3.0);
            bitmap.values()[0]
        }
        _ => panic!(),
    };
    let expected = [0.5 + 1.0 / 5f32.sqrt(), 0.5, 0.5 + 0.5 / 5f32.sqrt()];
    for (n, e) in n.to_array().iter().zip(expected) {
        assert!((n - e).abs() < 5e-3, "{n} {e}");
    }
    assert!(matches!(*material, Material::Mask { opacity: Texture::Constant(0.5), .. }));
}

#[test]
fn alpha_makes_holes() {
    let mut file = triangle(json!({
        "alphaMode": "MASK", "alphaCutoff": 0.25,
        "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5], "baseColorTexture": {"index": 0}}
    }));
    file.texture(3, &[[9, 9, 9, 128], [9, 9, 9, 127], [9, 9, 9, 255]]);
    let opacity = |file: &File| match read(file).0.material {
        Material::Mask { opacity, .. } => opacity,
        other => panic!("{other:?}"),
    };
    assert_eq!(opacity(&file).values(), [1.0, 0.0, 1.0]);
    file.json["materials"][0]["alphaMode"] = json!("BLEND");
    let blended = opacity(&file).values();
    assert_eq!(blended, [128.0, 127.0, 255.0].map(|a: f32| a / 255.0 * 0.5));
    file.json["materials"][0]["alphaMode"] = json!("OPAQUE");
    assert!(matches!(read(&file).0.material, Material::Principled(_)));
    // Without a texture.
    let constant = |cutoff: f64| json!({"alphaMode": "MASK", "alphaCutoff": cutoff, "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}});
    assert!(matches!(material(constant(0.5)), Material::Principled(_)));
    assert!(matches!(material(constant(0.6)), Material::Mask { opacity: Texture::Constant(0.0), .. }));
}

#[test]
fn emission_is_the_product_of_all_that_says_it() {
    let json = json!({
        "emissiveFactor": [0.5, 1, 0], "emissiveTexture": {"index": 0}, "doubleSided": true, "name": "lamp",
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 10}}
    });
    let mut file = triangle(json.clone());
    file.texture(2, &[[255, 51, 255, 0], [0, 0, 0, 0]]);
    let (_, object, notes) = read(&file);
    let emission = object.emission.unwrap();
    let left = at(&emission, 0.25);
    assert!((left.r - 5.0).abs() < 1e-6 && (left.g - 10.0 * srgb(51)).abs() < 1e-6 && left.b == 0.0, "{left:?}");
    assert_eq!(at(&emission, 0.75), Rgb::BLACK);
    assert!(notes.contains(&"the material `lamp` is double-sided, but emits from its front only".to_owned()));
    // A black one emits nothing.
    let mut file = triangle(json);
    file.texture(1, &[[0, 0, 0, 255]]);
    assert!(read(&file).1.emission.is_none());
    assert!(file.scene().description.environment.is_some());
}

#[test]
fn transmission_is_thin_without_a_thickness() {
    let extensions = |volume: Value| {
        json!({
            "KHR_materials_transmission": {"transmissionFactor": 0.75}, "KHR_materials_ior": {"ior": 1.3},
            "KHR_materials_volume": volume,
        })
    };
    let glass = |volume: Value| {
        read(&triangle(json!({"extensions": extensions(volume), "pbrMetallicRoughness": {"metallicFactor": 0}})))
    };
    let (named, object, _) = glass(json!({}));
    let Material::PrincipledThin(p) = named.material else { panic!() };
    assert_eq!((p.spec_trans, p.eta, p.diff_trans), (0.75.into(), 1.3, 0.0.into()));
    assert!(object.absorption.is_none());

    let thick = json!({"thicknessFactor": 0.1, "attenuationDistance": 0.5, "attenuationColor": [0.25, 1, 0.5]});
    let (named, object, _) = glass(thick);
    let p = principled(named.material);
    assert_eq!((p.spec_trans, p.eta), (0.75.into(), 1.3));
    // What is left after half a metre is the colour.
    let left = object.absorption.unwrap().map(|a| (-0.5 * a).exp());
    for (left, expected) in left.to_array().iter().zip([0.25, 1.0, 0.5]) {
        assert!((left - expected).abs() < 1e-6, "{left}");
    }
    let (_, object, _) = glass(json!({"thicknessFactor": 0.1}));
    assert!(object.absorption.is_none());
}

#[test]
fn coats_and_sheens_are_approximated() {
    let (named, _, notes) = read(&triangle(json!({"extensions": {
        "KHR_materials_clearcoat": {"clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.1, "clearcoatTexture": {"index": 0}},
        "KHR_materials_sheen": {"sheenColorFactor": [0.1, 0.3, 0.2]},
    }})));
    let p = principled(named.material);
    assert_eq!((p.clearcoat, p.sheen), (0.5.into(), 0.3.into()));
    let Texture::Constant(gloss) = p.clearcoat_gloss else { panic!() };
    assert!((0.1 + (0.001 - 0.1) * gloss - 0.01).abs() < 1e-6, "{gloss}");
    assert_eq!(notes.iter().filter(|n| n.contains("materials[0]")).count(), 3, "{notes:?}");
}

#[test]
fn vertex_colours_are_taken_without_a_texture() {
    let mut file = triangle(json!({"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1]}}));
    let colours = file.floats(&[[1.0, 0.5, 0.0, 0.3], [0.0, 2.0, 1.0, 1.0], [1.0; 4]]);
    file.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(colours);
    let (named, object, _) = read(&file);
    assert_eq!(principled(named.material).base_color, Texture::VertexColor);
    let expected = [Rgb::new(0.5, 0.5, 0.0), Rgb::new(0.0, 1.0, 1.0), Rgb::new(0.5, 1.0, 1.0)];
    assert_eq!(mesh(&object).colors, expected);
    // White ones cost nothing.
    let white = file.floats(&[[1.0f32; 3]; 3]);
    file.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(white);
    let (named, object, _) = read(&file);
    assert_eq!(principled(named.material).base_color, Rgb::new(0.5, 1.0, 1.0).into());
    assert!(mesh(&object).colors.is_empty());
    // With a texture they are left out.
    file.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(colours);
    file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0});
    file.texture(2, &[[0; 4], [255; 4]]);
    let (_, object, notes) = read(&file);
    assert!(mesh(&object).colors.is_empty() && notes[0].contains("vertex colours are left out"), "{notes:?}");
}

#[test]
fn a_texture_of_another_set_is_left_out() {
    let mut file = triangle(json!({
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
        "normalTexture": {"index": 0, "texCoord": 1},
    }));
    file.texture(2, &[[0; 4], [255; 4]]);
    let (named, _, notes) = read(&file);
    assert!(matches!(named.material, Material::Principled(_)));
    assert!(notes[0].contains("several sets of coordinates"), "{notes:?}");
}

#[test]
fn a_texture_without_an_image_is_left_out() {
    let mut file = triangle(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    file.json["textures"] = json!([{"extensions": {"KHR_texture_basisu": {"source": 0}}}]);
    let (named, object, notes) = read(&file);
    assert_eq!(principled(named.material).base_color, Rgb::WHITE.into());
    assert!(mesh(&object).uvs.is_empty() && notes[0].contains("no image in PNG or JPEG"), "{notes:?}");
}

#[test]
fn what_no_material_may_have_is_refused() {
    let flaw = |json: Value| triangle(json).flaw();
    assert!(flaw(json!({"emissiveFactor": [-1, 0, 0]})).contains("negative or not finite"));
    assert!(flaw(json!({"alphaMode": "GLASS"})).contains("none of those that are known"));
    assert!(flaw(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 3}}})).contains("textures[3]"));
    let mut file = triangle(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    file.json["textures"] = json!([{"source": 0}]);
    assert_eq!(file.flaw(), "images[0] is asked for, and there are 0");
    let view = file.view(b"neither");
    file.json["images"] = json!([{"bufferView": view}]);
    assert_eq!(file.flaw(), "images[0]: it is neither a PNG nor a JPEG");
    let positions = json!({"bufferView": 0, "componentType": F32, "type": "VEC3", "count": 3});
    file.json["accessors"][1] = positions;
    file.json["images"] =
        json!([{"uri": format!("data:image/png;base64,{}", super::base64(&super::png(2, &[[0; 4], [9; 4]])))}]);
    assert!(file.flaw().contains("of 3 numbers each"), "{}", file.flaw());
}
