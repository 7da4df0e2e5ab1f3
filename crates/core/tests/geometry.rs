//! Hits against exhaustive search, rays that leave surfaces, and input that hierarchies choke on.

use etendue_core::{
    geometry::{
        Cylinder, Disk, Geometry, Hit, Instance, Mesh, NO_INSTANCE, Shape, Sphere, Surface,
        offset::{shadow_ray, spawn_ray},
    },
    has::{ALL, CURVED, INSTANCES},
    ray::{PrimitiveId, Ray},
};
use glam::{Affine3A, Quat, Vec2, Vec3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn point(rng: &mut Pcg64Mcg) -> Vec3 {
    Vec3::new(rng.random(), rng.random(), rng.random()) * 2.0 - 1.0
}

fn unit(rng: &mut Pcg64Mcg) -> Vec3 {
    loop {
        let p = point(rng);
        if (0.01..1.0).contains(&p.length_squared()) {
            return p.normalize();
        }
    }
}

fn soup(rng: &mut Pcg64Mcg, count: usize, size: f32) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..count as u32 {
        let at = point(rng);
        mesh.positions.extend([at, at + point(rng) * size, at + point(rng) * size]);
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    mesh
}

fn sphere(rng: &mut Pcg64Mcg) -> Shape {
    Sphere { center: point(rng), radius: 0.01 + 0.3 * rng.random::<f32>(), inverted: rng.random() }.into()
}

fn disk(rng: &mut Pcg64Mcg) -> Shape {
    Disk { center: point(rng), normal: unit(rng), radius: 0.01 + 0.3 * rng.random::<f32>() }.into()
}

fn cylinder(rng: &mut Pcg64Mcg) -> Shape {
    let (from, axis) = (point(rng), unit(rng) * (0.05 + rng.random::<f32>()));
    Cylinder { from, axis, radius: 0.01 + 0.3 * rng.random::<f32>(), inverted: rng.random() }.into()
}

fn curve(rng: &mut Pcg64Mcg) -> Shape {
    match rng.random_range(0..3) {
        0 => sphere(rng),
        1 => disk(rng),
        _ => cylinder(rng),
    }
}

/// Each primitive of some shapes alone, in the order of their numbers: hierarchies without a box to miss.
fn alone(shapes: &[Shape]) -> Vec<Shape> {
    let mut out = Vec::new();
    for shape in shapes {
        match shape {
            Shape::Mesh(mesh) => out.extend(mesh.triangles.iter().map(|t| {
                let positions = t.iter().map(|&i| mesh.positions[i as usize]).collect();
                Shape::Mesh(Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() })
            })),
            other => out.push(other.clone()),
        }
    }
    out
}

/// The nearest hit by testing everything: each primitive, what it is, and whether it is a triangle.
struct Exhaustive(Vec<(Geometry, PrimitiveId, bool)>);

impl Exhaustive {
    fn new(shapes: &[Shape], groups: &[Vec<Shape>], instances: &[Instance]) -> Exhaustive {
        let mut all = Vec::new();
        let flat = |shape: &Shape| matches!(shape, Shape::Mesh(_));
        for (shape, primitive) in alone(shapes).into_iter().zip(0..) {
            let (id, flat) = (PrimitiveId { primitive, instance: NO_INSTANCE }, flat(&shape));
            all.push((Geometry::build(vec![shape], vec![], vec![]), id, flat));
        }
        for (instance, number) in instances.iter().zip(0..) {
            for (shape, primitive) in alone(&groups[instance.group as usize]).into_iter().zip(0..) {
                let instance = Instance { group: 0, ..*instance };
                let (id, flat) = (PrimitiveId { primitive, instance: number }, flat(&shape));
                all.push((Geometry::build(vec![], vec![vec![shape]], vec![instance]), id, flat));
            }
        }
        Exhaustive(all)
    }

    /// The corners of the triangle to which a point belongs; `None` if it is of another shape.
    fn corners(&self, surface: &Surface) -> Option<[Vec3; 3]> {
        let (_, _, flat) = self.0.iter().find(|(_, id, _)| *id == surface.id)?;
        // Without coordinates of their own, triangles have those of two edges.
        let first = surface.p - surface.dpdu * surface.uv.x - surface.dpdv * surface.uv.y;
        flat.then_some([first, first + surface.dpdu, first + surface.dpdv])
    }

