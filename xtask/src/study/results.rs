//! The results of a study: one line of JSON a checkpoint, appended when a cell is finished.

use crate::{error::Error, files, hash::Fnv};
use serde::{Deserialize, Serialize};
use std::{
    collections::BTreeMap,
    fs::OpenOptions,
    io::{Read, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
};

/// What a cell is of, the replicate apart. Cells that differ in any of it are never put together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Group {
    /// The scene as it was called.
    pub scene: String,
    /// Hash of the scene.
    pub scene_hash: String,
    /// Technique.
    pub technique: String,
    /// Its knobs.
    pub knobs: BTreeMap<String, f64>,
    /// Sampler.
    pub sampler: String,
    /// Width and height, such as `128x96`.
    pub size: String,
    /// Longest path.
    pub depth: u32,
    /// Seed from which those of the replicates are drawn.
    pub seed: u64,
    /// Threads: seconds on other numbers of them say something else.
    pub threads: usize,
    /// Hash of the reference: errors against another one say something else.
    pub reference: String,
}

impl Group {
    /// A short name for files.
    pub fn file_stem(&self) -> String {
        let id = Fnv::of(files::json(self).as_bytes()).hex();
        format!("{}-{}-{id}", files::plain_name(&self.scene), self.technique)
    }
}

/// A checkpoint of a cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// What it is of.
    #[serde(flatten)]
    pub group: Group,
    /// Which of the group's independent repetitions.
    pub replicate: u32,
    /// Passes so far, each one sample a pixel.
    pub passes: u32,
    /// Seconds that building the scene and the technique took.
    pub build_seconds: f64,
    /// Seconds so far, building included.
    pub seconds: f64,
    /// Processor seconds so far, building included.
    pub cpu_seconds: f64,
    /// Rays so far.
    pub rays: u64,
    /// Mean squared error.
    pub mse: f64,
    /// Mean squared error relative to the reference.
    pub relmse: f64,
    /// The same without the worst 0.1 % of the pixels.
    pub relmse_trimmed: f64,
    /// The part of `relmse` that those pixels hold.
    pub trimmed_share: f64,
    /// The part of the image's energy that those pixels hold.
    pub trimmed_energy_share: f64,
    /// Symmetric mean absolute percentage error.
    pub smape: f64,
    /// Mean of the image less that of the reference.
    pub mean_error: f64,
    /// The same over the mean of the reference.
    pub mean_error_relative: f64,
    /// Squared bias, in units of `mse`; the same for all replicates, and none until two of them are in.
    pub bias2: Option<f64>,
    /// Variance of one replicate, in units of `mse`; as `bias2`.
    pub variance: Option<f64>,
    /// Rejected samples so far.
    pub rejected: u64,
    /// The most memory that the process held during the cell, bytes; none where the system does not say.
    pub peak_bytes: Option<u64>,
    /// Seconds that the cell was given.
    pub budget_seconds: f64,
    /// Whether this is the cell's last checkpoint: the cell is whole.
    pub last: bool,
}

/// A finished cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Its checkpoints in order; there is at least one.
    pub lines: Vec<Line>,
}

impl Cell {
    /// What it is of.
    pub fn group(&self) -> &Group {
        &self.end().group
    }

    /// The last checkpoint.
    pub fn end(&self) -> &Line {
        &self.lines[self.lines.len() - 1]
    }
}

/// The finished cells of a study and the file that holds them.
pub struct Results {
    path: PathBuf,
    cells: Vec<Cell>,
}

impl Results {
    /// Reads a file, which may be missing. A cell without its last line, and a line that is not whole, do not count: an
    /// interruption leaves them. Of a cell that is there twice, the later one counts.
    pub fn open(path: &Path) -> Result<Results, Error> {
        let mut results = Results { path: path.into(), cells: Vec::new() };
        if path.exists() {
            let bytes = files::read_whole(path)?;
            let mut pending: Vec<Line> = Vec::new();
            for line in String::from_utf8_lossy(&bytes).lines() {
                let Ok(line) = serde_json::from_str::<Line>(line) else {
                    pending.clear();
                    continue;
                };
                let follows = pending.last().is_some_and(|p| {
                    (&p.group, p.replicate) == (&line.group, line.replicate) && p.passes < line.passes
                });
                if !follows {
                    pending.clear();
                }
                let last = line.last;
                pending.push(line);
                if last {
                    results.put(Cell { lines: std::mem::take(&mut pending) });
                }
            }
        }
        Ok(results)
    }

    fn put(&mut self, cell: Cell) {
        let (group, replicate) = (cell.group(), cell.end().replicate);
        self.cells.retain(|c| (c.group(), c.end().replicate) != (group, replicate));
        self.cells.push(cell);
    }

