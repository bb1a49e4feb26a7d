//! Temperature and fuel of a burning sheet.

use nalgebra::{Matrix2, Vector2, Vector3};
use ruga_blend::Driver;
use ruga_burn::{BurnSettings, BurnSolver, BurnState, FieldMesh, Source};
use ruga_mesh::{FaceId, Id, PerFace, PerVertex, TriMesh, VertexId, triangle_frame};
use ruga_remesh::shares_left;
use ruga_shell::FaceParameters;

use super::burnt_faces::{BurntFace, FreshFaces};
use super::covering::Covering;
use super::field_grid::{FieldGrid, levels};
use super::fire::{Fire, Heats};
use super::plan::check_fields;
use crate::skin::skin_mesh::{RegionMesh, SkinMesh};
use crate::support::Moves;
use crate::{BurntSurface, FireReport, PaintedNumber, StepperError};

/// Level of a vertex that never falls off, however little fuel it has.
const KEPT: f64 = 0.01;

/// Most parts of a step for balls that move.
const MOST_PARTS: f64 = 1000.0;

/// Fuel share that is left when the front counts as having passed.
const PASSED: f64 = 0.5;

/// Fuel share that must be missing at a vertex for the sheet to count as burnt; less is rounding.
pub(super) const TOUCHED: f64 = 1e-9;

/// A fire on one sheet: its law, its mesh, and what the sheet is made of.
pub(super) struct FireState<'a> {
    pub(super) fire: &'a Fire,
    pub(super) grid: FieldGrid,
    solver: BurnSolver,
    /// Factorisations of the matrix of the heat, of steps that were given up included.
    factorisations: usize,
    /// Shares of the field mesh's faces that the solver knows to conduct.
    conducting: Option<PerFace<f64>>,
    /// Fuel share at which every vertex of the field mesh falls off.
    ash: Vec<f64>,
    /// The sheet's triangles that the field mesh lies on, and what they are made of.
    covering: Covering,
    faces: FreshFaces,
}

/// What a fire has done so far.
#[derive(Clone, Debug)]
pub(super) struct Burning {
    state: BurnState,
    /// Vertices of the field mesh that went with a piece that fell off.
    fallen: Vec<bool>,
    /// When the front passed every vertex of the field mesh (s); no number before.
    passed: Vec<f64>,
    /// Time since the beginning, s.
    time: f64,
    /// Pieces that have vanished, and their area when fresh, m².
    vanished: (usize, f64),
}

/// What is left of a triangle of the sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Remains {
    /// Share of its area.
    pub(super) share: f64,
    /// Mean fuel share of that.
    pub(super) fuel: f64,
}

impl<'a> FireState<'a> {
    pub(super) fn new(
        driver: &Driver,
        fire: &'a Fire,
        region: &RegionMesh,
        budget: usize,
    ) -> Result<(Self, Burning), StepperError> {
        let skin = &region.skin;
        let lengths = skin.mesh.edges().as_slice().iter().map(|edge| {
            let [a, b] = edge.vertices.map(|v| skin.rest.positions[v.index()]);
            (b - a).norm()
        });
        let mean_edge = lengths.sum::<f64>() / skin.mesh.edges().len().max(1) as f64;
        let wanted = fire.front.width / fire.edges_per_width;
        let levels = levels(mean_edge, wanted);
        check_fields(fire, (levels, skin.mesh.vertex_count()), budget)?;
        let grid = FieldGrid::new(driver, region, levels);
        let uvs = grid.vertex_uvs();
        let law = fire.law()?;
        let fields = FieldMesh::new(&grid.mesh, &grid.rest).map_err(StepperError::burn)?;
        let painted = |paint: &Option<PaintedNumber>, plain: f64| -> Vec<f64> {
            let at = |uv: &Vector2<f64>| paint.as_ref().map_or(plain, |paint| paint.at(*uv));
            uvs.iter().map(at).collect()
        };
        let surroundings = fire.front.surroundings;
        let hot = |uv: &Vector2<f64>| {
            let at = fire.sources.iter().map(|source| match &source.heats {
                Heats::Start(mask) => {
                    surroundings + (source.temperature - surroundings) * mask.grey(*uv)
                }
                Heats::Ball { .. } => surroundings,
            });
            at.fold(surroundings, f64::max)
        };
        let start: PerVertex<f64> = uvs.iter().map(hot).collect();
        let filled = PerVertex::filled(uvs.len(), 1.0);
        let state = BurnState::new(&fields, start, filled).map_err(StepperError::burn)?;
        let factors: PerVertex<f64> = painted(&fire.speed, 1.0).into();
        let settings = BurnSettings::default();
        let solver = BurnSolver::with_speed_factors(fields, law, factors, settings);
        let burning = Burning {
            state,
            fallen: vec![false; uvs.len()],
            passed: vec![f64::NAN; uvs.len()],
            time: 0.0,
            vanished: (0, 0.0),
        };
        let own = Self {
            ash: painted(&fire.ash_paint, fire.ash_share),
            solver: solver.map_err(StepperError::burn)?,
            factorisations: 0,
            conducting: None,
            covering: Covering::of_region(&grid, region),
            faces: FreshFaces::default(),
            grid,
            fire,
        };
        Ok((own, burning))
    }