    /// The nearest hit of a ray of which no end is known to lie on anything, but not of these triangles.
    fn closest(&self, ray: &Ray, but: &[PrimitiveId]) -> Option<Hit> {
        let ray = Ray { leaves: PrimitiveId::NONE, arrives: PrimitiveId::NONE, ..*ray };
        let hits = self.0.iter().filter(|(_, id, flat)| !flat || !but.contains(id)).filter_map(|(geometry, id, _)| {
            let hit = geometry.closest::<ALL>(&ray)?;
            Some(Hit { instance: id.instance, primitive: id.primitive, ..hit })
        });
        hits.min_by(|a, b| (a.t, a.instance, a.primitive).partial_cmp(&(b.t, b.instance, b.primitive)).unwrap())
    }
}

/// How far beside a ray the point in which it meets a triangle may lie.
///
/// Edge functions of corners that are `reach` beside the ray and `far` from its origin are wrong by some roundings of their
/// product, which moves the point by that share of the area, as the ray sees it, times `reach`.
fn sideways(ray: &Ray, [a, b, c]: [Vec3; 3]) -> f32 {
    let direction = ray.direction.normalize();
    let from = [a, b, c].map(|corner| corner - ray.origin);
    let far = from.iter().map(|v| v.length()).fold(0.0, f32::max);
    let reach = from.iter().map(|v| v.cross(direction).length()).fold(0.0, f32::max);
    let seen = (b - a).cross(c - a).dot(direction).abs();
    8.0 * f32::EPSILON * far * (1.0 + reach * reach / seen)
}

/// Closest hits, occlusion and surfaces of random shapes against those of each shape alone.
fn check_against_search(
    seed: u64,
    triangles: usize,
    curved: usize,
    placed: usize,
    size: f32,
) -> Result<(), TestCaseError> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut shapes = vec![Shape::Mesh(soup(&mut rng, triangles, size))];
    for _ in 0..curved {
        let shape = curve(&mut rng);
        shapes.insert(rng.random_range(0..=shapes.len()), shape);
    }
    let mut group = vec![Shape::Mesh(soup(&mut rng, 10, size))];
    if curved > 0 {
        group.push(curve(&mut rng));
    }
    let groups = vec![group];
    let instances: Vec<Instance> = (0..placed)
        .map(|_| {
            let scale = Vec3::splat(0.3) + point(&mut rng).abs();
            let rotation = Quat::from_axis_angle(unit(&mut rng), rng.random::<f32>() * 6.0);
            let to_world = Affine3A::from_scale_rotation_translation(scale, rotation, point(&mut rng));
            Instance { group: 0, to_world }
        })
        .collect();
    let exhaustive = Exhaustive::new(&shapes, &groups, &instances);
    let geometry = Geometry::build(shapes, groups, instances);
    let wanted = (if curved > 0 { CURVED } else { 0 }) | (if placed > 0 { INSTANCES } else { 0 });
    prop_assert_eq!(geometry.has(), wanted);
    for _ in 0..200 {
        let (a, b) = (point(&mut rng) * 2.0, point(&mut rng));
        let t_max = if rng.random() { f32::INFINITY } else { 1.0 };
        let ray = Ray { t_max, ..Ray::new(a, b - a) };
        let hit = etendue_core::specialise!(geometry.has(), HAS => geometry.closest::<HAS>(&ray));
        prop_assert_eq!(hit, exhaustive.closest(&ray, &[]), "{:?}", ray);
        let occluded = etendue_core::specialise!(geometry.has(), HAS => geometry.occluded::<HAS>(&ray));
        prop_assert_eq!(occluded, hit.is_some(), "{:?}", ray);
        // The same ray as if it came from something that it meets and went on to what is behind that.
        let id = |hit: Option<Hit>, rng: &mut Pcg64Mcg| {
            let id = hit.map_or(PrimitiveId::NONE, |h| PrimitiveId { primitive: h.primitive, instance: h.instance });
            // At times another placement of it.
            let instance = if rng.random_ratio(1, 4) { rng.random_range(0..3) } else { id.instance };
            PrimitiveId { instance, ..id }
        };
        let leaves = id(hit, &mut rng);
        let ray = Ray { leaves, ..ray };
        let next = etendue_core::specialise!(geometry.has(), HAS => geometry.closest::<HAS>(&ray));
        prop_assert_eq!(next, exhaustive.closest(&ray, &[leaves]), "{:?}", ray);
        let arrives = id(next, &mut rng);
        let ray = Ray { arrives, ..ray };
        let occluded = etendue_core::specialise!(geometry.has(), HAS => geometry.occluded::<HAS>(&ray));
        prop_assert_eq!(occluded, exhaustive.closest(&ray, &[leaves, arrives]).is_some(), "{:?}", ray);
        if let Some(hit) = hit {
            let surface = geometry.surface::<{ ALL }>(&ray, &hit);
            // Both points lie near the ray. How far apart they are along it is no better known than the point in which it
            // meets the plane, which a rounding of the vertices moves by its size over the cosine.
            let direction = ray.direction.normalize();
            let apart = surface.p - ray.at(hit.t);
            let along = apart.dot(direction);
            let (across, cos) = ((apart - direction * along).length(), surface.ng.dot(direction).abs());
            let known = match exhaustive.corners(&surface) {
                Some(corners) => sideways(&ray, corners),
                None => 1e-5 * (1.0 + hit.t),
            };
            prop_assert!(across < known, "{} {} {:?}", across, known, surface);
            prop_assert!(along.abs() * cos < 1e-6 * (1.0 + hit.t), "{} {} {:?}", along, cos, surface);
            prop_assert!(surface.ns.dot(surface.ng) >= 0.0 && surface.dpdu.length_squared() > 0.0);
            prop_assert!((surface.ng.length() - 1.0).abs() < 1e-5);
            prop_assert!(surface.p_error.is_finite() && surface.uv.is_finite());
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(60) })]

    #[test]
    fn equals_exhaustive_search(seed: u64, triangles in 0usize..120, curved in 0usize..12, placed in 0usize..6, size in 0.01f32..1.5) {
        check_against_search(seed, triangles, curved, placed, size)?;
    }
}

