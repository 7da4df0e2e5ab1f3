//! BSDFs of every kind and how they nest.

use crate::files::{Folder, LENIENT, described, flaw, material};
use etendue_core::{
    bsdf::{ConductorFresnel, Distribution},
    material::{Bitangent, Material, Principled, PrincipledThin, Relief, RoughnessTexture},
    rgb::Rgb,
    texture::{Texel, Texture},
};
use glam::Affine2;

const BOARD: &str = "<texture name=\"NAME\" type=\"checkerboard\"/>";

/// In a checkerboard of numbers Mitsuba 3.9.1 has the two exchanged (`eval_1` of a `checkerboard`, against `eval`).
fn board<T: Texel>(even: T, odd: T) -> Texture<T> {
    Texture::Checkerboard { even, odd, to_uv: Affine2::IDENTITY }
}

fn white() -> Texture<Rgb> {
    Rgb::WHITE.into()
}

#[test]
fn coats_and_sheets_have_mitsubas_defaults() {
    let coat = (1.49 / 1.000277) as f32;
    let glass = (1.5046 / 1.000277) as f32;
    let plastic = |roughness, nonlinear| Material::Plastic {
        eta: coat,
        diffuse: Rgb::splat(0.5).into(),
        specular: white(),
        nonlinear,
        roughness,
    };
    for (bsdf, expected) in [
        ("<bsdf type=\"plastic\"/>", plastic(None, false)),
        ("<bsdf type=\"roughplastic\"/>", plastic(Some((Distribution::Beckmann, 0.1)), false)),
        (
            "<bsdf type=\"roughplastic\"><string name=\"distribution\" value=\"ggx\"/><float name=\"alpha\" value=\".3\"/>\
             <boolean name=\"nonlinear\" value=\"true\"/></bsdf>",
            plastic(Some((Distribution::Ggx, 0.3)), true),
        ),
        (
            "<bsdf type=\"thindielectric\"/>",
            Material::ThinDielectric { eta: glass, reflectance: white(), transmittance: white() },
        ),
        (
            "<bsdf type=\"dielectric\"><float name=\"specular_reflectance\" value=\".5\"/></bsdf>",
            Material::Dielectric {
                eta: glass,
                reflectance: Rgb::splat(0.5).into(),
                transmittance: white(),
                roughness: None,
            },
        ),
        ("<bsdf type=\"null\"/>", Material::dielectric(1.0, None)),
    ] {
        assert_eq!(material(bsdf), (expected, false), "{bsdf}");
    }
}

#[test]
fn principled_materials_have_mitsubas_defaults() {
    let (Material::Principled(p), _) = material("<bsdf type=\"principled\"/>") else { panic!() };
    let zero = || Texture::Constant(0.0);
    // (1 + sqrt(.04)) / (1 - sqrt(.04)).
    assert!((p.eta - 1.5).abs() < 1e-6);
    let expected = Principled {
        base_color: Rgb::splat(0.5).into(),
        roughness: 0.5.into(),
        anisotropic: zero(),
        metallic: zero(),
        spec_trans: zero(),
        eta: p.eta,
        spec_tint: zero(),
        sheen: zero(),
        sheen_tint: zero(),
        flatness: zero(),
        clearcoat: zero(),
        clearcoat_gloss: zero(),
    };
    assert_eq!(*p, expected);
    let thin = format!(
        "<bsdf type=\"principledthin\">{}<float name=\"eta\" value=\"1.33\"/><float name=\"diff_trans\" value=\"1.4\"/></bsdf>",
        BOARD.replace("NAME", "sheen")
    );
    let (Material::PrincipledThin(p), _) = material(&thin) else { panic!() };
    let expected = PrincipledThin {
        base_color: Rgb::splat(0.5).into(),
        roughness: 0.5.into(),
        anisotropic: zero(),
        spec_trans: zero(),
        eta: 1.33,
        spec_tint: zero(),
        sheen: board(0.2, 0.4),
        sheen_tint: zero(),
        flatness: zero(),
        diff_trans: 1.4.into(),
    };
    assert_eq!(*p, expected);
}

