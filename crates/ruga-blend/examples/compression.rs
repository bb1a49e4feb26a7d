//! A square with one blend shape: how much its weights compress the skin.
//!
//! `cargo run --release -p ruga-blend --example compression`
#![allow(clippy::print_stdout, reason = "an example's output is what it shows")]

use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, BlendError, BlendShape, Driver, face_strains};

fn main() -> Result<(), BlendError> {
    let square = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]];
    let driver = Driver::new(&ArtistMesh {
        positions: square.map(|[x, y]| Vector3::new(x, y, 0.0)).to_vec(),
        uvs: Some(
            square
                .map(|[x, y]| Vector2::new(10.0 * x, 10.0 * y))
                .to_vec(),
        ),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        shapes: vec![BlendShape {
            name: "frown".into(),
            position_deltas: square
                .map(|[x, y]| Vector3::new(-x, y / 4.0, 0.0) * 0.2)
                .to_vec(),
            normal_deltas: None,
        }],
        ..ArtistMesh::default()
    })?;
    for weight in [0.25, 0.5, 0.75, 1.0] {
        let posed = driver.pose(&driver.weights([("frown", weight)])?);
        let strains = face_strains(driver.topology(), driver.rest(), &posed);
        let most = strains
            .iter()
            .map(|(_, strain)| strain.first)
            .fold(0.0, f64::max);
        println!("frown {weight:.2}: the skin is {:.1} % shorter", 1e2 * most);
    }
    Ok(())
}