/// Found by the test above when it held distances along the ray, and then those beside it, against an absolute bound.
#[test]
fn equals_exhaustive_search_where_a_triangle_is_seen_edge_on() {
    check_against_search(13_814_153_097_395_931_637, 26, 3, 1, 1.296_155_1).unwrap();
    check_against_search(12_334_015_985_119_003_479, 76, 0, 0, 1.129_293_4).unwrap();
}

/// A direction in the hemisphere of `n`, often nearly at right angles to it: down to an angle of 1e-6, beyond which
/// single-precision normals and directions do not say on which side they are.
fn leaving(rng: &mut Pcg64Mcg, n: Vec3) -> Vec3 {
    let sideways = n.cross(unit(rng)).normalize_or(n.any_orthonormal_vector());
    (sideways + n * 10f32.powf(-6.0 * rng.random::<f32>())).normalize()
}

/// Rays that leave a flat or convex shape, outwards, never meet it; nor do shadow rays that end on it.
fn never_meets_itself(shape: impl Fn(&mut Pcg64Mcg, f32, Vec3) -> (Shape, Vec3), flat: bool, count: usize) {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    let mut tested = 0;
    for i in 0..count {
        let scale = 10f32.powi(i as i32 % 10 - 4);
        let translation = unit(&mut rng) * (scale * [0.0, 1.0, 30.0, 1000.0][i % 4]);
        let placed = i % 3 == 0;
        let (shape, aim) = shape(&mut rng, scale, if placed { Vec3::ZERO } else { translation });
        let (geometry, aim) = if placed {
            let rotation = Quat::from_axis_angle(unit(&mut rng), rng.random::<f32>() * 6.0);
            let to_world = Affine3A::from_scale_rotation_translation(Vec3::splat(0.7), rotation, translation);
            let instance = Instance { group: 0, to_world };
            (Geometry::build(vec![], vec![vec![shape]], vec![instance]), to_world.transform_point3(aim))
        } else {
            (Geometry::build(vec![shape], vec![], vec![]), aim)
        };
        let origin = aim + unit(&mut rng) * (scale * 10f32.powi(rng.random_range(-1..4)));
        let ray = Ray::new(origin, aim - origin);
        let Some(hit) = geometry.closest::<ALL>(&ray) else { continue };
        let surface = geometry.surface::<{ ALL }>(&ray, &hit);
        for _ in 0..8 {
            let side = if flat && rng.random() { -surface.ng } else { surface.ng };
            let ray = spawn_ray(&surface, leaving(&mut rng, side));
            assert_eq!(geometry.closest::<ALL>(&ray), None, "scale {scale}: {surface:?} {ray:?}");
            // A light's point of view: the far end lies on the shape, the near end in space.
            let there = surface.p + leaving(&mut rng, side) * (scale * 10f32.powf(rng.random::<f32>() * 5.0 - 1.0));
            // The numbers alone have to do it here: neither end is known to be on the shape.
            let id = PrimitiveId::NONE;
            let there = Surface { p: there, p_error: Vec3::ZERO, ng: side, id, ..surface };
            if (there.p - surface.p).dot(side) > 8.0 * surface.p_error.dot(side.abs()) {
                let ray = shadow_ray(&there, surface.p, surface.p_error, surface.ng, id);
                assert!(!geometry.occluded::<ALL>(&ray), "scale {scale}: {surface:?} {ray:?}");
            }
            tested += 1;
        }
    }
    assert!(tested > count, "{tested} rays of {count} shapes");
}

