//! Which kernels have twins.

use softshadow_native::has_twin;
use softshadow_plan::Kernel;
use softshadow_shaders::{EMBEDDED, Stage, module};

/// Kernels of techniques that draw triangles.
const DRAWS: &[&str] =
    &["hard_shadow_map/", "light_silhouettes/", "depth_complexity/blended/", "receivers/place_on_triangles.wgsl"];

#[test]
fn every_kernel_has_a_twin_but_those_of_techniques_that_draw() {
    let mut found = [0, 0];
    for (file, _) in EMBEDDED {
        for (entry, point) in &module(file).unwrap().entry_points {
            if point.stage == Stage::Compute {
                let draws = DRAWS.iter().any(|path| file.starts_with(path));
                let kernel = Kernel { file, entry: entry.clone().leak() };
                assert_eq!(has_twin(kernel), !draws, "{kernel}");
                found[usize::from(draws)] += 1;
            }
        }
    }
    assert!(found[0] >= 50 && found[1] >= 7, "{found:?}");
}
