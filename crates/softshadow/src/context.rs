//! An open device and what is kept for it: the engine, and the scenes of the last calls as the device reads them.

use std::str::FromStr;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use softshadow_engine::{AdapterChoice, WgpuEngine};
use softshadow_native::{NativeEngine, NativeSettings};
use softshadow_plan::{AdapterInfo, DeviceKind, Engine};
use softshadow_scene::{Light, Receivers, Scene};
use softshadow_techniques::Technique;

use crate::choose::calibration::{Calibration, Factors};
use crate::error::Error;
use crate::scene_cache::{Prepared, SceneCache};

/// Which device computes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DeviceChoice {
    /// What the environment variable `SOFTSHADOW_DEVICE` says, in the words of [`DeviceChoice::from_str`]; where it says nothing, a GPU,
    /// else the CPU without a driver. What that does not have, because it draws triangles, a software driver then does.
    #[default]
    Auto,
    /// A GPU.
    Gpu,
    /// Threads of the CPU, without any driver.
    Native,
    /// A software driver on the CPU.
    Software,
    /// The adapter with this position in [`adapters`].
    Index(usize),
}

/// Overrides [`DeviceChoice::Auto`].
const DEVICE_VARIABLE: &str = "SOFTSHADOW_DEVICE";

impl FromStr for DeviceChoice {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        match text {
            "auto" => Ok(Self::Auto),
            "gpu" => Ok(Self::Gpu),
            "native" => Ok(Self::Native),
            "software" => Ok(Self::Software),
            _ => text.parse().map(Self::Index).map_err(|_| {
                let known = "'auto', 'gpu', 'native', 'software' or an adapter's index";
                Error::Settings(format!("device '{text}' is none of {known}"))
            }),
        }
    }
}

/// Every adapter of this machine that has a driver.
#[must_use]
pub fn adapters() -> Vec<AdapterInfo> {
    softshadow_engine::adapters()
}

/// Devices and their caches. Calls from several threads take turns.
pub struct Context {
    main: Device,
    /// Draws triangles where the main device does not: opened when a technique first needs it.
    drawing: OnceLock<Device>,
    /// Whether [`Context::drawing`] may be opened.
    is_automatic: bool,
}

impl Context {
    /// Opens a device.
    ///
    /// # Errors
    /// [`Error::Device`] says how to install one where there is none.
    pub fn new(choice: &DeviceChoice) -> Result<Self, Error> {
        let choice = match (choice, std::env::var(DEVICE_VARIABLE)) {
            (DeviceChoice::Auto, Ok(text)) => {
                text.parse().map_err(|error| Error::Settings(format!("{DEVICE_VARIABLE}: {error}")))?
            }
            _ => *choice,
        };
        let main = match choice {
            DeviceChoice::Auto => match Device::open(Opening::Adapter(AdapterChoice::ReadyGpu)) {
                Err(Error::Device(_)) => Device::open(Opening::Native)?,
                found => found?,
            },
            DeviceChoice::Gpu => Device::open(Opening::Adapter(AdapterChoice::Gpu))?,
            DeviceChoice::Native => Device::open(Opening::Native)?,
            DeviceChoice::Software => Device::open(Opening::Adapter(AdapterChoice::Software))?,
            DeviceChoice::Index(index) => Device::open(Opening::Adapter(AdapterChoice::Index(index)))?,
        };
        Ok(Self { main, drawing: OnceLock::new(), is_automatic: choice == DeviceChoice::Auto })
    }

    /// What the device is.
    #[must_use]
    pub fn adapter(&self) -> &AdapterInfo {
        &self.main.adapter
    }

    /// Destroys the device as a failing driver would, for tests of what follows.
    pub fn lose_device(&self) {
        lock(&self.main.engine).destroy();
    }

    /// The device that can serve all of some techniques: what is compared has to have the same receivers, and those that are drawn are not
    /// those that rays find, next to silhouettes.
    pub(crate) fn device<'a>(&self, techniques: impl IntoIterator<Item = &'a Technique>) -> Result<&Device, Error> {
        let Some(drawing) = techniques.into_iter().find(|technique| technique.draws()) else { return Ok(&self.main) };
        if !self.is_automatic || self.main.engine()?.host().features.raster {
            return Ok(&self.main);
        }
        if let Some(device) = self.drawing.get() {
            return Ok(device);
        }
        let opened = Device::open(Opening::Adapter(AdapterChoice::Software))
            .map_err(|error| Error::Device(format!("{} draws triangles: {error}", drawing.name())))?;
        Ok(self.drawing.get_or_init(|| Device { is_stand_in: true, ..opened }))
    }
}

/// How a device is opened, and opened again where it was lost.
#[derive(Clone, Copy)]
enum Opening {
    Adapter(AdapterChoice),
    Native,
}

