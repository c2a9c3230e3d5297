//! A line on a terminal that says how far a scene is; nothing where stderr is none.

use std::io::{IsTerminal, Write};

const WIDTH: usize = 30;

/// Draws over itself.
#[derive(Debug)]
pub(crate) struct Progress {
    is_shown: bool,
}

impl Progress {
    pub(crate) fn on_stderr() -> Self {
        Self { is_shown: std::io::stderr().is_terminal() }
    }

    pub(crate) fn say(&self, what: &str, done: usize, total: usize) {
        if self.is_shown {
            // Where stderr is closed nobody looks.
            let _ = write!(std::io::stderr(), "\r{}", bar(what, done, total));
        }
    }

    /// Gives the line back to what is printed next.
    pub(crate) fn clear(&self) {
        if self.is_shown {
            let _ = write!(std::io::stderr(), "\r\x1b[K");
        }
    }
}

fn bar(what: &str, done: usize, total: usize) -> String {
    let full = WIDTH * done / total.max(1);
    format!("{what} [{}{}] {done} of {total}", "#".repeat(full), "-".repeat(WIDTH - full))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_fills_up() {
        assert_eq!(bar("fork", 0, 4), format!("fork [{}] 0 of 4", "-".repeat(30)));
        assert_eq!(bar("fork", 2, 4), format!("fork [{}{}] 2 of 4", "#".repeat(15), "-".repeat(15)));
        assert_eq!(bar("fork", 4, 4), format!("fork [{}] 4 of 4", "#".repeat(30)));
    }
}
