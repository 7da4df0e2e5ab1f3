//! Texture coordinates of every shape and their derivatives, against Mitsuba.

use etendue_core::{
    camera::{CameraDescription, Projection},
    has::ALL,
    material::Material,
    ray::Ray,
    rgb::Rgb,
    scene::{NamedMaterial, Object, ObjectShape, Scene, SceneDescription},
};
use glam::{DAffine3, DQuat, DVec3, UVec2, Vec2, Vec3};
use rand::{RngExt, SeedableRng};

#[derive(Clone, Copy, Debug)]
enum Kind {
    Sphere,
    Disk,
    Rectangle,
    Cube,
    Cylinder,
}
use Kind::*;

fn shape(kind: Kind) -> ObjectShape {
    match kind {
        Sphere => ObjectShape::Sphere { center: DVec3::new(0.2, 0.0, -0.1), radius: 0.7, inverted: false },
        Disk => ObjectShape::Disk,
        Rectangle => ObjectShape::Rectangle,
        Cube => ObjectShape::Cube,
        Cylinder => ObjectShape::Cylinder {
            from: DVec3::new(0.1, 0.2, 0.3),
            to: DVec3::new(1.0, -0.4, 0.9),
            radius: 0.3,
            inverted: false,
        },
    }
}

/// One shape, scaled by 1.5, turned by 40 degrees about (1, 2, 3) and moved, perhaps mirrored before.
fn scene(shape: ObjectShape, mirrored: bool) -> Scene {
    let rotation = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 40f64.to_radians());
    let scale = DVec3::new(if mirrored { -1.5 } else { 1.5 }, 1.5, 1.5);
    let to_world = DAffine3::from_scale_rotation_translation(scale, rotation, DVec3::new(0.3, -0.2, 0.5));
    Scene::new(&SceneDescription {
        camera: Some(CameraDescription {
            projection: Projection::Perspective { fov_x: 1.0 },
            to_world: DAffine3::IDENTITY,
            resolution: UVec2::ONE,
            crop: None,
        }),
        materials: vec![NamedMaterial {
            name: "grey".into(),
            material: Material::lambert(Rgb::splat(0.5)),
            two_sided: true,
        }],
        objects: vec![Object { name: "shape".into(), shape, to_world, material: 0, emission: None, absorption: None }],
        ..SceneDescription::default()
    })
    .expect("the scene is valid")
}

