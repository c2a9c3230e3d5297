//! Scenes of the last calls as the device reads them, and what hides each light. A scene that moves takes one place: its last frame.

use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;
use std::time::Instant;

use softshadow_plan::{Content, ContentKey, Host};
use softshadow_scene::occluders::BoundaryEffect;
use softshadow_scene::{Light, LocalScene, Receivers, Scene};
use softshadow_techniques::parts::occluder_buffers::boundary_of;
use softshadow_techniques::{OccluderContents, SceneContents};

use crate::error::Error;
use crate::info::Preparation;

/// Scenes that are kept ready.
const KEPT_SCENES: usize = 4;

/// Lately used entries stand last.
#[derive(Default)]
pub(crate) struct SceneCache {
    scenes: Vec<KeptScene>,
    occluders: Vec<KeptOccluders>,
    superseded: Vec<ContentKey>,
}

struct KeptScene {
    identity: u64,
    topology: u64,
    contents: Arc<SceneContents>,
}

struct KeptOccluders {
    identity: u64,
    topology: u64,
    /// What the light's boundary does to the scene. Lights that do the same share an entry, wherever they are.
    effect: BoundaryEffect,
    /// The scene that the occluders were made of.
    scene: Arc<SceneContents>,
    contents: Arc<OccluderContents>,
}

/// A scene and what hides each light of a call, as the device reads them.
pub(crate) struct Prepared {
    pub(crate) contents: Arc<SceneContents>,
    /// One a light, where the technique wants them.
    pub(crate) occluders: Vec<Arc<OccluderContents>>,
    pub(crate) preparation: Preparation,
}

impl Prepared {
    /// Everything that plans may upload.
    pub(crate) fn uploads(&self) -> BTreeMap<ContentKey, Content> {
        let everything = self.contents.contents().chain(self.occluders.iter().flat_map(|o| o.contents()));
        everything.map(|c| (c.key, c.clone())).collect()
    }
}

impl SceneCache {
    /// The scene as a host reads it, and with `lights` what hides each: from the cache where it was used lately, from an earlier
    /// frame of a scene that moves, or made anew. With it, and with a failure, come the keys of contents that are replaced.
    pub(crate) fn prepare(
        &mut self,
        scene: &Scene,
        receivers: &Receivers,
        lights: &[Light],
        host: &Host,
    ) -> (Result<Prepared, Error>, Vec<ContentKey>) {
        // Without a vertex the frame is that of the points.
        let bounds = match receivers {
            Receivers::Points(points) => points_bounds(points.positions()),
            Receivers::Camera(_) => None,
        };
        let started = Instant::now();
        let mut preparation = Preparation::default();
        let contents = self.contents(scene, bounds, host.limits.storage_binding_bytes, &mut preparation);
        let occluders = self.occluders(scene, &contents, lights, &mut preparation);
        let superseded = self.superseded();
        preparation.preparation_ms = started.elapsed().as_secs_f64() * 1e3;
        (occluders.map(|occluders| Prepared { contents, occluders, preparation }), superseded)
    }

    /// The scene; `bounds` are those of the points where it has no vertex at all.
    fn contents(
        &mut self,
        scene: &Scene,
        bounds: Option<([f64; 3], [f64; 3])>,
        max_binding_bytes: u64,
        preparation: &mut Preparation,
    ) -> Arc<SceneContents> {
        if let Some(at) = self.scenes.iter().position(|kept| kept.identity == scene.identity()) {
            self.scenes[at..].rotate_left(1);
            return Arc::clone(&self.scenes[self.scenes.len() - 1].contents);
        }
        let earlier = self.scenes.iter().position(|kept| kept.topology == scene.topology());
        let refitted = earlier.and_then(|at| match self.scenes[at].contents.local.moved(scene) {
            Ok(local) => Some(local),
            Err(reason) => {
                preparation.rebuild_reasons.push(format!("scene: {reason}"));
                None
            }
        });
        *(if refitted.is_some() { &mut preparation.scene_refits } else { &mut preparation.scene_builds }) += 1;
        let local = refitted.unwrap_or_else(|| LocalScene::new(scene, bounds, max_binding_bytes));
        let contents = Arc::new(SceneContents::new(local));
        if contents.local.triangle_count() > 0 {
            let (identity, topology) = (scene.identity(), scene.topology());
            if earlier.is_some() || self.scenes.len() == KEPT_SCENES {
                let old = self.scenes.remove(earlier.unwrap_or_default());
                self.superseded.extend(old.contents.contents().map(|content| content.key));
            }
            self.scenes.push(KeptScene { identity, topology, contents: Arc::clone(&contents) });
        }
        contents
    }

    /// What hides each light.
    fn occluders(
        &mut self,
        scene: &Scene,
        contents: &Arc<SceneContents>,
        lights: &[Light],
        preparation: &mut Preparation,
    ) -> Result<Vec<Arc<OccluderContents>>, Error> {
        let found = lights.iter().map(|light| self.occluders_of(scene, contents, light, preparation));
        let found = found.collect::<Result<Vec<_>, _>>();
        // After a failure too: otherwise a moving scene that fails every frame would leave one entry each.
        if !lights.is_empty() {
            self.drop_occluders(scene, KEPT_SCENES.max(lights.len()));
        }
        found
    }

