//! `scene`: what a scene consists of, what it costs to load and to hold, and which effects it has.

mod images;

use crate::{
    cli::SceneArgs,
    clock::{self, Cost, human_seconds, timed},
    coverage,
    error::Error,
    files,
    hash::scene_hash,
};
use etendue_core::{
    camera::{CameraDescription, Projection},
    effects::{Census, LightCount},
    scene::{ObjectShape, Scene},
    technique::Parts,
};
use etendue_scenes::{LoadedScene, load_with};
use images::{Images, images};
use serde::Serialize;

/// What a scene comes to, as it is printed.
#[derive(Debug, Serialize)]
pub struct SceneReport {
    scene: String,
    scene_hash: String,
    width: u32,
    height: u32,
    camera: &'static str,
    filter: String,
    /// Longest path; none without a bound.
    depth: Option<u32>,
    roulette_depth: u32,
    samples: Option<u32>,
    triangles: usize,
    shapes: Shapes,
    groups: usize,
    instances: usize,
    materials: usize,
    images: Images,
    lights: Lights,
    /// Reading and decoding files.
    load: Cost,
    /// Placing the scene and building its hierarchy and lights.
    build: Cost,
    memory: Memory,
    notes: Vec<String>,
    effects: Vec<String>,
    /// Light that some technique cannot render.
    gaps: Vec<String>,
}

/// Shapes by kind, those of groups once.
#[derive(Debug, Default, PartialEq, Serialize)]
struct Shapes {
    meshes: usize,
    rectangles: usize,
    cubes: usize,
    spheres: usize,
    disks: usize,
    cylinders: usize,
}

#[derive(Debug, Serialize)]
struct Lights {
    /// Shapes that shine, and the triangles and curved shapes in them.
    area: usize,
    area_elements: usize,
    point: usize,
    spot: usize,
    projector: usize,
    directional: usize,
    environment: bool,
}

/// Bytes that the scene takes.
#[derive(Debug, Serialize)]
struct Memory {
    /// Shapes and hierarchy.
    geometry_bytes: u64,
    /// That, over the triangles; none without any.
    bytes_per_triangle: Option<f64>,
    /// Shapes, hierarchy and lights, with the image of an environment.
    scene_bytes: u64,
    /// The most that the process has held; none where the system does not say.
    peak_bytes: Option<u64>,
}

/// The command.
pub fn run(args: &SceneArgs) -> Result<(), Error> {
    let threads = args.threads.map_or_else(clock::default_threads, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|e| Error::Input(format!("--threads {threads}: {e}")))?;
    clock::reset_peak_memory();
    let (loaded, load) = timed(|| pool.install(|| load_with(&args.scene, args.load.into())));
    let loaded = loaded?;
    let (scene, build) = timed(|| pool.install(|| Scene::new(&loaded.description)));
    let scene = scene.map_err(|source| Error::Scene { scene: args.scene.clone(), source })?;
    let report = SceneReport::new(&args.scene, &loaded, &scene, (load, build));
    if args.json { files::print_json(&report) } else { files::print(&report.text()) }
}

impl SceneReport {
    fn new(spec: &str, loaded: &LoadedScene, scene: &Scene, (load, build): (Cost, Cost)) -> SceneReport {
        let d = &loaded.description;
        let peak_bytes = clock::peak_memory();
        let census: &Census = scene.census();
        let geometry_bytes = scene.geometry().memory_bytes() as u64;
        let LightCount { area_objects, area_elements, point, spot, projector, directional } = census.lights;
        let size = d.camera.as_ref().map(CameraDescription::film_size).unwrap_or_default();
        let triangles = census.triangles;
        SceneReport {
            scene: spec.to_owned(),
            scene_hash: scene_hash(loaded),
            width: size.x,
            height: size.y,
            camera: match d.camera.as_ref().map(|c| c.projection) {
                Some(Projection::ThinLens { .. }) => "thin lens",
                Some(Projection::Orthographic { .. }) => "parallel",
                _ => "pinhole",
            },
            filter: format!("{:?}", loaded.filter),
            depth: (loaded.max_depth != u32::MAX).then_some(loaded.max_depth),
            roulette_depth: loaded.roulette_depth,
            samples: loaded.samples,
            triangles,
            shapes: Shapes::of(loaded),
            groups: d.groups.len(),
            instances: d.instances.len(),
            materials: d.materials.len(),
            images: images(d),
            lights: Lights {
                area: area_objects,
                area_elements,
                point,
                spot,
                projector,
                directional,
                environment: d.environment.is_some(),
            },
            load,
            build,
            memory: Memory {
                geometry_bytes,
                bytes_per_triangle: (triangles > 0).then(|| geometry_bytes as f64 / triangles as f64),
                scene_bytes: scene.memory_bytes(),
                peak_bytes,
            },
            notes: loaded.notes.clone(),
            effects: census.to_string().lines().map(str::to_owned).collect(),
            gaps: coverage::gaps(d, loaded.max_depth, Parts::ALL, &coverage::every_technique()),
        }
    }

