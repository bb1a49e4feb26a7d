//! One sweep over patches, side by side where none waits for another.

use std::collections::BTreeSet;
use std::sync::{Mutex, MutexGuard};

use rayon::Scope;

/// Which patches wait for which in a sweep: each for its neighbours that come before it.
#[derive(Debug)]
pub(super) struct Order {
    /// For every patch how many it waits for.
    earlier: Vec<usize>,
    /// For every patch those that wait for it.
    later: Vec<Vec<usize>>,
}

/// What a sweep does after a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Next {
    GoOn,
    /// Those that wait for it are left out.
    Fail,
    /// No other patch begins, and what is under way is left out.
    Stop,
}

impl Order {
    /// The order of patches of which each reads what its neighbours leave. `neighbours` are their numbers, for every
    /// patch; of two patches either both are neighbours of each other or none.
    pub(super) fn new<'a>(neighbours: impl Iterator<Item = &'a [usize]>) -> Self {
        let split = neighbours.enumerate().map(|(i, near)| {
            let later: Vec<usize> = near.iter().copied().filter(|&j| j > i).collect();
            (near.len() - later.len(), later)
        });
        let (earlier, later) = split.unzip();
        Self { earlier, later }
    }

    /// Solves all `patches` that are due once, and returns what `solve` made of them: `None` of those that were
    /// not due or not reached.
    ///
    /// Each begins when those that it waits for are done, on whichever thread of the current pool is free, with `x` as
    /// these have left it. `finish` is called with one after another, in no certain order, and may change `x`
    /// where the patch moves it, and who else is due. So everything that a patch reads is the same for any number of
    /// threads.
    pub(super) fn sweep<P: Send, R: Send>(
        &self,
        patches: &mut [P],
        (x, is_due): (&mut [f64], &mut [bool]),
        solve: impl Fn(&mut P, &[f64]) -> R + Send + Sync,
        finish: impl FnMut(&P, &R, (&mut [f64], &mut [bool])) -> Next + Send,
    ) -> Vec<Option<R>> {
        let mut sweep = Sweep {
            x,
            is_due,
            waits: self.earlier.clone(),
            later: &self.later,
            solved: patches.iter().map(|_| None).collect(),
            patches: patches.iter_mut().map(Some).collect(),
            ready: BTreeSet::new(),
            open: 0,
            is_over: false,
            finish,
        };
        let first = (0..self.earlier.len()).filter(|&i| self.earlier[i] == 0);
        sweep.release(first.collect());
        let shared = Shared {
            sweep: Mutex::new(sweep),
            solve,
        };
        rayon::scope(|scope| {
            let wanted = shared.lock().wanted();
            shared.spawn(scope, wanted);
        });
        shared.lock().solved.drain(..).collect()
    }
}

/// A sweep under way.
struct Sweep<'a, P, R, F> {
    x: &'a mut [f64],
    is_due: &'a mut [bool],
    /// For every patch how many it still waits for.
    waits: Vec<usize>,
    later: &'a [Vec<usize>],
    /// Those that nobody works on.
    patches: Vec<Option<&'a mut P>>,
    /// Those that wait for a thread alone.
    ready: BTreeSet<usize>,
    /// Number of patches that are being solved.
    open: usize,
    solved: Vec<Option<R>>,
    is_over: bool,
    finish: F,
}

impl<'a, P, R, F> Sweep<'a, P, R, F>
where
    F: FnMut(&P, &R, (&mut [f64], &mut [bool])) -> Next,
{
    /// Notes that some patches wait for nobody any more: those that are not due are passed over.
    fn release(&mut self, mut free: Vec<usize>) {
        while let Some(i) = free.pop() {
            if self.is_due[i] {
                self.ready.insert(i);
            } else {
                self.pass(i, &mut free);
            }
        }
    }

    /// How many patches could be begun.
    ///
    /// A thread that waits for a part of its own patch looks for other work. It is not to begin a patch meanwhile that
    /// another thread could: its own would wait for all of that, and there would be more of them in memory than
    /// threads.
    fn wanted(&self) -> usize {
        let free = rayon::current_num_threads().saturating_sub(self.open);
        self.ready.len().min(free)
    }

    /// Adds to `free` what waited for the patch `i` alone.
    fn pass(&mut self, i: usize, free: &mut Vec<usize>) {
        for &j in &self.later[i] {
            self.waits[j] -= 1;
            if self.waits[j] == 0 {
                free.push(j);
            }
        }
    }

    /// The first patch that is ready, and what it begins from.
    fn begin(&mut self) -> Option<(usize, &'a mut P, Vec<f64>)> {
        if self.is_over || self.wanted() == 0 {
            return None;
        }
        let i = self.ready.pop_first()?;
        let patch = self.patches[i].take()?;
        self.open += 1;
        // One whose neighbours move later is due again.
        self.is_due[i] = false;
        Some((i, patch, self.x.to_vec()))
    }

    /// Ends the work on a patch, and returns how many others could be begun.
    fn end(&mut self, i: usize, patch: &P, solved: R) -> usize {
        self.open -= 1;
        if self.is_over {
            return 0;
        }
        let next = (self.finish)(patch, &solved, (self.x, self.is_due));
        self.solved[i] = Some(solved);
        let mut free = Vec::new();
        match next {
            Next::GoOn => self.pass(i, &mut free),
            Next::Fail => {}
            Next::Stop => self.is_over = true,
        }
        self.release(free);
        self.wanted()
    }
}

/// What all threads share.
struct Shared<'a, P, R, F, S> {
    sweep: Mutex<Sweep<'a, P, R, F>>,
    solve: S,
}

