//! The grid: scenes, lights, receivers, techniques, and what is wanted.

use std::sync::Arc;

use softshadow_plan::{Host, Plan, Values};
use softshadow_scene::{
    Camera, Light, LightShape, LightTexture, LocalScene, Material, Mesh, Points, SamplePattern, SampleSpread, Scene,
    look_at,
};
use softshadow_techniques::occlusion_layers::{Filter, Near};
use softshadow_techniques::parts::occluder_buffers::boundary_of;
use softshadow_techniques::penumbra_map::Ramp;
use softshadow_techniques::{
    Attenuation, Block, CameraRamp, DepthComplexity, HardShadowMap, OccluderContents, OcclusionCamera, OcclusionLayers,
    PenumbraMap, RayTraced, ReceiverSource, Request, SceneContents, Shading, Technique, Wants,
};

/// Width and height of the grid's images.
pub(crate) const SIZE: [u32; 2] = [8, 4];
/// How many points the grid's point requests have.
pub(crate) const POINTS: usize = 5;

/// Everything that requests refer to.
pub(crate) struct Fixture {
    /// Without triangles, with one sub-scene, with two, with two and the upper of two sheets semi-opaque.
    pub(crate) scenes: [SceneContents; 4],
    pub(crate) camera: Camera,
    pub(crate) points: Points,
    /// A rectangle above the scene, a rectangle within it, a sphere, a sun, a rectangle with a texture, and a sphere that
    /// triangles touch.
    pub(crate) lights: Vec<Light>,
    /// What hides each light, by scene. Where something is semi-opaque, the last light has nothing: triangles touch it.
    pub(crate) occluders: [Vec<Arc<OccluderContents>>; 4],
}

impl Fixture {
    pub(crate) fn new() -> Self {
        let rows = |z: f64| [[-1.0, -1.0, z], [1.0, -1.0, z], [1.0, 1.0, z], [-1.0, 1.0, z]];
        let sheet = |z, opacity| {
            let material = Material { opacity, ..Material::default() };
            Mesh::new("sheet", rows(z).to_vec(), vec![[0, 1, 2], [0, 2, 3]], material).unwrap()
        };
        let sheets = Scene::new(vec![sheet(0.0, 1.0), sheet(0.5, 1.0)]).unwrap();
        let glass = Scene::new(vec![sheet(0.0, 1.0), sheet(0.5, 0.25)]).unwrap();
        let contents = |scene: &Scene, binding| SceneContents::new(LocalScene::new(scene, None, binding));
        // Two hierarchy nodes of 32 bytes a triangle: 128 bytes hold two of the four triangles.
        let empty = Scene::new(Vec::new()).unwrap();
        let scenes =
            [contents(&empty, 1 << 20), contents(&sheets, 1 << 20), contents(&sheets, 128), contents(&glass, 128)];
        assert_eq!(scenes.each_ref().map(|s| s.local.sub_scenes.len()), [0, 1, 2, 2]);
        let down = |from| look_at(from, [0.0, 0.0, -9.0], Some([0.0, 1.0, 0.0])).unwrap();
        let light = |shape, from| Light::new(shape, down(from)).unwrap();
        let rectangle = LightShape::Rectangle { width: 1.0, height: 0.5 };
        let texture = LightTexture::new(2, 1, vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).unwrap();
        let lights = vec![
            light(rectangle.clone(), [0.0, 0.0, 5.0]),
            light(rectangle.clone(), [0.0, 0.0, 0.25]),
            light(LightShape::Sphere { radius: 0.5 }, [0.0, 0.0, 5.0]),
            light(LightShape::Sun { angular_diameter: 0.01 }, [0.0, 0.0, 5.0]),
            light(rectangle, [0.0, 0.0, 5.0]).with_texture(texture).unwrap(),
            light(LightShape::Sphere { radius: 0.3 }, [0.0, 0.0, 0.5]),
        ];
        let occluders = scenes.each_ref().map(|scene| {
            let of = |light| OccluderContents::new(&scene.local, boundary_of(&scene.local, light)).ok().map(Arc::new);
            lights.iter().map_while(of).collect::<Vec<_>>()
        });
        let positions = (0..POINTS).map(|n| [0.1 * n as f64, 0.0, 0.1]).collect();
        Self {
            scenes,
            camera: Camera::look_at([3.0, 0.5, 4.0], [0.0; 3], None, 45.0, SIZE).unwrap(),
            points: Points::new(positions, Some(vec![[0.0, 0.0, 1.0]; POINTS])).unwrap(),
            lights,
            occluders,
        }
    }

