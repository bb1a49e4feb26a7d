//! How a mesh is divided into patches.

use nalgebra::Vector3;

/// Divides some vertices into groups of at most `most`, halving the longest side of the box around them;
/// each group is ascending.
pub(super) fn divided(
    positions: &[Vector3<f64>],
    mut some: Vec<u32>,
    most: usize,
) -> Vec<Vec<u32>> {
    if some.len() <= most {
        some.sort_unstable();
        return vec![some];
    }
    let corners = some.iter().map(|&v| positions[v as usize]);
    let (low, high) = corners.fold(
        (positions[some[0] as usize], positions[some[0] as usize]),
        |(low, high), x| (low.inf(&x), high.sup(&x)),
    );
    let axis = (high - low).imax();
    // Vertices at the same place go by their number.
    some.sort_by(|&a, &b| {
        let [x, y] = [a, b].map(|v| positions[v as usize][axis]);
        x.total_cmp(&y).then(a.cmp(&b))
    });
    let upper = some.split_off(some.len() / 2);
    let halves = [some, upper].into_iter();
    halves
        .flat_map(|half| divided(positions, half, most))
        .collect()
}

/// Groups of numbers of which no two are neighbours, each ascending.
pub(super) fn coloured(neighbours: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let mut colours: Vec<Vec<usize>> = Vec::new();
    for (i, near) in neighbours.iter().enumerate() {
        let is_apart = |group: &&mut Vec<usize>| near.iter().all(|j| !group.contains(j));
        match colours.iter_mut().find(is_apart) {
            Some(group) => group.push(i),
            None => colours.push(vec![i]),
        }
    }
    colours
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rows of vertices along x.
    fn strip(length: u32) -> Vec<Vector3<f64>> {
        let corner = |i: u32| Vector3::new(f64::from(i / 2), f64::from(i % 2), 0.0);
        (0..2 * length + 2).map(corner).collect()
    }

    #[test]
    fn groups_are_small_and_hold_every_vertex_once() {
        let positions = strip(49);
        let some: Vec<u32> = (0..100).rev().filter(|v| v % 3 > 0).collect();
        let groups = divided(&positions, some.clone(), 20);
        assert!(
            groups
                .iter()
                .all(|group| group.len() <= 20 && group.is_sorted())
        );
        let mut all = groups.concat();
        all.sort_unstable();
        let mut wanted = some;
        wanted.sort_unstable();
        assert_eq!(all, wanted);
        // They lie side by side along the strip.
        let ends = groups
            .iter()
            .map(|group| (group[0], group[group.len() - 1]));
        let ends: Vec<_> = ends.collect();
        assert!(
            ends.windows(2).all(|pair| pair[0].1 < pair[1].0),
            "{ends:?}"
        );
    }

    #[test]
    fn places_that_coincide_are_divided_too() {
        let positions = vec![Vector3::zeros(); 9];
        let groups = divided(&positions, (0..9).collect(), 2);
        assert!(groups.iter().all(|group| group.len() <= 2));
        assert_eq!(groups.concat().len(), 9);
    }

    #[test]
    fn no_two_neighbours_have_one_colour() {
        let ring: Vec<Vec<usize>> = (0..5).map(|i| vec![(i + 4) % 5, (i + 1) % 5]).collect();
        assert_eq!(coloured(&ring), [vec![0, 2], vec![1, 3], vec![4]]);
    }
}