/// Mitsuba 3.9.1 (`scalar_rgb`), `scene.ray_intersect` from the first point towards the second: `p`, `uv`, `dp_du`, `dp_dv`
/// and the shading normal.
type Row = (Kind, bool, [f32; 3], [f32; 3], [f32; 3], [f32; 2], [f32; 3], [f32; 3], [f32; 3]);
#[rustfmt::skip]
const MITSUBA: [Row; 24] = [
    (Sphere, false, [6.12, 1.22, 0.81], [-0.63, -0.34, 0.32], [1.49168, 0.1503439, 0.4740183], [0.946729, 0.3172283], [-1.097208, 5.356236, 0.8894133], [0.5178309, 0.6366066, -3.194968], [0.9675343, 0.1666432, 0.1900193]),
    (Sphere, false, [-0.48, -6.13, 0.09], [0.06, -0.86, 0.94], [0.0756396, -0.7073693, 0.9646179], [0.5331256, 0.3337702], [3.621188, -4.011241, -1.868779], [-2.221933, -0.9622042, -2.240182], [-0.3810757, -0.6502265, 0.6572571]),
    (Sphere, true, [3.05, 5.13, 0.66], [0.1, -0.47, -0.27], [0.5286652, 0.3437377, -0.1348616], [0.4722187, 0.6180936], [3.754095, -4.457178, -1.960682], [-2.032181, -0.5994545, -2.528266], [-0.4976662, -0.6644272, 0.5575526]),
    (Sphere, true, [3.41, -3.69, -3.26], [0.2, 0.54, 0.62], [0.8529801, -0.3204692, -0.1692719], [0.5901536, 0.5724765], [-0.08599788, -6.409768, -0.463316], [-1.949619, 0.2178467, -2.651936], [-0.8065376, -0.03184921, 0.5903243]),
    (Disk, false, [-4.1, -3.27, 3.19], [0.22, -0.58, 0.38], [-0.2428414, -0.8682046, 0.6810613], [0.5864988, 0.5450404], [-0.9255623, -1.139311, 0.3087153], [3.766278, -3.573692, -1.896963], [0.3937178, -0.07152554, 0.9164445]),
    (Disk, false, [-2.82, -3.65, 4.29], [0.23, -1.01, 0.82], [0.6852911, -0.615912, 0.3020128], [0.4003504, 0.7851182], [0.962384, -1.038871, -0.4945346], [2.483879, 2.708359, -0.8557317], [0.3937178, -0.07152554, 0.9164445]),
    (Disk, true, [-0.84, -5.77, -1.41], [0.01, -0.64, 0.51], [0.0461899, -0.4215832, 0.5917466], [0.2327956, 0.9829812], [-1.090269, -0.951836, 0.3941077], [-1.234687, 1.688449, 0.6622173], [0.3937178, -0.07152554, 0.9164444]),
    (Disk, true, [4.67, -3.48, 2.98], [-0.63, -0.5, -0.46], [0.5602568, -1.169239, 0.312544], [0.6806196, 0.7931136], [0.3823824, -1.424053, -0.2754198], [-5.665304, -1.962338, 2.280742], [0.3937178, -0.07152554, 0.9164444]),
    (Rectangle, false, [-3.19, 3.28, -2.93], [0.42, 0.11, 0.08], [0.7147875, -0.1488582, 0.3257927], [0.6346217, 0.431764], [2.348267, 1.646397, -0.8803532], [-1.445863, 2.498667, 0.8161767], [0.3937178, -0.07152555, 0.9164445]),
    (Rectangle, false, [-2.56, -2.7, -4.15], [0.49, -0.49, 0.45], [0.4611575, -0.5108989, 0.4064997], [0.4943212, 0.3793159], [2.348267, 1.646397, -0.8803532], [-1.445863, 2.498667, 0.8161767], [0.3937178, -0.07152554, 0.9164445]),
    (Rectangle, true, [-0.05, 2.29, 5.95], [0.37, -0.47, 0.13], [0.3453107, -0.3077558, 0.4721239], [0.5051629, 0.4602766], [-2.348267, -1.646397, 0.8803532], [-1.445863, 2.498667, 0.8161767], [0.3937178, -0.07152555, 0.9164445]),
    (Rectangle, true, [4.68, 1.93, -3.01], [0.21, -0.41, 0.86], [0.9179971, -0.03937044, 0.2470362], [0.2846245, 0.422373], [-2.348267, -1.646397, 0.8803532], [-1.445863, 2.498667, 0.8161767], [0.3937178, -0.07152555, 0.9164445]),
    (Cube, false, [-3.15, 2.23, 4.76], [0.54, -0.62, 1.17], [-0.7429454, 0.3708932, 2.418178], [0.855319, 0.06451882], [-2.348267, -1.646397, 0.8803532], [-1.181153, 0.2145767, -2.749333], [-0.4819544, 0.8328889, 0.2720589]),
    (Cube, false, [-3.4, 2.13, -3.61], [-0.57, -0.09, 0.64], [-1.269793, 0.458954, -0.4109254], [0.1474737, 0.3000604], [1.445863, -2.498667, -0.8161767], [2.348267, 1.646397, -0.8803532], [-0.3937178, 0.07152554, -0.9164445]),
    (Cube, false, [4.68, -2.99, 3.5], [0.06, -0.43, 0.93], [1.315339, -1.125599, 1.628316], [0.1822334, 0.4852296], [-1.445863, 2.498667, 0.8161767], [2.348267, 1.646397, -0.8803532], [0.3937178, -0.07152554, 0.9164444]),
    (Cube, false, [-1.29, -5.29, -2.25], [0.34, -0.14, 1.12], [-0.2866021, -2.119755, -0.1754901], [0.2624356, 0.06183269], [1.181153, -0.2145767, 2.749333], [2.348267, 1.646397, -0.8803532], [0.4819544, -0.8328889, -0.2720588]),
    (Cube, false, [-5.58, -0.48, -0.64], [0.8, -0.6, 0.54], [-1.511634, -0.5565211, 0.1124564], [0.656916, 0.1523552], [-1.445863, 2.498667, 0.8161767], [1.181153, -0.2145767, 2.749333], [-0.7827557, -0.5487989, 0.2934511]),
    (Cube, false, [5.67, 1.96, -1.09], [0.24, -1.22, 0.02], [1.928702, -0.2310366, -0.325204], [0.1548952, 0.5375949], [-1.445863, 2.498667, 0.8161767], [-1.181153, 0.2145766, -2.749333], [0.7827557, 0.5487989, -0.2934511]),
    (Cube, true, [-4.64, 1.11, 3.64], [0.02, -0.49, -0.27], [-1.583279, 0.06048243, 1.075241], [0.9270357, 0.5776452], [-1.445863, 2.498667, 0.8161767], [-1.181153, 0.2145767, -2.749333], [-0.7827557, -0.5487989, 0.2934511]),
    (Cube, true, [-1.16, 2.63, 5.59], [-0.09, 0.79, 1.1], [-0.1961057, 0.9724624, 1.545247], [0.4827958, 0.2737585], [2.348267, 1.646397, -0.8803532], [-1.181153, 0.2145766, -2.749333], [-0.4819544, 0.8328889, 0.2720589]),
    (Cylinder, false, [-0.61, -5.26, -2.59], [0.38, -0.21, 0.74], [0.5151442, 0.4793718, 1.194576], [0.2351067, 0.03991272], [-0.2966557, -1.487415, 2.386205], [1.844825, -0.07309456, 0.183788], [-0.01886201, 0.8495312, 0.5272011]),
    (Cylinder, false, [2.67, 4.02, 4.04], [0.24, -0.01, 0.31], [0.5572982, 0.5162188, 0.7970461], [0.08793444, 0.04049728], [-0.2211881, 1.022343, 2.626836], [1.844825, -0.07309456, 0.183788], [0.07241726, 0.9315084, -0.3564376]),
    (Cylinder, true, [6.14, 1.15, 0.38], [0.96, -0.32, 0.94], [0.5565242, -0.4344997, 0.9836191], [0.6570264, 0.1249875], [-1.509105, -1.078843, -2.133794], [-0.2686149, -1.554852, 0.9761059], [0.8331658, -0.3900516, -0.3920389]),
    (Cylinder, true, [0.23, -3.74, 5.35], [0.46, 0.23, 0.96], [0.4241179, -0.3893544, 1.644878], [0.4293227, 0.3024255], [2.12192, -1.242684, -1.395555], [-0.2686149, -1.554852, 0.9761059], [0.6448461, 0.3233602, 0.69254]),
];