#[test]
fn rays_that_leave_a_triangle_do_not_meet_it() {
    let triangle = |rng: &mut Pcg64Mcg, scale: f32, at: Vec3| {
        let positions: Vec<Vec3> = (0..3).map(|_| point(rng) * scale + at).collect();
        let (mut u, mut v) = (rng.random::<f32>(), rng.random::<f32>());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let aim = positions[0] * (1.0 - u - v) + positions[1] * u + positions[2] * v;
        (Shape::Mesh(Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() }), aim)
    };
    never_meets_itself(triangle, true, 60_000);
}

#[test]
fn rays_that_leave_a_disk_do_not_meet_it() {
    let disk = |rng: &mut Pcg64Mcg, scale: f32, at: Vec3| {
        (Shape::from(Disk { center: at, normal: unit(rng), radius: scale }), at + unit(rng) * (0.1 * scale))
    };
    never_meets_itself(disk, true, 30_000);
}

#[test]
fn rays_that_leave_a_sphere_do_not_meet_it() {
    let sphere = |_: &mut Pcg64Mcg, scale: f32, at: Vec3| {
        (Shape::from(Sphere { center: at, radius: scale, inverted: false }), at)
    };
    never_meets_itself(sphere, false, 30_000);
}

#[test]
fn rays_that_leave_a_cylinder_do_not_meet_it() {
    let cylinder = |rng: &mut Pcg64Mcg, scale: f32, at: Vec3| {
        let axis = unit(rng) * (scale * 10f32.powf(rng.random::<f32>() * 2.0 - 1.0));
        (Shape::from(Cylinder { from: at - axis * 0.5, axis, radius: 0.3 * scale, inverted: false }), at)
    };
    never_meets_itself(cylinder, false, 30_000);
}

/// Through its open ends as well: both sides, and nothing where the ends would be.
#[test]
fn cylinders_have_a_side_and_no_ends() {
    let cylinder = Cylinder { from: Vec3::new(0.0, 0.0, -1.0), axis: Vec3::Z * 2.0, radius: 0.5, inverted: false };
    let geometry = Geometry::build(vec![cylinder.into()], vec![], vec![]);
    let hit = |origin: Vec3, direction: Vec3| {
        let ray = Ray::new(origin, direction.normalize());
        let hit = geometry.closest::<CURVED>(&ray)?;
        Some((hit.t, geometry.surface::<{ ALL }>(&ray, &hit).ng))
    };
    assert_eq!(hit(Vec3::new(3.0, 0.0, 0.3), Vec3::NEG_X), Some((2.5, Vec3::X)));
    assert_eq!(hit(Vec3::ZERO, Vec3::NEG_X), Some((0.5, Vec3::NEG_X)));
    assert_eq!(hit(Vec3::new(3.0, 0.0, 1.01), Vec3::NEG_X), None);
    for along in [Vec3::Z, Vec3::NEG_Z] {
        assert_eq!(hit(Vec3::new(0.1, 0.2, 0.0), along), None);
        assert_eq!(hit(Vec3::new(0.5, 0.0, 0.0) - along * 3.0, along), None);
    }
    // In through the end, out by the inner side; over the rim and past.
    let (t, ng) = hit(Vec3::new(0.0, 0.0, 2.0), Vec3::new(0.5, 0.0, -1.5)).expect("the inner side");
    assert!((t - (0.25f32 + 2.25).sqrt()).abs() < 1e-6 && ng == Vec3::X, "{t} {ng}");
    assert_eq!(hit(Vec3::new(0.0, 0.0, 2.0), Vec3::new(0.5, 0.0, -0.9)), None);
    let inverted = Geometry::build(vec![Cylinder { inverted: true, ..cylinder }.into()], vec![], vec![]);
    let ray = Ray::new(Vec3::ZERO, Vec3::X);
    let hit = inverted.closest::<CURVED>(&ray).expect("the inner side");
    assert_eq!(inverted.surface::<{ ALL }>(&ray, &hit).ng, Vec3::NEG_X);
}

