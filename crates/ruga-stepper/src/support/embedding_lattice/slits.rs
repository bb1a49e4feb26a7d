//! Slits: flesh that is cut below creases, while the layer goes across.

#[cfg(test)]
mod tests;

use nalgebra::Vector3;
use ruga_blend::{Driver, Smoothing, SurfacePoints};
use ruga_crease::CreaseEdge;
use ruga_lattice::{Embedding, Lattice, LatticeError, MAX_CELLS, Shape, cell_size};
use ruga_mesh::{FaceId, Id, MaterialPoint, vertex_normals};

use super::lips::Lips;
use super::{EmbeddingLattice, Faces, Walls, spec_of, surface_of};
use crate::error::{Checked, refuse, setting};
use crate::skin::boundary_cut::Cut;
use crate::skin::crease_cut::{Creased, cut_along_creases};
use crate::skin::piece::Piece;
use crate::support::slit_carving::{Carved, Meeting, SlitEdge, carve};
use crate::validation::{less_than_flesh, of_crease};
use crate::{Body, CreaseSpec, LayerSpec, StepperError};

/// Width of a slit at rest, in cells.
const OPENING: f64 = 1e-3;

/// Share of a cell that will do as one: cells are a little larger than what they divide.
const NEARLY: f64 = 0.999;

/// The way down the walls, as fractions of their depth, at which they are compared.
const DOWN: [f64; 2] = [0.0, 0.5];

/// Distance along the line, in depths of the slit, over which the direction of its walls is the mean of the normals.
/// Normals that turn from vertex to vertex, some of which are a hundredth of an edge apart, would fold deep walls.
const REACH: f64 = 2.0;

/// A crease with a slit.
struct Slit<'a> {
    /// Owner in messages.
    of: String,
    crease: &'a CreaseSpec,
    depth: f64,
    /// Depth of the body below it, m.
    flesh: f64,
}

impl EmbeddingLattice {
    /// The body with its flesh cut below the creases of `layers` that say so, each over so much `flesh` (m).
    ///
    /// The surface is opened to thin wedges, and the lattice built anew: a slit that crosses a cell parts it in two
    /// elements, like the lips of a mouth that is closed. Layers keep their addresses on the surface without slits.
    ///
    /// # Errors
    /// A slit that is shallower than a cell, as deep as the body or as its anchor, that meets another one or itself, or
    /// that parts no cell.
    pub(crate) fn with_slits(
        self,
        (driver, smoothing): (&Driver, Smoothing),
        body: &Body,
        layers: &[LayerSpec],
        flesh: &[Vec<f64>],
    ) -> Result<Self, StepperError> {
        let slits = slits_of(layers, flesh);
        if slits.is_empty() {
            return Ok(self);
        }
        for slit in &slits {
            self.check_depth(slit)?;
        }
        let creases: Vec<CreaseSpec> = slits.iter().map(|slit| slit.crease.clone()).collect();
        // Lines end at edges of this surface, so that it has to be fine without smoothing, too.
        let surface = surface_of(driver, smoothing, true);
        let cut = cut_along_creases(driver, &creases, Cut::none(Piece::of(&surface)));
        let points = SurfacePoints::new(driver, cut.piece.points.clone(), smoothing);
        let positions = points.pose(driver.rest()).positions;
        // Of the triangles themselves: those of an artist's flat faces are mixed from their corners.
        let normals = vertex_normals(&cut.piece.mesh, &positions);
        let edges = slit_edges(&cut, &slits, &normals);
        let opening = OPENING * self.lattice.cell_size().min();
        let carved = carve(&cut.piece.mesh, &positions, &edges, opening);
        let carved = carved.map_err(|Meeting(pair)| meeting(&slits, pair))?;
        let lattice = Lattice::build(&carved.mesh, &carved.positions, &spec_of(body, self.cells));
        let before = cut.piece.mesh.face_count();
        let lattice = lattice.map_err(|error| in_a_slit(error, &slits, (&carved, before)))?;
        let walls = walls(&lattice, &carved, &slits)?;
        if let Some(number) = walls.closed() {
            let whole = match body.shape {
                Shape::Quadratic => "three",
                Shape::Linear => "two",
            };
            let accepted = format!(
                "one that crosses at least {whole} cells of the lattice from side to side, which are up to {:.2} mm \
                 long: lengthen the line, or raise `cells`",
                1e3 * lattice.cell_size().max()
            );
            let slit = &slits[number];
            let found = format!("{} m, but nothing can open it", slit.depth);
            refuse(&slit.of, "slit", found, accepted)?;
        }
        let of_driver = driver.topology().face_count();
        let lines = slits.iter().map(|slit| &slit.crease.line);
        let lips = Lips::new(driver, lines, (&cut.piece.origins, carved.touches));
        Ok(Self {
            lattice,
            faces: Faces::new(&cut.piece.origins, of_driver, Some(lips)),
            walls: Some(walls),
            ..self
        })
    }

