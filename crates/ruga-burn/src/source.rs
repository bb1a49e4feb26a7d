//! Heating from outside.

use ruga_mesh::PerVertex;

use crate::error::{TEMPERATURES, check_field, is_temperature};
use crate::{BurnError, FieldMesh};

/// A hot (or cold) thing that draws the sheet to its temperature where it touches it: an ember, a
/// flame, an iron.
///
/// Adds `coefficient × weight × (temperature - T)` to the heat equation of [`BurnLaw`](crate::BurnLaw). One
/// that moves gets new weights before each step.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Temperature of the source (K); at least 0.
    pub temperature: f64,
    /// Share of the difference that is made up per second where the weight is 1 (1/s); at least 0. A
    /// body that the sheet touches has 10 to 100.
    pub coefficient: f64,
    /// How much each vertex is heated; from 0, not at all, to 1.
    pub weights: PerVertex<f64>,
}

/// All sources together during a substep: the sheet relaxes towards one temperature at each vertex.
pub(crate) struct Heating {
    /// Per vertex the share of the way that a substep goes, and the temperature it goes towards (K).
    relaxations: Vec<(f64, f64)>,
}

impl Source {
    /// Refuses a source that does not fit the mesh.
    ///
    /// # Errors
    /// [`BurnError::OutOfRange`], [`BurnError::FieldSize`] or [`BurnError::FieldOutOfRange`].
    pub fn check(&self, mesh: &FieldMesh) -> Result<(), BurnError> {
        check_number("temperature of a source", self.temperature, TEMPERATURES)?;
        check_number(
            "coefficient of a source",
            self.coefficient,
            "finite, at least 0 1/s",
        )?;
        let (weights, count) = (self.weights.as_slice(), mesh.vertex_count());
        check_field("weight of a source", weights, count, "0 to 1", |weight| {
            (0.0..=1.0).contains(&weight)
        })
    }
}

fn check_number(name: &'static str, value: f64, accepted: &'static str) -> Result<(), BurnError> {
    // Temperatures and coefficients have the same range.
    if is_temperature(value) {
        return Ok(());
    }
    Err(BurnError::OutOfRange {
        name,
        value,
        accepted,
    })
}

impl Heating {
    /// Joins checked sources for substeps of `substep` (s).
    ///
    /// Several sources at a vertex act like one with the sum of their coefficients, at the mean of their
    /// temperatures weighted by these. Relaxation is exact over the substep, so that it is stable and
    /// bounded for any coefficient without entering the matrix.
    pub(crate) fn new(sources: &[Source], vertex_count: usize, substep: f64) -> Self {
        if sources.is_empty() {
            let relaxations = Vec::new();
            return Self { relaxations };
        }
        let mut sums = vec![(0.0, 0.0); vertex_count];
        for source in sources {
            for (sum, weight) in sums.iter_mut().zip(source.weights.as_slice()) {
                let coefficient = weight * source.coefficient;
                sum.0 += coefficient;
                sum.1 += coefficient * source.temperature;
            }
        }
        let relaxations = sums.into_iter().map(|(coefficient, heat)| {
            if coefficient > 0.0 {
                (relaxed_share(coefficient, substep), heat / coefficient)
            } else {
                (0.0, 0.0)
            }
        });
        Self {
            relaxations: relaxations.collect(),
        }
    }

    /// Rise of temperature (K) of a vertex at `temperature` (K) in a substep.
    pub(crate) fn rise(&self, vertex: usize, temperature: f64) -> f64 {
        match self.relaxations.get(vertex) {
            Some(&(share, target)) => share * (target - temperature),
            None => 0.0,
        }
    }
}

/// Share of a difference that is made up in `time` (s) at a rate of `coefficient` (1/s).
pub(crate) fn relaxed_share(coefficient: f64, time: f64) -> f64 {
    -(-coefficient * time).exp_m1()
}
