//! The same bytes from any number of threads.

mod patch;

use patch::{Driver, Patch, waves};
use rayon::ThreadPoolBuilder;
use ruga_bake::{BakeSettings, Frame, WrinkleMap, bake};

fn bytes(map: &WrinkleMap) -> Vec<u8> {
    let normals = map.normals.iter().flatten().flat_map(|c| c.to_le_bytes());
    let heights = map.heights.iter().flat_map(|h| h.to_le_bytes());
    normals.chain(heights).collect()
}

#[test]
fn one_and_several_threads_agree_to_the_byte() {
    let mut patch = Patch::new(Driver::Sphere(0.06), [96, 8], 1.4e-3, waves);
    // Overlapping faces on purpose: which one wins must not depend on who comes first.
    for uvs in patch.uvs.iter_mut().skip(5000) {
        *uvs = uvs.map(|uv| uv * 0.7);
    }
    for (frame, supersample) in [(Frame::Driver, 1), (Frame::Mesh, 2)] {
        let settings = BakeSettings {
            size: 250,
            frame,
            supersample,
        };
        let maps = [1, 2, 5].map(|threads| {
            let pool = ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| bake(&patch.relief(), &patch.frames, &settings).unwrap())
        });
        assert_eq!(bytes(&maps[0]), bytes(&maps[1]));
        assert_eq!(bytes(&maps[0]), bytes(&maps[2]));
        assert_eq!(maps[0], maps[2]);
    }
}
