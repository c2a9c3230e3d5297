//! An open device and what is kept for it: the engine, and the scenes of the last calls as the device reads them.

use std::collections::VecDeque;
use std::str::FromStr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use softshadow_engine::{AdapterChoice, AdapterInfo, DeviceKind, Engine};
use softshadow_scene::{Light, LocalScene, Receivers, Scene};
use softshadow_techniques::parts::occluder_buffers::boundary_of;
use softshadow_techniques::{OccluderContents, SceneContents};

use crate::error::Error;

/// Scenes that are kept ready.
const KEPT_SCENES: usize = 4;

/// Which device computes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DeviceChoice {
    /// A GPU, else a software driver on the CPU.
    #[default]
    Auto,
    /// A GPU.
    Gpu,
    /// A software driver on the CPU.
    Software,
    /// The adapter with this position in [`adapters`].
    Index(usize),
}

impl FromStr for DeviceChoice {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        match text {
            "auto" => Ok(Self::Auto),
            "gpu" => Ok(Self::Gpu),
            "software" => Ok(Self::Software),
            _ => text.parse().map(Self::Index).map_err(|_| {
                Error::Settings(format!("device '{text}' is none of 'auto', 'gpu', 'software' or an adapter's index"))
            }),
        }
    }
}

/// Every adapter of this machine.
#[must_use]
pub fn adapters() -> Vec<AdapterInfo> {
    softshadow_engine::adapters()
}

/// A device and its caches. Calls from several threads take turns.
pub struct Context {
    choice: AdapterChoice,
    adapter: AdapterInfo,
    engine: Mutex<Arc<Engine>>,
    scenes: Mutex<VecDeque<(u64, Arc<SceneContents>)>>,
    occluders: Mutex<VecDeque<(u64, Arc<OccluderContents>)>>,
}

impl Context {
    /// Opens a device.
    ///
    /// # Errors
    /// [`Error::Device`] says how to install one where there is none.
    pub fn new(choice: &DeviceChoice) -> Result<Self, Error> {
        let choice = match *choice {
            DeviceChoice::Auto => AdapterChoice::Auto,
            DeviceChoice::Gpu => AdapterChoice::Gpu,
            DeviceChoice::Software => AdapterChoice::Software,
            DeviceChoice::Index(index) => AdapterChoice::Index(index),
        };
        let engine = Engine::new(choice)?;
        let adapter = engine.adapter().clone();
        if adapter.device_type == DeviceKind::Software {
            log::warn!("'{}' is a software adapter: everything runs on the CPU", adapter.name);
        }
        Ok(Self {
            choice,
            adapter,
            engine: Mutex::new(Arc::new(engine)),
            scenes: Mutex::default(),
            occluders: Mutex::default(),
        })
    }

    /// What the device is.
    #[must_use]
    pub fn adapter(&self) -> &AdapterInfo {
        &self.adapter
    }

    /// Destroys the device as a failing driver would, for tests of what follows.
    pub fn lose_device(&self) {
        lock(&self.engine).destroy();
    }

    /// The engine; opened again where the device was lost.
    pub(crate) fn engine(&self) -> Result<Arc<Engine>, Error> {
        let mut engine = lock(&self.engine);
        if engine.is_lost() {
            *engine = Arc::new(Engine::new(self.choice)?);
        }
        Ok(Arc::clone(&engine))
    }

    /// The scene as the device reads it, from the cache where it was used lately.
    pub(crate) fn contents(&self, scene: &Scene, receivers: &Receivers) -> Result<Arc<SceneContents>, Error> {
        let mut scenes = lock(&self.scenes);
        if let Some(at) = scenes.iter().position(|(identity, _)| *identity == scene.identity()) {
            let known = scenes.remove(at);
            scenes.extend(known);
            return Ok(Arc::clone(&scenes[scenes.len() - 1].1));
        }
        // Without a vertex the frame is that of the points.
        let bounds = match receivers {
            Receivers::Points(points) => points_bounds(points.positions()),
            Receivers::Camera(_) => None,
        };
        let binding = self.engine()?.host().limits.storage_binding_bytes;
        let contents = Arc::new(SceneContents::new(LocalScene::new(scene, bounds, binding)));
        if contents.local.triangle_count() > 0 {
            scenes.push_back((scene.identity(), Arc::clone(&contents)));
            if scenes.len() > KEPT_SCENES {
                scenes.pop_front();
            }
        }
        Ok(contents)
    }

    /// What hides each light, from the cache where it was used lately.
    pub(crate) fn occluders(
        &self,
        scene: &Scene,
        contents: &SceneContents,
        lights: &[Light],
    ) -> Result<Vec<Arc<OccluderContents>>, Error> {
        let of = |light: &Light| {
            let boundary = boundary_of(&contents.local, light);
            let mut kept = lock(&self.occluders);
            let is_it =
                |(id, known): &&(u64, Arc<OccluderContents>)| *id == scene.identity() && known.boundary == boundary;
            if let Some(at) = kept.iter().position(|entry| is_it(&entry)) {
                let known = kept.remove(at);
                kept.extend(known);
                return Ok(Arc::clone(&kept[kept.len() - 1].1));
            }
            let made = Arc::new(OccluderContents::new(&contents.local, boundary)?);
            kept.push_back((scene.identity(), Arc::clone(&made)));
            if kept.len() > KEPT_SCENES.max(lights.len()) {
                kept.pop_front();
            }
            Ok(made)
        };
        lights.iter().map(of).collect()
    }
}

fn points_bounds(points: &[[f64; 3]]) -> Option<([f64; 3], [f64; 3])> {
    let first = *points.first()?;
    Some(points.iter().fold((first, first), |(low, high), p| {
        ([0, 1, 2].map(|k| p[k].min(low[k])), [0, 1, 2].map(|k| p[k].max(high[k])))
    }))
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use softshadow_scene::{LightShape, LightTexture, Material, Mesh, look_at};

    use super::*;

    #[test]
    fn another_frame_of_a_texture_rebuilds_nothing() {
        let corners = vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
        let mesh = Mesh::new("leaf", corners, vec![[0, 1, 2]], Material::default()).unwrap();
        let scene = Scene::new(vec![mesh]).unwrap();
        let pose = look_at([0.0, 0.0, 0.5], [0.0, 0.4, 0.0], None).unwrap();
        let light = Light::new(LightShape::Rectangle { width: 1.0, height: 1.0 }, pose).unwrap();
        let frame =
            |red: f32| light.clone().with_texture(LightTexture::new(1, 1, vec![[red, 0.0, 0.0]]).unwrap()).unwrap();
        let context = Context::new(&DeviceChoice::Auto).unwrap();
        let receivers = Receivers::Points(softshadow_scene::Points::new(vec![[0.0, 0.0, -1.0]], None).unwrap());
        let contents = |scene| context.contents(scene, &receivers).unwrap();
        let occluders = |light| context.occluders(&scene, &contents(&scene), &[light]).unwrap().remove(0);
        let (scene_then, then) = (contents(&scene), occluders(frame(1.0)));
        assert!(Arc::ptr_eq(&scene_then, &contents(&scene)));
        assert!(Arc::ptr_eq(&then, &occluders(frame(0.5))));
        // A light that has moved has other occluders.
        let moved =
            Light::new(light.shape().clone(), look_at([0.0, 0.0, 0.2], [0.0, 0.4, 0.0], None).unwrap()).unwrap();
        assert!(!Arc::ptr_eq(&then, &occluders(moved)));
    }
}
