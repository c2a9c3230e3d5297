//! The WGSL of softshadow: linked, validated and described by reflection
