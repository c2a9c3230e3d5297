//! The rules of dependency between the rooms of this workspace, read from manifests and sources. Each rule is a function over
//! names and texts, and each has a text that breaks it.

mod dependencies;
mod files;
mod shaders;
mod techniques;