    fn text(&self) -> String {
        let SceneReport { lights: l, images: i, memory: m, .. } = self;
        let depth = self.depth.map_or_else(|| "any depth".to_owned(), |d| format!("depth {d}"));
        let samples = self.samples.map_or_else(String::new, |s| format!(", {s} samples a pixel"));
        let (width, height, camera, filter) = (self.width, self.height, self.camera, &self.filter);
        let per_triangle = m.bytes_per_triangle.map_or_else(String::new, |b| format!(" ({b:.0} bytes a triangle)"));
        let peak = m.peak_bytes.map_or_else(String::new, |b| format!("; {} at the most", human_bytes(b)));
        let mut rows = vec![
            ("scene", format!("{} ({})", self.scene, self.scene_hash)),
            ("image", format!("{width} x {height}, {camera}, {filter}, {depth}{samples}")),
            ("shapes", format!("{}; {} triangles", self.shapes.text(), self.triangles)),
        ];
        if self.instances > 0 || self.groups > 0 {
            rows.push(("instances", format!("{} of {} groups", self.instances, self.groups)));
        }
        rows.extend([
            ("materials", self.materials.to_string()),
            ("images", format!("{}, {} texels, {}", i.count, i.texels, human_bytes(i.bytes))),
            ("lights", l.text()),
            ("load", time(self.load)),
            ("build", time(self.build)),
            (
                "memory",
                format!(
                    "geometry {}{per_triangle}, with lights {}{peak}",
                    human_bytes(m.geometry_bytes),
                    human_bytes(m.scene_bytes)
                ),
            ),
        ]);
        let mut text: String = rows.iter().map(|(name, value)| format!("{name:<10} {value}\n")).collect();
        for (title, lines) in
            [("effects", &self.effects), ("light that some techniques leave out", &self.gaps), ("notes", &self.notes)]
        {
            if !lines.is_empty() {
                text += &format!("{title}\n  {}\n", lines.join("\n  "));
            }
        }
        text.truncate(text.trim_end().len());
        text
    }
}

impl Shapes {
    fn of(loaded: &LoadedScene) -> Shapes {
        let d = &loaded.description;
        let mut shapes = Shapes::default();
        for object in d.objects.iter().chain(d.groups.iter().flat_map(|g| &g.objects)) {
            *match object.shape {
                ObjectShape::Mesh(_) => &mut shapes.meshes,
                ObjectShape::Rectangle => &mut shapes.rectangles,
                ObjectShape::Cube => &mut shapes.cubes,
                ObjectShape::Sphere { .. } => &mut shapes.spheres,
                ObjectShape::Disk => &mut shapes.disks,
                ObjectShape::Cylinder { .. } => &mut shapes.cylinders,
            } += 1;
        }
        shapes
    }

    fn text(&self) -> String {
        listed(&[
            (self.meshes, "meshes"),
            (self.rectangles, "rectangles"),
            (self.cubes, "cubes"),
            (self.spheres, "spheres"),
            (self.disks, "disks"),
            (self.cylinders, "cylinders"),
        ])
    }
}

impl Lights {
    fn text(&self) -> String {
        let text = listed(&[
            (self.area, "areas"),
            (self.point, "points"),
            (self.spot, "spots"),
            (self.projector, "projectors"),
            (self.directional, "directional"),
            (usize::from(self.environment), "environment"),
        ]);
        match self.area_elements {
            0 => text,
            elements => format!("{text}; {elements} triangles or curved shapes shine"),
        }
    }
}

/// What there is any of.
fn listed(counts: &[(usize, &str)]) -> String {
    let some = counts.iter().filter(|(count, _)| *count > 0);
    let text = some.map(|(count, what)| format!("{count} {what}")).collect::<Vec<_>>().join(", ");
    if text.is_empty() { "none".to_owned() } else { text }
}

fn time(cost: Cost) -> String {
    format!("{} ({} of processor time)", human_seconds(cost.seconds), human_seconds(cost.cpu_seconds))
}

/// Bytes as people read them.
fn human_bytes(bytes: u64) -> String {
    match bytes as f64 {
        b if b < 1e3 => format!("{b} bytes"),
        b if b < 1e6 => format!("{:.1} kB", b / 1e3),
        b if b < 1e9 => format!("{:.1} MB", b / 1e6),
        b => format!("{:.2} GB", b / 1e9),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_readable() {
        let texts = [999, 1000, 1_500_000, 2_340_000_000].map(human_bytes);
        assert_eq!(texts, ["999 bytes", "1.0 kB", "1.5 MB", "2.34 GB"]);
    }

    #[test]
    fn what_there_is_is_listed() {
        assert_eq!(listed(&[(0, "a"), (2, "b"), (1, "c")]), "2 b, 1 c");
        assert_eq!(listed(&[(0, "a")]), "none");
    }
}