#[test]
fn rays_within_a_cylinder_meet_it_once() {
    let mut rng = Pcg64Mcg::seed_from_u64(8);
    for i in 0..20_000 {
        let scale = 10f32.powi(i % 10 - 4);
        let axis = unit(&mut rng) * (1e4 * scale);
        let middle = unit(&mut rng) * (scale * [0.0, 1.0, 30.0][i as usize % 3]);
        let shape = Shape::from(Cylinder { from: middle - axis * 0.5, axis, radius: scale, inverted: true });
        let geometry = Geometry::build(vec![shape], vec![], vec![]);
        let ray = Ray::new(middle + unit(&mut rng) * (0.5 * scale), unit(&mut rng));
        let Some(hit) = geometry.closest::<CURVED>(&ray) else { continue };
        let surface = geometry.surface::<{ ALL }>(&ray, &hit);
        let direction = (surface.ng + unit(&mut rng) * 0.9).normalize();
        let Some(on) = geometry.closest::<CURVED>(&spawn_ray(&surface, direction)) else { continue };
        // The chord that the cross-section has in this direction; what is across the long axis is known less well.
        let along = direction.dot(axis.normalize());
        let chord = 2.0 * scale * direction.dot(surface.ng) / (1.0 - along * along);
        assert!((on.t - chord).abs() < 2e-3 * chord.max(scale), "scale {scale}: {} instead of {chord}", on.t);
    }
}

#[test]
fn rays_within_a_sphere_meet_it_once() {
    let mut rng = Pcg64Mcg::seed_from_u64(6);
    for i in 0..20_000 {
        let scale = 10f32.powi(i % 10 - 4);
        let center = unit(&mut rng) * (scale * [0.0, 1.0, 30.0][i as usize % 3]);
        let shape = Shape::from(Sphere { center, radius: scale, inverted: true });
        let geometry = Geometry::build(vec![shape], vec![], vec![]);
        let ray = Ray::new(center + unit(&mut rng) * (0.9 * scale), unit(&mut rng));
        let hit = geometry.closest::<CURVED>(&ray).expect("inside");
        let surface = geometry.surface::<{ ALL }>(&ray, &hit);
        // On to the far side and not to the same point: the chord has the length that its angle asks for.
        let direction = (surface.ng + unit(&mut rng) * 0.9).normalize();
        let on = spawn_ray(&surface, direction);
        let hit = geometry.closest::<CURVED>(&on).expect("inside still");
        let chord = 2.0 * scale * direction.dot(surface.ng);
        assert!((hit.t - chord).abs() < 1e-4 * scale, "scale {scale}: {} instead of {chord}", hit.t);
    }
}

#[test]
fn tiny_and_huge_spheres_are_met_where_they_are() {
    let mut hits = 0;
    for (radius, distance) in [(1e-4f32, 1e3f32), (1e-3, 1e4), (1e6, 1e7), (1e5, 1.0)] {
        let sphere = Sphere { center: Vec3::new(0.0, 0.0, -distance - radius), radius, inverted: false };
        let geometry = Geometry::build(vec![sphere.into()], vec![], vec![]);
        for i in -20..=20 {
            let x = i as f32 / 16.0;
            // Aimed at the height x of the disk that the sphere looks like.
            let target = sphere.center.as_dvec3() + glam::DVec3::X * f64::from(x * radius);
            let direction = target.normalize().as_vec3();
            let ray = Ray::new(Vec3::ZERO, direction);
            let hit = geometry.closest::<CURVED>(&ray);
            // The distance between centre and line decides; by a cross product nothing cancels.
            let (d, r, c) = (direction.as_dvec3().normalize(), f64::from(radius), sphere.center.as_dvec3());
            let height = c.cross(d).length();
            if height > 1.0001 * r {
                assert_eq!(hit, None, "radius {radius}, height {height}");
            } else if height < 0.99 * r {
                let n = geometry.surface::<{ ALL }>(&ray, &hit.expect("a hit")).ng;
                let to_line = c.cross(d).cross(d);
                let expected = (to_line - d * (r * r - height * height).sqrt()) / r;
                assert!((n.as_dvec3() - expected).length() < 1e-6, "radius {radius}: {n} instead of {expected}");
                hits += 1;
            }
        }
    }
    assert!(hits > 80, "{hits}");
}

