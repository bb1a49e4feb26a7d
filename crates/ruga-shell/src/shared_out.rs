//! Loops over the elements of a layer that all threads share.

use rayon::prelude::*;

/// Elements from which on a loop is shared out: those of the whole of a large layer. Its patches have fewer, and are
/// solved by one thread each.
const MANY: usize = 1 << 18;

/// Elements whose values are found before what is made of them, one after the other.
const AT_A_TIME: usize = 1 << 15;

/// Elements that a thread takes at least.
const AT_ONCE: usize = 1 << 10;

/// Changes every element, on all threads of the pool that this is called in, if any.
pub(crate) fn for_each_mut<T: Send>(elements: &mut [T], change: impl Fn(&mut T) + Send + Sync) {
    for_each_numbered_mut(elements, |_, element| change(element));
}

/// The same by what depends on the element's number, too.
pub(crate) fn for_each_numbered_mut<T: Send>(
    elements: &mut [T],
    change: impl Fn(usize, &mut T) + Send + Sync,
) {
    let change = |(i, element): (usize, &mut T)| change(i, element);
    match rayon::current_thread_index() {
        Some(_) => elements.par_iter_mut().enumerate().for_each(change),
        None => elements.iter_mut().enumerate().for_each(change),
    }
}

/// The value of every element.
pub(crate) fn values<T: Sync, R: Send>(
    elements: &[T],
    value: impl Fn(&T) -> R + Send + Sync,
) -> Vec<R> {
    numbered(elements.len(), |i| value(&elements[i]))
}

/// The values of `count` elements, each found from its number.
pub(crate) fn numbered<R: Send>(count: usize, value: impl Fn(usize) -> R + Send + Sync) -> Vec<R> {
    match is_shared_out(count) {
        true => {
            let numbers = (0..count).into_par_iter().with_min_len(AT_ONCE);
            numbers.map(value).collect()
        }
        false => (0..count).map(value).collect(),
    }
}

/// Finds the value of every element, and hands the elements with it to `take` in their order.
pub(crate) fn in_order<T: Sync, R: Send>(
    elements: &[T],
    value: impl Fn(usize, &T) -> R + Send + Sync,
    mut take: impl FnMut(&T, R),
) {
    if !is_shared_out(elements.len()) {
        for (i, element) in elements.iter().enumerate() {
            take(element, value(i, element));
        }
        return;
    }
    for (batch, elements) in elements.chunks(AT_A_TIME).enumerate() {
        let shared = elements.par_iter().with_min_len(AT_ONCE).enumerate();
        let values: Vec<R> = shared
            .map(|(i, element)| value(batch * AT_A_TIME + i, element))
            .collect();
        for (element, value) in elements.iter().zip(values) {
            take(element, value);
        }
    }
}

fn is_shared_out(elements: usize) -> bool {
    elements >= MANY && rayon::current_thread_index().is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_change_neither_values_nor_their_order() {
        let elements: Vec<usize> = (0..MANY + 77).collect();
        let all = || {
            let mut taken = Vec::new();
            in_order(
                &elements,
                |i, e| (i, e * 3),
                |e, (i, v)| taken.push((*e, i, v)),
            );
            (values(&elements, |e| e + 1), taken)
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build();
        let alone = all();
        assert_eq!(alone.1[MANY], (MANY, MANY, 3 * MANY));
        assert!(pool.expect("three threads").install(all) == alone);
    }
}
