//! Offsets and scales: where a scene stands and how large it is changes nothing.

use softshadow::{Light, Receivers, Scene};

use super::judge::{Case, expect_rays};
use super::{MANY, aimed};
use crate::common::{Random, bits, points, rectangle};
use crate::shapes::{Point, map, scene, sphere, torus};

/// All coordinates are multiples of 2^-20, so that adding a whole number rounds nothing.
fn dyadic(p: Point) -> Point {
    p.map(|x| (x * 1_048_576.0).round() / 1_048_576.0)
}

struct Placed {
    scene: Scene,
    light: Light,
    receivers: Receivers,
}

fn placed(scale: f64, offset: Point) -> Placed {
    let place = |p: Point| {
        let p = dyadic(p);
        [0, 1, 2].map(|k| p[k] * scale + offset[k])
    };
    let bodies = [torus(0.5, 0.25, 16, 8), sphere([0.25, 0.0, 0.5], 0.25, 2)].concat();
    let around = Random(70).points(MANY, [-1.0, 1.0], [-1.0, 1.0], [-1.0, 1.0]);
    Placed {
        scene: scene(&map(&bodies, place)),
        light: aimed(rectangle(scale, 0.75 * scale), place([0.125, 0.25, 3.0]), place([0.0; 3])),
        receivers: points(around.into_iter().map(place).collect()),
    }
}

impl Placed {
    fn case(&self) -> Case {
        Case::run(&self.scene, &self.light, &self.receivers)
    }
}

#[test]
fn powers_of_two_and_whole_offsets_change_no_bit() {
    let seen = |placed: &Placed| bits(&placed.case().seen);
    let expected = seen(&placed(1.0, [0.0; 3]));
    for (scale, offset) in [
        (2f64.powi(-20), [0.0; 3]),
        (2f64.powi(20), [0.0; 3]),
        (1.0, [524_288.0, 4_194_304.0, 0.0]),
        (1.0, [500_000.0, 4_000_000.0, 300.0]),
    ] {
        assert!(seen(&placed(scale, offset)) == expected, "{scale:e} {offset:?}");
    }
    // A length that does not scale with the rest is noticed, and so is an offset that rounds.
    let mut spoilt = placed(1.0, [0.0; 3]);
    spoilt.light = placed(1.0 + 1e-3, [0.0; 3]).light;
    assert!(seen(&spoilt) != expected);
    assert!(seen(&placed(1.0, [0.0, 0.0, 1e13])) != expected);
}

#[test]
fn any_place_has_the_bits_of_rays() {
    for (name, scale, offset) in [
        ("sizes: 1e-4, off the origin", 1e-4, [0.3, -0.2, 0.7]),
        ("sizes: 2^20", 2f64.powi(20), [0.0; 3]),
        ("sizes: UTM", 1.0, [500_000.25, 4_000_000.1, 300.7]),
    ] {
        expect_rays(name, [placed(scale, offset).case()]);
    }
}
