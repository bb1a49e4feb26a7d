//! Poses, as many at a time as there are threads and memory for.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard};
use std::thread;

use crate::error::CliError;
use crate::interrupt;

/// Limits to what is in work at a time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Capacity {
    /// Threads that poses share, at least one for each.
    pub(crate) threads: usize,
    /// Bytes that these poses may take together; `None` for as many as they take.
    pub(crate) memory: Option<u64>,
}

impl Capacity {
    /// Poses that can be in work at a time, at most, when each takes so many bytes; at least one.
    pub(crate) fn most_at_a_time(self, bytes: &[u64]) -> usize {
        let mut smallest_first = bytes.to_vec();
        smallest_first.sort_unstable();
        let all = 1..=smallest_first.len();
        let fitting = all.take_while(|&count| self.has_memory(&smallest_first[..count]));
        fitting.count().clamp(1, self.threads.max(1))
    }

    /// Whether poses that take so many bytes may be in work together.
    fn has_memory(self, bytes: &[u64]) -> bool {
        let together = bytes
            .iter()
            .fold(0, |sum: u64, more| sum.saturating_add(*more));
        self.memory.is_none_or(|most| together <= most)
    }
}

/// What a pose is expected to take.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Planned {
    /// Memory while it is in work.
    pub(crate) bytes: u64,
    /// On one thread.
    pub(crate) seconds: f64,
}

/// Runs `work` on the numbers of `planned`, which have what each takes, and returns the results in order.
///
/// Whenever a thread is free, the lowest number begins that still fits beside those in work; where none does,
/// one of these has to end. One that takes more than all of the memory runs by itself. `work` is told how many
/// threads it has: those that are free are shared with the numbers that can begin at the same time, the lowest
/// having what is left over, or more where all that fits beside it would be done long before it. After Ctrl-C or the
/// first error no further number is taken and `given_up` tells those in work. What was not run is `None`.
///
/// # Errors
/// The error of the lowest number that failed.
pub(crate) fn run_all<T: Send>(
    planned: &[Planned],
    capacity: Capacity,
    work: impl Fn(usize, usize, &(dyn Fn() -> bool + Sync)) -> Result<Option<T>, CliError> + Sync,
) -> Result<Vec<Option<T>>, CliError> {
    let queue = Queue {
        turns: Turns { planned, capacity },
        state: Mutex::new(State {
            waiting: (0..planned.len()).collect(),
            in_work: Vec::new(),
            free: capacity.threads.max(1),
        }),
        ended: Condvar::new(),
        failed: AtomicBool::new(false),
    };
    let results: Mutex<Vec<_>> = Mutex::new(planned.iter().map(|_| Ok(None)).collect());
    let worker = || {
        while let Some(turn) = queue.next() {
            let result = work(turn.number, turn.threads, &|| queue.has_failed());
            queue.failed.fetch_or(result.is_err(), Ordering::Relaxed);
            results
                .lock()
                .expect("no thread panics while it holds the results")[turn.number] = result;
        }
    };
    thread::scope(|scope| {
        for _ in 0..capacity.threads.min(planned.len()) {
            scope.spawn(worker);
        }
    });
    let results = results
        .into_inner()
        .expect("no thread panics while it holds the results");
    results.into_iter().collect()
}

/// Seconds until all numbers are done, in the turns that [`run_all`] gives them: those in work have so many threads and
/// seconds to go, and one that waits takes so many `seconds` with the threads that it will have.
pub(crate) fn seconds_until_done(
    (planned, capacity): (&[Planned], Capacity),
    waiting: Vec<usize>,
    mut in_work: Vec<(usize, usize, f64)>,
    seconds: impl Fn(usize, usize) -> f64,
) -> f64 {
    let turns = Turns { planned, capacity };
    let taken: usize = in_work.iter().map(|(_, threads, _)| threads).sum();
    let mut state = State {
        waiting,
        in_work: in_work.iter().map(|(number, ..)| *number).collect(),
        free: capacity.threads.max(1).saturating_sub(taken),
    };
    let mut clock = 0.0;
    loop {
        while let Some((number, threads)) = turns.next(&mut state) {
            in_work.push((number, threads, seconds(number, threads)));
        }
        let ends = in_work.iter().enumerate();
        let Some((first, _)) = ends.min_by(|(_, a), (_, b)| a.2.total_cmp(&b.2)) else {
            return clock;
        };
        let (number, threads, to_go) = in_work.swap_remove(first);
        clock += to_go;
        for (_, _, seconds) in &mut in_work {
            *seconds -= to_go;
        }
        state.end(number, threads);
    }
}

