//! Ctrl-C, turned into a wish to stop.

use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::messages;

static ASKED: AtomicBool = AtomicBool::new(false);

/// Lets Ctrl-C (and a request to terminate) ask instead of kill, from now on.
pub(crate) fn listen() {
    static LISTENING: Once = Once::new();
    LISTENING.call_once(|| {
        let listening = ctrlc::set_handler(|| ASKED.store(true, Ordering::Relaxed));
        if let Err(error) = listening {
            messages::warning(&format!("Ctrl-C will end the run at once: {error}"));
        }
    });
}

/// Whether the user has asked to stop.
pub(crate) fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}
