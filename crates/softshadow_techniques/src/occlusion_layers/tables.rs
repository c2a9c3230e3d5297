//! From triangles to tables: which passes, and what they weigh.

use softshadow_plan::{Kernel, Over, Plan, ResourceId, Values};

use super::frame::{CasterRange, LayerFrame};
use super::settings::{Filter, OcclusionLayers};
use crate::parts::scene_buffers;
use crate::request::Request;

const BOUND_CASTERS: Kernel = Kernel { file: "occlusion_layers/bound_casters.wgsl", entry: "bound_casters" };
const PLACE_PLANES: Kernel = Kernel { file: "occlusion_layers/place_planes.wgsl", entry: "place_planes" };
const fn slicing(entry: &'static str) -> Kernel {
    Kernel { file: "occlusion_layers/slice_triangles.wgsl", entry }
}
const SLICE_TRIANGLES: Kernel = slicing("slice_triangles");
const SIZE_ROWS: Kernel = slicing("size_rows");
const SLICE_ROWS: Kernel = slicing("slice_rows");
const COUNT_WORDS: Kernel = Kernel { file: "occlusion_layers/sum_areas.wgsl", entry: "count_words" };
const SUM_COLUMNS: Kernel = Kernel { file: "occlusion_layers/sum_areas.wgsl", entry: "sum_columns" };

const EXPAND: Kernel = Kernel { file: "occlusion_layers/build_levels.wgsl", entry: "expand" };
const BUILD_LEVEL: Kernel = Kernel { file: "occlusion_layers/build_levels.wgsl", entry: "build_level" };

/// `LevelRange` of `build_levels.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct LevelRange {
    level: u32,
    reserved0: u32,
    reserved1: u32,
    reserved2: u32,
}

/// Bytes of `CasterBounds` of `casters.wgsl`.
pub const CASTER_BOUNDS_BYTES: u64 = 48;
/// Bytes of `LayerPlaces` of `layers.wgsl`.
pub const LAYER_PLACES_BYTES: u64 = 32 + 128 * 4;
/// Bytes of `TallTriangles` of `slice_triangles.wgsl` before its list.
const TALL_HEADER_BYTES: u64 = 16;
/// Label of the bounds of the casters, which leave where they are made.
pub const CASTER_BOUNDS: &str = "caster bounds";

/// The share of all casters' area that the projection sees from the side, by the bounds that were read back.
#[must_use]
pub fn edge_on_share(bounds: &[u32]) -> f64 {
    match bounds {
        [_, _, _, _, _, _, _, edge_on, area, ..] if *area > 0 => f64::from(*edge_on) / f64::from(*area),
        _ => 0.0,
    }
}

/// What receivers look up.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layers {
    pub(super) places: ResourceId,
    pub(super) layer_tables: ResourceId,
}

/// Bytes of the summed-area tables, or of all levels.
pub(super) fn table_bytes(settings: &OcclusionLayers) -> u64 {
    let stride = u64::from(settings.resolution) + 1;
    match settings.filter {
        Filter::SummedArea => u64::from(settings.slices) * stride * stride * 4,
        Filter::Nbuffer | Filter::Mipmap => {
            (0..=last_level(settings)).map(|level| level_entries(settings, level) * 4).sum()
        }
    }
}

/// Whether this stage makes the tables: they are kept from block to block where the light is the same in all.
pub(super) fn are_made(request: &Request<'_>) -> bool {
    (request.opens_run || !request.only_light) && !request.scene.local.sub_scenes.is_empty()
}

/// Adds the tables, and where the light begins the passes that fill them.
pub(super) fn append(plan: &mut Plan, request: &Request<'_>, settings: &OcclusionLayers, frame: ResourceId) -> Layers {
    let places = plan.persistent("layer places", LAYER_PLACES_BYTES);
    // Without casters nothing is looked up.
    let bytes = if request.scene.local.sub_scenes.is_empty() { 4 } else { table_bytes(settings) };
    let layer_tables = plan.persistent("layer tables", bytes);
    if are_made(request) {
        fill(plan, request, settings, frame, places, layer_tables);
    }
    Layers { places, layer_tables }
}

