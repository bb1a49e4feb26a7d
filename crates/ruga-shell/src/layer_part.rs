//! The energy of a part of a layer, for solving a large layer in overlapping patches.

use crate::LayerEnergy;
use crate::sheet::Sheet;

/// The energy of a layer as a function of some of its vertices, all others standing still.
///
/// It has the stencils that touch a free vertex, in the order of the whole layer, and the vertices of
/// these stencils; of those all that are not free are pinned. Gradient and Hessian are the whole's at
/// the free vertices, bit for bit. Values differ from the whole's by a constant: the energy of the
/// stencils that no free vertex touches.
///
/// [`PartIndex::part`] makes it. That, evaluation and [`Self::follow`] cost as much as the part is large, however
/// large the whole is.
#[derive(Clone, Debug)]
pub struct LayerPart {
    numbers: PartNumbers,
    energy: LayerEnergy,
}

impl LayerPart {
    /// The vertices of the whole layer that the part knows, ascending: free ones and those that a
    /// stencil joins with them. Vertex `i` of [`Self::energy`] is `vertices()[i]` of the whole.
    pub fn vertices(&self) -> &[u32] {
        &self.numbers.vertices
    }

    /// The energy over the part's own vertices; its free vertices are those asked for, in the same
    /// order.
    ///
    /// Forces on pinned vertices are those of the part's stencils alone; a pinned vertex has no
    /// tangential spring. A clone cannot be given another rest metric, natural curvature, bending factor, material,
    /// creases, line anchors or stiffness on the gradient of the drift, and panics: these depend on faces that the part
    /// has no stencil on.
    pub fn energy(&self) -> &LayerEnergy {
        &self.energy
    }

    /// Takes over rest metric, natural strains and curvatures, rest angles, bending factor, material, creases,
    /// stiffness on the gradient of the drift and surface below of `whole`, the layer that it was made from.
    pub fn follow(&mut self, whole: &LayerEnergy) {
        self.energy.follow(whole, &self.numbers);
    }
}

/// Index from a layer's vertices to the stencils on them, to make parts of the layer from.
#[derive(Clone, Debug)]
pub struct PartIndex {
    faces: AtVertices,
    hinges: AtVertices,
    stars: AtVertices,
    /// Edges of the foundation.
    edges: AtVertices,
}

impl PartIndex {
    /// Index of a layer; `None` if it is a pair of sheets.
    pub fn new(whole: &LayerEnergy) -> Option<Self> {
        let (sheet, foundation) = whole.one_sheet()?;
        let count = whole.vertex_count();
        let faces = || sheet.faces().iter().map(<[u32; 3]>::as_slice);
        let bending = sheet.bending();
        Some(Self {
            faces: AtVertices::new(count, faces),
            hinges: AtVertices::new(count, || bending.hinge_stencils().map(<[u32; 4]>::as_slice)),
            stars: AtVertices::new(count, || bending.star_stencils()),
            edges: AtVertices::new(count, || foundation.edge_stencils()),
        })
    }

    /// The part of `whole` in which the vertices `free` move: ascending, none of them pinned in `whole`, which must
    /// be the layer of this index.
    ///
    /// # Panics
    /// When `free` is not ascending, or names a vertex that is pinned or not there.
    pub fn part(&self, whole: &LayerEnergy, free: &[u32]) -> LayerPart {
        let ascending = free.windows(2).all(|pair| pair[0] < pair[1]);
        assert!(ascending, "free vertices are ascending");
        for &vertex in free {
            let moves = whole.blocks().free(vertex).is_some();
            assert!(moves, "vertex {vertex} is pinned in the whole layer");
        }
        let (sheet, _) = whole
            .one_sheet()
            .expect("the layer of an index has one sheet");
        let numbers = self.numbers(sheet, free);
        let energy = whole.part(&numbers);
        let mut part = LayerPart { numbers, energy };
        part.follow(whole);
        part
    }

    /// The numbers of what a part with these `free` vertices has.
    fn numbers(&self, sheet: &Sheet, free: &[u32]) -> PartNumbers {
        let faces = self.faces.touching(free);
        let mut hinges = self.hinges.touching(free);
        let stars = self.stars.touching(free);
        let mut vertices = free.to_vec();
        let corners = faces.iter().map(|&face| &sheet.faces()[face as usize]);
        vertices.extend(corners.flatten());
        let bending = sheet.bending();
        vertices.extend(hinges.iter().flat_map(|&hinge| bending.hinge(hinge)));
        vertices.extend(stars.iter().flat_map(|&star| bending.star(star).0));
        // Their vertices are those of the stars.
        hinges.extend(stars.iter().flat_map(|&star| bending.star(star).1));
        for numbers in [&mut vertices, &mut hinges] {
            numbers.sort_unstable();
            numbers.dedup();
        }
        PartNumbers {
            is_free: vertices
                .iter()
                .map(|v| free.binary_search(v).is_ok())
                .collect(),
            vertices,
            faces,
            hinges,
            stars,
            edges: self.edges.touching(free),
        }
    }
}

/// The numbers of the stencils at every vertex.
#[derive(Clone, Debug)]
struct AtVertices {
    starts: Vec<u32>,
    numbers: Vec<u32>,
}

impl AtVertices {
    fn new<'a, I: Iterator<Item = &'a [u32]>>(count: usize, stencils: impl Fn() -> I) -> Self {
        let mut starts = vec![0; count + 1];
        for &vertex in stencils().flatten() {
            starts[vertex as usize + 1] += 1;
        }
        for vertex in 0..count {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut numbers = vec![0; starts[count] as usize];
        for (number, stencil) in (0..).zip(stencils()) {
            for &vertex in stencil {
                let place = &mut next[vertex as usize];
                numbers[*place as usize] = number;
                *place += 1;
            }
        }
        Self { starts, numbers }
    }

    /// Numbers of the stencils with any of `vertices`, ascending.
    fn touching(&self, vertices: &[u32]) -> Vec<u32> {
        let at = |&v: &u32| {
            let range = self.starts[v as usize]..self.starts[v as usize + 1];
            &self.numbers[range.start as usize..range.end as usize]
        };
        let mut all: Vec<u32> = vertices.iter().flat_map(at).copied().collect();
        all.sort_unstable();
        all.dedup();
        all
    }
}

/// Numbers in a whole layer of what a part of it has, each list ascending.
#[derive(Clone, Debug)]
pub(crate) struct PartNumbers {
    pub(crate) vertices: Vec<u32>,
    /// Whether each of `vertices` moves.
    pub(crate) is_free: Vec<bool>,
    pub(crate) faces: Vec<u32>,
    pub(crate) hinges: Vec<u32>,
    pub(crate) stars: Vec<u32>,
    /// Edges of the foundation.
    pub(crate) edges: Vec<u32>,
}

/// Rank of a number in an ascending list; of one that is not in it a rank that no list is long enough for.
pub(crate) fn rank(numbers: &[u32], number: u32) -> u32 {
    numbers
        .binary_search(&number)
        .map_or(u32::MAX, |rank| rank as u32)
}

/// Replaces `target` by the elements of `source` with these numbers.
pub(crate) fn pick<T: Copy>(target: &mut Vec<T>, source: &[T], numbers: &[u32]) {
    target.clear();
    target.extend(numbers.iter().map(|&number| source[number as usize]));
}
