//! From a scene's `[burn]` to the fire that is simulated.

use std::path::Path;

use ruga_material::{ShrinkLaw, UvTile};
use ruga_stepper::{Fire, FireSource, FrontDesign, GrowthDirection, Heats, Mask, PaintedNumber};

use crate::SceneError;
use crate::file::{Burn, BurnSource};
use crate::mask_image::{channel_masks, mask};
use crate::placement::Placement;
use crate::scene::Inspection;

/// Points per wavelength for every edge over the width of a front that the scene says nothing of: 4 edges at standard
/// quality, at which the speed of a front is right to 0.1 %.
const POINTS_PER_EDGE: f64 = 3.0;

/// The fire of `burn`, in the axes of the mesh file, as fine as so many points per wavelength.
///
/// # Errors
/// What is wrong with an image, naming its key.
fn fire_of(
    (burn, points): (&Burn, f64),
    placement: &Placement,
    path: &Path,
    tiles: &[UvTile],
) -> Result<Fire, SceneError> {
    let channels = burn.map.as_ref().map(|map| {
        let meaning = "red for the speed, green for the asymmetry, blue for the shrinkage";
        channel_masks::<3>(&map.image, (path, "burn.map.image"), tiles, meaning)
    });
    let channels = channels.transpose()?;
    let painted = |channel: usize, range: Option<[f64; 2]>| {
        let image = channels.as_ref()?[channel].clone();
        Some(PaintedNumber {
            image,
            range: range?,
        })
    };
    let map = burn.map.as_ref();
    let ash = burn.ash_image.as_deref();
    let ash = ash.map(|image| mask(image, (path, "burn.ash_image"), tiles));
    let range = burn.ash_range;
    let ash_paint = ash.transpose()?.map(|image| PaintedNumber { image, range });
    let sources = burn.sources.iter().enumerate().map(|(i, source)| {
        source_of(source, placement, |image| {
            mask(image, (path, &format!("burn.sources[{i}].image")), tiles)
        })
    });
    Ok(Fire {
        front: FrontDesign {
            speed: burn.front_speed,
            width: burn.front_width,
            ignition: burn.ignition,
            burning: burn.burning,
            surroundings: burn.surroundings,
            loss_time: burn.loss_time,
        },
        edges_per_width: burn
            .edges_per_width
            .unwrap_or((points / POINTS_PER_EDGE).max(1.0)),
        speed: painted(0, map.and_then(|map| map.speed)),
        shrink: ShrinkLaw {
            along: burn.shrink[0],
            across: burn.shrink[1],
            asymmetry: burn.asymmetry,
            char_young: burn.char.young,
            char_thickness: burn.char.thickness,
        },
        grain: GrowthDirection::Angle(burn.grain.to_radians()),
        shrink_factor: painted(2, map.and_then(|map| map.shrink)),
        asymmetry_factor: painted(1, map.and_then(|map| map.asymmetry)),
        char_mass: burn.char.mass,
        ash_share: burn.ash_share,
        ash_paint,
        least_piece: burn
            .least_piece
            .unwrap_or(burn.front_width * burn.front_width),
        sources: sources.collect::<Result<_, _>>()?,
    })
}

impl Inspection {
    /// Reads what the fire of the scene names.
    pub(crate) fn look_at_fire(&mut self) {
        let (Some(burn), Some((mesh, _))) = (&self.file.burn, &self.mesh) else {
            return;
        };
        let burn = (burn, self.points());
        match fire_of(burn, &Placement::of(mesh), &self.path, &self.tiles) {
            Ok(fire) => self.fire = Some(fire),
            Err(problem) => self.problems.push(problem),
        }
    }
}

fn source_of(
    source: &BurnSource,
    placement: &Placement,
    read: impl Fn(&Path) -> Result<Mask, SceneError>,
) -> Result<FireSource, SceneError> {
    let ball = source.sphere.map(|sphere| Heats::Ball {
        centre: placement.place_in_file(sphere.centre),
        radius: sphere.radius,
        coefficient: source.coefficient,
    });
    let image = source.image.as_deref().map(read).transpose()?;
    // Reading a scene has refused sources with neither.
    let heats = ball.or(image.map(Heats::Start));
    Ok(FireSource {
        name: source.name.clone(),
        temperature: source.temperature,
        heats: heats.unwrap_or_else(|| unreachable!("a source is a ball or painted")),
    })
}
