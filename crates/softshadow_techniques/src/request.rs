//! What a technique is asked for: receivers, one light, and what the caller wants to know.

use softshadow_plan::Host;
use softshadow_scene::{Camera, Light, Points};

use crate::block::Block;
use crate::parts::occluder_buffers::OccluderContents;
use crate::parts::scene_buffers::SceneContents;
use crate::parts::shading::Shading;

/// Where receivers come from.
#[derive(Debug, Clone, Copy)]
pub enum ReceiverSource<'a> {
    /// What a camera sees.
    Camera(&'a Camera),
    /// Given points.
    Points(&'a Points),
}

impl ReceiverSource<'_> {
    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        match self {
            Self::Camera(camera) => camera.size().iter().map(|&n| n as usize).product(),
            Self::Points(points) => points.positions().len(),
        }
    }

    /// Receivers in a row of neighbours: the image's width, or 1.
    #[must_use]
    pub fn row(&self) -> usize {
        match self {
            Self::Camera(camera) => camera.size()[0] as usize,
            Self::Points(_) => 1,
        }
    }
}

/// What the caller wants besides visibility. What nobody wants costs no pass and no byte.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Wants {
    /// The standard error of every value, where the technique has one.
    pub standard_error: bool,
    /// The mask of blocked samples of every receiver.
    pub sample_masks: bool,
    /// A picture.
    pub picture: Option<Shading>,
}

/// One light, one block of receivers.
#[derive(Debug, Clone, Copy)]
pub struct Request<'a> {
    /// The scene on the device.
    pub scene: &'a SceneContents,
    /// Where receivers come from.
    pub receivers: ReceiverSource<'a>,
    /// Which of them.
    pub block: Block,
    /// The light that the plan is for. Plans of lights of one kind are equal.
    pub light: &'a Light,
    /// What hides this light, for techniques that ask for it.
    pub occluders: Option<&'a OccluderContents>,
    /// Whether any light of the call has a texture: then values have three channels.
    pub channels: u32,
    /// This is the first light and pass of the block: receivers are placed, pictures begin.
    pub opens_block: bool,
    /// This is the first light of the call.
    pub first_light: bool,
    /// This is the first block: what serves all blocks is drawn.
    pub opens_run: bool,
    /// The call has no other light: what is made for it where the run opens can be kept for all blocks.
    pub only_light: bool,
    /// This is the light's last pass: results leave.
    pub closes_light: bool,
    /// This is the block's last pass: the picture leaves.
    pub closes_block: bool,
    /// Which stage of the light's pass the plan is for, from 0, where a technique has several.
    pub stage: u32,
    /// What the stage before read back.
    pub decision: [u32; 4],
    /// What is wanted.
    pub wants: Wants,
    /// What the host can do.
    pub host: Host,
}
