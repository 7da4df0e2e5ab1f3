//! Cameras: rays as in Mitsuba, and importance that is their density.

mod sampling;

use etendue_core::camera::{Camera, CameraDescription, CameraError, Crop, Projection};
use glam::{DAffine3, DMat3, DVec2, DVec3, UVec2, Vec2, Vec3};
use sampling::{Moments, Random, chi_square};
use std::f64::consts::PI;

const ORIGIN: DVec3 = DVec3::new(0.2, 1.4, 1.85);

/// Mitsuba's `look_at` from (0.2, 1.4, 1.85) to (0, 1, -2), up +y.
fn look_at() -> DAffine3 {
    let forward = (DVec3::new(0.0, 1.0, -2.0) - ORIGIN).normalize();
    let left = DVec3::Y.cross(forward).normalize();
    DAffine3 { matrix3: DMat3::from_cols(left, forward.cross(left), forward), translation: ORIGIN }
}

fn camera(projection: Projection, width: u32, height: u32) -> Camera {
    let description =
        CameraDescription { projection, to_world: look_at(), resolution: UVec2::new(width, height), crop: None };
    Camera::new(&description, DVec3::ZERO).expect("the camera is valid")
}

fn perspective(degrees: f64) -> Projection {
    Projection::Perspective { fov_x: degrees.to_radians() }
}

fn thin_lens(aperture_radius: f64) -> Projection {
    Projection::ThinLens { fov_x: 50f64.to_radians(), aperture_radius, focus_distance: 4.0 }
}

#[track_caller]
fn close(a: Vec3, b: [f32; 3]) {
    assert!((a - Vec3::from(b)).length() < 1e-5, "{a} instead of {b:?}");
}

/// Slopes of Mitsuba 3.9.1 (`sensor.sample_ray`) for the `perspective` sensor with the principal point offset by (0.2, 0.1).
#[test]
fn rays_off_the_axis_agree_with_mitsuba() {
    let projection = Projection::OffAxis { fov_x: 90f64.to_radians(), offset: DVec2::new(0.2, 0.1) };
    let cropped = Crop { offset: UVec2::new(3, 2), size: UVec2::new(10, 6) };
    let whole = Crop { offset: UVec2::ZERO, size: UVec2::new(20, 10) };
    for (crop, share, slope) in [
        (whole, 0.5, [-0.4, -0.1]),
        (whole, 0.0, [0.6, 0.4]),
        (whole, 1.0, [-1.4, -0.6]),
        (cropped, 0.5, [-0.2, -0.1]),
        (cropped, 0.0, [0.3, 0.2]),
        (cropped, 1.0, [-0.7, -0.4]),
    ] {
        let resolution = UVec2::new(20, 10);
        let description = CameraDescription { projection, to_world: DAffine3::IDENTITY, resolution, crop: Some(crop) };
        let camera = Camera::new(&description, DVec3::ZERO).unwrap();
        let film = crop.size.as_vec2() * share;
        let direction = camera.sample_ray(film, Vec2::ZERO).direction;
        close(direction / direction.z, [slope[0], slope[1], 1.0]);
        let back = camera.film_position(Vec3::ZERO, direction).unwrap();
        assert!((back - film).length() < 1e-4, "{back} {film}");
    }
}

/// Directions of Mitsuba 3.9.1 (`scalar_rgb`, `sensor.sample_ray`) for the `perspective` sensor with the look_at above.
#[test]
fn perspective_rays_agree_with_mitsuba() {
    let square = camera(perspective(39.3), 256, 256);
    for (film, direction) in [
        ([0.0, 0.0], [-0.366_073_6, 0.224_91, -0.902_998_15]),
        ([128.0, 128.0], [-0.051_601_123, -0.103_202_15, -0.993_321_06]),
        ([256.0, 0.0], [0.270_537_6, 0.224_91, -0.936_068_9]),
        ([0.0, 256.0], [-0.362_660_68, -0.409_155_9, -0.837_298_6]),
        ([200.0, 57.0], [0.142_363_09, 0.090_278_28, -0.985_689]),
    ] {
        let ray = square.sample_ray(Vec2::from(film), Vec2::ZERO);
        close(ray.direction, direction);
        assert_eq!(ray.origin, ORIGIN.as_vec3());
    }
    let wide = camera(perspective(50.0), 320, 180);
    for (film, direction) in [
        ([0.0, 0.0], [-0.457_343_25, 0.139_045_61, -0.878_352_76]),
        ([320.0, 0.0], [0.363_869_6, 0.139_045_61, -0.921_013_2]),
        ([0.0, 180.0], [-0.454_866_74, -0.321_039_68, -0.830_680_3]),
        ([250.0, 40.0], [0.200_722_17, 0.039_979_864, -0.978_832_07]),
    ] {
        close(wide.sample_ray(Vec2::from(film), Vec2::ZERO).direction, direction);
    }
}

