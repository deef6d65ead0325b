//! Progress on stderr for work that lasts.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Work that is done sooner is not worth a line.
const PATIENCE: Duration = Duration::from_secs(2);

static SILENT: AtomicBool = AtomicBool::new(false);

/// Shows no progress from now on, whatever stderr is: for `--json`, whose
/// reader is a program.
pub fn silence() {
    SILENT.store(true, Ordering::Relaxed);
}

/// A line on stderr that says how far a piece of work has come.
///
/// It appears once the work has lasted two seconds, only where stderr is a
/// terminal, and goes away when the work is done or the value is dropped.
/// `&Progress` may be shared between threads.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    // Waits out the patience; told to stop by dropping the sender.
    reveal: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Progress {
    /// Begins a piece of work of `total` steps.
    #[must_use]
    pub fn start(label: &str, total: u64) -> Self {
        let shown = !SILENT.load(Ordering::Relaxed) && std::io::stderr().is_terminal();
        let target = shown.then(ProgressDrawTarget::stderr);
        Self::begin(label, total, target, PATIENCE)
    }

    fn begin(
        label: &str,
        total: u64,
        target: Option<ProgressDrawTarget>,
        patience: Duration,
    ) -> Self {
        let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden());
        // The template is a constant; were it malformed, the default style would stay.
        if let Ok(style) = ProgressStyle::with_template(
            "{msg}  [{bar:30}] {percent:>3} %  {elapsed} gone, about {eta} left",
        ) {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_message(label.to_owned());
        let reveal = target.map(|target| {
            let (sender, receiver) = mpsc::channel::<()>();
            let bar = bar.clone();
            let waiting = std::thread::spawn(move || {
                if receiver.recv_timeout(patience) == Err(RecvTimeoutError::Timeout) {
                    bar.set_draw_target(target);
                    // Redraws between steps, so that long steps do not look hung.
                    bar.enable_steady_tick(Duration::from_millis(200));
                }
            });
            (sender, waiting)
        });
        Self { bar, reveal }
    }

    /// Counts `steps` more steps as done; more than the total is harmless.
    pub fn advance(&self, steps: u64) {
        self.bar.inc(steps);
    }

    /// How many steps are done.
    #[must_use]
    pub fn done(&self) -> u64 {
        self.bar.position()
    }

    /// Ends the work and clears the line.
    pub fn finish(self) {}
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some((sender, waiting)) = self.reveal.take() {
            drop(sender);
            // The thread runs nothing that panics; were it gone, the line still goes.
            let _ = waiting.join();
        }
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io;
    use std::sync::{Arc, Mutex};

    use indicatif::TermLike;

    /// A terminal that keeps what was written to it.
    #[derive(Clone, Debug, Default)]
    struct Screen(Arc<Mutex<String>>);

    impl TermLike for Screen {
        fn width(&self) -> u16 {
            100
        }
        fn move_cursor_up(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_down(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_right(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_left(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn write_line(&self, text: &str) -> io::Result<()> {
            self.write_str(text)
        }
        fn write_str(&self, text: &str) -> io::Result<()> {
            self.0.lock().unwrap().push_str(text);
            Ok(())
        }
        fn clear_line(&self) -> io::Result<()> {
            Ok(())
        }
        fn flush(&self) -> io::Result<()> {
            Ok(())
        }
    }

    fn run(work: Duration, patience: Duration) -> String {
        let screen = Screen::default();
        let target = ProgressDrawTarget::term_like(Box::new(screen.clone()));
        let progress = Progress::begin("shooting", 10, Some(target), patience);
        progress.advance(3);
        std::thread::sleep(work);
        progress.finish();
        screen.0.lock().unwrap().clone()
    }

    #[test]
    fn short_work_shows_nothing() {
        assert_eq!(run(Duration::ZERO, Duration::from_secs(60)), "");
    }

    #[test]
    fn long_work_shows_label_and_share_even_within_one_step() {
        let text = run(Duration::from_millis(700), Duration::from_millis(50));
        assert!(text.contains("shooting"), "{text}");
        assert!(text.contains("30 %"), "{text}");
    }

    #[test]
    fn threads_may_share_it() {
        let progress = Progress::begin("rays", 400, None, PATIENCE);
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| (0..100).for_each(|_| progress.advance(1)));
            }
        });
        assert_eq!(progress.done(), 400);
    }
}