fn mesh_of(triangles: impl IntoIterator<Item = [Vec3; 3]>) -> Shape {
    let mut mesh = Mesh::default();
    for triangle in triangles {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(triangle);
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    Shape::Mesh(mesh)
}

fn front(geometry: &Geometry, origin: Vec3) -> Option<Hit> {
    geometry.closest::<ALL>(&Ray::new(origin, Vec3::NEG_Z))
}

#[test]
fn coincident_triangles_build_and_the_first_wins() {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let geometry = Geometry::build(vec![mesh_of(vec![triangle; 16_384])], vec![], vec![]);
    let hit = front(&geometry, Vec3::new(0.2, 0.2, 1.0)).expect("a hit");
    assert_eq!((hit.primitive, hit.t), (0, 1.0));
    assert_eq!(front(&geometry, Vec3::new(0.8, 0.8, 1.0)), None);
}

#[test]
fn coincident_centres_and_rows_build() {
    // All about one point; and all in one row at equal distances, boxes alike.
    let nested = (1..=16_384).map(|i| [Vec3::NEG_X, Vec3::X, Vec3::Y].map(|p| p * i as f32));
    let geometry = Geometry::build(vec![mesh_of(nested)], vec![], vec![]);
    assert_eq!(front(&geometry, Vec3::new(0.0, 0.5, 1.0)).map(|h| h.primitive), Some(0));
    assert_eq!(front(&geometry, Vec3::new(0.0, 16_383.5, 1.0)).map(|h| h.primitive), Some(16_383));
    let row = (0..16_384).map(|i| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p + Vec3::X * (2 * i) as f32));
    let geometry = Geometry::build(vec![mesh_of(row)], vec![], vec![]);
    for i in [0, 1, 777, 16_383] {
        assert_eq!(front(&geometry, Vec3::new(i as f32 * 2.0 + 0.25, 0.25, 1.0)).map(|h| h.primitive), Some(i));
        assert_eq!(front(&geometry, Vec3::new(i as f32 * 2.0 + 1.25, 0.25, 1.0)), None);
    }
}

#[test]
fn triangles_without_area_are_dropped_and_counted() {
    let good = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let point = [Vec3::ONE; 3];
    let line = [Vec3::ZERO, Vec3::X, Vec3::X * 2.0];
    let sliver = [Vec3::ZERO, Vec3::X, Vec3::new(0.5, f32::MIN_POSITIVE, 0.0)];
    let thin = [Vec3::ZERO, Vec3::X, Vec3::new(0.5, 1e-6, 0.0)];
    let geometry = Geometry::build(vec![mesh_of([point, line, good, sliver, thin])], vec![], vec![]);
    assert_eq!(geometry.degenerate_dropped(), 3);
    assert_eq!((geometry.triangle_count(), geometry.primitive_count()), (5, 5));
    let ray = Ray::new(Vec3::new(0.2, 0.2, 1.0), Vec3::NEG_Z);
    let hit = geometry.closest::<0>(&ray).expect("a hit");
    assert_eq!((hit.primitive, geometry.surface::<{ ALL }>(&ray, &hit).element), (2, 2));
    assert_eq!(geometry.triangle(0, 2), good);
}

