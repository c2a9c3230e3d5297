//! How visibility is computed, as a value: textures, buffers and passes
