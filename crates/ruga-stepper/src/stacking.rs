//! What every layer of a stack is by itself, and how it lies on the one below.

use ruga_material::{StackLayer, StackPair, Wrinkling, composite_layers, wrinkling};

use crate::below::Seat;
use crate::{Coupling, LayerSpec, Stack, StepperError};

/// The layers as they are simulated, bottom first.
#[derive(Clone, Debug)]
pub(crate) struct Stacking {
    pub(crate) specs: Vec<LayerSpec>,
    pub(crate) wrinkling: Vec<Wrinkling>,
    pub(crate) seats: Vec<Seat>,
    /// Every layer with the one above it.
    pub(crate) pairs: Vec<StackPair>,
}

impl Stacking {
    /// Applies the meaning of the stack to `layers`.
    pub(crate) fn new(layers: &[LayerSpec], stack: Stack) -> Result<Self, StepperError> {
        let alone = layers.iter().map(alone).collect::<Result<Vec<_>, _>>()?;
        let pairs = (1..layers.len())
            .map(|k| {
                let pair = StackPair::new(&alone[k - 1], &alone[k]);
                pair.map_err(|source| material(&layers[k], source))
            })
            .collect::<Result<Vec<_>, _>>()?;
        let mut stacking = Self {
            specs: layers.to_vec(),
            wrinkling: alone.iter().map(|layer| layer.wrinkling).collect(),
            seats: vec![Seat::default(); layers.len()],
            pairs,
        };
        if stack == Stack::Composite {
            stacking.replace_by_composites(&alone)?;
        }
        stacking.seat(layers, stack);
        Ok(stacking)
    }

    /// Lets every layer stand for itself and all above it.
    fn replace_by_composites(&mut self, alone: &[StackLayer]) -> Result<(), StepperError> {
        if let Some(painted) = self.specs.iter().find(|spec| spec.map.is_some()) {
            return Err(StepperError::PaintedComposite {
                layer: painted.name.clone(),
            });
        }
        let composites =
            composite_layers(alone).map_err(|source| material(&self.specs[0], source))?;
        for (k, composite) in composites.into_iter().enumerate() {
            self.specs[k].material = composite.material;
            self.wrinkling[k] = composite.wrinkling;
        }
        Ok(())
    }

    /// Puts the upper layers on those below; `layers` have their real thicknesses.
    fn seat(&mut self, layers: &[LayerSpec], stack: Stack) {
        for (k, pair) in self.pairs.iter().enumerate() {
            let upper = k + 1;
            let step = 0.5 * (layers[k].material.thickness + layers[upper].material.thickness);
            let (tie, transfer) = match stack {
                Stack::Nominal => (pair.nominal_tie(), pair.bending_transfer),
                Stack::Composite => (pair.shear_tie(), 1.0),
            };
            self.wrinkling[upper].tangential_stiffness = tie;
            self.seats[upper] = Seat {
                offset: self.seats[k].offset + step,
                bending_transfer: layers[upper].bending_transfer.unwrap_or(transfer),
                tie: Some(tie),
            };
            // Rows that hold a layer on a wrinkled one would leave their own pattern in it.
            if self.specs[upper].coupling == Coupling::Hybrid {
                self.specs[upper].coupling = Coupling::Elastic;
            }
        }
    }

    /// What the user should know about the stack.
    pub(crate) fn warnings(&self, stack: Stack) -> Vec<String> {
        let pairs = self.pairs.iter().zip(self.specs.windows(2));
        let disagreeing =
            pairs.filter(|(pair, _)| stack == Stack::Nominal && pair.nominal_disagrees());
        disagreeing
            .filter_map(|(pair, names)| Some((pair.joint?, names)))
            .map(|(joint, names)| {
                format!(
                    "layers '{}' and '{}' would wrinkle together every {:.2} mm from {:.1} % compression on; stack = \"nominal\" gives each its own wrinkles instead, \"composite\" the joint ones",
                    names[0].name,
                    names[1].name,
                    1e3 * joint.wavelength,
                    100.0 * joint.critical_strain
                )
            })
            .collect()
    }
}

fn alone(layer: &LayerSpec) -> Result<StackLayer, StepperError> {
    let numbers = wrinkling(&layer.material, &layer.substrate, layer.model);
    Ok(StackLayer {
        material: layer.material,
        wrinkling: numbers.map_err(|source| material(layer, source))?,
    })
}

fn material(layer: &LayerSpec, source: ruga_material::MaterialError) -> StepperError {
    StepperError::Material {
        layer: layer.name.clone(),
        source,
    }
}