fn fill(
    plan: &mut Plan,
    request: &Request<'_>,
    settings: &OcclusionLayers,
    frame: ResourceId,
    places: ResourceId,
    layer_tables: ResourceId,
) {
    let corners = scene_buffers::append_corners(plan, request.scene);
    let triangles = |index: usize| (request.scene.local.sub_scenes[index].corners.len() / 3) as u32;
    let range = plan.parameter("caster range", size_of::<CasterRange>() as u64);
    let bounds = plan.buffer(CASTER_BOUNDS, CASTER_BOUNDS_BYTES);
    plan.clear("no casters", "bounds grow from nothing", bounds);
    for (index, corners) in corners.iter().enumerate() {
        let over = Over::Items { count: triangles(index), work_per_item: 1 };
        let why = "finds how far the triangles reach that can hide the light from anybody";
        plan.compute(format!("bound casters {index}"), why, BOUND_CASTERS, over)
            .bind("layer_frame", frame)
            .bind("caster_range", range)
            .bind("corners", *corners)
            .bind("caster_bounds", bounds);
    }
    let once = Over::Items { count: 1, work_per_item: settings.slices };
    plan.compute("place planes", "puts the slices' planes and texels around the casters", PLACE_PLANES, once)
        .bind("layer_frame", frame)
        .bind("caster_range", range)
        .bind("caster_bounds", bounds)
        .bind("layer_places", places);
    plan.outputs.push(bounds);

    let rows = settings.slices * settings.resolution;
    let words = u64::from(rows) * u64::from(settings.resolution / 32) * 4;
    let bits = plan.buffer("slice bits", words);
    plan.clear("empty slices", "no bit is set at first", bits);
    for (index, corners) in corners.iter().enumerate() {
        let count = triangles(index);
        let tall = plan.buffer(format!("tall triangles {index}"), TALL_HEADER_BYTES + u64::from(count) * 4);
        plan.clear(format!("no tall triangles {index}"), "the list is empty at first", tall);
        let why = "sets the bits of triangles of few rows, and lists the others";
        let over = Over::Items { count, work_per_item: 8 };
        plan.compute(format!("slice triangles {index}"), why, SLICE_TRIANGLES, over)
            .bind("layer_frame", frame)
            .bind("caster_range", range)
            .bind("corners", *corners)
            .bind("layer_places", places)
            .bind("slice_bits", bits)
            .bind("tall", tall);
        let size = plan.buffer(format!("row dispatch {index}"), 12);
        let once = Over::Items { count: 1, work_per_item: 1 };
        plan.compute(format!("size rows {index}"), "sizes the dispatch over the rows of the others", SIZE_ROWS, once)
            .bind("layer_places", places)
            .bind("tall", tall)
            .bind("dispatch_size", size);
        let why = "sets the bits of triangles of many rows, row by row";
        plan.compute(format!("slice rows {index}"), why, SLICE_ROWS, Over::Indirect(size))
            .bind("layer_frame", frame)
            .bind("caster_range", range)
            .bind("corners", *corners)
            .bind("layer_places", places)
            .bind("slice_bits", bits)
            .bind("tall", tall);
    }
    match settings.filter {
        Filter::SummedArea => append_sums(plan, settings, frame, bits, layer_tables),
        Filter::Nbuffer | Filter::Mipmap => append_levels(plan, settings, frame, bits, layer_tables),
    }
}

fn append_sums(
    plan: &mut Plan,
    settings: &OcclusionLayers,
    frame: ResourceId,
    bits: ResourceId,
    layer_tables: ResourceId,
) {
    let rows = settings.slices * settings.resolution;
    let before = plan.buffer("words before", u64::from(rows) * u64::from(settings.resolution / 32) * 4);
    let over = Over::Items { count: rows, work_per_item: settings.resolution / 128 + 1 };
    plan.compute("count words", "counts the bits of a row before each of its words", COUNT_WORDS, over)
        .bind("layer_frame", frame)
        .bind("slice_bits", bits)
        .bind("words_before", before);
    let columns = settings.slices * (settings.resolution + 1);
    let over = Over::Items { count: columns, work_per_item: settings.resolution / 4 };
    plan.compute("sum columns", "adds up the bits of all rows and columns before every texel", SUM_COLUMNS, over)
        .bind("layer_frame", frame)
        .bind("slice_bits", bits)
        .bind("words_before", before)
        .bind("layer_tables", layer_tables);
}

fn append_levels(
    plan: &mut Plan,
    settings: &OcclusionLayers,
    frame: ResourceId,
    bits: ResourceId,
    layer_tables: ResourceId,
) {
    let entries = |level: u32| Over::Items { count: level_entries(settings, level) as u32, work_per_item: 1 };
    plan.compute("expand level 0", "turns bits into shares, four slices a word", EXPAND, entries(0))
        .bind("layer_frame", frame)
        .bind("slice_bits", bits)
        .bind("layer_tables", layer_tables);
    for level in 1..=last_level(settings) {
        let range = plan.parameter(level_label(level), size_of::<LevelRange>() as u64);
        let why = "means over squares twice as wide, from four of the level below";
        plan.compute(format!("build level {level}"), why, BUILD_LEVEL, entries(level))
            .bind("layer_frame", frame)
            .bind("level_range", range)
            .bind("layer_tables", layer_tables);
    }
}

/// The values of the parameters of levels.
pub(super) fn level_values(settings: &OcclusionLayers, values: &mut Values) {
    let levels = if settings.filter == Filter::SummedArea { 0 } else { last_level(settings) };
    for level in 1..=levels {
        let range = LevelRange { level, reserved0: 0, reserved1: 0, reserved2: 0 };
        values.insert(level_label(level), bytemuck::bytes_of(&range).to_vec());
    }
}

fn level_label(level: u32) -> String {
    format!("level range {level}")
}

/// The level of a single texel.
fn last_level(settings: &OcclusionLayers) -> u32 {
    settings.resolution.ilog2()
}

/// Words of a level, of four slices each.
fn level_entries(settings: &OcclusionLayers, level: u32) -> u64 {
    let side = match settings.filter {
        Filter::Mipmap => settings.resolution >> level,
        Filter::SummedArea | Filter::Nbuffer => settings.resolution + (1 << level) - 1,
    };
    u64::from(settings.slices.div_ceil(4)) * u64::from(side) * u64::from(side)
}

/// Bytes of `LayerFrame`.
pub(super) const FRAME_BYTES: u64 = size_of::<LayerFrame>() as u64;