impl<'a, P, R, F, S> Shared<'a, P, R, F, S>
where
    P: Send,
    R: Send,
    F: FnMut(&P, &R, (&mut [f64], &mut [bool])) -> Next + Send,
    S: Fn(&mut P, &[f64]) -> R + Send + Sync,
{
    /// While it is locked nothing may wait for other threads of the pool, which may wait for the lock.
    fn lock(&self) -> MutexGuard<'_, Sweep<'a, P, R, F>> {
        // A panic of another thread is passed on by the scope.
        self.sweep
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// Lets threads begin so many patches.
    fn spawn<'s>(&'s self, scope: &Scope<'s>, wanted: usize) {
        for _ in 0..wanted {
            scope.spawn(|scope| {
                let begun = self.lock().begin();
                if let Some((i, patch, x)) = begun {
                    let solved = (self.solve)(patch, &x);
                    let wanted = self.lock().end(i, patch, solved);
                    self.spawn(scope, wanted);
                }
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    /// A ring with chords, numbered so that few patches wait for all others: every patch has four to seven neighbours.
    fn neighbours() -> Vec<Vec<usize>> {
        let mut near = vec![BTreeSet::new(); 40];
        for place in 0..40 {
            for step in [1, 2, 5 + place % 7] {
                let [i, j] = [place, place + step].map(|place| place * 11 % 40);
                near[i].insert(j);
                near[j].insert(i);
            }
        }
        near.into_iter()
            .map(|of| of.into_iter().collect())
            .collect()
    }

    /// What every patch makes of its neighbours' values. Takes longer for some, so that threads overtake each other.
    fn solve(near: &[usize], i: usize, x: &[f64]) -> f64 {
        std::thread::sleep(std::time::Duration::from_micros(
            1000 + 37 * (i as u64 * 7 % 11),
        ));
        let sum: f64 = near.iter().map(|&j| x[j]).sum();
        1.0 + 0.3 * sum.sin()
    }

    /// A sweep by so many threads in which `next` says how it goes on after a patch; the values that patches
    /// leave, who is due then, and who was solved.
    fn swept(
        threads: usize,
        next: impl Fn(usize) -> Next + Send + Sync,
    ) -> (Vec<f64>, Vec<bool>, Vec<bool>) {
        let near = neighbours();
        let order = Order::new(near.iter().map(Vec::as_slice));
        let mut patches: Vec<usize> = (0..40).collect();
        let mut x: Vec<f64> = (0..40).map(f64::from).collect();
        // Most become due only when a neighbour has moved.
        let mut is_due: Vec<bool> = (0..40).map(|i| i % 9 == 0).collect();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let solved = pool.expect("threads").install(|| {
            order.sweep(
                &mut patches,
                (&mut x, &mut is_due),
                |patch, x| (*patch, solve(&near[*patch], *patch, x)),
                |&patch, &(i, value), (x, is_due)| {
                    assert_eq!(patch, i);
                    x[i] = value;
                    near[i]
                        .iter()
                        .for_each(|&j| is_due[j] = i % 4 == 0 || is_due[j]);
                    next(i)
                },
            )
        });
        for (i, solved) in solved.iter().enumerate() {
            assert!(solved.is_none_or(|(patch, _)| patch == i));
        }
        (x, is_due, solved.iter().map(Option::is_some).collect())
    }

    #[test]
    fn threads_make_what_one_after_the_other_makes() {
        let near = neighbours();
        let mut x: Vec<f64> = (0..40).map(f64::from).collect();
        let mut is_due: Vec<bool> = (0..40).map(|i| i % 9 == 0).collect();
        let mut is_solved = vec![false; 40];
        for i in 0..40 {
            if is_due[i] {
                x[i] = solve(&near[i], i, &x);
                (is_due[i], is_solved[i]) = (false, true);
                near[i]
                    .iter()
                    .for_each(|&j| is_due[j] = i % 4 == 0 || is_due[j]);
            }
        }
        assert!(is_solved.contains(&false) && is_due.contains(&true));
        let one_by_one = (x, is_due, is_solved);
        for threads in [1, 4] {
            assert_eq!(
                swept(threads, |_| Next::GoOn),
                one_by_one,
                "{threads} threads"
            );
        }
    }

    /// Threads that wait for parts of a patch begin no other ones beyond their number.
    #[test]
    fn no_more_patches_are_open_than_there_are_threads() {
        let order = Order::new((0..60).map(|_| [].as_slice()));
        let (open, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(4).build();
        let solved = pool.expect("threads").install(|| {
            order.sweep(
                &mut [(); 60],
                (&mut [], &mut [true; 60]),
                |(), _| {
                    most.fetch_max(open.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
                    let part = || std::thread::sleep(std::time::Duration::from_micros(300));
                    rayon::join(|| rayon::join(part, part), || rayon::join(part, part));
                    open.fetch_sub(1, Ordering::SeqCst);
                },
                |(), (), _| Next::GoOn,
            )
        });
        assert!(solved.iter().all(Option::is_some));
        assert!(most.into_inner() <= 4);
    }

    #[test]
    fn what_waits_for_a_failure_is_left_out() {
        let fail = |i| if i == 0 { Next::Fail } else { Next::GoOn };
        let (.., solved) = swept(4, fail);
        assert!(solved[0] && neighbours()[0].iter().all(|&j| !solved[j]));
        assert!(solved[1..].contains(&true), "others do not wait for it");
        assert_eq!(solved, swept(1, fail).2);
    }

    #[test]
    fn nothing_counts_after_a_stop() {
        for threads in [1, 4] {
            let calls = AtomicUsize::new(0);
            let (.., solved) = swept(threads, |_| {
                calls.fetch_add(1, Ordering::Relaxed);
                Next::Stop
            });
            assert_eq!(solved.iter().filter(|solved| **solved).count(), 1);
            assert_eq!(calls.into_inner(), 1, "{threads} threads");
        }
    }
}