/// Numbers that wait, and those in work.
struct Queue<'a> {
    turns: Turns<'a>,
    state: Mutex<State>,
    /// Told of whenever a number is no longer in work.
    ended: Condvar,
    failed: AtomicBool,
}

/// Whose turn it is.
#[derive(Clone, Copy)]
struct Turns<'a> {
    planned: &'a [Planned],
    capacity: Capacity,
}

struct State {
    /// Ascending.
    waiting: Vec<usize>,
    in_work: Vec<usize>,
    /// Threads that nothing in work has.
    free: usize,
}

impl State {
    fn end(&mut self, number: usize, threads: usize) {
        self.in_work.retain(|&other| other != number);
        self.free += threads;
    }
}

impl Queue<'_> {
    /// The next number to work on; `None` when there is none, or it is not wanted any more.
    ///
    /// Only where something is in work does it wait, and whatever is in work ends soon after Ctrl-C or an
    /// error: so that neither has to wake it.
    fn next(&self) -> Option<Turn<'_>> {
        let mut state = self.state();
        loop {
            if interrupt::asked() || self.has_failed() || state.waiting.is_empty() {
                return None;
            }
            if let Some((number, threads)) = self.turns.next(&mut state) {
                return Some(Turn {
                    queue: self,
                    number,
                    threads,
                });
            }
            state = self.ended.wait(state).expect(UNPOISONED);
        }
    }

    fn has_failed(&self) -> bool {
        self.failed.load(Ordering::Relaxed)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().expect(UNPOISONED)
    }
}

impl Turns<'_> {
    /// Takes the next number that can begin out of those that wait, with its threads.
    fn next(&self, state: &mut State) -> Option<(usize, usize)> {
        let beginning = self.beginning(state);
        let &number = beginning.first()?;
        let shared = state.free.div_ceil(beginning.len());
        let threads = shared.max(self.threads_for(number, state));
        state.waiting.retain(|&waiting| waiting != number);
        state.in_work.push(number);
        state.free -= threads;
        Some((number, threads))
    }

    /// Free threads that one number should have so that it ends when the others have done all that fits beside it,
    /// each by itself; 0 where no time is planned.
    fn threads_for(&self, number: usize, state: &State) -> usize {
        let mut in_work = state.in_work.clone();
        in_work.push(number);
        let seconds = |number: usize| self.planned[number].seconds;
        let others = state.waiting.iter().copied();
        let beside = others.filter(|&other| other != number && self.fits(other, &in_work));
        let all = seconds(number) + beside.map(seconds).sum::<f64>();
        let threads = (state.free as f64 * seconds(number) / all + UNUSED).floor() as usize;
        threads.min(state.free)
    }

    /// The numbers that can begin now, beside those in work and each other, at most one for each free thread.
    fn beginning(&self, state: &State) -> Vec<usize> {
        let mut together = state.in_work.clone();
        for &number in &state.waiting {
            if together.len() < state.in_work.len() + state.free && self.fits(number, &together) {
                together.push(number);
            }
        }
        together.split_off(state.in_work.len())
    }

    fn fits(&self, number: usize, in_work: &[usize]) -> bool {
        let together = in_work.iter().chain([&number]);
        let bytes: Vec<u64> = together.map(|&number| self.planned[number].bytes).collect();
        in_work.is_empty() || self.capacity.has_memory(&bytes)
    }
}

/// Share of a thread that is not kept for others: they would be done in a quarter of the time.
const UNUSED: f64 = 0.25;

const UNPOISONED: &str = "no thread panics while it holds the queue";

/// A number in work. When it goes, also by a panic, those who wait for its memory or its threads go on.
struct Turn<'a> {
    queue: &'a Queue<'a>,
    number: usize,
    threads: usize,
}