    /// Takes the sheet's triangles that the field mesh lies on.
    pub(super) fn lie_on(&mut self, covering: Covering) {
        self.covering = covering;
    }

    /// Takes what the triangles of the sheet's mesh, which it lies on, are made of when fresh.
    pub(super) fn put_on(&mut self, driver: &Driver, skin: &SkinMesh, fresh: Vec<FaceParameters>) {
        let on = (&self.grid, &self.covering);
        self.faces = FreshFaces::new(self.fire, (driver, skin), fresh, on);
    }

    /// Lets the sheet, whose region is at `positions` (m), burn for a time (s) that ends at a fraction of the pose.
    pub(super) fn advance(
        &mut self,
        burning: &mut Burning,
        (coarse, positions): (&TriMesh, &[Vector3<f64>]),
        (moves, [from, to]): (&Moves<'_>, [f64; 2]),
        time: f64,
    ) -> Result<(), StepperError> {
        let shares = self.shares(burning)?;
        // A matrix that has not changed needs no iterations.
        let is_whole = |shares: &PerFace<f64>| shares.as_slice().iter().all(|share| *share == 1.0);
        let is_known = match &self.conducting {
            Some(known) => *known == shares,
            None => is_whole(&shares),
        };
        if !is_known {
            let set = self.solver.set_conducting(&shares);
            set.map_err(StepperError::burn)?;
            self.conducting = Some(shares);
        }
        // A ball that moves heats all along its way.
        let parts = self.parts(moves, [from, to]);
        let places = match self.fire.movers().next() {
            Some(_) => self.grid.interpolated(coarse, positions),
            None => Vec::new(),
        };
        for part in 0..parts {
            let middle = (f64::from(part) + 0.5) / f64::from(parts);
            let at = if parts == 1 {
                to
            } else {
                from + (to - from) * middle
            };
            let sources = self.sources(&places, (moves, at));
            self.burn_on(burning, &sources, time / f64::from(parts))?;
        }
        Ok(())
    }

    /// Parts of a step between two fractions of the pose in which every ball moves by at most half its radius.
    pub(super) fn parts(&self, moves: &Moves<'_>, ends: [f64; 2]) -> u32 {
        let parts = self.fire.sources.iter().map(|source| match source.heats {
            Heats::Ball { centre, radius, .. } => {
                let [a, b] = ends.map(|at| moves.place_of(&source.name, &centre, at));
                ((b - a).norm() / (0.5 * radius)).ceil()
            }
            Heats::Start(_) => 1.0,
        });
        parts.fold(1.0, f64::max).min(MOST_PARTS) as u32
    }

    fn burn_on(
        &mut self,
        burning: &mut Burning,
        sources: &[Source],
        time: f64,
    ) -> Result<(), StepperError> {
        let before = burning.state.fuel().clone();
        let step = self.solver.step(&mut burning.state, sources, time);
        self.factorisations += step.map_err(StepperError::burn)?.factorisations as usize;
        let pairs = before
            .as_slice()
            .iter()
            .zip(burning.state.fuel().as_slice());
        for (passed, (before, after)) in burning.passed.iter_mut().zip(pairs) {
            if *before >= PASSED && *after < PASSED {
                *passed = burning.time + time * (before - PASSED) / (before - after);
            }
        }
        burning.time += time;
        Ok(())
    }

    /// What the balls heat at a fraction of the pose, with the vertices of the field mesh at `places` (m).
    fn sources(&self, places: &[Vector3<f64>], (moves, at): (&Moves<'_>, f64)) -> Vec<Source> {
        let balls = self
            .fire
            .sources
            .iter()
            .filter_map(|source| match source.heats {
                Heats::Ball {
                    centre,
                    radius,
                    coefficient,
                } => Some((source, centre, radius, coefficient)),
                Heats::Start(_) => None,
            });
        let balls = balls.map(|(source, centre, radius, coefficient)| {
            let centre = moves.place_of(&source.name, &centre, at);
            // The rim is as soft as the mesh is fine.
            let edge = self.solver.mesh().mean_edge();
            let weight =
                |x: &Vector3<f64>| ((radius - (x - centre).norm()) / edge + 0.5).clamp(0.0, 1.0);
            Source {
                temperature: source.temperature,
                coefficient,
                weights: places.iter().map(weight).collect(),
            }
        });
        balls.collect()
    }

    /// Fuel share of every vertex above that at which it falls off.
    pub(super) fn level(&self, burning: &Burning) -> Vec<f64> {
        let fuel = burning.state.fuel().as_slice().iter();
        let vertices = fuel.zip(&self.ash).zip(&burning.fallen);
        let level = vertices.map(|((fuel, ash), fallen)| match (fallen, *ash > 0.0) {
            (true, _) => -1.0,
            (false, true) => fuel - ash,
            (false, false) => fuel.max(KEPT),
        });
        level.collect()
    }

    /// Share of every face of the field mesh that is left.
    fn shares(&self, burning: &Burning) -> Result<PerFace<f64>, StepperError> {
        let level = PerVertex::from(self.level(burning));
        shares_left(&self.grid.mesh, &level).map_err(|source| StepperError::Remesh {
            layer: "burn".to_owned(),
            source,
        })
    }

    /// Rest area of a face of the sheet, m².
    pub(super) fn area(&self, face: FaceId) -> f64 {
        self.covering.areas()[face.index()]
    }

    /// The sheet's triangle under a triangle of the field mesh.
    pub(super) fn owner(&self, field: FaceId) -> FaceId {
        self.covering.owner(field)
    }

    /// Area below which a loose piece vanishes, m².
    pub(super) fn least_piece(&self) -> f64 {
        self.fire.least_piece
    }

    /// What is left of every triangle of the sheet.
    pub(super) fn remains(&self, burning: &Burning) -> Result<PerFace<Remains>, StepperError> {
        let shares = self.shares(burning)?;
        let sums = self.covering.sums(|field| {
            let fuel = mean_fuel(burning, &self.grid.mesh.faces()[field]);
            [shares[field], shares[field] * fuel, fuel]
        });
        let faces = (0..sums.len()).map(FaceId::from_index);
        let remains = sums
            .iter()
            .zip(faces)
            .map(|([left, left_fuel, fuel], face)| {
                let area = self.covering.weight(face);
                Remains {
                    // What no piece is missing of is exactly whole.
                    share: if *left > area * (1.0 - 1e-12) {
                        1.0
                    } else {
                        left / area
                    },
                    fuel: if *left > 0.0 {
                        (left_fuel / left).clamp(0.0, 1.0)
                    } else {
                        fuel / area
                    },
                }
            });
        Ok(remains.collect())
    }

    /// Rest shape and material of a face of which so much is left.
    pub(super) fn face(&self, face: FaceId, remains: &Remains) -> Result<BurntFace, StepperError> {
        self.faces.burnt(face, (remains.fuel, self.fire.char_mass))
    }

    /// Drops the fuel of the faces of `piece` and counts their area, as far as `remains` says, as vanished.
    pub(super) fn vanish(
        &self,
        burning: &mut Burning,
        piece: &[FaceId],
        remains: &PerFace<Remains>,
    ) {
        let mut is_in = vec![false; self.covering.areas().len()];
        let mut area = 0.0;
        for face in piece {
            is_in[face.index()] = true;
            area += self.area(*face) * remains[*face].share;
        }
        let fields = self.pairs().filter(|(_, owner)| is_in[owner.index()]);
        // A piece that touches another one in a vertex takes that with it, or it would not be gone whole.
        self.drop_fields(burning, fields.map(|(field, _)| field));
        burning.vanished.0 += 1;
        burning.vanished.1 += area;
    }

    /// Lets triangles of the field mesh fall off, with their fuel.
    pub(super) fn drop_fields(
        &self,
        burning: &mut Burning,
        fields: impl IntoIterator<Item = FaceId>,
    ) {
        let mut vertices = Vec::new();
        for v in fields
            .into_iter()
            .flat_map(|field| self.grid.mesh.faces()[field])
        {
            if !std::mem::replace(&mut burning.fallen[v.index()], true) {
                vertices.push(v);
            }
        }
        burning.state.drop_fuel(self.solver.mesh(), &vertices);
    }

    /// Triangles of the field mesh, and those of the sheet on which they or parts of them lie.
    pub(super) fn pairs(&self) -> impl Iterator<Item = (FaceId, FaceId)> + '_ {
        self.covering.pairs()
    }

    /// Drops what is left of faces that do not stand any more: it is nobody's, and would stay behind.
    pub(super) fn drop_specks(&self, burning: &mut Burning, stands: impl Fn(FaceId) -> bool) {
        let mut is_used = vec![false; self.ash.len()];
        for (field, owner) in self.pairs() {
            if stands(owner) {
                for v in self.grid.mesh.faces()[field] {
                    is_used[v.index()] = true;
                }
            }
        }
        let specks = (0..is_used.len()).map(VertexId::from_index);
        let specks = specks.filter(|v| !is_used[v.index()] && !burning.fallen[v.index()]);
        let specks: Vec<VertexId> = specks.collect();
        for v in &specks {
            burning.fallen[v.index()] = true;
        }
        burning.state.drop_fuel(self.solver.mesh(), &specks);
    }

    /// The fields as maps show them.
    pub(super) fn surface(&self, burning: &Burning) -> BurntSurface {
        BurntSurface {
            faces: self
                .grid
                .mesh
                .faces()
                .as_slice()
                .iter()
                .map(|f| f.map(|v| v.0))
                .collect(),
            uvs: self.grid.uvs.clone(),
            temperature: burning.state.temperature().as_slice().to_vec(),
            fuel: burning.state.fuel().as_slice().to_vec(),
            level: self.level(burning),
            char_thickness: self.fire.shrink.char_thickness,
        }
    }

    /// What the fire has done, with the mass that is left (kg), the pieces that this is in and the faces whose curl is cut.
    pub(super) fn report(
        &self,
        burning: &Burning,
        (mass, pieces, capped): (f64, usize, usize),
    ) -> FireReport {
        let area: f64 = self.covering.areas().iter().sum();
        let faces = self.grid.mesh.faces().iter();
        let fuel: f64 = faces
            .map(|(face, corners)| self.grid.areas[face] * mean_fuel(burning, corners))
            .sum();
        FireReport {
            field_vertices: self.grid.mesh.vertex_count(),
            factorisations: self.factorisations,
            // By the triangles as the mass is, not by the areas of the flipped ones that heat flows on.
            fuel_left: fuel / area,
            mass,
            front_speed: self.front_speed(burning),
            pieces,
            vanished: burning.vanished.0,
            vanished_area: burning.vanished.1,
            capped,
            remeshed: 0,
        }
    }

    /// Median speed of the front over the triangles that it has passed, m/s; `None` where it has passed none.
    fn front_speed(&self, burning: &Burning) -> Option<f64> {
        let mut speeds: Vec<f64> = Vec::new();
        for corners in self.grid.mesh.faces().as_slice() {
            let times = corners.map(|v| burning.passed[v.index()]);
            let places = corners.map(|v| self.grid.rest[v.index()]);
            let [x, y] = triangle_frame(&places);
            let edge = |k: usize| places[k] - places[0];
            let edges = Matrix2::new(
                edge(1).dot(&x),
                edge(1).dot(&y),
                edge(2).dot(&x),
                edge(2).dot(&y),
            );
            let changes = Vector2::new(times[1] - times[0], times[2] - times[0]);
            let gradient = edges
                .try_inverse()
                .map(|inverse| (inverse * changes).norm());
            // No number where the front has not passed all three corners.
            speeds.extend(gradient.filter(|g| *g > 0.0).map(f64::recip));
        }
        speeds.sort_by(f64::total_cmp);
        speeds.get(speeds.len() / 2).copied()
    }
}

impl Remains {
    /// Whether something of it has burnt.
    pub(super) fn is_burnt(&self) -> bool {
        self.share < 1.0 || self.fuel < 1.0 - TOUCHED
    }
}

impl Burning {
    /// Temperature (K) and fuel share at the vertices of the field mesh.
    pub(super) fn fields(&self) -> [&[f64]; 2] {
        [self.state.temperature(), self.state.fuel()].map(|values| values.as_slice())
    }

    /// Whether anything has burnt.
    pub(super) fn has_burnt(&self) -> bool {
        self.state
            .fuel()
            .as_slice()
            .iter()
            .any(|fuel| *fuel < 1.0 - TOUCHED)
    }
}

/// Mean fuel share of a triangle of the field mesh.
fn mean_fuel(burning: &Burning, corners: &[VertexId; 3]) -> f64 {
    corners
        .iter()
        .map(|v| burning.state.fuel()[*v])
        .sum::<f64>()
        / 3.0
}
