//! The cull changes no verdict, and the verdicts of single blockers are what the bounds say.

use super::*;
use crate::test_scenes::{add_offset, beyond_an_edge, float32_vector, hostile_mesh, uniforms, vertex};

impl RayReference {
    fn verdicts_without_cull(&self, receiver: &Receiver, targets: &[Target]) -> Vec<SampleVerdict> {
        let all: Vec<ShadowVolume> = self.blockers(receiver).collect();
        targets
            .iter()
            .map(|target| {
                let ray = Ray::new(receiver.origin, target);
                verdict(block(&ray, beyond_horizon(receiver, &ray), &all))
            })
            .collect()
    }
}

#[test]
fn the_cull_changes_no_verdict() {
    let mut next = uniforms(1);
    let (mut kept, mut seen, mut grazing) = (0, 0, 0);
    for round in 0..200 {
        let mesh = hostile_mesh(&mut next, 150);
        let scene = RayReference::new(&mesh).unwrap();
        let mut receiver = Receiver::at(float32_vector(&mut next, 2.0));
        match round % 4 {
            1 => receiver.normal = Some(float32_vector(&mut next, 1.0)),
            2 => receiver.origin[2] = 0.0,
            3 => receiver.excluded_triangle = Some(5),
            _ => {}
        }
        let light = float32_vector(&mut next, 8.0);
        let spread = 10_f64.powf(next() * 3.0 - 2.0);
        let targets: Vec<Target> = (0..64)
            .map(|sample| {
                let at = match sample % 8 {
                    3.. if round % 10 == 7 => vertex(beyond_an_edge(&mesh[sample], receiver.origin)),
                    _ => vertex(add_offset(light, &mut next, spread)),
                };
                if round % 5 == 0 && sample % 2 == 0 { Target::Direction(at) } else { Target::Point(at) }
            })
            .collect();
        let expected = scene.verdicts_without_cull(&receiver, &targets);
        assert_eq!(scene.verdicts(&receiver, &targets), expected, "round {round}");
        grazing += expected.iter().filter(|v| v.grazing).count();

        let rays: Vec<Ray> = targets.iter().map(|target| Ray::new(receiver.origin, target)).collect();
        let hull = TargetHull::around(rays.iter()).unwrap();
        for volume in scene.blockers(&receiver) {
            seen += 1;
            let touches = volume.may_touch(&hull);
            kept += usize::from(touches);
            let possible = rays.iter().any(|ray| volume.contact(ray).possible);
            assert!(touches || !possible, "a culled triangle could hit");
        }
    }
    // The comparison means something only if the cull culls and the scenes are hard.
    assert!(kept * 2 < seen, "the cull keeps {kept} of {seen}");
    assert!(grazing > 100, "only {grazing} grazing samples");
}

#[test]
fn a_hull_that_misses_a_target_is_caught() {
    // The spoilt cull: a hull around the first target only.
    let scene = [[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [0.0, 1.0, 1.0]];
    let volume = ShadowVolume::new([0.0; 3], &scene);
    let [far, under] = [[9.0, 0.0, 2.0], [0.0, 0.0, 2.0]].map(|point| Ray::new([0.0; 3], &Target::Point(point)));
    let spoilt = TargetHull::around([far].iter()).unwrap();
    assert!(!volume.may_touch(&spoilt));
    assert!(volume.contact(&under).possible);
    let whole = TargetHull::around([far, under].iter()).unwrap();
    assert!(volume.may_touch(&whole));
}

#[test]
fn contacts_are_certain_only_beyond_the_bound() {
    let triangle = [[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [0.0, 1.0, 1.0]];
    let volume = ShadowVolume::new([0.0; 3], &triangle);
    let contact = |point: Vec3| volume.contact(&Ray::new([0.0; 3], &Target::Point(point)));
    let inside = contact([0.0, 0.0, 2.0]);
    assert!(inside.hit && inside.certain);
    let on_edge = contact([0.0, -2.0, 2.0]);
    assert!(on_edge.possible && !on_edge.certain);
    // Bounds that are ten times too small would call this one certain.
    let just_outside = contact([0.0, -2.0 - 1e-6, 2.0]);
    assert!(!just_outside.hit && just_outside.possible);
    assert_eq!(contact([0.0, -2.1, 2.0]), Contact::NONE);
    let on_triangle = contact([0.0, 0.0, 1.0]);
    assert!(on_triangle.possible && !on_triangle.certain);
    assert_eq!(contact([0.0, 0.0, 0.9]), Contact::NONE);
}