impl Drop for Turn<'_> {
    fn drop(&mut self) {
        self.queue.state().end(self.number, self.threads);
        self.queue.ended.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;
    use std::sync::atomic::{AtomicU64, AtomicUsize};
    use std::time::Duration;

    /// Work that takes so many bytes each, and a second.
    fn of(bytes: &[u64]) -> Vec<Planned> {
        let seconds = 1.0;
        let each = bytes.iter().map(|&bytes| Planned { bytes, seconds });
        each.collect()
    }

    /// Runs numbers that take so many bytes, for uneven times; the most that were in work together, and
    /// the most bytes.
    fn most_in_work(bytes: &[u64], capacity: Capacity) -> (usize, u64) {
        let (now, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let (taken, most_taken) = (AtomicU64::new(0), AtomicU64::new(0));
        let results = run_all(&of(bytes), capacity, |number, _, _| {
            most.fetch_max(now.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
            let own = bytes[number];
            most_taken.fetch_max(
                taken.fetch_add(own, Ordering::SeqCst) + own,
                Ordering::SeqCst,
            );
            thread::sleep(Duration::from_millis(((7 * number) % 5) as u64));
            taken.fetch_sub(own, Ordering::SeqCst);
            now.fetch_sub(1, Ordering::SeqCst);
            Ok(Some(number))
        })
        .expect("no work fails");
        assert_eq!(results, (0..bytes.len()).map(Some).collect::<Vec<_>>());
        (most.into_inner(), most_taken.into_inner())
    }

    fn capacity(threads: usize, memory: Option<u64>) -> Capacity {
        Capacity { threads, memory }
    }

    #[test]
    fn never_more_in_work_than_threads_and_results_in_order() {
        let (most, _) = most_in_work(&[1; 20], capacity(3, None));
        assert!(most <= 3);
        assert_eq!(most_in_work(&[], capacity(3, None)), (0, 0));
    }

    #[test]
    fn never_more_in_work_than_there_is_memory_for() {
        let bytes: Vec<u64> = (0..40).map(|number| (number * 13) % 11).collect();
        for threads in [1, 2, 3, 8] {
            // As large as the largest is enough for all.
            for memory in [10, 13, 25] {
                let (most, taken) = most_in_work(&bytes, capacity(threads, Some(memory)));
                assert!(most <= threads && taken <= memory, "{taken} of {memory}");
            }
        }
    }

    #[test]
    fn one_that_takes_all_memory_or_more_runs_by_itself() {
        assert_eq!(most_in_work(&[5, 5, 5], capacity(3, Some(5))), (1, 5));
        assert_eq!(most_in_work(&[9, u64::MAX], capacity(2, Some(5))).0, 1);
        let (_, taken) = most_in_work(&[1, 1, 9, 1, 1, 5], capacity(4, Some(5)));
        assert_eq!(taken, 9);
    }

    #[test]
    fn what_does_not_fit_lets_others_pass() {
        // The second one waits for the first, which waits for the third.
        let third = AtomicBool::new(false);
        let results = run_all(&of(&[3, 3, 1]), capacity(2, Some(4)), |number, _, _| {
            while number == 0 && !third.load(Ordering::SeqCst) {
                thread::sleep(Duration::from_millis(1));
            }
            third.fetch_or(number == 2, Ordering::SeqCst);
            Ok(Some(number))
        });
        assert_eq!(results.expect("no work fails"), [0, 1, 2].map(Some));
    }

    /// Threads of every number, where all that can are in work together until the last of these has begun.
    fn threads_of(planned: &[Planned], capacity: Capacity, together: usize) -> Vec<usize> {
        let begun = AtomicUsize::new(0);
        let results = run_all(planned, capacity, |_, threads, _| {
            begun.fetch_add(1, Ordering::SeqCst);
            while begun.load(Ordering::SeqCst) < together {
                thread::sleep(Duration::from_millis(1));
            }
            Ok(Some(threads))
        });
        let results = results.expect("no work fails").into_iter();
        results.map(|threads| threads.expect("it ran")).collect()
    }

    #[test]
    fn free_threads_are_shared_by_those_that_can_begin() {
        assert_eq!(threads_of(&of(&[1]), capacity(4, None), 1), [4]);
        assert_eq!(threads_of(&of(&[1; 3]), capacity(4, None), 3), [2, 1, 1]);
        assert_eq!(
            threads_of(&of(&[1; 5]), capacity(8, None), 5),
            [2, 2, 2, 1, 1]
        );
        assert_eq!(threads_of(&of(&[1; 8]), capacity(8, None), 8), [1; 8]);
        // No other one fits beside the first one.
        assert_eq!(threads_of(&of(&[5, 1]), capacity(2, Some(5)), 1), [2, 2]);
        assert_eq!(threads_of(&of(&[9]), capacity(2, Some(5)), 1), [2]);
    }

    /// The second would be done in a tenth of the first one's time, and the third does not fit beside that.
    #[test]
    fn long_work_has_the_threads_that_would_soon_have_nothing_to_do() {
        let planned = [(4, 10.0), (1, 1.0), (2, 8.0)];
        let planned = planned.map(|(bytes, seconds)| Planned { bytes, seconds });
        assert_eq!(threads_of(&planned, capacity(2, Some(5)), 1)[0], 2);
        assert_eq!(threads_of(&planned, capacity(4, Some(5)), 2)[0], 3);
        // The others have half of its time to do.
        let half = [(4, 10.0), (1, 5.0)].map(|(bytes, seconds)| Planned { bytes, seconds });
        assert_eq!(threads_of(&half, capacity(2, Some(5)), 2), [1, 1]);
        // Everything fits.
        assert_eq!(threads_of(&planned, capacity(2, None), 2)[..2], [1, 1]);
        let nothing = planned.map(|planned| Planned {
            seconds: 0.0,
            ..planned
        });
        assert_eq!(threads_of(&nothing, capacity(2, Some(5)), 2)[..2], [1, 1]);
    }

    /// Two of three fit together; the third begins when the first of them has ended.
    #[test]
    fn what_is_left_is_waited_for_in_turn() {
        let planned = [(3, 10.0), (2, 4.0), (3, 5.0)];
        let planned = planned.map(|(bytes, seconds)| Planned { bytes, seconds });
        let left = |capacity, waiting: &[usize], in_work: &[(usize, usize, f64)]| {
            let seconds = |number: usize, threads: usize| planned[number].seconds / threads as f64;
            let plan = (planned.as_slice(), capacity);
            seconds_until_done(plan, waiting.to_vec(), in_work.to_vec(), seconds)
        };
        assert_eq!(left(capacity(1, None), &[0, 1, 2], &[]), 19.0);
        assert_eq!(left(capacity(1, None), &[2], &[(0, 1, 3.0)]), 8.0);
        // The third has both threads, once it fits.
        assert_eq!(left(capacity(2, Some(5)), &[0, 1, 2], &[]), 12.5);
        assert_eq!(
            left(capacity(2, Some(5)), &[2], &[(0, 1, 3.0), (1, 1, 1.0)]),
            5.5
        );
        assert_eq!(left(capacity(2, Some(5)), &[], &[]), 0.0);
    }

    #[test]
    fn most_at_a_time_is_what_fits_together() {
        assert_eq!(capacity(8, None).most_at_a_time(&[7, 7, 7]), 3);
        assert_eq!(capacity(2, None).most_at_a_time(&[7, 7, 7]), 2);
        assert_eq!(capacity(8, Some(10)).most_at_a_time(&[7, 2, 9, 3, 0]), 3);
        assert_eq!(capacity(8, Some(10)).most_at_a_time(&[11, 12]), 1);
        assert_eq!(capacity(8, Some(10)).most_at_a_time(&[]), 1);
    }

    #[test]
    fn an_error_ends_the_queue() {
        let done = AtomicUsize::new(0);
        let result = run_all(&of(&[1; 50]), capacity(1, None), |number, _, _| {
            done.fetch_add(1, Ordering::SeqCst);
            let path = PathBuf::from("scene.toml");
            if number == 3 {
                Err(CliError::InTheWay { path })
            } else {
                Ok(Some(number))
            }
        });
        assert!(matches!(result, Err(CliError::InTheWay { .. })));
        assert_eq!(done.load(Ordering::SeqCst), 4);
    }

    #[test]
    fn an_error_ends_those_who_wait_for_memory() {
        let done = AtomicUsize::new(0);
        let result = run_all(&of(&[5; 50]), capacity(4, Some(5)), |_, _, _| {
            done.fetch_add(1, Ordering::SeqCst);
            thread::sleep(Duration::from_millis(10));
            let path = PathBuf::from("scene.toml");
            Err::<Option<()>, _>(CliError::InTheWay { path })
        });
        assert!(matches!(result, Err(CliError::InTheWay { .. })));
        assert_eq!(done.load(Ordering::SeqCst), 1);
    }

    #[test]
    fn a_panic_leaves_nobody_waiting() {
        let done = AtomicUsize::new(0);
        let ended = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            run_all(&of(&[5; 4]), capacity(3, Some(5)), |number, _, _| {
                done.fetch_add(1, Ordering::SeqCst);
                assert_ne!(number, 0, "this one is to panic");
                Ok(Some(number))
            })
        }));
        assert!(ended.is_err());
        assert_eq!(done.load(Ordering::SeqCst), 4);
    }
}
