//! Fire on a free sheet: what an artist says about it.

use nalgebra::Vector3;
use ruga_blend::Driver;
use ruga_burn::{BurnLaw, FrontDesign};
use ruga_material::ShrinkLaw;
use ruga_mesh::face_areas;

use super::plan::longest_side;
use crate::error::{Checked, refuse};
use crate::{GrowthDirection, Mask, PaintedNumber, PoseSpec, StepperError};

/// Fuel share at which a sheet may fall off: at 1 it would before it burns.
const ASH_SHARES: std::ops::Range<f64> = 0.0..1.0;

/// A sheet that burns: how fast and how wide the front is, what becomes of what has burnt, and what is hot.
///
/// It needs motion in time ([`Modelling::dynamics`](crate::Modelling::dynamics)): a pose takes its number of steps
/// times the time step. Heat flows in the sheet at rest, whose shrinkage does not shorten its ways.
#[derive(Clone, Debug)]
pub struct Fire {
    /// Speed and width of the front, temperatures and loss of heat.
    pub front: FrontDesign,
    /// Edges of the mesh of temperature and fuel over a width of the front: 2 is a draft, 4 the standard, 8 fine.
    pub edges_per_width: f64,
    /// Factor on the front's speed; its width stays. Numbers above 0.
    pub speed: Option<PaintedNumber>,
    /// Lengths, curvature and stiffness of what has burnt.
    pub shrink: ShrinkLaw,
    /// Direction of the grain, along which the first shrinkage counts; where its paint has none, both count as their
    /// mean.
    pub grain: GrowthDirection,
    /// Factor on the shrinkage, 0 to 1.
    pub shrink_factor: Option<PaintedNumber>,
    /// Factor on the asymmetry, -1 to 1.
    pub asymmetry_factor: Option<PaintedNumber>,
    /// Mass of what has burnt out over that of the fresh sheet, 0 to 1. Nominal: 0.2.
    pub char_mass: f64,
    /// Fuel share at which the sheet falls off, from 0, never, to below 1.
    pub ash_share: f64,
    /// Painted fuel share at which the sheet falls off, in place of `ash_share`.
    pub ash_paint: Option<PaintedNumber>,
    /// Pieces that nothing holds and that are smaller than this vanish, m².
    pub least_piece: f64,
    /// What sets it on fire.
    pub sources: Vec<FireSource>,
}

/// Something hot.
#[derive(Clone, Debug)]
pub struct FireSource {
    /// Name in motions and messages.
    pub name: String,
    /// Its temperature, K.
    pub temperature: f64,
    /// What it heats.
    pub heats: Heats,
}

/// What a [`FireSource`] heats.
#[derive(Clone, Debug)]
pub enum Heats {
    /// What lies in a ball, which motions of a pose can move.
    Ball {
        /// Its centre at rest, m.
        centre: Vector3<f64>,
        /// Its radius, m.
        radius: f64,
        /// Share of the difference of temperature that is made up per second, 1/s.
        coefficient: f64,
    },
    /// Painted places, which have its temperature at the beginning where they are white.
    Start(Mask),
}

impl Fire {
    /// The law of burning at a speed factor of 1.
    pub(super) fn law(&self) -> Result<BurnLaw, StepperError> {
        self.front.law().map_err(StepperError::burn)
    }

    /// Names that motions may have.
    pub(super) fn movers(&self) -> impl Iterator<Item = &str> {
        let balls = self.sources.iter();
        let balls = balls.filter(|source| matches!(source.heats, Heats::Ball { .. }));
        balls.map(|source| source.name.as_str())
    }

    /// Refuses what no sheet can burn with.
    pub(super) fn check(&self, driver: &Driver) -> Checked {
        let of = "burn";
        self.law()?;
        let side = longest_side(driver.rest());
        if self.front.width > 0.5 * side {
            let found = format!("{} m", self.front.width);
            let accepted = format!(
                "at most half the sheet's longest side, {:.3e} m",
                0.5 * side
            );
            return refuse(of, "front_width", found, accepted);
        }
        let at_least_one = 1.0..f64::INFINITY;
        if !at_least_one.contains(&self.edges_per_width) {
            return refuse(
                of,
                "edges_per_width",
                self.edges_per_width,
                "a number from 1",
            );
        }
        self.extreme_laws().try_for_each(|law| {
            let check = law.validate();
            check.map_err(|source| StepperError::Char { source })
        })?;
        let is_outside = |range: [f64; 2], accepted: &dyn Fn(f64) -> bool| {
            range.into_iter().find(|number| !accepted(*number))
        };
        let is_speed = |factor: f64| factor > 0.0 && factor.is_finite();
        if let Some(factor) = is_outside(ends(&self.speed, 1.0), &is_speed) {
            return refuse(of, "speed", factor, "factors above 0");
        }
        let is_share = |share: f64| (0.0..=1.0).contains(&share);
        if let Some(factor) = is_outside(ends(&self.shrink_factor, 1.0), &is_share) {
            return refuse(of, "shrink factor", factor, "factors from 0 to 1");
        }
        if !is_share(self.char_mass) {
            return refuse(of, "char.mass", self.char_mass, "a share from 0 to 1");
        }
        let ash = ends(&self.ash_paint, self.ash_share);
        if let Some(share) = is_outside(ash, &|share| ASH_SHARES.contains(&share)) {
            let accepted = "a share of the fuel from 0, at which nothing falls off, to below 1";
            return refuse(of, "ash_share", share, accepted);
        }
        if !(self.least_piece >= 0.0 && self.least_piece.is_finite()) {
            return refuse(of, "least_piece", self.least_piece, "an area from 0, in m2");
        }
        self.sources.iter().try_for_each(|source| source.check())?;
        Ok(())
    }

