//! Buffers, kept between runs and given back when they have not been used for a while.

use std::collections::{BTreeMap, HashMap};

use softshadow_plan::{Content, ContentKey, EngineError, Origin, Plan, Resource, Shape, Stage};

/// Runs after which uploads that were not used are given back. Other buffers are given back after one: a caller's memory limit
/// holds for each call, and its buffers must not pile up.
const KEPT_RUNS: u64 = 8;

#[derive(PartialEq, Eq, Hash)]
enum Key {
    Content(ContentKey),
    Named(String, u64),
}

#[derive(Default)]
pub(super) struct Store {
    kept: HashMap<Key, (Vec<u32>, u64)>,
    run: u64,
}

fn key(resource: &Resource) -> Key {
    match resource.origin {
        Origin::Uploaded(key) => Key::Content(key),
        _ => Key::Named(resource.label.clone(), resource.bytes()),
    }
}

impl Store {
    /// Begins a run and gives back what has not been used for a while.
    pub(super) fn begin_run(&mut self) {
        self.run += 1;
        let run = self.run;
        self.kept.retain(|key, (_, used)| *used + if matches!(key, Key::Content(_)) { KEPT_RUNS } else { 1 } >= run);
    }

    /// Gives uploads back that will not be used again.
    pub(super) fn forget(&mut self, contents: &[ContentKey]) {
        for key in contents {
            self.kept.remove(&Key::Content(*key));
        }
    }

    /// The buffers of a stage, one a resource; [`Store::put_back`] keeps them for the next.
    pub(super) fn take(
        &mut self,
        stage: &Stage,
        contents: &BTreeMap<ContentKey, Content>,
    ) -> Result<Vec<Vec<u32>>, EngineError> {
        let name = &stage.plan.name;
        let take = |resource: &Resource| {
            let Shape::Buffer { bytes } = resource.shape else {
                return Err(EngineError::contents(name, &resource.label, "the native engine has no textures"));
            };
            let missing = |problem| EngineError::contents(name, &resource.label, problem);
            let length = bytes.div_ceil(4) as usize;
            let given = match resource.origin {
                Origin::External => return Err(missing("no external resource was given")),
                Origin::Parameter => {
                    let value = stage.values.get(&resource.label).filter(|value| value.len() as u64 == bytes);
                    Some(value.ok_or_else(|| missing("its value was not given"))?.as_slice())
                }
                _ => None,
            };
            let mut words = match (self.kept.remove(&key(resource)), resource.origin) {
                (Some((words, _)), _) => words,
                (None, Origin::Uploaded(key)) => {
                    let content = contents.get(&key).filter(|content| content.bytes.len() as u64 == bytes);
                    let content = content.ok_or_else(|| missing("its contents were not given"))?;
                    bytemuck::pod_collect_to_vec(&content.bytes)
                }
                (None, _) => zeros(length).ok_or_else(|| EngineError::OutOfMemory {
                    stage: name.clone(),
                    reason: format!("{bytes} bytes for '{}'", resource.label),
                })?,
            };
            if let Some(value) = given {
                bytemuck::cast_slice_mut::<u32, u8>(&mut words)[..value.len()].copy_from_slice(value);
            }
            Ok(words)
        };
        stage.plan.resources.iter().map(take).collect()
    }

    /// Keeps the buffers of a stage.
    pub(super) fn put_back(&mut self, plan: &Plan, buffers: Vec<Vec<u32>>) {
        for (resource, words) in plan.resources.iter().zip(buffers) {
            self.kept.insert(key(resource), (words, self.run));
        }
    }
}

/// So many zeros, or nothing where there is no memory for them. The system hands out zeroed pages as they are touched: lists that stay empty
/// cost nothing, where filling them would take longer than many a pass.
fn zeros(length: usize) -> Option<Vec<u32>> {
    Vec::<u32>::new().try_reserve_exact(length).ok()?;
    Some(vec![0; length])
}
