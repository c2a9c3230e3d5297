//! What a kernel is given: buffers by the WGSL names of its bindings, and which items it works on.

use std::ops::Range;

use bytemuck::Pod;
use fearless_simd::Level;
use softshadow_plan::Pass;

/// One call of a kernel's twin.
pub(crate) struct Call {
    buffers: Vec<(&'static str, usize, Vec<u32>)>,
    /// The items of this slice of the pass; where an earlier pass wrote how many groups there are, those groups.
    pub(crate) items: Range<u32>,
    /// Which vector instructions to use.
    pub(crate) level: Level,
}

impl Call {
    /// Takes the buffers of a pass; [`Call::put_back`] returns them.
    pub(super) fn new(pass: &Pass, buffers: &mut [Vec<u32>], items: Range<u32>, level: Level) -> Self {
        let take = |(name, id): &(&'static str, softshadow_plan::ResourceId)| {
            (*name, id.index(), std::mem::take(&mut buffers[id.index()]))
        };
        Self { buffers: pass.bindings.iter().map(take).collect(), items, level }
    }

    pub(super) fn put_back(self, buffers: &mut [Vec<u32>]) {
        for (_, index, words) in self.buffers {
            // A buffer under two names was taken by the first.
            if !words.is_empty() {
                buffers[index] = words;
            }
        }
    }

    /// The items as positions in a buffer.
    pub(crate) fn item_range(&self) -> Range<usize> {
        self.items.start as usize..self.items.end as usize
    }

    /// Buffers by the names of their bindings, to read and to write.
    ///
    /// # Panics
    /// If a name is not bound: [`softshadow_plan::check`] compares a plan with the kernel, and tests the kernel with its twin.
    pub(crate) fn buffers<const N: usize>(&mut self, names: [&str; N]) -> [&mut [u32]; N] {
        let mut found: [Option<&mut [u32]>; N] = [const { None }; N];
        for (name, _, words) in &mut self.buffers {
            if let Some(at) = names.iter().position(|wanted| wanted == name) {
                found[at] = Some(words);
            }
        }
        let mut at = 0;
        found.map(|words| {
            at += 1;
            words.unwrap_or_else(|| panic!("no binding '{}'", names[at - 1]))
        })
    }

    /// A uniform, by the name of its binding.
    pub(crate) fn uniform<T: Pod>(&mut self, name: &str) -> T {
        let [words] = self.buffers([name]);
        bytemuck::pod_read_unaligned(&bytemuck::cast_slice::<u32, u8>(words)[..size_of::<T>()])
    }
}
