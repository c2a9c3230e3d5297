//! Sphere lights where they meet something: what lies behind their front hides nothing, and inside them is light everywhere.

use softshadow::{
    Camera, Light, LightShape, Material, Mesh, Picture, PictureOptions, RayTraced, Scene, Shading, Technique, render,
};

use crate::common::{context, hard_shadow_map, lamp, points, ray_traced, rectangle, see};

fn plate(z: f64, half: f64) -> Mesh {
    let corners = [[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]];
    let material = Material { base_color: [0.8; 3], roughness: 1.0, specular: 0.0, opacity: 1.0 };
    Mesh::new("plate", corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]], material).unwrap()
}

#[test]
fn a_ceiling_behind_a_lamp_hides_nothing_of_it() {
    let lamp_under = |z: f64| Scene::new(vec![plate(z, 20.0)]).unwrap();
    let light = lamp(LightShape::Sphere { radius: 1.0 }, [0.0, 0.0, 1.0]);
    let receivers =
        points(vec![[1.05, 0.0, 1.0], [1.5, 0.0, 1.0], [1.2, 0.3, 0.6], [3.0, -1.0, 0.2], [0.2, 0.1, -2.0]]);
    let seen = see(&lamp_under(2.1), std::slice::from_ref(&light), &receivers, &ray_traced(256));
    assert_eq!(seen.values, [1.0; 5], "the plate lies wholly behind the lamp");
    // A plate that cuts the lamp hides what lies above it.
    let cut = see(&lamp_under(1.2), std::slice::from_ref(&light), &receivers, &ray_traced(256));
    assert!([1, 3].iter().all(|&i: &usize| cut.values[i] < 0.9), "{:?}", cut.values);
}

#[test]
fn what_lies_inside_a_lamp_casts_no_hard_shadow_either() {
    let light = lamp(LightShape::Sphere { radius: 1.0 }, [0.0, 0.0, 3.0]);
    let receivers = points(vec![[0.1, 0.0, 0.0], [0.7, -0.4, 0.1], [-3.0, 2.0, 0.2]]);
    for (z, lit) in [(2.8, true), (1.5, false)] {
        let scene = Scene::new(vec![plate(z, 0.8), plate(-2.0, 9.0)]).unwrap();
        let seen = see(&scene, std::slice::from_ref(&light), &receivers, &hard_shadow_map(512));
        assert_eq!(seen.values[..2], [f32::from(u8::from(lit)); 2], "plate at {z}");
        assert_eq!(seen.values[2], 1.0, "beside the plate");
    }
}

fn picture(scene: &Scene, lights: &[Light], technique: RayTraced, shading: Shading) -> Picture {
    let camera = Camera::look_at([0.0, 0.0, 2.0], [0.0; 3], None, 30.0, [8, 8]).unwrap();
    let options = PictureOptions { shading, ..PictureOptions::default() };
    let technique = Technique::RayTraced(technique);
    let picture = render(context(), scene, lights, &camera, &technique, &options, &mut |_, _| true).unwrap();
    assert!(picture.linear.iter().flatten().all(|c| c.is_finite()));
    picture
}

#[test]
fn inside_a_sphere_light_a_surface_returns_its_share() {
    let scene = Scene::new(vec![plate(0.0, 3.0)]).unwrap();
    let light = lamp(LightShape::Sphere { radius: 9.0 }, [0.0, 0.0, 0.0]);
    for samples in [1, 16, 64] {
        let technique = RayTraced { samples, ..RayTraced::default() };
        let seen = picture(&scene, std::slice::from_ref(&light), technique, Shading::Integrated);
        assert!(seen.linear.iter().flatten().all(|c| (c - 0.8).abs() < 1e-5), "{samples} samples");
    }
}

#[test]
fn modulated_light_is_the_unshadowed_light_times_the_final_visibility() {
    // A cover hides about half of the light. Of few samples each pass sees another share, so that the order of averaging shows.
    let open = Scene::new(vec![plate(0.0, 3.0)]).unwrap();
    let light = lamp(rectangle(0.5, 0.5), [0.0, 0.0, 60.0]);
    let cover = Mesh::new(
        "cover",
        vec![[0.03, -9.0, 59.9], [9.0, -9.0, 59.9], [9.0, 9.0, 59.9], [0.03, 9.0, 59.9]],
        vec![[0, 1, 2], [0, 2, 3]],
        Material::default(),
    );
    let covered = Scene::new(vec![plate(0.0, 3.0), cover.unwrap()]).unwrap();
    for passes in [1, 2, 5] {
        let technique = RayTraced { samples: 3, passes, ..RayTraced::default() };
        let lights = [light.clone(), light.clone()];
        let [whole, seen] = [&open, &covered].map(|s| picture(s, &lights, technique.clone(), Shading::Modulated));
        for ((all, part), visible) in whole.linear.iter().zip(&seen.linear).zip(&seen.visibility.values) {
            assert!(*visible > 0.0 && *visible < 1.0);
            assert!((part[0] / all[0] - visible).abs() < 1e-3, "{passes} passes: {} for {visible}", part[0] / all[0]);
        }
    }
}