    fn check_depth(&self, slit: &Slit<'_>) -> Checked {
        let depth = slit.depth;
        let found = format!("{depth} m");
        if depth >= slit.flesh {
            return refuse(&slit.of, "slit", found, less_than_flesh(slit.flesh));
        }
        let cell = self.lattice.cell_size().max();
        let reaches = |cell: f64| depth >= NEARLY * cell;
        if !reaches(cell) {
            let mut finer = self.cells + 1..=MAX_CELLS;
            let enough = finer.find(|&cells| reaches(cell_size(&self.sides, cells).max()));
            let advice = match enough {
                Some(cells) => format!("a deeper one, or `cells = {cells}`"),
                None => "a deeper one".to_owned(),
            };
            let accepted = format!(
                "at least {:.2} mm, the size of a cell of the lattice: {advice}",
                // Rounded up, so that what is told is accepted.
                (1e5 * cell * NEARLY).ceil() * 1e-2
            );
            return refuse(&slit.of, "slit", found, accepted);
        }
        match slit.crease.anchor.filter(|anchor| anchor.depth <= depth) {
            None => Ok(()),
            Some(anchor) => {
                let accepted = format!("more than {depth} m, where its slit ends");
                let found = format!("{} m", anchor.depth);
                refuse(&slit.of, "anchor.depth", found, accepted)
            }
        }
    }

    /// Deepest overlap of the walls of a slit with the nodes at `q` (m), and the name of its crease; `None` where no
    /// walls overlap.
    pub(crate) fn slit_overlap(&self, q: &[Vector3<f64>]) -> Option<(f64, &str)> {
        let Walls {
            sides,
            slits,
            names,
        } = self.walls.as_ref()?;
        let [left, right] = [0, 1].map(|side| sides[side].positions(q));
        // Normals of the left wall point out of its flesh, over to the right one.
        let pairs = left.iter().zip(&right).zip(sides[0].normals(q));
        let depths = pairs.map(|((left, right), normal)| normal.dot(&(left - right)));
        let deepest = depths.zip(slits).max_by(|a, b| a.0.total_cmp(&b.0));
        let (depth, slit) = deepest?;
        (depth > 0.0).then(|| (depth, names[*slit].as_str()))
    }
}

impl Walls {
    /// The first slit of which all pairs of places hang on the same nodes.
    fn closed(&self) -> Option<usize> {
        let nodes = |side: usize, pair: usize| {
            let row = self.sides[side].rows().row(pair);
            row.map(|(node, _)| node).collect::<Vec<_>>()
        };
        let mut opens = vec![false; self.names.len()];
        for (pair, &slit) in self.slits.iter().enumerate() {
            opens[slit] |= nodes(0, pair) != nodes(1, pair);
        }
        opens.iter().position(|opens| !opens)
    }
}

fn slits_of<'a>(layers: &'a [LayerSpec], flesh: &[Vec<f64>]) -> Vec<Slit<'a>> {
    let layers = layers.iter().zip(flesh);
    let creases = layers.flat_map(|(layer, flesh)| {
        let creases = layer.creases.iter().zip(flesh);
        creases.filter_map(move |(crease, &flesh)| {
            Some(Slit {
                of: of_crease(layer, crease),
                crease,
                depth: crease.slit?,
                flesh,
            })
        })
    });
    creases.collect()
}

