//! Ctrl-C: the pass that runs is finished, then what there is is saved. A second one ends the program at once.

use crate::error::Error;
use std::sync::{
    Once,
    atomic::{AtomicBool, Ordering},
};

static ASKED: AtomicBool = AtomicBool::new(false);
static HANDLER: Once = Once::new();

/// From now on, Ctrl-C (and a request to terminate) only sets what [`asked`] returns.
pub fn listen() -> Result<(), Error> {
    let mut result = Ok(());
    HANDLER.call_once(|| {
        result = ctrlc::set_handler(|| {
            if ASKED.swap(true, Ordering::SeqCst) {
                std::process::exit(130);
            }
        });
    });
    result.map_err(|e| Error::Input(format!("Ctrl-C cannot be handled: {e}")))
}

/// Whether the user wants an end.
pub fn asked() -> bool {
    ASKED.load(Ordering::SeqCst)
}
