//! Merging of the nodes that neighbouring elements share.

use petgraph::unionfind::UnionFind;

use crate::Shape;
use crate::pieces::Link;

/// Gives every element nodes of its own, then merges those of linked elements that lie at the same
/// place: 18 of 27, or 4 of 8 (RK 5.1, figure 5).
///
/// Returns the node numbers of all elements, one element after the other, and how many nodes there
/// are. Nodes are numbered in the order in which elements name them.
pub(crate) fn merge_nodes(elements: usize, links: &[Link], shape: Shape) -> (Vec<u32>, usize) {
    let per_element = shape.nodes_per_element();
    // Elements around an edge of the grid share nodes through chains of neighbours. Superimposed
    // ones that no chain joins keep theirs apart: that is how lips do not stick.
    let mut groups: UnionFind<usize> = UnionFind::new(elements * per_element);
    for link in links {
        let [lower, upper] = link.pieces.map(|element| element * per_element);
        for (low, high) in shared_nodes(shape, link.axis) {
            groups.union(lower + low, upper + high);
        }
    }
    // Numbers do not come from the groups' names, which depend on the order of the links.
    let mut number = vec![u32::MAX; elements * per_element];
    let mut count = 0;
    let nodes = (0..elements * per_element)
        .map(|copy| {
            let slot = &mut number[groups.find(copy)];
            if *slot == u32::MAX {
                *slot = count;
                count += 1;
            }
            *slot
        })
        .collect();
    (nodes, count as usize)
}

/// Pairs of local nodes, of an element and of its upper neighbour along `axis`, at the same place.
fn shared_nodes(shape: Shape, axis: usize) -> impl Iterator<Item = (usize, usize)> {
    let n = shape.nodes_per_axis();
    let step = n.pow(2 - axis as u32);
    // The upper element begins one step further along the axis: the lower one's first nodes have no
    // counterpart in it.
    let is_shared = move |local: usize| !(local / step).is_multiple_of(n);
    (0..n * n * n)
        .filter(move |&local| is_shared(local))
        .map(move |local| (local, local - step))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eighteen_of_27_and_four_of_8_are_shared() {
        for axis in 0..3 {
            assert_eq!(shared_nodes(Shape::Quadratic, axis).count(), 18);
            assert_eq!(shared_nodes(Shape::Linear, axis).count(), 4);
        }
        assert!(shared_nodes(Shape::Linear, 0).eq([(4, 0), (5, 1), (6, 2), (7, 3)]));
        assert!(shared_nodes(Shape::Linear, 2).eq([(1, 0), (3, 2), (5, 4), (7, 6)]));
    }

    #[test]
    fn a_row_of_elements_has_two_nodes_more_than_elements() {
        let links: Vec<Link> = (0..4)
            .map(|i| Link {
                pieces: [i, i + 1],
                axis: 1,
            })
            .collect();
        assert_eq!(merge_nodes(5, &links, Shape::Quadratic).1, 7 * 9);
        assert_eq!(merge_nodes(5, &links, Shape::Linear).1, 6 * 4);
        assert_eq!(merge_nodes(5, &[], Shape::Linear).1, 5 * 8);
    }
}