    /// Laws of shrinkage at the ends of what is painted.
    fn extreme_laws(&self) -> impl Iterator<Item = ShrinkLaw> + '_ {
        let shrinks = ends(&self.shrink_factor, 1.0);
        let asymmetries = ends(&self.asymmetry_factor, 1.0);
        let pairs = shrinks.map(|shrink| asymmetries.map(|asymmetry| [shrink, asymmetry]));
        pairs
            .into_iter()
            .flatten()
            .map(|factors| self.shrink_by(factors))
    }

    /// The law of shrinkage with these factors on shrinkage and asymmetry.
    pub(super) fn shrink_by(&self, [shrink, asymmetry]: [f64; 2]) -> ShrinkLaw {
        ShrinkLaw {
            along: shrink * self.shrink.along,
            across: shrink * self.shrink.across,
            asymmetry: asymmetry * self.shrink.asymmetry,
            ..self.shrink
        }
    }

    /// Warnings of a fire on `driver` that will not burn, or is too narrow for maps of `map_size` texels a side.
    pub(super) fn warnings(&self, driver: &Driver, map_size: u32) -> Vec<String> {
        let mut warnings = Vec::new();
        let Ok(law) = self.law() else {
            return warnings;
        };
        let is_hot = |source: &&FireSource| source.temperature > law.ignition;
        if !self.sources.iter().any(|source| is_hot(&source)) {
            warnings.push(format!(
                "burn: nothing will burn, because no source is hotter than `ignition`, {} K; add one, or make one hotter",
                law.ignition
            ));
        }
        for source in self.sources.iter().filter(is_hot) {
            let starter = law.starter(source.temperature);
            if matches!(source.heats, Heats::Start(_)) && !starter.is_hot_enough {
                warnings.push(format!(
                    "burn: source '{}' of {} K may go out before anything beside it burns: where it meets the fresh sheet that has {:.0} K, below `ignition`; take more than {:.0} K",
                    source.name, source.temperature, starter.meeting, starter.least
                ));
            }
        }
        let area: f64 = face_areas(driver.topology(), driver.rest())
            .as_slice()
            .iter()
            .sum();
        let in_texture: f64 = driver
            .uvs()
            .as_slice()
            .iter()
            .map(|[a, b, c]| {
                let (p, q) = (b - a, c - a);
                0.5 * (p.x * q.y - p.y * q.x).abs()
            })
            .sum();
        let texel = (area / in_texture).sqrt() / f64::from(map_size);
        if in_texture > 0.0 && self.front.width < 2.0 * texel {
            warnings.push(format!(
                "burn: the front of {:.2e} m is less than two texels of the maps wide, which are {:.2e} m; take larger maps",
                self.front.width, texel
            ));
        }
        warnings
    }

    /// Warns of time steps (s) in which the front goes on by more than its width.
    pub(super) fn leaps(&self, time_step: f64) -> Option<String> {
        let fastest = ends(&self.speed, 1.0).into_iter().fold(0.0, f64::max);
        let longest = self.front.width / (fastest * self.front.speed);
        (time_step > longest).then(|| {
            format!(
                "burn: in a time step of {time_step} s the front goes on by more than its width, and what it passes shrinks and curls at once; take a `time_step` of at most {longest:.2} s, and more `steps`"
            )
        })
    }

    /// Refuses a motion of a painted source.
    pub(super) fn check_pose(&self, pose: &PoseSpec) -> Checked {
        let painted = self.sources.iter();
        let painted = painted.filter(|source| matches!(source.heats, Heats::Start(_)));
        let mut names = painted.map(|source| &source.name);
        match names.find(|name| pose.motions.iter().any(|motion| motion.of == **name)) {
            None => Ok(()),
            Some(name) => {
                let accepted = "motions of balls: what is painted burns where it is painted";
                refuse(
                    format!("pose '{}'", pose.name),
                    "motions",
                    format!("source '{name}'"),
                    accepted,
                )
            }
        }
    }
}

impl FireSource {
    fn check(&self) -> Checked {
        let of = format!("burn, source '{}'", self.name);
        if !(self.temperature >= 0.0 && self.temperature.is_finite()) {
            return refuse(of, "temperature", self.temperature, "a number from 0, in K");
        }
        let Heats::Ball {
            centre,
            radius,
            coefficient,
        } = &self.heats
        else {
            return Ok(());
        };
        if !centre.iter().all(|c| c.is_finite()) {
            return refuse(of, "sphere.centre", format!("{centre:?}"), "finite numbers");
        }
        if !(*radius > 0.0 && radius.is_finite()) {
            return refuse(of, "sphere.radius", radius, "a length above 0, in m");
        }
        if !(*coefficient > 0.0 && coefficient.is_finite()) {
            return refuse(of, "coefficient", coefficient, "a number above 0, in 1/s");
        }
        Ok(())
    }
}

/// Numbers at the ends of what is painted, or the plain one.
fn ends(paint: &Option<PaintedNumber>, plain: f64) -> [f64; 2] {
    paint.as_ref().map_or([plain; 2], |paint| paint.range)
}