#[test]
fn conductors_go_by_name_or_by_spectra() {
    let fresnel = |inner: &str| match material(&format!("<bsdf type=\"conductor\">{inner}</bsdf>")).0 {
        Material::Conductor { fresnel, .. } => fresnel,
        other => panic!("{other:?}"),
    };
    let complex = |eta, k| ConductorFresnel::Complex { eta, k, tint: Rgb::WHITE };
    // Mitsuba 3.9.1, scalar_rgb, `traverse` of a conductor.
    let copper = complex(Rgb::new(0.201005, 0.92375, 1.10222), Rgb::new(3.91326, 2.45305, 2.14209));
    assert_eq!(fresnel("<string name=\"material\" value=\"Cu\"/>"), copper);
    let grey = "<spectrum name=\"eta\" value=\"0.789\"/><spectrum name=\"k\" value=\"6.15\"/>";
    assert_eq!(fresnel(grey), complex(Rgb::splat(0.789), Rgb::splat(6.15)));
    let immersed = format!("{grey}<string name=\"extEta\" value=\"water\"/>");
    assert_eq!(fresnel(&immersed), complex(Rgb::splat(0.789) / 1.333, Rgb::splat(6.15) / 1.333));
    let message = flaw("<bsdf type=\"conductor\"><string name=\"material\" value=\"cu\"/></bsdf>");
    assert!(
        message.starts_with("scene.xml:2:55: the conductor `cu` is not known (did you mean `Cu`?); give `eta` and `k`")
    );
}

#[test]
fn parameters_may_be_textures() {
    let texture = |name: &str| BOARD.replace("NAME", name);
    let metal = format!("<bsdf type=\"roughconductor\">{}{}</bsdf>", texture("alphaU"), texture("alpha_v"));
    let (Material::Conductor { roughness: Some(roughness), .. }, _) = material(&metal) else { panic!() };
    let expected =
        RoughnessTexture { distribution: Distribution::Beckmann, alpha_u: board(0.2, 0.4), alpha_v: board(0.2, 0.4) };
    assert_eq!(roughness, expected);
    let (plastic, _) = material(&format!("<bsdf type=\"plastic\">{}</bsdf>", texture("diffuseReflectance")));
    let Material::Plastic { diffuse, .. } = plastic else { panic!() };
    assert_eq!(diffuse, board(Rgb::splat(0.4), Rgb::splat(0.2)));
    let (mask, _) = material(&format!("<bsdf type=\"mask\">{}<bsdf type=\"diffuse\"/></bsdf>", texture("opacity")));
    let Material::Mask { opacity, material } = mask else { panic!() };
    assert_eq!((opacity, *material), (board(0.2, 0.4), Material::lambert(Rgb::splat(0.5))));
    // A texture may stand by itself and serve several.
    let scene = described(
        "<texture type=\"checkerboard\" id=\"t\"/><shape type=\"cube\"><bsdf type=\"blendbsdf\"><ref name=\"weight\" id=\"t\"/>\
         <bsdf type=\"diffuse\"><ref id=\"t\" name=\"reflectance\"/></bsdf><bsdf type=\"conductor\"/></bsdf></shape>",
    );
    let Material::Mix { first, weight, .. } = &scene.materials[0].material else { panic!() };
    assert_eq!(*weight, board(0.2, 0.4));
    assert_eq!(**first, Material::Lambert { reflectance: board(Rgb::splat(0.4), Rgb::splat(0.2)) });
}