#[test]
fn empty_and_single_and_enormous_inputs() {
    let empty = Geometry::build(vec![], vec![], vec![]);
    assert_eq!((front(&empty, Vec3::Z), empty.bounds(), empty.has()), (None, None, 0));
    let empty = Geometry::build(vec![Shape::Mesh(Mesh::default())], vec![vec![]], vec![]);
    assert_eq!((front(&empty, Vec3::Z), empty.bounds(), empty.shape_count()), (None, None, 1));
    let nothing_placed = Instance { group: 0, to_world: Affine3A::IDENTITY };
    let empty = Geometry::build(vec![], vec![vec![]], vec![nothing_placed]);
    assert_eq!((front(&empty, Vec3::Z), empty.bounds(), empty.has()), (None, None, INSTANCES));
    for scale in [1e-15f32, 1e-4, 1.0, 1e5, 1e15] {
        let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p * scale);
        for count in [1, 2, 5, 9] {
            let copies = (0..count).map(|i| triangle.map(|p| p - Vec3::Z * (scale * i as f32)));
            let geometry = Geometry::build(vec![mesh_of(copies)], vec![], vec![]);
            let hit = front(&geometry, Vec3::new(0.25, 0.25, 1.0) * scale).expect("a hit");
            assert_eq!((hit.t, hit.primitive), (scale, 0));
            let (lo, hi) = geometry.bounds().expect("bounds");
            assert!(lo.x <= 0.0 && hi.x >= scale && hi.x < scale * 1.00001);
        }
    }
    // Near the end of the range of floats nothing is promised but an answer.
    let geometry =
        Geometry::build(vec![mesh_of([[Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p * 1e38); 40])], vec![], vec![]);
    let _ = front(&geometry, Vec3::new(1e37, 1e37, 1e38));
}

#[test]
fn shapes_are_numbered_through_groups() {
    let ball = |x: f32| Shape::from(Sphere { center: Vec3::X * x, radius: 0.1, inverted: false });
    let groups = vec![vec![ball(0.0)], vec![ball(0.0), ball(1.0)]];
    let place = |group, y| Instance { group, to_world: Affine3A::from_translation(Vec3::Y * y) };
    let geometry = Geometry::build(vec![ball(0.0), ball(1.0)], groups, vec![place(1, 3.0), place(0, 5.0)]);
    let at = |x: f32, y: f32| {
        let ray = Ray::new(Vec3::new(x, y, 1.0), Vec3::NEG_Z);
        let hit = geometry.closest::<ALL>(&ray).expect("a hit");
        (hit.instance, geometry.surface::<{ ALL }>(&ray, &hit).shape)
    };
    assert_eq!([at(0.0, 0.0), at(1.0, 0.0)], [(NO_INSTANCE, 0), (NO_INSTANCE, 1)]);
    assert_eq!([at(0.0, 3.0), at(1.0, 3.0), at(0.0, 5.0)], [(0, 3), (0, 4), (1, 2)]);
    for i in 0..5 {
        assert!(matches!(geometry.shape(i), Shape::Sphere(..)));
    }
    assert_eq!(geometry.shape_count(), 5);
}

#[test]
fn shading_normals_and_tangents_of_meshes() {
    let mesh = |normals: [Vec3; 3], uvs: Vec<Vec2>| {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        Shape::Mesh(Mesh { positions, normals: normals.to_vec(), uvs, triangles: vec![[0, 1, 2]], ..Mesh::default() })
    };
    let look = |shape: Shape| {
        let geometry = Geometry::build(vec![shape], vec![], vec![]);
        let ray = Ray::new(Vec3::new(0.25, 0.25, 1.0), Vec3::NEG_Z);
        geometry.surface::<{ ALL }>(&ray, &geometry.closest::<0>(&ray).expect("a hit"))
    };
    // Interpolated: the mean with weights 1/2, 1/4, 1/4.
    let tilted = Vec3::new(1.0, 0.0, 1.0);
    let surface = look(mesh([Vec3::Z, tilted, Vec3::Z], vec![]));
    assert_eq!((surface.ng, surface.uv), (Vec3::Z, Vec2::splat(0.25)));
    assert!((surface.ns - Vec3::new(0.25, 0.0, 1.0).normalize()).length() < 1e-6);
    // Opposed to the face: turned over. Cancelled: the face's.
    assert_eq!(look(mesh([Vec3::NEG_Z; 3], vec![])).ns, Vec3::Z);
    assert_eq!(look(mesh([Vec3::X, Vec3::NEG_X, Vec3::NEG_X], vec![])).ns, Vec3::Z);
    // u grows along y, at half its rate.
    let uvs = [[0.0, 0.0], [0.0, 1.0], [0.5, 0.0]].map(Vec2::from_array).to_vec();
    let surface = look(mesh([Vec3::Z; 3], uvs));
    assert_eq!((surface.dpdu, surface.uv), (Vec3::Y * 2.0, Vec2::new(0.125, 0.25)));
    // Degenerate texture coordinates: some tangent.
    let surface = look(mesh([Vec3::Z; 3], vec![Vec2::ONE; 3]));
    assert!(surface.dpdu.is_finite() && surface.dpdu.length() > 0.5 && surface.dpdu.dot(surface.ng) == 0.0);
}
