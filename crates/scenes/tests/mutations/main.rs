//! Mutated input to every parser: whatever it is, there is a result or an error, no panic, and no memory beyond what the
//! input's size allows.
//!
//! The inputs are the same in every run. `ETENDUE_FUZZ_INPUTS` says how many each parser gets (by default a few thousand),
//! `ETENDUE_FUZZ_SEED` which, and `ETENDUE_FUZZ_CORPUS` names a folder into which the sound inputs are written, for the
//! targets under `fuzz/`, which find inputs by what they reach. An input that fails is written to the system's folder for
//! temporary files; once what it shows is mended, it belongs into `kept/`, under the name of its parser.

#[path = "../formats/gltf/build.rs"]
mod build;
mod checks;
mod memory;
mod mutate;
mod seeds;
#[path = "../formats/serialized_writer.rs"]
mod serialized_writer;

use mutate::{Random, mutated};
use std::{
    panic::catch_unwind,
    path::PathBuf,
    sync::{Mutex, MutexGuard, PoisonError},
    time::Instant,
};

/// One parser at a time: memory is counted for the whole process.
static ALONE: Mutex<()> = Mutex::new(());

fn alone() -> MutexGuard<'static, ()> {
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

type Check = fn(&[u8]);

/// A parser, and what memory it may take for an input of a length.
fn parser(name: &str) -> (Check, fn(usize) -> usize) {
    const MB: usize = 1 << 20;
    match name {
        // A vertex or a corner of a few bytes becomes one of a few dozen, and lists double as they grow.
        "ply" => (checks::ply, |length| 64 * length + MB / 16),
        "obj" => (checks::obj, |length| 256 * length + MB / 16),
        // Deflation packs up to 1032 bytes into one.
        "serialized" => (checks::serialized, |length| 1032 * length + MB / 4),
        // A byte may stand for 8 * 1032 texels, each of which is held once as it is decoded and once as it is used.
        "gltf" => (checks::gltf, |length| 8 * 1032 * 24 * length + 4 * MB),
        // A texel of 12 bytes, beside those of the decoder.
        "exr" | "hdr" => (if name == "exr" { checks::exr } else { checks::hdr }, |length| 1032 * 64 * length + 4 * MB),
        // The tree of the document, and a sky's image, which a few words ask for.
        "xml" => (checks::xml, |length| 1024 * length + 64 * MB),
        other => panic!("no parser {other}"),
    }
}

/// Why an input fails, if it does; and the memory that it took.
fn failure(name: &str, input: &[u8]) -> (Option<String>, usize) {
    let (check, allowed) = parser(name);
    memory::start();
    let outcome = catch_unwind(|| check(input));
    let peak = memory::peak();
    let failure = match outcome {
        Err(cause) => {
            let text = cause.downcast_ref::<String>().map(String::as_str).or(cause.downcast_ref::<&str>().copied());
            Some(format!("it panicked: {}", text.unwrap_or("without words")))
        }
        Ok(()) if peak > allowed(input.len()) => {
            Some(format!("it took {peak} bytes, and {} are allowed", allowed(input.len())))
        }
        Ok(()) => None,
    };
    (failure, peak)
}

fn number(variable: &str, default: u64) -> u64 {
    match std::env::var(variable) {
        Ok(text) => text.parse().unwrap_or_else(|_| panic!("{variable} is `{text}`, not a number")),
        Err(_) => default,
    }
}

fn mutations(name: &str, default_inputs: u64) {
    let _alone = alone();
    let inputs = number("ETENDUE_FUZZ_INPUTS", default_inputs);
    let start = number("ETENDUE_FUZZ_SEED", 0);
    let seeds = seeds::all().into_iter().find(|(n, _)| *n == name).map(|(_, seeds)| seeds).unwrap();
    for seed in &seeds {
        assert_eq!(failure(name, seed).0, None, "{name}: a sound input");
    }
    let mut failures = Vec::new();
    let (mut slowest, mut largest) = (0.0f64, 0);
    for index in 0..inputs {
        let mut random = Random(start.wrapping_add(index).wrapping_mul(0xD129_8A2E_03FF_4E1B) ^ name.len() as u64);
        let mut input = mutated(&seeds, &mut random);
        if name == "serialized" && random.below(2) == 1 {
            input = serialized_from_inside(&mut random);
        }
        let begun = Instant::now();
        let (failure, peak) = failure(name, &input);
        slowest = slowest.max(begun.elapsed().as_secs_f64());
        largest = largest.max(peak);
        if let Some(why) = failure {
            let file = std::env::temp_dir().join(format!("etendue-{name}-{start}-{index}"));
            let kept = std::fs::write(&file, &input).map_or_else(|e| e.to_string(), |()| file.display().to_string());
            failures.push(format!("input {index} ({kept}): {why}"));
            assert!(failures.len() < 20, "{name}: {failures:#?}");
        }
    }
    println!("{name}: {inputs} inputs from seed {start}, slowest {:.1} ms, most memory {largest} bytes", 1e3 * slowest);
    assert!(failures.is_empty(), "{name}: {failures:#?}");
}

/// A container whose contents are changed before they are deflated, which no change of the container itself gets at.
fn serialized_from_inside(random: &mut Random) -> Vec<u8> {
    let layout = *random.of(&serialized_writer::LAYOUTS);
    let mesh = etendue_scenes::serialized::read(&seeds::serialized()[0], random.below(2)).unwrap();
    let contents = mutated(&[serialized_writer::contents(&mesh, layout, 0)], random);
    serialized_writer::container(&[serialized_writer::shape(&contents, layout.version)], layout.version)
}

#[test]
fn ply() {
    mutations("ply", 10_000);
}

#[test]
fn obj() {
    mutations("obj", 10_000);
}

#[test]
fn serialized() {
    mutations("serialized", 4_000);
}

#[test]
fn gltf() {
    mutations("gltf", 4_000);
}

#[test]
fn exr() {
    mutations("exr", 4_000);
}

#[test]
fn hdr() {
    mutations("hdr", 4_000);
}

#[test]
fn xml() {
    mutations("xml", 3_000);
}

/// Inputs that failed once, here or in other programs' parsers.
#[test]
fn kept_inputs() {
    let _alone = alone();
    let root = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/mutations/kept"));
    let mut count = 0;
    for (name, _) in seeds::all() {
        let Ok(folder) = root.join(name).read_dir() else { continue };
        for entry in folder {
            let path = entry.unwrap().path();
            assert_eq!(failure(name, &std::fs::read(&path).unwrap()).0, None, "{}", path.display());
            count += 1;
        }
    }
    assert!(count > 0, "there are none in {}", root.display());
}

/// Does nothing unless it is asked to.
#[test]
fn write_corpus() {
    let Some(folder) = std::env::var_os("ETENDUE_FUZZ_CORPUS").map(PathBuf::from) else { return };
    for (name, seeds) in seeds::all() {
        let folder = folder.join(name);
        std::fs::create_dir_all(&folder).unwrap();
        for (index, seed) in seeds.iter().enumerate() {
            std::fs::write(folder.join(format!("seed-{index}")), seed).unwrap();
        }
    }
}
