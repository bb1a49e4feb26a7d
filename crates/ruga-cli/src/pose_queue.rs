//! Poses, as many at a time as there are threads.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

use crate::error::CliError;
use crate::interrupt;

/// Runs `work` on 0..`count` from `threads` threads and returns the results in order.
///
/// A thread takes the next number when it has finished the last, so no more than `threads` are in
/// work at any time, whatever parallel loops run inside. After Ctrl-C or the first error no further
/// number is taken and `given_up` tells those in work. What was not run is `None`.
///
/// # Errors
/// The error of the lowest number that failed.
pub(crate) fn run_all<T: Send>(
    count: usize,
    threads: usize,
    work: impl Fn(usize, &(dyn Fn() -> bool + Sync)) -> Result<Option<T>, CliError> + Sync,
) -> Result<Vec<Option<T>>, CliError> {
    let next = AtomicUsize::new(0);
    let failed = AtomicBool::new(false);
    let given_up = || failed.load(Ordering::Relaxed);
    let results = Mutex::new(BTreeMap::new());
    let worker = || {
        while !interrupt::asked() && !given_up() {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                break;
            }
            let result = work(index, &given_up);
            failed.fetch_or(result.is_err(), Ordering::Relaxed);
            results
                .lock()
                .expect("no thread panics while it holds the results")
                .insert(index, result);
        }
    };
    thread::scope(|scope| {
        for _ in 0..threads.min(count) {
            scope.spawn(worker);
        }
    });
    let mut results = results
        .into_inner()
        .expect("no thread panics while it holds the results");
    (0..count)
        .map(|index| results.remove(&index).transpose().map(Option::flatten))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    #[test]
    fn never_more_in_work_than_threads_and_results_in_order() {
        let (now, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let results = run_all(20, 3, |index, _| {
            most.fetch_max(now.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
            thread::sleep(std::time::Duration::from_millis(((7 * index) % 5) as u64));
            now.fetch_sub(1, Ordering::SeqCst);
            Ok(Some(index))
        })
        .expect("no work fails");
        assert_eq!(results, (0..20).map(Some).collect::<Vec<_>>());
        assert!(most.load(Ordering::SeqCst) <= 3);
    }

    #[test]
    fn an_error_ends_the_queue() {
        let done = AtomicUsize::new(0);
        let result = run_all(50, 1, |index, _| {
            done.fetch_add(1, Ordering::SeqCst);
            let path = PathBuf::from("scene.toml");
            if index == 3 {
                Err(CliError::InTheWay { path })
            } else {
                Ok(Some(index))
            }
        });
        assert!(matches!(result, Err(CliError::InTheWay { .. })));
        assert_eq!(done.load(Ordering::SeqCst), 4);
    }
}