    pub(crate) fn camera(&self) -> ReceiverSource<'_> {
        ReceiverSource::Camera(&self.camera)
    }

    pub(crate) fn points(&self) -> ReceiverSource<'_> {
        ReceiverSource::Points(&self.points)
    }

    /// A request for everything at once in one block, for the first light; the tests change what they are about.
    pub(crate) fn request<'a>(&'a self, scene: usize, receivers: ReceiverSource<'a>) -> Request<'a> {
        self.request_for(scene, receivers, 0)
    }

    /// The same for another light, with what hides it.
    pub(crate) fn request_for<'a>(&'a self, scene: usize, receivers: ReceiverSource<'a>, light: usize) -> Request<'a> {
        Request {
            scene: &self.scenes[scene],
            receivers,
            block: Block { first: 0, count: receivers.count(), skip: 0, keep: receivers.count() },
            light: &self.lights[light],
            occluders: self.occluders[scene].get(light).map(Arc::as_ref),
            channels: 1,
            opens_block: true,
            first_light: true,
            opens_run: true,
            only_light: true,
            closes_light: true,
            closes_block: true,
            stage: 0,
            decision: [0; 4],
            wants: Wants::default(),
            host: Host::default(),
        }
    }

    /// The whole grid, as the front door asks a technique: with occluders for who works on them, without lights that have none, and without
    /// receivers that it does not serve.
    pub(crate) fn requests(&self, technique: &Technique) -> Vec<Request<'_>> {
        let asks = technique.wants_occluders();
        let mut grid = Vec::new();
        let wants = |picture, all| Wants { standard_error: all, sample_masks: all, picture };
        // First of all stages, first of a block, a middle one, the last.
        let places = [[true, true, true, true], [false, true, false, false], [false; 4], [false, false, true, true]];
        for scene in 0..self.scenes.len() {
            let served =
                |receivers: &ReceiverSource<'_>| technique.check_call(*receivers, &[], &Host::default()).is_ok();
            for receivers in [self.camera(), self.points()].into_iter().filter(served) {
                // And without lights that it refuses.
                let takes = |index: usize| {
                    let request = self.request_for(scene, receivers, index);
                    !asks && technique.values(&request, request.light, 0).is_ok()
                };
                let has_all = |index: &usize| takes(*index) || asks && *index < self.occluders[scene].len();
                for index in (0..self.lights.len()).filter(has_all) {
                    // A picture shows a material, and without triangles there is none: the front door asks for no such plan.
                    let pictures = [None, Some(Shading::Integrated), Some(Shading::Modulated)];
                    let shown = if scene == 0 { 1 } else { pictures.len() };
                    for picture in pictures.into_iter().take(shown) {
                        for [opens_run, opens_block, closes_light, closes_block] in places {
                            let channels = if index == 4 { 3 } else { 1 };
                            let wants = wants(picture, index % 2 == 0);
                            let base = self.request_for(scene, receivers, index);
                            grid.push(Request {
                                occluders: base.occluders.filter(|_| asks),
                                channels,
                                opens_run,
                                opens_block,
                                closes_light,
                                closes_block,
                                wants,
                                ..base
                            });
                        }
                    }
                }
            }
        }
        grid
    }
}

pub(crate) fn techniques() -> Vec<Technique> {
    let traced = |samples, probes, passes| {
        let pattern = if samples % 2 == 0 { SamplePattern::Stratified } else { SamplePattern::LowDiscrepancy };
        Technique::RayTraced(RayTraced { samples, probes, passes, pattern, seed: 7, ..RayTraced::default() })
    };
    let mut all = Technique::defaults();
    all.extend([traced(1, 0, 1), traced(33, 8, 3), traced(64, 63, 1), traced(1000, 0, 2)]);
    let silhouettes = |samples, exact_area, passes| {
        let pattern = if samples % 2 == 0 { SamplePattern::Stratified } else { SamplePattern::LowDiscrepancy };
        Technique::DepthComplexity(DepthComplexity {
            samples,
            exact_area,
            passes,
            pattern,
            seed: 7,
            ..DepthComplexity::default()
        })
    };
    all.extend([
        silhouettes(1, true, 2),
        silhouettes(16, false, 1),
        silhouettes(33, false, 3),
        silhouettes(256, true, 1),
    ]);
    let sum = DepthComplexity { attenuation: Attenuation::Sum, ..DepthComplexity::default() };
    all.push(Technique::DepthComplexity(sum));
    for spread in [SampleSpread::Decorrelated, SampleSpread::Interleaved] {
        let spreads =
            |samples, probes, passes, tile| RayTraced { samples, probes, passes, spread, tile, ..RayTraced::default() };
        all.extend([spreads(16, 0, 1, 4), spreads(33, 8, 2, 3)].map(Technique::RayTraced));
        let spreads = |samples, exact_area, tile| DepthComplexity {
            samples,
            exact_area,
            spread,
            tile,
            ..DepthComplexity::default()
        };
        all.extend([spreads(64, true, 4), spreads(256, false, 5)].map(Technique::DepthComplexity));
    }
    all.extend([16, 300].map(|resolution| Technique::HardShadowMap(HardShadowMap { resolution })));
    all.push(Technique::PenumbraMap(PenumbraMap { resolution: 300, ramp: Ramp::Paper }));
    let bent = OcclusionCamera { resolution: 48, steps: 1, bias: 0.0, ramp: CameraRamp::Bernstein };
    all.push(Technique::OcclusionCamera(bent));
    let layers = |slices, resolution, split, near| OcclusionLayers {
        slices,
        resolution,
        split,
        near,
        ..OcclusionLayers::default()
    };
    all.extend(
        [layers(3, 64, 1, Near::Fade), layers(128, 128, 8, Near::Fade), layers(1, 256, 3, Near::Rays)]
            .map(Technique::OcclusionLayers),
    );
    let filtered = |filter| OcclusionLayers { filter, ..layers(6, 64, 1, Near::Rays) };
    all.extend([Filter::Nbuffer, Filter::Mipmap].map(|filter| Technique::OcclusionLayers(filtered(filter))));
    all
}

/// The plan and the values of a request's first pass.
pub(crate) fn stage(technique: &Technique, request: &Request<'_>) -> (Plan, Values) {
    (technique.plan(request), technique.values(request, request.light, 0).unwrap())
}