/// A device, and what is kept for it.
pub(crate) struct Device {
    opening: Opening,
    adapter: AdapterInfo,
    engine: Mutex<Arc<dyn Engine>>,
    scenes: Mutex<SceneCache>,
    /// Whether it does what the main device does not.
    is_stand_in: bool,
    /// What kernels take, with words about where that comes from; made when a choice first needs it.
    calibration: Mutex<Option<(Arc<Calibration>, String)>>,
    /// How much more or less some scenes take, by scene and technique; the latest stand last.
    factors: Mutex<Vec<(u64, &'static str, Factors)>>,
}

/// Scenes and techniques whose costs are remembered.
const KEPT_FACTORS: usize = 32;

impl Device {
    fn open(opening: Opening) -> Result<Self, Error> {
        let engine = engine(opening)?;
        let adapter = engine.adapter().clone();
        if adapter.device_type == DeviceKind::Software {
            log::warn!("'{}' is a software adapter: everything runs on the CPU", adapter.name);
        }
        Ok(Self {
            opening,
            adapter,
            engine: Mutex::new(engine),
            scenes: Mutex::default(),
            is_stand_in: false,
            calibration: Mutex::default(),
            factors: Mutex::default(),
        })
    }

    /// What the device is.
    pub(crate) fn adapter(&self) -> &AdapterInfo {
        &self.adapter
    }

    /// A note where this is not the device that the caller has.
    pub(crate) fn stands_in(&self) -> Option<String> {
        let name = &self.adapter.name;
        self.is_stand_in.then(|| format!("computed by '{name}': the native engine draws no triangles"))
    }

    /// The engine; opened again where the device was lost.
    pub(crate) fn engine(&self) -> Result<Arc<dyn Engine>, Error> {
        let mut kept = lock(&self.engine);
        if kept.is_lost() {
            *kept = engine(self.opening)?;
        }
        Ok(Arc::clone(&kept))
    }

    /// What kernels take on this device, and where that comes from.
    pub(crate) fn calibration(&self) -> Result<(Arc<Calibration>, String), Error> {
        let mut kept = lock(&self.calibration);
        if let Some(known) = &*kept {
            return Ok(known.clone());
        }
        let (made, words) = Calibration::load_or_make(self)?;
        Ok(kept.insert((Arc::new(made), words)).clone())
    }

    /// How much more or less than calibrated a technique took on a scene; nothing where it has not run there.
    pub(crate) fn factors(&self, scene: &Scene, technique: &str) -> Factors {
        let kept = lock(&self.factors);
        let found = kept.iter().find(|(topology, name, _)| *topology == scene.topology() && *name == technique);
        found.map_or_else(Factors::new, |(_, _, factors)| factors.clone())
    }

    pub(crate) fn learn(&self, scene: &Scene, technique: &'static str, factors: Factors) {
        let mut kept = lock(&self.factors);
        kept.retain(|(topology, name, _)| *topology != scene.topology() || *name != technique);
        kept.push((scene.topology(), technique, factors));
        let surplus = kept.len().saturating_sub(KEPT_FACTORS);
        kept.drain(..surplus);
    }

    /// The scene as the device reads it, and with `lights` what hides each: from the cache where it was used lately, from an earlier
    /// frame of a scene that moves, or made anew.
    pub(crate) fn prepare(&self, scene: &Scene, receivers: &Receivers, lights: &[Light]) -> Result<Prepared, Error> {
        let engine = self.engine()?;
        let (prepared, superseded) = lock(&self.scenes).prepare(scene, receivers, lights, &engine.host());
        // It would wait for another thread's run.
        if !superseded.is_empty() {
            engine.forget(&superseded);
        }
        prepared
    }
}

fn engine(opening: Opening) -> Result<Arc<dyn Engine>, Error> {
    Ok(match opening {
        Opening::Adapter(choice) => Arc::new(WgpuEngine::new(choice)?),
        Opening::Native => Arc::new(NativeEngine::new(NativeSettings::default())),
    })
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
        let prepare = |light| context.main.prepare(&scene, &receivers, &[light]).unwrap();
        let occluders = |light| prepare(light).occluders.remove(0);
        let (scene_then, then) = (prepare(frame(1.0)).contents, occluders(frame(1.0)));
        assert!(Arc::ptr_eq(&scene_then, &prepare(frame(0.5)).contents));
        assert!(Arc::ptr_eq(&then, &occluders(frame(0.5))));
        // A light that has moved has other occluders.
        let moved =
            Light::new(light.shape().clone(), look_at([0.0, 0.0, 0.2], [0.0, 0.4, 0.0], None).unwrap()).unwrap();
        assert!(!Arc::ptr_eq(&then, &occluders(moved)));
    }
}