/// The edges of all slits, on a surface with these `normals`.
fn slit_edges(cut: &Creased, slits: &[Slit<'_>], normals: &[Vector3<f64>]) -> Vec<SlitEdge> {
    let vertices = |crease: &CreaseEdge| cut.piece.mesh.edges()[crease.edge].vertices;
    let mut edges = Vec::new();
    for (number, slit) in slits.iter().enumerate() {
        let own = cut.creases.iter().filter(|crease| crease.line == number);
        let own: Vec<&CreaseEdge> = own.collect();
        // The mean normal of every edge, in the middle of it, with its length as weight.
        let along = own.iter().map(|crease| {
            let [a, b] = vertices(crease).map(|v| normals[v.index()]);
            let [from, to] = crease.at;
            (0.5 * (from + to), (a + b) * (0.5 * (to - from).abs()))
        });
        let along: Vec<(f64, Vector3<f64>)> = along.collect();
        let reach = REACH * slit.depth;
        let down = |at: f64| {
            let sum: Vector3<f64> = along
                .iter()
                .map(|(middle, normal)| {
                    let apart = slit.crease.line.apart([at, *middle]).abs();
                    normal * (1.0 - apart / reach).max(0.0)
                })
                .sum();
            // Around a line that turns over on itself normals may cancel.
            sum.try_normalize(0.0).map(|normal| normal * -slit.depth)
        };
        for crease in &own {
            let own_normals = vertices(crease).map(|v| normals[v.index()]);
            let down = [0, 1].map(|end| {
                let mean = down(crease.at[end]);
                mean.unwrap_or(own_normals[end] * -slit.depth)
            });
            edges.push(SlitEdge {
                edge: crease.edge,
                slit: number,
                is_along: crease.at[0] < crease.at[1],
                down,
            });
        }
    }
    edges
}

/// The walls of a carved surface from which a lattice was built.
fn walls(lattice: &Lattice, carved: &Carved, slits: &[Slit<'_>]) -> Result<Walls, LatticeError> {
    let at = |(face, [lip, bottom]): (FaceId, [usize; 2]), down: f64| {
        let mut barycentric = [0.0; 3];
        barycentric[lip] = 1.0 - down;
        barycentric[bottom] = down;
        MaterialPoint { face, barycentric }
    };
    let side = |side: usize| {
        let pairs = carved.pairs.iter();
        let places = pairs.flat_map(|(_, pair)| DOWN.map(|down| at(pair[side], down)));
        Embedding::of_points(lattice, &places.collect::<Vec<_>>())
    };
    let of_pairs = carved.pairs.iter();
    Ok(Walls {
        sides: [side(0)?, side(1)?],
        slits: of_pairs.flat_map(|(slit, _)| [*slit; DOWN.len()]).collect(),
        names: slits.iter().map(|slit| slit.crease.name.clone()).collect(),
    })
}

fn meeting(slits: &[Slit<'_>], [a, b]: [usize; 2]) -> StepperError {
    let found = match a == b {
        true => "one that meets itself".to_owned(),
        false => format!("one that meets that of crease '{}'", slits[a].crease.name),
    };
    let accepted = "slits that do not meet; of lines that do, one may have a slit";
    setting(&slits[b].of, "slit", found, accepted)
}

/// Error about the surface with slits, of which the plain one has been accepted.
fn in_a_slit(
    error: LatticeError,
    slits: &[Slit<'_>],
    (carved, before): (&Carved, usize),
) -> StepperError {
    let slit = match &error {
        LatticeError::SelfIntersection { faces, .. } => {
            let walls = faces
                .iter()
                .filter_map(|face| face.index().checked_sub(before));
            walls.min().map_or(0, |wall| carved.slits[wall])
        }
        // Walls that touch; which ones, it does not tell.
        LatticeError::CannotCut { .. } => 0,
        _ => return error.into(),
    };
    let accepted = "a shallower one, or a line that is straighter and farther from others: its walls run into each \
                    other, into those of another slit or through the skin";
    let found = format!("{} m", slits[slit].depth);
    setting(&slits[slit].of, "slit", found, accepted)
}