    /// All finished cells, groups in the order in which they first came.
    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }

    /// The groups, in the order in which they first came.
    pub fn groups(&self) -> Vec<&Group> {
        let mut groups: Vec<&Group> = Vec::new();
        for cell in &self.cells {
            if !groups.contains(&cell.group()) {
                groups.push(cell.group());
            }
        }
        groups
    }

    /// The cells of a group by replicate.
    pub fn of(&self, group: &Group) -> Vec<&Cell> {
        let mut cells: Vec<&Cell> = self.cells.iter().filter(|c| c.group() == group).collect();
        cells.sort_by_key(|c| c.end().replicate);
        cells
    }

    /// Adds a cell and appends it to the file in one piece.
    pub fn append(&mut self, cell: Cell) -> Result<(), Error> {
        let text: String = cell.lines.iter().map(json_line).collect();
        let attempt = || -> std::io::Result<()> {
            let mut file = OpenOptions::new().create(true).read(true).append(true).open(&self.path)?;
            // Half a line that an interruption left must not swallow the next one.
            let mut end = [b'\n'];
            if file.seek(SeekFrom::End(0))? > 0 {
                file.seek(SeekFrom::End(-1))?;
                file.read_exact(&mut end)?;
            }
            let separator = if end == [b'\n'] { "" } else { "\n" };
            file.write_all(format!("{separator}{text}").as_bytes())?;
            file.sync_data()
        };
        attempt().map_err(|source| Error::Write { path: self.path.clone(), source })?;
        self.put(cell);
        Ok(())
    }

    /// Sets squared bias and variance where they are known, and writes the file anew if that changes it.
    pub fn fill(&mut self, known: impl Fn(&Group, u32) -> Result<Option<(f64, f64)>, Error>) -> Result<(), Error> {
        let mut changed = false;
        for line in self.cells.iter_mut().flat_map(|c| &mut c.lines) {
            if let Some((bias2, variance)) = known(&line.group, line.passes)? {
                let filled = (Some(bias2), Some(variance));
                changed |= (line.bias2, line.variance) != filled;
                (line.bias2, line.variance) = filled;
            }
        }
        if !changed {
            return Ok(());
        }
        let text: String = self.cells.iter().flat_map(|c| &c.lines).map(json_line).collect();
        files::write_whole(&self.path, |w| w.write_all(text.as_bytes()))
    }
}

fn json_line(line: &Line) -> String {
    serde_json::to_string(line).expect("a line has string keys alone") + "\n"
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A cell whose error falls as 1 / passes from a start.
    pub fn cell(scene: &str, replicate: u32, start: f64, checkpoints: u32) -> Cell {
        let group = Group {
            scene: scene.into(),
            scene_hash: "a".into(),
            technique: "path".into(),
            knobs: [("k".to_owned(), 0.1 + 0.2)].into(),
            sampler: "independent".into(),
            size: "4x4".into(),
            depth: u32::MAX,
            seed: u64::MAX,
            threads: 2,
            reference: "r".into(),
        };
        let line = |i: u32| Line {
            group: group.clone(),
            replicate,
            passes: 1 << i,
            build_seconds: 0.0,
            seconds: 0.01 * f64::from(1 << i),
            cpu_seconds: 0.02 * f64::from(1 << i),
            rays: 100 << i,
            mse: start / f64::from(1 << i),
            relmse: start / f64::from(1 << i),
            relmse_trimmed: 0.9 * start / f64::from(1 << i),
            trimmed_share: 0.1,
            trimmed_energy_share: 0.01,
            smape: 0.3,
            mean_error: -1e-3,
            mean_error_relative: -1e-2,
            bias2: None,
            variance: None,
            rejected: 0,
            peak_bytes: Some(1 << 20),
            budget_seconds: 1.0,
            last: i + 1 == checkpoints,
        };
        Cell { lines: (0..checkpoints).map(line).collect() }
    }

    #[test]
    fn what_is_appended_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.jsonl");
        let mut results = Results::open(&path).unwrap();
        for (scene, replicate) in [("a", 0), ("b", 0), ("a", 1)] {
            results.append(cell(scene, replicate, 0.1, 4)).unwrap();
        }
        let read = Results::open(&path).unwrap();
        assert_eq!(read.cells(), results.cells());
        assert_eq!(read.groups().len(), 2);
        assert_eq!(read.of(cell("a", 0, 1.0, 1).group()).len(), 2);
    }

    #[test]
    fn interrupted_writing_loses_no_finished_cell() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.jsonl");
        let mut results = Results::open(&path).unwrap();
        results.append(cell("a", 0, 0.1, 3)).unwrap();
        let whole = std::fs::read(&path).unwrap().len();
        results.append(cell("a", 1, 0.1, 3)).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        for cut in (whole..bytes.len() - 1).step_by(41) {
            std::fs::write(&path, &bytes[..cut]).unwrap();
            let mut read = Results::open(&path).unwrap();
            assert_eq!(read.cells().len(), 1, "cut at {cut}");
            // The cell is run again and must not be lost behind the half line.
            read.append(cell("a", 1, 0.1, 3)).unwrap();
            assert_eq!(Results::open(&path).unwrap().cells().len(), 2, "cut at {cut}");
        }
    }

    #[test]
    fn a_later_cell_replaces_an_earlier_one_and_keys_keep_cells_apart() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.jsonl");
        let mut results = Results::open(&path).unwrap();
        results.append(cell("a", 0, 0.1, 3)).unwrap();
        results.append(cell("a", 0, 0.1, 5)).unwrap();
        assert_eq!(results.cells().len(), 1);
        assert_eq!(Results::open(&path).unwrap().cells()[0].lines.len(), 5);
        let mut other = cell("a", 0, 0.1, 3);
        other.lines.iter_mut().for_each(|l| l.group.threads = 1);
        results.append(other).unwrap();
        assert_eq!(results.groups().len(), 2);
    }

    #[test]
    fn filling_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.jsonl");
        let mut results = Results::open(&path).unwrap();
        results.append(cell("a", 0, 0.1, 3)).unwrap();
        results.fill(|_, passes| Ok((passes == 2).then_some((1e-9, 0.5)))).unwrap();
        let read = Results::open(&path).unwrap();
        let filled: Vec<Option<f64>> = read.cells()[0].lines.iter().map(|l| l.variance).collect();
        assert_eq!(filled, [None, Some(0.5), None]);
    }
}