    /// Drops what was made of earlier frames of a scene, and the oldest entries beyond `most`.
    fn drop_occluders(&mut self, scene: &Scene, most: usize) {
        let is_current = |kept: &KeptOccluders| kept.topology != scene.topology() || kept.identity == scene.identity();
        let (current, mut dropped): (Vec<_>, Vec<_>) = self.occluders.drain(..).partition(is_current);
        self.occluders = current;
        dropped.extend(self.occluders.drain(..self.occluders.len().saturating_sub(most)));
        self.superseded.extend(dropped.iter().flat_map(|kept| kept.contents.contents()).map(|content| content.key));
    }

    fn occluders_of(
        &mut self,
        scene: &Scene,
        contents: &Arc<SceneContents>,
        light: &Light,
        preparation: &mut Preparation,
    ) -> Result<Arc<OccluderContents>, Error> {
        let (identity, topology) = (scene.identity(), scene.topology());
        let boundary = boundary_of(&contents.local, light);
        let effect = boundary.effect(&contents.local);
        if let Some(at) = self.occluders.iter().position(|kept| kept.identity == identity && kept.effect == effect) {
            self.occluders[at..].rotate_left(1);
            return Ok(Arc::clone(&self.occluders[self.occluders.len() - 1].contents));
        }
        let is_related = |kept: &&KeptOccluders| kept.topology == topology;
        let related = self.occluders.iter().rev().filter(is_related);
        // An entry with the same effect serves best; any other says why it does not.
        let best = related.clone().find(|kept| kept.effect == effect).or_else(|| related.clone().next());
        let refitted =
            best.and_then(|kept| match kept.contents.moved(&kept.scene.local, &contents.local, boundary, &effect) {
                Ok(moved) => Some(moved),
                Err(reason) => {
                    preparation.rebuild_reasons.push(format!("occluders: {reason}"));
                    None
                }
            });
        let made = match refitted {
            Some(moved) => {
                preparation.occluder_refits += 1;
                moved
            }
            None => {
                preparation.occluder_builds += 1;
                OccluderContents::new(&contents.local, boundary)?
            }
        };
        let made = Arc::new(made);
        let (scene, contents) = (Arc::clone(contents), Arc::clone(&made));
        self.occluders.push(KeptOccluders { identity, topology, effect, scene, contents });
        Ok(made)
    }

    /// Keys of contents that were replaced since the last call, without those that are still kept.
    fn superseded(&mut self) -> Vec<ContentKey> {
        let mut keys = std::mem::take(&mut self.superseded);
        let kept = self.scenes.iter().flat_map(|kept| kept.contents.contents());
        let kept = kept.chain(self.occluders.iter().flat_map(|kept| kept.contents.contents()));
        let kept: HashSet<ContentKey> = kept.map(|content| content.key).collect();
        keys.retain(|key| !kept.contains(key));
        keys
    }
}

fn points_bounds(points: &[[f64; 3]]) -> Option<([f64; 3], [f64; 3])> {
    let first = *points.first()?;
    Some(points.iter().fold((first, first), |(low, high), p| {
        ([0, 1, 2].map(|k| p[k].min(low[k])), [0, 1, 2].map(|k| p[k].max(high[k])))
    }))
}

#[cfg(test)]
mod tests {
    use softshadow_scene::{LightShape, Material, Mesh, look_at};

    use super::*;

    #[test]
    fn a_moving_scene_takes_one_place_whether_its_frames_fail_or_not() {
        let corners = |frame: u32| vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.1 * f64::from(frame)]];
        let mesh =
            Mesh::new("leaf", corners(0), vec![[0, 1, 2]], Material { opacity: 0.5, ..Material::default() }).unwrap();
        let still = Scene::new(vec![mesh]).unwrap();
        let ball = |z| {
            let pose = look_at([0.0, 0.0, z], [0.0, 0.0, z - 1.0], Some([0.0, 1.0, 0.0])).unwrap();
            Light::new(LightShape::Sphere { radius: 0.5 }, pose).unwrap()
        };
        let mut cache = SceneCache::default();
        for frame in 0..10 {
            let scene = still.with_vertices(vec![Some(corners(frame))]).unwrap();
            // Every other frame has a light that the leaf touches, which something semi-opaque must not.
            let (lights, fails) = ([ball(3.0), ball(if frame % 2 == 0 { 0.0 } else { 4.0 })], frame % 2 == 0);
            let mut preparation = Preparation::default();
            let contents = cache.contents(&scene, None, 1 << 20, &mut preparation);
            assert_eq!(cache.occluders(&scene, &contents, &lights, &mut preparation).is_err(), fails);
            assert_eq!((cache.scenes.len(), cache.occluders.len()), (1, 1), "frame {frame}");
            assert_eq!(cache.superseded().is_empty(), frame == 0, "the last frame's buffers are named");
        }
    }
}