/// As above for `thinlens` (fov 50, aperture_radius 0.3, focus_distance 4, 320 x 180) and for `orthographic` with a
/// scale of 2 (a width of 4). Mitsuba starts rays at its near plane: its origins lie on our rays.
#[test]
fn thin_lens_and_parallel_rays_agree_with_mitsuba() {
    let check = |camera: &Camera, film: [f32; 2], lens: [f32; 2], origin: [f32; 3], direction: [f32; 3]| {
        let ray = camera.sample_ray(Vec2::from(film), Vec2::from(lens));
        close(ray.direction, direction);
        let across = (Vec3::from(origin) - ray.origin).cross(ray.direction);
        assert!(across.length() < 2e-6, "{film:?} {lens:?}: {across}");
    };
    let thin = camera(thin_lens(0.3), 320, 180);
    let (middle, side) = ([0.5, 0.5], [0.9, 0.4]);
    check(
        &thin,
        [0., 0.],
        middle,
        [0.194_813_15, 1.401_576_9, 1.840_038_4],
        [-0.457_343_25, 0.139_045_6, -0.878_352_76],
    );
    check(&thin, [0., 0.], side, [-0.039_420_62, 1.355_121_7, 1.857_032_9], [-0.412_890_73, 0.152_002_68, -0.898_007]);
    check(
        &thin,
        [160., 90.],
        side,
        [-0.034_749_78, 1.352_512_7, 1.857_061_4],
        [0.007_091_3, -0.091_394_87, -0.995_789_5],
    );
    check(
        &thin,
        [250., 40.],
        side,
        [-0.032_138_13, 1.353_962_2, 1.856_775_2],
        [0.252_598_82, 0.050_265_59, -0.966_264_6],
    );
    let parallel = camera(Projection::Orthographic { width: 4.0 }, 320, 180);
    let forward = [-0.051_601_093, -0.103_202_18, -0.993_321_06];
    check(&parallel, [0., 0.], middle, [-1.803_845_9, 2.517_960_8, 1.827_876_9], forward);
    check(&parallel, [160., 90.], middle, [0.199_483_75, 1.398_968, 1.840_066_8], forward);
    check(&parallel, [250., 40.], middle, [1.319_622_4, 2.020_630_6, 1.717_289_4], forward);
}

