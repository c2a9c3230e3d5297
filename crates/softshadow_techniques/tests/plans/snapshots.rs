//! A handful of plans as text: what a change to a technique changes stands in the diff.

use softshadow_techniques::penumbra_map::Ramp;
use softshadow_techniques::{
    DepthComplexity, HardShadowMap, OcclusionCamera, OcclusionLayers, PenumbraMap, RayTraced, Request, Shading,
    Technique,
};

use crate::requests::Fixture;

fn traced(probes: u32) -> Technique {
    Technique::RayTraced(RayTraced { probes, ..RayTraced::default() })
}

#[test]
fn ray_traced_points() {
    let fixture = Fixture::new();
    insta::assert_snapshot!(traced(0).plan(&fixture.request(1, fixture.points())));
}

#[test]
fn ray_traced_everything() {
    let fixture = Fixture::new();
    let mut request = Request { channels: 3, ..fixture.request_for(2, fixture.camera(), 4) };
    request.wants.picture = Some(Shading::Integrated);
    request.wants.standard_error = true;
    request.wants.sample_masks = true;
    insta::assert_snapshot!(traced(8).plan(&request));
}

#[test]
fn ray_traced_second_light() {
    let fixture = Fixture::new();
    let request = fixture.request(1, fixture.camera());
    insta::assert_snapshot!(traced(0).plan(&Request { opens_block: false, opens_run: false, ..request }));
}

#[test]
fn hard_shadow_map_within_the_scene() {
    let fixture = Fixture::new();
    let mut request = fixture.request_for(1, fixture.points(), 1);
    request.wants.picture = Some(Shading::Modulated);
    let technique = Technique::HardShadowMap(HardShadowMap { resolution: 512 });
    insta::assert_snapshot!(technique.plan(&request));
}

#[test]
fn penumbra_map_of_a_sphere() {
    let fixture = Fixture::new();
    let mut request = fixture.request_for(1, fixture.camera(), 2);
    request.wants.picture = Some(Shading::Modulated);
    let technique = Technique::PenumbraMap(PenumbraMap { resolution: 512, ramp: Ramp::Light });
    insta::assert_snapshot!(technique.plan(&request));
}

#[test]
fn occlusion_camera_points() {
    let fixture = Fixture::new();
    let technique = Technique::OcclusionCamera(OcclusionCamera { resolution: 512, ..OcclusionCamera::default() });
    insta::assert_snapshot!(technique.plan(&fixture.request(1, fixture.points())));
}

#[test]
fn occlusion_layers_of_two_sub_scenes() {
    let fixture = Fixture::new();
    let mut request = fixture.request(2, fixture.camera());
    request.wants.picture = Some(Shading::Modulated);
    let technique = Technique::OcclusionLayers(OcclusionLayers::default());
    insta::assert_snapshot!(technique.plan(&request));
}

fn silhouettes(samples: u32) -> Technique {
    Technique::DepthComplexity(DepthComplexity { samples, ..DepthComplexity::default() })
}

#[test]
fn depth_complexity_points() {
    let fixture = Fixture::new();
    insta::assert_snapshot!(silhouettes(64).plan(&fixture.request(1, fixture.points())));
}

#[test]
fn depth_complexity_everything() {
    let fixture = Fixture::new();
    let mut request = Request { channels: 3, ..fixture.request_for(2, fixture.camera(), 4) };
    request.wants.picture = Some(Shading::Integrated);
    request.wants.standard_error = true;
    request.wants.sample_masks = true;
    insta::assert_snapshot!(silhouettes(256).plan(&request));
}

#[test]
fn depth_complexity_second_light_within_the_scene() {
    let fixture = Fixture::new();
    let mut request = fixture.request_for(1, fixture.camera(), 1);
    request.wants.picture = Some(Shading::Modulated);
    insta::assert_snapshot!(silhouettes(16).plan(&Request { opens_block: false, opens_run: false, ..request }));
}

#[test]
fn ray_traced_semi_opaque() {
    let fixture = Fixture::new();
    let mut request = fixture.request(3, fixture.points());
    request.wants.sample_masks = true;
    insta::assert_snapshot!(traced(8).plan(&request));
}

#[test]
fn depth_complexity_semi_opaque() {
    let fixture = Fixture::new();
    let mut request = fixture.request(3, fixture.camera());
    request.wants.picture = Some(Shading::Integrated);
    request.wants.sample_masks = true;
    insta::assert_snapshot!(silhouettes(64).plan(&request));
}

#[test]
fn depth_complexity_empty_scene() {
    let fixture = Fixture::new();
    insta::assert_snapshot!(silhouettes(64).plan(&fixture.request(0, fixture.points())));
}

#[test]
fn explanation() {
    let fixture = Fixture::new();
    insta::assert_snapshot!(traced(8).plan(&fixture.request(1, fixture.camera())).explain());
}
