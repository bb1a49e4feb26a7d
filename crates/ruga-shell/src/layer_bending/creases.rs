//! Creases in the bending of a layer: where they are put and how they are folded.

use nalgebra::Vector3;
use ruga_mesh::{EdgeId, Id};

use super::LayerBending;
use crate::crease::Crease;
use crate::layer_creases::{HingeCrease, SizedCrease, star_branches};
use crate::{CreaseState, FaceParameters, RestTriangle, ShellError};

impl LayerBending {
    /// Replaces all creases; stiffness is to be recomputed by [`Self::size_creases`].
    pub(crate) fn set_creases(&mut self, creases: &[(EdgeId, Crease)]) -> Result<(), ShellError> {
        let edges = self.hinges.iter().map(|element| element.edge.index() + 1);
        let mut hinge_of = vec![None; edges.max().unwrap_or(0)];
        for (hinge, element) in (0..).zip(&self.hinges) {
            hinge_of[element.edge.index()] = Some(hinge);
        }
        let mut placed = Vec::with_capacity(creases.len());
        let mut crease_at = vec![None; self.hinges.len()];
        for (number, &(edge, crease)) in (0..).zip(creases) {
            let index = edge.index();
            crease.check(index)?;
            let hinge: Option<u32> = hinge_of.get(index).copied().flatten();
            let hinge = hinge.ok_or(ShellError::CreaseOutside { edge: index })?;
            let before = crease_at[hinge as usize].replace(number);
            if before.is_some() {
                return Err(ShellError::CreaseTwice { edge: index });
            }
            placed.push(HingeCrease { hinge, crease });
        }
        self.clear_creases();
        let is_plain = |number: &u32| placed[*number as usize].crease.is_plain();
        for (index, star) in (0..).zip(&self.stars) {
            let folds = (0..).zip(&star.hinges);
            let creased =
                folds.filter_map(|(fold, &hinge)| Some((fold, crease_at[hinge as usize]?)));
            let creased: Vec<_> = creased.filter(|(_, number)| !is_plain(number)).collect();
            if !creased.is_empty() {
                self.creased_stars.push((index, creased));
            }
        }
        self.creases = placed;
        Ok(())
    }

    fn clear_creases(&mut self) {
        for (star, _) in self.creased_stars.drain(..) {
            self.stars[star as usize].branches.clear();
        }
        for HingeCrease { hinge, .. } in self.creases.drain(..) {
            self.hinges[hinge as usize].crease = None;
        }
    }

    /// Recomputes what creases do under a rest metric, whose stars and hinges have their stiffness.
    pub(crate) fn size_creases(&mut self, rest: &[RestTriangle], parameters: &[FaceParameters]) {
        let sized = self.creases.iter().map(|at| {
            let sides = self.hinges[at.hinge as usize].sides();
            SizedCrease::in_layer(at.crease, sides, rest, parameters)
        });
        let sized: Vec<_> = sized.collect();
        for (star, creased) in &self.creased_stars {
            let element = &mut self.stars[*star as usize];
            let creased = creased.iter().map(|&(fold, c)| (fold, sized[c as usize]));
            let creased: Vec<_> = creased.collect();
            element.branches = star_branches(&creased, (&element.star, rest), &element.rows);
        }
        if self.stars.is_empty() {
            for (at, sized) in self.creases.iter().zip(&sized) {
                let element = &mut self.hinges[at.hinge as usize];
                let branch = sized.of_hinge(element.hinge.stiffness);
                element.crease = (!at.crease.is_plain()).then(|| Box::new(branch));
            }
        }
    }

    /// How every crease is folded, in the order in which they were set.
    pub(crate) fn crease_states(&self, x: &[Vector3<f64>]) -> Vec<CreaseState> {
        let mut states = vec![CreaseState::default(); self.creases.len()];
        if self.stars.is_empty() {
            for (at, target) in self.creases.iter().zip(&mut states) {
                let element = &self.hinges[at.hinge as usize];
                if let Some(branch) = &element.crease {
                    let fold = element.fold(branch, &element.state(x));
                    (target.angle, target.energy) = fold.state(branch);
                }
            }
            return states;
        }
        let bends = self.bends(x);
        let mut stars = vec![0.0; states.len()];
        for (star, creased) in &self.creased_stars {
            let element = &self.stars[*star as usize];
            let Some(fold) = element.fold(&bends) else {
                continue;
            };
            for branch in &element.branches {
                let (angle, energy) = fold.state(branch);
                let folds: Vec<_> = branch.folds.into_iter().flatten().collect();
                let members = creased.iter().filter(|(at, _)| folds.contains(at));
                for &(_, crease) in members {
                    let target = &mut states[crease as usize];
                    target.angle += angle;
                    target.energy += energy / folds.len() as f64;
                    stars[crease as usize] += 1.0;
                }
            }
        }
        for (state, stars) in states.iter_mut().zip(stars) {
            // The stars at both ends of an edge measure the same fold.
            state.angle /= f64::max(stars, 1.0);
        }
        states
    }
}