fn all_kinds() -> [(&'static str, Camera); 4] {
    [
        ("perspective", camera(perspective(39.3), 64, 48)),
        ("wide perspective", camera(perspective(120.0), 64, 48)),
        ("thin lens", camera(thin_lens(0.3), 64, 48)),
        ("orthographic", camera(Projection::Orthographic { width: 4.0 }, 64, 48)),
    ]
}

#[test]
fn rays_and_connections_agree_on_film_positions() {
    let mut random = Random::new(40);
    for (name, camera) in all_kinds() {
        for _ in 0..10_000 {
            // Also a little outside of the film.
            let film = (random.vec2() * 1.2 - 0.1) * camera.resolution().as_vec2();
            let lens = random.vec2();
            let ray = camera.sample_ray(film, lens);
            let back = camera.film_position(ray.origin, ray.direction).expect("it leads forwards");
            assert!((back - film).length() < 1e-3, "{name}: {film} came back as {back}");
            let p = ray.at(0.5 + 10.0 * random.f32());
            let s = camera.sample_direct(p, lens).expect("it is in front");
            assert!((s.film - film).length() < 1e-3, "{name}: {film} connects to {}", s.film);
            assert!((s.wi + ray.direction).length() < 1e-5 && (s.target - ray.origin).length() < 1e-5, "{name}");
            assert_eq!(s.delta, camera.is_delta());
            // Importance is the density of camera rays, and the connection's density is that of the lens.
            let cos = -s.wi.dot(camera.forward());
            let d2 = (p - s.target).length_squared();
            let pixels = 64.0 * 48.0;
            let (importance, pdf_w) = match name {
                "thin lens" => (camera.pdf_a() * camera.pdf_w(-s.wi) * pixels / cos, camera.pdf_a() * d2 / cos),
                "orthographic" => (camera.pdf_a() * pixels, 1.0),
                _ => (camera.pdf_w(-s.wi) * pixels / d2, 1.0),
            };
            assert!((s.importance / importance - 1.0).abs() < 1e-4, "{name}: {s:?} {importance}");
            assert!((s.pdf_w / pdf_w - 1.0).abs() < 1e-4, "{name}: {s:?} {pdf_w}");
        }
    }
}

/// A plane of radiance 1 in front of the camera, seen by light tracing: points of the plane are connected to the lens,
/// and every pixel finds a mean radiance of 1, also where it sees the plane at a slant.
#[test]
fn a_uniform_field_splats_to_a_uniform_image() {
    for (name, camera) in all_kinds() {
        // Slanted, and larger than what the film sees.
        let normal = (-camera.forward() + Vec3::new(0.1, 0.2, 0.0)).normalize();
        let (s, t) = normal.any_orthonormal_pair();
        let middle = camera.position() + camera.forward() * 3.0;
        let half = if name == "wide perspective" { 12.0 } else { 3.5 };
        let area = 4.0 * half * half;
        let (mut random, n) = (Random::new(41), 400_000);
        let mut tiles: Vec<Moments> = (0..12).map(|_| Moments::default()).collect();
        for _ in 0..n {
            let u = random.vec2() * 2.0 - 1.0;
            let p = middle + (s * u.x + t * u.y) * half;
            let sample = camera.sample_direct(p, random.vec2());
            let tile = sample.filter(|s| camera.film_contains(s.film, 0.0)).map(|s| {
                let value = area * s.importance * s.wi.dot(normal).max(0.0) / s.pdf_w;
                ((s.film.y / 16.0) as usize * 4 + (s.film.x / 16.0) as usize, value)
            });
            for (i, moments) in tiles.iter_mut().enumerate() {
                moments.add(tile.filter(|(tile, _)| *tile == i).map_or(0.0, |(_, value)| f64::from(value) / 256.0));
            }
        }
        // A tile has 16 x 16 pixels.
        for (i, moments) in tiles.iter().enumerate() {
            moments.assert_mean(&format!("{name}, tile {i}"), 1.0);
        }
    }
}

/// Camera rays from random film positions, counted where they meet a plane, against the density that is said.
#[test]
fn rays_follow_their_density() {
    for (name, camera) in all_kinds().into_iter().filter(|(name, _)| *name != "orthographic") {
        let lens = Vec2::new(0.8, 0.3);
        let (origin, forward) = (camera.sample_ray(Vec2::ZERO, lens).origin, camera.forward().as_dvec3());
        let (s, t) = forward.any_orthonormal_pair();
        let half = if name == "wide perspective" { 2.0 } else { 0.6 };
        let (mut random, n, cells, fine) = (Random::new(42), 100_000, 16, 32);
        let mut counts = vec![0.0; cells * cells];
        for _ in 0..n {
            let film = random.vec2() * camera.resolution().as_vec2();
            let d = camera.sample_ray(film, lens).direction.as_dvec3();
            let (x, y) = (d.dot(s) / d.dot(forward) / half, d.dot(t) / d.dot(forward) / half);
            assert!(x.abs() < 1.0 && y.abs() < 1.0, "{name}: {x} {y}");
            let cell = |x: f64| ((0.5 + 0.5 * x) * cells as f64) as usize;
            counts[cell(y) * cells + cell(x)] += 1.0;
        }
        let mut expected = vec![0.0; cells * cells];
        let step = 2.0 * half / (cells * fine) as f64;
        for (i, j) in (0..cells * fine).flat_map(|j| (0..cells * fine).map(move |i| (i, j))) {
            let at = |i: usize| (i as f64 + 0.5) * step - half;
            let d = forward + s * at(i) + t * at(j);
            let w = d.normalize().as_vec3();
            let film = camera.film_position(origin, w).expect("it leads forwards");
            if camera.film_contains(film, 0.0) {
                // The plane at distance 1 in solid angle.
                let solid_angle = step * step / d.length().powi(3);
                expected[j / fine * cells + i / fine] += f64::from(camera.pdf_w(w)) * solid_angle * f64::from(n);
            }
        }
        chi_square(name, &counts, &expected);
    }
}

#[test]
fn lens_points_are_uniform() {
    let camera = camera(thin_lens(0.3), 64, 48);
    let (mut random, n) = (Random::new(43), 100_000);
    let (s, t) = camera.forward().any_orthonormal_pair();
    let mut counts = vec![0.0; 256];
    for _ in 0..n {
        let q = camera.sample_ray(Vec2::splat(20.0), random.vec2()).origin - camera.position();
        assert!(q.dot(camera.forward()).abs() < 1e-6);
        let ring = (f64::from(q.length_squared()) / 0.09 * 16.0).min(15.0) as usize;
        let turn = (f64::from(q.dot(t)).atan2(f64::from(q.dot(s))) / (2.0 * PI)).rem_euclid(1.0);
        counts[ring * 16 + ((turn * 16.0) as usize).min(15)] += 1.0;
    }
    chi_square("lens", &counts, &[f64::from(n) / 256.0; 256]);
}

#[test]
fn what_cannot_be_connected_is_not() {
    for (name, camera) in all_kinds() {
        for p in [camera.position(), camera.position() - camera.forward(), camera.position() - 1e-3 * camera.forward()]
        {
            assert!(camera.sample_direct(p, Vec2::splat(0.5)).is_none(), "{name}");
        }
        if name != "orthographic" {
            assert!(camera.film_position(camera.position(), -camera.forward()).is_none());
            assert_eq!(camera.pdf_w(-camera.forward()), 0.0);
        }
        assert!(camera.film_contains(Vec2::ZERO, 0.0) && !camera.film_contains(Vec2::new(64.0, 1.0), 0.0));
        assert!(camera.film_contains(Vec2::new(64.5, -0.5), 1.0) && !camera.film_contains(Vec2::new(1.0, -1.1), 1.0));
    }
}

#[test]
fn the_transform_keeps_its_directions_alone() {
    let far = DVec3::new(1e7, -2e6, 3e5);
    let description = CameraDescription {
        projection: perspective(39.3),
        to_world: DAffine3::from_translation(far) * look_at() * DAffine3::from_scale(DVec3::new(3.0, 0.5, 2.0)),
        resolution: UVec2::splat(256),
        crop: None,
    };
    let film = Vec2::new(200.0, 57.0);
    let ray = Camera::new(&description, far).expect("it is valid").sample_ray(film, Vec2::ZERO);
    close(ray.direction, [0.142_363_09, 0.090_278_28, -0.985_689]);
    close(ray.origin, ORIGIN.as_vec3().to_array());
    // A reflection mirrors the image.
    let mirrored = look_at() * DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let mirrored =
        Camera::new(&CameraDescription { to_world: mirrored, ..description }, DVec3::ZERO).expect("it is valid");
    let plain = camera(perspective(39.3), 256, 256);
    let across = mirrored.sample_ray(Vec2::new(56.0, 57.0), Vec2::ZERO).direction;
    close(across, plain.sample_ray(film, Vec2::ZERO).direction.to_array());
}

#[test]
fn invalid_cameras_are_refused() {
    let valid = CameraDescription {
        projection: perspective(40.0),
        to_world: look_at(),
        resolution: UVec2::new(64, 48),
        crop: None,
    };
    let error = |d: &CameraDescription| Camera::new(d, DVec3::ZERO).expect_err("it is not valid");
    let offset = DVec2::new(0.0, f64::MAX);
    let projection = Projection::OffAxis { fov_x: 1.0, offset };
    assert_eq!(error(&CameraDescription { projection, ..valid.clone() }), CameraError::Offset(offset));
    let empty = UVec2::new(0, 48);
    assert_eq!(error(&CameraDescription { resolution: empty, ..valid.clone() }), CameraError::Resolution(empty));
    for fov_x in [0.0, -1.0, PI, 4.0, f64::NAN, f64::INFINITY] {
        let projection = Projection::Perspective { fov_x };
        assert!(matches!(error(&CameraDescription { projection, ..valid.clone() }), CameraError::FieldOfView(_)));
    }
    for length in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300, 1e300] {
        for projection in [
            Projection::Orthographic { width: length },
            Projection::ThinLens { fov_x: 1.0, aperture_radius: length, focus_distance: 1.0 },
            Projection::ThinLens { fov_x: 1.0, aperture_radius: 1.0, focus_distance: length },
        ] {
            let error = error(&CameraDescription { projection, ..valid.clone() });
            assert!(matches!(error, CameraError::Length { .. }), "{projection:?}: {error}");
        }
    }
    let with = |matrix3: DMat3, translation: DVec3| {
        error(&CameraDescription { to_world: DAffine3 { matrix3, translation }, ..valid.clone() }).to_string()
    };
    let flat = DMat3::from_cols(DVec3::X, DVec3::X, DVec3::Z);
    let skew = DMat3::from_cols(DVec3::X, DVec3::new(0.3, 1.0, 0.0), DVec3::Z);
    assert!(with(DMat3::NAN, DVec3::ZERO).contains("not finite"));
    assert!(with(DMat3::IDENTITY, DVec3::splat(1e300)).contains("not finite"));
    assert!(with(DMat3::ZERO, DVec3::ZERO).contains("singular"));
    assert!(with(flat, DVec3::ZERO).contains("singular"));
    assert!(with(skew, DVec3::ZERO).contains("skew"));
}
