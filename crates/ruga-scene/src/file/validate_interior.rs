//! What `[interior]` and the motions of poses must mean, beyond being well-formed.

use super::fault::{Checked, Fault, fault, fraction_of_pose, names_given, positive, within};
use super::{Cylinder, Handle, Interior, Motion, Movers, Obstacle, Plane, Sphere};
use ruga_blend::nearest;

impl Interior {
    pub(super) fn faults(&self, layers: usize) -> Checked {
        if let Some(cells) = self.cells {
            within("interior.cells", u64::from(cells), 1, 64)?;
        }
        positive("interior.density", self.density)?;
        finite("interior.gravity", &self.gravity)?;
        self.follow
            .map_or(Ok(()), |stiffness| positive("interior.follow", stiffness))?;
        mover_faults(&self.movers())?;
        if layers == 0 {
            return fault("interior", "no layer", "at least one layer on a lattice");
        }
        Ok(())
    }
}

/// Checks handles and obstacles.
pub(super) fn mover_faults(movers: &Movers<'_>) -> Checked {
    let table = movers.table;
    for (i, handle) in movers.handles.iter().enumerate() {
        let key = format!("{table}.handles[{i}]");
        name_fault(movers, &key, i)?;
        handle.faults(&key)?;
    }
    for (i, obstacle) in movers.obstacles.iter().enumerate() {
        let key = format!("{table}.obstacles[{i}]");
        name_fault(movers, &key, movers.handles.len() + i)?;
        obstacle.faults(&key)?;
    }
    Ok(())
}

/// Whether what stands at `place` among all that can be moved has a name of its own.
fn name_fault(movers: &Movers<'_>, key: &str, place: usize) -> Checked {
    let names: Vec<&str> = movers.names().take(place + 1).collect();
    let Some((name, earlier)) = names.split_last() else {
        return Ok(());
    };
    let key = format!("{key}.name");
    if name.trim().is_empty() {
        return fault(&key, format!("`{name}`"), "a name that motions can give");
    }
    if earlier.contains(name) {
        let accepted = "a different name for each handle and obstacle";
        return fault(&key, format!("`{name}` twice"), accepted);
    }
    Ok(())
}

impl Handle {
    fn faults(&self, key: &str) -> Checked {
        finite(&format!("{key}.min"), &self.min)?;
        finite(&format!("{key}.max"), &self.max)?;
        for (axis, (min, max)) in self.min.iter().zip(self.max).enumerate() {
            if *min >= max {
                let accepted = format!("a coordinate below max[{axis}] = {max}");
                return fault(&format!("{key}.min[{axis}]"), min, &accepted);
            }
        }
        Ok(())
    }
}

impl Obstacle {
    fn faults(&self, key: &str) -> Checked {
        let given = [
            ("plane", self.plane.is_some()),
            ("sphere", self.sphere.is_some()),
            ("cylinder", self.cylinder.is_some()),
        ];
        if given.iter().filter(|(_, is_given)| *is_given).count() != 1 {
            let accepted = "exactly one of plane, sphere, cylinder";
            return fault(key, names_given(&given), accepted);
        }
        let plane = self.plane.map(|it| it.faults(&format!("{key}.plane")));
        let sphere = self.sphere.map(|it| it.faults(&format!("{key}.sphere")));
        let cylinder = (self.cylinder).map(|it| it.faults(&format!("{key}.cylinder")));
        plane.or(sphere).or(cylinder).unwrap_or(Ok(()))
    }
}

impl Plane {
    fn faults(&self, key: &str) -> Checked {
        finite(&format!("{key}.point"), &self.point)?;
        let accepted = "a direction that is not zero, such as [0.0, 0.0, 1.0]";
        direction(&format!("{key}.normal"), &self.normal, accepted)
    }
}

impl Sphere {
    pub(super) fn faults(&self, key: &str) -> Checked {
        finite(&format!("{key}.centre"), &self.centre)?;
        positive(&format!("{key}.radius"), self.radius)
    }
}

impl Cylinder {
    fn faults(&self, key: &str) -> Checked {
        finite(&format!("{key}.from"), &self.from)?;
        let to = format!("{key}.to");
        finite(&to, &self.to)?;
        let axis: [f64; 3] = std::array::from_fn(|i| self.to[i] - self.from[i]);
        if !has_length(&axis) {
            let accepted = "another point than `from`, the centre of the other end";
            return fault(&to, format!("{:?}", self.to), accepted);
        }
        positive(&format!("{key}.radius"), self.radius)
    }
}

/// Checks the motions of the pose at `key`.
pub(super) fn motion_faults(key: &str, motions: &[Motion], movers: Option<Movers<'_>>) -> Checked {
    if motions.is_empty() {
        return Ok(());
    }
    let Some(movers) = movers else {
        let accepted =
            "motions of handles and obstacles of an [interior] or [sheet] table, which is missing";
        let found = format!("{} of them", motions.len());
        return fault(&format!("{key}.motions"), found, accepted);
    };
    for (i, motion) in motions.iter().enumerate() {
        let key = format!("{key}.motions[{i}]");
        motion.faults(&key, &movers)?;
        let before = motions.iter().take(i).rfind(|other| other.of == motion.of);
        if let Some(before) = before.filter(|before| before.at >= motion.at) {
            let accepted = format!(
                "a fraction above {}, that of the keyframe of `{}` before it",
                before.at, motion.of
            );
            return fault(&format!("{key}.at"), motion.at, &accepted);
        }
    }
    Ok(())
}

impl Motion {
    fn faults(&self, key: &str, movers: &Movers<'_>) -> Checked {
        if !movers.names().any(|name| name == self.of) {
            return unknown_name(&format!("{key}.of"), &self.of, movers);
        }
        fraction_of_pose(&format!("{key}.at"), self.at)?;
        finite(&format!("{key}.move"), &self.translation)?;
        finite(&format!("{key}.turn"), &self.turn)?;
        finite(&format!("{key}.about"), &self.about)
    }
}

fn unknown_name(key: &str, name: &str, movers: &Movers<'_>) -> Checked {
    let names: Vec<String> = movers.names().map(|n| format!("`{n}`")).collect();
    let accepted = match names.as_slice() {
        [] => format!(
            "the name of a handle or an obstacle, of which [{}] has none",
            movers.table
        ),
        names => format!("a handle or an obstacle: {}", names.join(", ")),
    };
    Err(Fault {
        key: key.to_owned(),
        reason: format!("found `{name}`; accepted: {accepted}"),
        suggestion: nearest(name, movers.names()),
    })
}

pub(super) fn finite(key: &str, values: &[f64; 3]) -> Checked {
    match values.iter().position(|value| !value.is_finite()) {
        Some(i) => fault(&format!("{key}[{i}]"), values[i], "a finite number"),
        None => Ok(()),
    }
}

fn direction(key: &str, values: &[f64; 3], accepted: &str) -> Checked {
    finite(key, values)?;
    if has_length(values) {
        return Ok(());
    }
    fault(key, format!("{values:?}"), accepted)
}

/// Whether the vector can be made a unit vector: squares of tiny or huge numbers are none.
fn has_length(vector: &[f64; 3]) -> bool {
    let squared: f64 = vector.iter().map(|x| x * x).sum();
    squared.is_normal()
}
