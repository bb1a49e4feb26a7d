//! The energy of a part of a layer, for solving a large layer in overlapping patches.

use crate::LayerEnergy;
use crate::layer_foundation::LayerFoundation;
use crate::sheet::Sheet;
use crate::stencil::touches;

/// The energy of a layer as a function of some of its vertices, all others standing still.
///
/// It has the stencils that touch a free vertex, in the order of the whole layer, and the vertices of
/// these stencils; of those all that are not free are pinned. Gradient and Hessian are the whole's at
/// the free vertices, bit for bit. Values differ from the whole's by a constant: the energy of the
/// stencils that no free vertex touches.
///
/// Evaluation and [`Self::follow`] cost as much as the part is large, however large the whole is.
#[derive(Clone, Debug)]
pub struct LayerPart {
    numbers: PartNumbers,
    energy: LayerEnergy,
}

impl LayerPart {
    /// The part of `whole` in which the vertices `free` move: ascending, none of them pinned in `whole`.
    /// `None` if `whole` is a pair of sheets.
    ///
    /// # Panics
    /// When `free` is not ascending, or names a vertex that is pinned or not there.
    pub fn new(whole: &LayerEnergy, free: &[u32]) -> Option<Self> {
        let ascending = free.windows(2).all(|pair| pair[0] < pair[1]);
        assert!(ascending, "free vertices are ascending");
        let mut is_free = vec![false; whole.vertex_count()];
        for &vertex in free {
            let moves = whole.blocks().free(vertex).is_some();
            assert!(moves, "vertex {vertex} is pinned in the whole layer");
            is_free[vertex as usize] = true;
        }
        let (numbers, energy) = whole.part(&is_free)?;
        let mut this = Self { numbers, energy };
        this.follow(whole);
        Some(this)
    }

    /// The vertices of the whole layer that the part knows, ascending: free ones and those that a
    /// stencil joins with them. Vertex `i` of [`Self::energy`] is `vertices()[i]` of the whole.
    pub fn vertices(&self) -> &[u32] {
        &self.numbers.vertices
    }

    /// The energy over the part's own vertices; its free vertices are those asked for, in the same
    /// order.
    ///
    /// Forces on pinned vertices are those of the part's stencils alone; a pinned vertex has no
    /// tangential spring. A clone cannot be given another rest metric, natural curvature, bending factor, material, creases
    /// or line anchors, and panics: bending depends on faces that the part has no stencil on.
    pub fn energy(&self) -> &LayerEnergy {
        &self.energy
    }

    /// Takes over rest metric, natural strains and curvatures, rest angles, bending factor, material, creases
    /// and surface below of `whole`, the layer that it was made from.
    pub fn follow(&mut self, whole: &LayerEnergy) {
        self.energy.follow(whole, &self.numbers);
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

impl PartNumbers {
    /// The numbers for free vertices marked among those of the whole layer.
    pub(crate) fn new(is_free: &[bool], sheet: &Sheet, foundation: &LayerFoundation) -> Self {
        let mut is_known = is_free.to_vec();
        for stencil in sheet
            .stencils()
            .filter(|&stencil| touches(stencil, is_free))
        {
            for &vertex in stencil {
                is_known[vertex as usize] = true;
            }
        }
        let vertices = marked(&is_known);
        let [faces, hinges, stars] = sheet.touching(is_free);
        Self {
            is_free: vertices.iter().map(|&v| is_free[v as usize]).collect(),
            vertices,
            faces,
            hinges,
            stars,
            edges: foundation.touching(is_free),
        }
    }
}

/// Numbers of the marked elements, ascending.
pub(crate) fn marked(marks: &[bool]) -> Vec<u32> {
    let numbers = (0..).zip(marks).filter(|&(_, &mark)| mark);
    numbers.map(|(number, _)| number).collect()
}

/// Rank of each of `count` elements in a list of numbers; one that is not in it has a rank that no list
/// is long enough for.
pub(crate) fn ranks(numbers: &[u32], count: usize) -> Vec<u32> {
    let mut ranks = vec![u32::MAX; count];
    for (rank, &number) in (0..).zip(numbers) {
        ranks[number as usize] = rank;
    }
    ranks
}

/// Replaces `target` by the elements of `source` with these numbers.
pub(crate) fn pick<T: Copy>(target: &mut Vec<T>, source: &[T], numbers: &[u32]) {
    target.clear();
    target.extend(numbers.iter().map(|&number| source[number as usize]));
}
