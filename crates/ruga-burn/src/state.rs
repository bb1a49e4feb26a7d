//! Temperature and fuel of a sheet.

use ruga_mesh::{PerVertex, VertexId};

use crate::error::{TEMPERATURES, check_field, is_temperature};
use crate::{BurnError, BurnLaw, FieldMesh, Source};

/// Temperature (K) and fuel share (1 fresh, 0 burnt out) at every vertex of a field mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct BurnState {
    pub(crate) temperature: PerVertex<f64>,
    pub(crate) fuel: PerVertex<f64>,
}

/// What a fire may still do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Prospect {
    /// Fuel is above ignition: it burns.
    Burning,
    /// Nothing burns yet, but a source or a place without fuel is hotter than ignition.
    MayIgnite,
    /// Nothing is above ignition where there is fuel, and no source can bring it there: nothing will burn.
    NothingWillBurn {
        /// The highest temperature where there is fuel (K).
        hottest: f64,
    },
    /// No fuel is left.
    BurntOut,
}

impl BurnState {
    /// The start of a fire: temperatures (K) and fuel shares. Painting hot places into the
    /// temperatures is one way to set a sheet on fire; a [`Source`] is the other.
    ///
    /// # Errors
    /// Those of [`BurnState::restored`], and [`BurnError::NoFuel`].
    pub fn new(
        mesh: &FieldMesh,
        temperature: PerVertex<f64>,
        fuel: PerVertex<f64>,
    ) -> Result<Self, BurnError> {
        let state = Self::restored(mesh, temperature, fuel)?;
        if state.is_burnt_out() {
            return Err(BurnError::NoFuel);
        }
        Ok(state)
    }

    /// A state from what [`BurnState::into_parts`] gave, which may be burnt out.
    ///
    /// # Errors
    /// [`BurnError::FieldSize`] or [`BurnError::FieldOutOfRange`].
    pub fn restored(
        mesh: &FieldMesh,
        temperature: PerVertex<f64>,
        fuel: PerVertex<f64>,
    ) -> Result<Self, BurnError> {
        let (count, temperatures) = (mesh.vertex_count(), temperature.as_slice());
        check_field(
            "temperature",
            temperatures,
            count,
            TEMPERATURES,
            is_temperature,
        )?;
        check_field("fuel share", fuel.as_slice(), count, "0 to 1", |share| {
            (0.0..=1.0).contains(&share)
        })?;
        Ok(Self { temperature, fuel })
    }

    /// A fresh sheet at one temperature (K).
    ///
    /// # Errors
    /// [`BurnError::FieldOutOfRange`] when the temperature is not finite or below zero kelvin.
    pub fn fresh(mesh: &FieldMesh, temperature: f64) -> Result<Self, BurnError> {
        let count = mesh.vertex_count();
        let filled = |value| PerVertex::filled(count, value);
        Self::new(mesh, filled(temperature), filled(1.0))
    }

    /// Temperature of every vertex (K).
    pub fn temperature(&self) -> &PerVertex<f64> {
        &self.temperature
    }

    /// Fuel share of every vertex, from 1, fresh, to 0, burnt out.
    pub fn fuel(&self) -> &PerVertex<f64> {
        &self.fuel
    }

    /// Takes the fuel of vertices away, as of pieces that have fallen off, and returns how much it was (m²).
    ///
    /// # Panics
    /// When a vertex is none of this state's, or `mesh` has not its vertices.
    pub fn drop_fuel(&mut self, mesh: &FieldMesh, vertices: &[VertexId]) -> f64 {
        let drop = |&v: &VertexId| mesh.areas()[v] * std::mem::take(&mut self.fuel[v]);
        vertices.iter().map(drop).sum()
    }

    /// Temperatures (K) and fuel shares, as [`BurnState::restored`] takes them.
    pub fn into_parts(self) -> (PerVertex<f64>, PerVertex<f64>) {
        (self.temperature, self.fuel)
    }

    /// Whether everything has burnt away.
    pub fn is_burnt_out(&self) -> bool {
        self.fuel.as_slice().iter().all(|&share| share == 0.0)
    }

    /// Fuel that is left (m²): the area of fresh sheet that holds as much.
    ///
    /// # Panics
    /// When `mesh` has not the vertices of this state.
    pub fn fuel_left(&self, mesh: &FieldMesh) -> f64 {
        integral(mesh, &self.fuel)
    }

    /// Heat content above zero kelvin (K m²); times the areal heat capacity it is in joules.
    ///
    /// # Panics
    /// When `mesh` has not the vertices of this state.
    pub fn heat_content(&self, mesh: &FieldMesh) -> f64 {
        integral(mesh, &self.temperature)
    }

    /// Tells whether anything burns, may burn or never will under the given sources.
    pub fn prospect(&self, law: &BurnLaw, sources: &[Source]) -> Prospect {
        if self.is_burnt_out() {
            return Prospect::BurntOut;
        }
        let with_fuel = || self.fuel.iter().filter(|(_, share)| **share > 0.0);
        let hottest = with_fuel()
            .map(|(v, _)| self.temperature[v])
            .fold(0.0, f64::max);
        if hottest > law.ignition {
            return Prospect::Burning;
        }
        // Heat flows, so that a source anywhere on the sheet may ignite fuel elsewhere.
        let heats = |source: &Source| {
            source.temperature > law.ignition
                && source.coefficient > 0.0
                && source.weights.as_slice().iter().any(|&w| w > 0.0)
        };
        let mut anywhere = self.temperature.as_slice().iter();
        if sources.iter().any(heats) || anywhere.any(|&t| t > law.ignition) {
            Prospect::MayIgnite
        } else {
            Prospect::NothingWillBurn { hottest }
        }
    }
}

fn integral(mesh: &FieldMesh, field: &PerVertex<f64>) -> f64 {
    let areas = mesh.areas().iter();
    areas.map(|(v, area)| area * field[v]).sum()
}
