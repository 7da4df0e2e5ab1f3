//! `merge`: adds films exactly.

use crate::{cli::MergeArgs, error::Error, film_file::FilmFile, output, render};

/// The command.
pub fn run(args: &MergeArgs) -> Result<(), Error> {
    output::check_image_path(&args.out)?;
    let mut merged: Option<FilmFile> = None;
    for path in &args.films {
        let film = FilmFile::read(path)?;
        match &mut merged {
            None => merged = Some(film),
            Some(sum) => sum.merge(&film).map_err(|reason| Error::Content { path: path.clone(), reason })?,
        }
    }
    let merged = merged.ok_or_else(|| Error::Input("no film is given".into()))?;
    render::print_report(&render::save(&merged, &args.out)?, args.json)
}
