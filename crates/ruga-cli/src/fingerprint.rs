//! A number that changes when the inputs of a run do.

use nalgebra::{Vector2, Vector3};
use ruga_blend::ArtistMesh;

/// FNV-1a, 64 bits: the same on every machine and in every release, which the standard library's
/// hasher does not promise. It guards against forgetting, not against forgery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Fingerprint(u64);

impl Fingerprint {
    /// Fingerprint of nothing.
    pub(crate) fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// Fingerprint of what came before and one more piece; where a piece ends counts.
    pub(crate) fn with(self, bytes: &[u8]) -> Self {
        self.with_each(&(bytes.len() as u64).to_le_bytes())
            .with_each(bytes)
    }

    /// Fingerprint of what came before and numbers, bit by bit.
    pub(crate) fn with_numbers(self, numbers: impl IntoIterator<Item = f64>) -> Self {
        let start = self.with(b"numbers");
        numbers
            .into_iter()
            .fold(start, |hash, n| hash.with_each(&n.to_bits().to_le_bytes()))
    }

    /// Fingerprint of what came before and a mesh: all that was read, from whatever files.
    pub(crate) fn with_mesh(self, mesh: &ArtistMesh) -> Self {
        let corners = mesh.triangles.iter().flatten();
        let mut hash = self
            .with(mesh.name.as_bytes())
            .with_numbers(coordinates(&mesh.positions))
            .with_numbers(mesh.normals.iter().flat_map(|n| coordinates(n)))
            .with_numbers(mesh.uvs.iter().flat_map(|uvs| uv_coordinates(uvs)))
            .with_numbers(corners.map(|&v| f64::from(v)));
        for shape in &mesh.shapes {
            hash = hash
                .with(shape.name.as_bytes())
                .with_numbers(coordinates(&shape.position_deltas))
                .with_numbers(shape.normal_deltas.iter().flat_map(|n| coordinates(n)));
        }
        hash
    }

    /// The fingerprint as 16 hexadecimal digits.
    pub(crate) fn text(self) -> String {
        format!("{:016x}", self.0)
    }

    fn with_each(self, bytes: &[u8]) -> Self {
        Self(bytes.iter().fold(self.0, |hash, &byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        }))
    }
}

fn coordinates(points: &[Vector3<f64>]) -> impl Iterator<Item = f64> + '_ {
    points.iter().flat_map(|p| [p.x, p.y, p.z])
}

fn uv_coordinates(points: &[Vector2<f64>]) -> impl Iterator<Item = f64> + '_ {
    points.iter().flat_map(|p| [p.x, p.y])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matches_the_published_values_of_fnv_1a() {
        assert_eq!(Fingerprint::new().with_each(b"").text(), "cbf29ce484222325");
        assert_eq!(
            Fingerprint::new().with_each(b"a").text(),
            "af63dc4c8601ec8c"
        );
        assert_eq!(
            Fingerprint::new().with_each(b"foobar").text(),
            "85944171f73967e8"
        );
    }

    #[test]
    fn pieces_do_not_run_into_each_other() {
        let new = Fingerprint::new();
        assert_ne!(new.with(b"ab").with(b"c"), new.with(b"a").with(b"bc"));
    }
}
