//! Order of the items that a sweep line cuts.

/// An ordered set of numbers, searched by a comparison of the caller's.
///
/// A treap (Seidel & Aragon 1996): a search tree that is also a heap of pseudo-random priorities,
/// which keep it shallow whatever is inserted. Removal compares nothing, so that comparisons which
/// contradict each other, as those of overlapping faces do, cannot damage it.
#[derive(Debug, Clone)]
pub(crate) struct SweepLine {
    root: Option<u32>,
    nodes: Vec<Node>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Node {
    parent: Option<u32>,
    children: [Option<u32>; 2],
    /// The ones before and after it in the order.
    neighbours: [Option<u32>; 2],
}

impl SweepLine {
    /// An empty line for the numbers below `count`.
    pub(crate) fn new(count: usize) -> Self {
        Self {
            root: None,
            nodes: vec![Node::default(); count],
        }
    }

    /// The ones before and after `item`.
    pub(crate) fn neighbours(&self, item: u32) -> [Option<u32>; 2] {
        self.node(item).neighbours
    }

    /// Puts `item`, which is not on the line, before those for which `is_before` holds.
    pub(crate) fn insert(&mut self, item: u32, mut is_before: impl FnMut(u32) -> bool) {
        let mut node = Node::default();
        let mut below = self.root;
        let mut side = 0;
        while let Some(other) = below {
            side = usize::from(!is_before(other));
            node.parent = Some(other);
            // The last node passed on a side is the neighbour there, so the list costs no further
            // search.
            node.neighbours[1 - side] = Some(other);
            below = self.node(other).children[side];
        }
        self.nodes[item as usize] = node;
        match node.parent {
            None => self.root = Some(item),
            Some(parent) => self.nodes[parent as usize].children[side] = Some(item),
        }
        self.link([node.neighbours[0], Some(item)]);
        self.link([Some(item), node.neighbours[1]]);
        // A rotation keeps the order, so the heap is mended without another comparison.
        while let Some(parent) = self.node(item).parent {
            if priority(parent) >= priority(item) {
                break;
            }
            self.lift(item);
        }
    }

    /// Takes `item` off the line; returns those that have become neighbours.
    pub(crate) fn remove(&mut self, item: u32) -> [Option<u32>; 2] {
        // The node sinks until a child is missing. The child of higher priority rises, or the other
        // would end up under a lower one.
        while let [Some(left), Some(right)] = self.node(item).children {
            self.lift(if priority(left) > priority(right) {
                left
            } else {
                right
            });
        }
        let [left, right] = self.node(item).children;
        self.replace(item, left.or(right));
        let neighbours = self.node(item).neighbours;
        self.link(neighbours);
        self.nodes[item as usize] = Node::default();
        neighbours
    }

    fn node(&self, item: u32) -> &Node {
        &self.nodes[item as usize]
    }

    fn link(&mut self, [lower, upper]: [Option<u32>; 2]) {
        if let Some(lower) = lower {
            self.nodes[lower as usize].neighbours[1] = upper;
        }
        if let Some(upper) = upper {
            self.nodes[upper as usize].neighbours[0] = lower;
        }
    }

    /// Swaps `item` with its parent, the order kept.
    fn lift(&mut self, item: u32) {
        let Some(parent) = self.node(item).parent else {
            return;
        };
        let side = usize::from(self.node(parent).children[1] == Some(item));
        let inner = self.node(item).children[1 - side];
        self.nodes[parent as usize].children[side] = inner;
        if let Some(inner) = inner {
            self.nodes[inner as usize].parent = Some(parent);
        }
        self.replace(parent, Some(item));
        self.nodes[item as usize].children[1 - side] = Some(parent);
        self.nodes[parent as usize].parent = Some(item);
    }

    /// Hangs `new` where `old` hangs.
    fn replace(&mut self, old: u32, new: Option<u32>) {
        let parent = self.node(old).parent;
        match parent {
            None => self.root = new,
            Some(parent) => {
                let side = usize::from(self.node(parent).children[1] == Some(old));
                self.nodes[parent as usize].children[side] = new;
            }
        }
        if let Some(new) = new {
            self.nodes[new as usize].parent = parent;
        }
    }
}

/// A repeatable shuffle (the finaliser of MurmurHash3), so that equal input gives equal trees.
fn priority(item: u32) -> u32 {
    let mixed = (item ^ (item >> 16)).wrapping_mul(0x85eb_ca6b);
    let mixed = (mixed ^ (mixed >> 13)).wrapping_mul(0xc2b2_ae35);
    mixed ^ (mixed >> 16)
}