#[test]
fn texture_coordinates_and_derivatives_are_those_of_mitsuba() {
    for (kind, mirrored, origin, target, p, uv, dpdu, dpdv, normal) in MITSUBA {
        let scene = scene(shape(kind), mirrored);
        let middle = scene.middle().as_vec3();
        let [origin, target, p, dpdu, dpdv, normal] = [origin, target, p, dpdu, dpdv, normal].map(Vec3::from);
        let ray = Ray::new(origin - middle, (target - origin).normalize());
        let surface = scene.surface::<ALL>(&ray, &scene.closest::<ALL>(&ray).expect("a hit"));
        let close = |what: &str, found: Vec3, expected: Vec3| {
            // Both are single precision; the points lie up to 7 from where the rays start.
            let error = (found - expected).length() / expected.length().max(1.0);
            assert!(error < 2e-5, "{kind:?}, mirrored {mirrored}: {what} {found} instead of {expected}");
        };
        close("point", surface.p + middle, p);
        close("uv", surface.uv.extend(0.0), Vec2::from(uv).extend(0.0));
        close("dpdu", surface.dpdu, dpdu);
        close("dpdv", surface.dpdv, dpdv);
        // A mirroring transform turns Mitsuba's sphere inside out; here what is outside stays so.
        let inside_out = mirrored && matches!(kind, Sphere);
        close("normal", surface.ns, if inside_out { -normal } else { normal });
    }
}

/// By finite differences along the surface: what the derivatives say is what the coordinates do.
#[test]
fn the_derivatives_are_the_slope_of_the_coordinates() {
    for kind in [Sphere, Disk, Rectangle, Cube, Cylinder] {
        for mirrored in [false, true] {
            let scene = scene(shape(kind), mirrored);
            let middle = scene.middle().as_vec3();
            let mut checked = 0;
            let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(1);
            let mut point = move || Vec3::new(rng.random(), rng.random(), rng.random()) * 2.0 - 1.0;
            for _ in 0..1000 {
                let origin = point().normalize_or(Vec3::X) * 6.0;
                let target = Vec3::new(0.3, -0.2, 0.5) - middle + point();
                let look = |target: Vec3| {
                    let ray = Ray::new(origin, (target - origin).normalize());
                    Some(scene.surface::<ALL>(&ray, &scene.closest::<ALL>(&ray)?))
                };
                let Some(here) = look(target) else { continue };
                let step = (target - origin).any_orthonormal_vector() * 0.01;
                let (Some(before), Some(after)) = (look(target - step), look(target + step)) else { continue };
                let (uv, p) = (after.uv - before.uv, after.p - before.p);
                // Over a seam, an edge or a pole there is no slope.
                if uv.length() > 0.05 || before.element != after.element || p.dot(here.ng).abs() > 0.1 * p.length() {
                    continue;
                }
                let predicted = here.dpdu * uv.x + here.dpdv * uv.y;
                assert!((predicted - p).length() < 0.05 * p.length(), "{kind:?}: {predicted} instead of {p}");
                checked += 1;
            }
            assert!(checked > 30, "{kind:?}: {checked}");
        }
    }
}
