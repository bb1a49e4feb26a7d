//! Triangle connectivity that can be edited in place: split, flip, collapse.
//!
//! Half-edge `3 f + c` runs from corner `c` of face `f` to corner `c + 1`. Each knows its twin and
//! whether its edge is a feature; each vertex knows one outgoing half-edge, at a border vertex the
//! one that has no twin, so that turning counter-clockwise from it meets every face once.
//! Positions are nobody's business here. Removed faces and vertices keep their slots, marked.

use ruga_mesh::{Id, PerEdge, TriMesh};

/// No half-edge, no vertex.
pub(crate) const NONE: u32 = u32::MAX;

#[derive(Clone, Debug)]
pub(crate) struct HalfEdges {
    /// Tail vertex of every half-edge; `NONE` in removed faces.
    tails: Vec<u32>,
    twins: Vec<u32>,
    features: Vec<bool>,
    /// An outgoing half-edge of every vertex; `NONE` for removed vertices.
    starts: Vec<u32>,
}

/// The half-edge after `h` in its face.
pub(crate) fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// The half-edge before `h` in its face.
pub(crate) fn prev(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

impl HalfEdges {
    /// Copies a mesh; border edges become features.
    ///
    /// # Errors
    /// The vertex at which no face or more than one fan of faces meets.
    pub(crate) fn new(mesh: &TriMesh, features: &PerEdge<bool>) -> Result<Self, u32> {
        let mut tails = Vec::with_capacity(3 * mesh.face_count());
        let mut twins = vec![NONE; 3 * mesh.face_count()];
        let mut marks = Vec::with_capacity(3 * mesh.face_count());
        let mut first = vec![NONE; mesh.edges().len()];
        for (face, vertices) in mesh.faces().iter() {
            for (corner, edge) in mesh.face_edges(face).into_iter().enumerate() {
                let h = 3 * face.0 + corner as u32;
                tails.push(vertices[corner].0);
                // The border counts whether it is marked or not: nothing may move off it.
                marks.push(features[edge] || mesh.edges()[edge].is_border());
                match std::mem::replace(&mut first[edge.index()], h) {
                    NONE => {}
                    other => {
                        twins[h as usize] = other;
                        twins[other as usize] = h;
                    }
                }
            }
        }
        let mut result = Self {
            tails,
            twins,
            features: marks,
            starts: vec![NONE; mesh.vertex_count()],
        };
        result.find_starts(mesh)?;
        Ok(result)
    }

    fn find_starts(&mut self, mesh: &TriMesh) -> Result<(), u32> {
        for h in 0..self.tails.len() as u32 {
            let tail = self.tail(h) as usize;
            if self.starts[tail] == NONE {
                self.starts[tail] = self.clockwise_most(h);
            }
        }
        for (v, &start) in self.starts.iter().enumerate() {
            let faces = mesh.vertex_faces(Id::from_index(v)).len();
            // Turning around a vertex stays in one fan, so a second one shows as faces that were
            // not met.
            if start == NONE || self.outgoing(v as u32).count() != faces {
                return Err(v as u32);
            }
        }
        Ok(())
    }

    /// Number of vertex slots, removed ones included.
    pub(crate) fn vertex_slots(&self) -> usize {
        self.starts.len()
    }

    /// Number of face slots, removed ones included.
    pub(crate) fn face_slots(&self) -> usize {
        self.tails.len() / 3
    }

    pub(crate) fn tail(&self, h: u32) -> u32 {
        self.tails[h as usize]
    }

    pub(crate) fn head(&self, h: u32) -> u32 {
        self.tails[next(h) as usize]
    }

    /// The vertex opposite a half-edge in its face.
    pub(crate) fn apex(&self, h: u32) -> u32 {
        self.tails[prev(h) as usize]
    }

    pub(crate) fn twin(&self, h: u32) -> Option<u32> {
        let twin = self.twins[h as usize];
        (twin != NONE).then_some(twin)
    }

    pub(crate) fn is_feature(&self, h: u32) -> bool {
        self.features[h as usize]
    }

    /// The end of an edge that is not `v`.
    pub(crate) fn other_end(&self, h: u32, v: u32) -> u32 {
        if self.tail(h) == v {
            self.head(h)
        } else {
            self.tail(h)
        }
    }

    pub(crate) fn is_alive_vertex(&self, v: u32) -> bool {
        self.starts[v as usize] != NONE
    }

    /// Corners of a face; `None` where it was removed.
    pub(crate) fn face(&self, f: u32) -> Option<[u32; 3]> {
        let i = 3 * f as usize;
        let corners = [self.tails[i], self.tails[i + 1], self.tails[i + 2]];
        (corners[0] != NONE).then_some(corners)
    }

    /// One half-edge of every edge, in order.
    pub(crate) fn edges(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.tails.len() as u32)
            .filter(|&h| self.tail(h) != NONE && self.twin(h).is_none_or(|t| h < t))
    }

    /// Outgoing half-edges of a vertex, counter-clockwise: one for each face.
    pub(crate) fn outgoing(&self, v: u32) -> Outgoing<'_> {
        let start = self.starts[v as usize];
        Outgoing {
            mesh: self,
            start,
            current: start,
        }
    }

    pub(crate) fn is_border_vertex(&self, v: u32) -> bool {
        self.twin(self.starts[v as usize]).is_none()
    }

    /// Neighbours of a vertex, counter-clockwise, each with whether its edge is a feature.
    pub(crate) fn neighbours(&self, v: u32) -> impl Iterator<Item = (u32, bool)> + '_ {
        let mut last = NONE;
        let inner = self
            .outgoing(v)
            .map(move |h| (self.head(h), self.is_feature(h)));
        // At a border the last face has one more edge, which no outgoing half-edge runs.
        if self.is_border_vertex(v) {
            last = self.outgoing(v).last().map_or(NONE, prev);
        }
        let extra = (last != NONE).then(|| (self.tail(last), self.is_feature(last)));
        inner.chain(extra)
    }

    /// Says whether an edge joins two vertices.
    pub(crate) fn are_joined(&self, a: u32, b: u32) -> bool {
        self.neighbours(a).any(|(v, _)| v == b)
    }

    fn clockwise_most(&self, h: u32) -> u32 {
        let mut current = h;
        while let Some(twin) = self.twin(current) {
            current = next(twin);
            if current == h {
                break;
            }
        }
        current
    }

    fn add_face(&mut self, corners: [u32; 3]) -> u32 {
        let h = self.tails.len() as u32;
        self.tails.extend(corners);
        self.twins.extend([NONE; 3]);
        self.features.extend([false; 3]);
        h
    }

    fn join(&mut self, a: u32, b: u32, feature: bool) {
        for (h, other) in [(a, b), (b, a)] {
            if h != NONE {
                self.twins[h as usize] = other;
                self.features[h as usize] = feature;
            }
        }
    }

    /// Moves what `from` knows about its edge to the half-edge `to`.
    fn hand_over(&mut self, from: (u32, bool), to: u32) {
        self.join(to, from.0, from.1);
    }

    fn link(&self, h: u32) -> (u32, bool) {
        (self.twins[h as usize], self.features[h as usize])
    }

    /// Renumbers: vertex `vertices[i]` becomes `i`, faces follow the lowest of their new vertices.
    ///
    /// Only for meshes without removed vertices or faces.
    pub(crate) fn renumber(&mut self, vertices: &[u32]) {
        let mut number = vec![0; vertices.len()];
        for (new, &old) in vertices.iter().enumerate() {
            number[old as usize] = new as u32;
        }
        let mut faces: Vec<(u32, u32)> = (0..self.face_slots() as u32)
            .map(|f| (self.lowest_corner(f, &number), f))
            .collect();
        faces.sort_unstable();
        let mut half_edge = vec![NONE; self.tails.len()];
        for (new, &(_, old)) in faces.iter().enumerate() {
            for corner in 0..3 {
                half_edge[(3 * old + corner) as usize] = 3 * new as u32 + corner;
            }
        }
        // A permutation in place would read what it has already written.
        let before = self.clone();
        for (h, &new) in half_edge.iter().enumerate() {
            let twin = before.twins[h];
            self.tails[new as usize] = number[before.tails[h] as usize];
            self.features[new as usize] = before.features[h];
            self.twins[new as usize] = if twin == NONE {
                NONE
            } else {
                half_edge[twin as usize]
            };
        }
        for (new, &old) in vertices.iter().enumerate() {
            self.starts[new] = half_edge[before.starts[old as usize] as usize];
        }
    }

    fn lowest_corner(&self, face: u32, number: &[u32]) -> u32 {
        (3 * face..3 * face + 3)
            .map(|h| number[self.tail(h) as usize])
            .fold(NONE, u32::min)
    }

    /// Puts a new vertex on an edge; returns it. Its half-edges are features as the edge was.
    ///
    /// ```text
    ///        c                    c
    ///      / f \                / | \
    ///     a --h-> b    ->      a--m--b     (below: the same with d, where there is a twin)
    /// ```
    pub(crate) fn split(&mut self, h: u32) -> u32 {
        let n = next(h);
        let (b, c) = (self.head(h), self.apex(h));
        let (twin, feature) = self.link(h);
        let m = self.starts.len() as u32;
        // The old face keeps its slot and `h` its tail, so half-edges in callers' lists stay what
        // they were; only the far half is new.
        let m_to_b = self.add_face([m, b, c]);
        let outer = self.link(n);
        self.tails[n as usize] = m;
        self.hand_over(outer, m_to_b + 1);
        self.join(n, m_to_b + 2, false);
        // The half-edge that left `b` here now leaves `m`.
        if self.starts[b as usize] == n {
            self.starts[b as usize] = m_to_b + 1;
        }
        self.features[m_to_b as usize] = feature;
        // On a border the start is the half-edge without a twin.
        self.starts.push(if twin == NONE { m_to_b } else { n });
        if twin != NONE {
            self.split_other_side(twin, m, m_to_b);
        }
        m
    }

    fn split_other_side(&mut self, t: u32, m: u32, m_to_b: u32) {
        let (b, d, p) = (self.tail(t), self.apex(t), prev(t));
        let b_to_m = self.add_face([b, m, d]);
        let (outer, feature) = (self.link(p), self.is_feature(t));
        self.tails[t as usize] = m;
        self.hand_over(outer, b_to_m + 2);
        self.join(p, b_to_m + 1, false);
        self.join(m_to_b, b_to_m, feature);
        if self.starts[b as usize] == t {
            self.starts[b as usize] = b_to_m;
        }
        if self.starts[d as usize] == p {
            self.starts[d as usize] = b_to_m + 2;
        }
    }

    /// Replaces the edge of `h` by the other diagonal of its two faces, which must exist.
    ///
    /// ```text
    ///       c              c
    ///      / \            /|\
    ///     a-h>b    ->    a | b       h then runs d -> c, its twin c -> d
    ///      \ /            \|/
    ///       d              d
    /// ```
    pub(crate) fn flip(&mut self, h: u32) {
        let t = self.twins[h as usize];
        debug_assert!(t != NONE, "only edges with two faces are flipped");
        let (n, p, tn, tp) = (next(h), prev(h), next(t), prev(t));
        let (a, b, c, d) = (self.tail(h), self.tail(t), self.apex(h), self.apex(t));
        // All links are read before the first is written.
        let [at_n, at_p, at_tn, at_tp] = [n, p, tn, tp].map(|e| self.link(e));
        // `h` and `t` stay the flipped edge: queues of callers hold on to them.
        for (edge, tail) in [(h, d), (n, c), (p, a), (t, c), (tn, d), (tp, b)] {
            self.tails[edge as usize] = tail;
        }
        self.hand_over(at_p, n);
        self.hand_over(at_tn, p);
        self.hand_over(at_tp, tn);
        self.hand_over(at_n, tp);
        for (vertex, old, new) in [
            (a, [h, tn], p),
            (b, [t, n], tp),
            (c, [p, p], n),
            (d, [tp, tp], tn),
        ] {
            if old.contains(&self.starts[vertex as usize]) {
                self.starts[vertex as usize] = new;
            }
        }
    }

    /// Merges the vertex `gone`, one end of `h`, into the other end; the faces at the edge vanish.
    ///
    /// The caller has checked [`HalfEdges::can_collapse`].
    pub(crate) fn collapse(&mut self, h: u32, gone: u32) {
        let kept = self.other_end(h, gone);
        let around: Vec<u32> = self.outgoing(gone).collect();
        let sides = [Some(h), self.twin(h)];
        for &edge in &around {
            self.tails[edge as usize] = kept;
        }
        self.starts[gone as usize] = NONE;
        let mut at_kept = NONE;
        for side in sides.into_iter().flatten() {
            let apex = self.apex(side);
            let (n, p) = (next(side), prev(side));
            let (after, before) = (self.link(n), self.link(p));
            // Two edges become one. That not both are features has been checked by `can_collapse`.
            self.join(after.0, before.0, after.1 || before.1);
            for edge in [side, n, p] {
                self.tails[edge as usize] = NONE;
                self.twins[edge as usize] = NONE;
            }
            // Of the joined pair, one runs away from the apex and one towards it.
            let survivor = if after.0 == NONE { before.0 } else { after.0 };
            let (out, other) = if self.tail(survivor) == apex {
                (survivor, next(survivor))
            } else {
                (next(survivor), survivor)
            };
            // The start may have been in the vanished face. At a border it must be the half-edge
            // without a twin, hence the turn.
            self.starts[apex as usize] = self.clockwise_most(out);
            at_kept = other;
        }
        self.starts[kept as usize] = self.clockwise_most(at_kept);
    }

    /// Says whether merging the ends of `h` leaves a manifold mesh with the same features.
    pub(crate) fn can_collapse(&self, h: u32) -> bool {
        let (a, b) = (self.tail(h), self.head(h));
        let twin = self.twin(h);
        // An inner edge from border to border: the surface would be pinched to a point.
        if twin.is_some() && self.is_border_vertex(a) && self.is_border_vertex(b) {
            return false;
        }
        // The link condition: another common neighbour than the apexes would leave two faces on the
        // same three vertices.
        let common = self
            .neighbours(a)
            .filter(|&(v, _)| self.are_joined(b, v))
            .count();
        let expected = 1 + usize::from(twin.is_some());
        common == expected
            && [Some(h), twin]
                .into_iter()
                .flatten()
                .all(|s| self.side_can_vanish(s))
    }

    /// Says whether the apex of a vanishing face keeps enough faces and no two features become one.
    fn side_can_vanish(&self, side: u32) -> bool {
        let (n, p, apex) = (next(side), prev(side), self.apex(side));
        let two_features = self.is_feature(n) && self.is_feature(p);
        let faces = self.outgoing(apex).count();
        // One of them vanishes. Three must stay around an inner vertex, one at a border.
        let least = if self.is_border_vertex(apex) { 2 } else { 4 };
        !two_features && faces >= least
    }
}

/// See [`HalfEdges::outgoing`].
pub(crate) struct Outgoing<'a> {
    mesh: &'a HalfEdges,
    start: u32,
    current: u32,
}

impl Iterator for Outgoing<'_> {
    type Item = u32;

    fn next(&mut self) -> Option<u32> {
        let h = self.current;
        if h == NONE {
            return None;
        }
        // The twin of the half-edge before leaves the same vertex in the next face
        // counter-clockwise. At a border there is none, and the turn ends.
        let turned = self.mesh.twins[prev(h) as usize];
        self.current = if turned == self.start { NONE } else { turned };
        Some(h)
    }
}

#[cfg(test)]
mod tests;