/// Whatever the order in a file, the relief comes out outermost, then the mask or mixture, then the rest.
#[test]
fn nesting_is_brought_into_one_order() {
    let diffuse = "<bsdf type=\"diffuse\"/>";
    let twosided = |inner: &str| format!("<bsdf type=\"twosided\">{inner}</bsdf>");
    let mask = |inner: &str| format!("<bsdf type=\"mask\">{inner}</bsdf>");
    let bump = |inner: &str| {
        format!(
            "<bsdf type=\"bumpmap\"><float name=\"scale\" value=\"2\"/>{}{inner}</bsdf>",
            BOARD.replace("NAME", "whatever")
        )
    };
    let normal =
        |inner: &str| format!("<bsdf type=\"normalmap\"><rgb name=\"normalmap\" value=\".5 .5 1\"/>{inner}</bsdf>");
    let grey = || Material::lambert(Rgb::splat(0.5));
    let relief = || Relief::Bump { height: board(0.2, 0.4), scale: 2.0 };
    let bumped = |inner| Material::Relief { relief: relief(), material: Box::new(inner) };
    let sheet = |inner| Material::Relief { relief: Relief::Sheet(Box::new(relief())), material: Box::new(inner) };
    let masked = |inner| Material::Mask { opacity: 0.5.into(), material: Box::new(inner) };
    for (bsdf, expected) in [
        (twosided(&bump(diffuse)), (bumped(grey()), true)),
        (bump(&twosided(diffuse)), (sheet(grey()), true)),
        (mask(&twosided(diffuse)), (masked(grey()), true)),
        (mask(&bump(diffuse)), (bumped(masked(grey())), false)),
        (bump(&mask(&twosided(diffuse))), (sheet(masked(grey())), true)),
        (mask(&mask(diffuse)), (Material::Mask { opacity: 0.25.into(), material: Box::new(grey()) }, false)),
        (mask(&twosided(&bump(diffuse))), (bumped(masked(grey())), true)),
        (
            normal(diffuse),
            (
                Material::Relief {
                    relief: Relief::NormalMap {
                        normals: Rgb::new(0.5, 0.5, 1.0).into(),
                        bitangent: Bitangent::RightHanded,
                    },
                    material: Box::new(grey()),
                },
                false,
            ),
        ),
        (twosided("<bsdf type=\"principled\"/>"), (material("<bsdf type=\"principled\"/>").0, true)),
    ] {
        assert_eq!(material(&bsdf), expected, "{bsdf}");
    }
    let blend =
        |a: &str, b: &str| format!("<bsdf type=\"blendbsdf\"><float name=\"weight\" value=\".3\"/>{a}{b}</bsdf>");
    let mixed = || Material::Mix { first: Box::new(grey()), second: Box::new(grey()), weight: 0.3.into() };
    assert_eq!(material(&twosided(&blend(diffuse, diffuse))), (mixed(), true));
    assert_eq!(material(&blend(&bump(diffuse), &bump(diffuse))), (bumped(mixed()), false));

    let masks = "a mask over a blend, or over a mask where both are textures, is not supported";
    let board_mask = |inner: &str| format!("<bsdf type=\"mask\">{}{inner}</bsdf>", BOARD.replace("NAME", "opacity"));
    for (bsdf, expected) in [
        (board_mask(&board_mask(diffuse)), masks),
        (mask(&blend(diffuse, diffuse)), masks),
        (blend(&mask(diffuse), diffuse), "a blend of blends or masks is not supported"),
        (blend(&bump(diffuse), diffuse), "a bump or normal map that the other has not is not supported"),
        (blend(&twosided(diffuse), diffuse), "a blend of a twosided and a one-sided BSDF is not supported"),
        (bump(&bump(diffuse)), "a bump or normal map on another is not supported"),
        (twosided(&twosided(diffuse)), "a twosided BSDF inside another"),
        (twosided(&mask(diffuse)), "a BSDF that lets light through cannot be twosided: it has both sides already"),
        (twosided("<bsdf type=\"principledthin\"/>"), "it has both sides already"),
        (
            twosided("<bsdf type=\"diffuse\"/><bsdf type=\"conductor\"/>"),
            "a different BSDF for the back side is not supported",
        ),
        (mask(""), "the bsdf type `mask` needs a bsdf"),
        (
            "<bsdf type=\"bumpmap\"><bsdf type=\"diffuse\"/></bsdf>".to_owned(),
            "the bsdf type `bumpmap` needs one texture",
        ),
        ("<bsdf type=\"roughdiffuse\"/>".to_owned(), "the bsdf type `roughdiffuse` is not supported"),
        ("<bsdf type=\"coating\"/>".to_owned(), "the bsdf type `coating` is not supported"),
    ] {
        let message = flaw(&format!("<shape type=\"cube\">{bsdf}</shape>"));
        assert!(message.contains(expected), "{bsdf}: {message}");
        // Leniently, something stands in, and is said.
        let scene = Folder::new().scene(&format!("<shape type=\"cube\">{bsdf}</shape>")).load_with(LENIENT);
        assert_eq!(scene.description.materials.len(), 1, "{bsdf}");
        assert!(scene.notes.iter().any(|n| n.contains(expected)), "{bsdf}: {:?}", scene.notes);
    }
}

#[test]
fn one_bsdf_for_both_sides_is_one() {
    let scene = described(
        "<bsdf type=\"diffuse\" id=\"d\"/><shape type=\"cube\"><bsdf type=\"twosided\"><ref id=\"d\"/><ref id=\"d\"/></bsdf></shape>",
    );
    assert!(scene.materials[0].two_sided);
}

#[test]
fn emitters_without_a_bsdf_are_black() {
    let scene = described("<shape type=\"cube\"><emitter type=\"area\"/></shape><shape type=\"cube\"/>");
    let of = |i: usize| &scene.materials[scene.objects[i].material].material;
    assert_eq!((of(0), of(1)), (&Material::lambert(Rgb::BLACK), &Material::lambert(Rgb::splat(0.5))));
}
