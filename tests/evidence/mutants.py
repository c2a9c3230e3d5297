"""One change at a time to the silhouette edges, each of which the tests have to notice.

Every mutant is a line of ``crates/`` or of ``shaders_wgsl/`` written wrong: a sign flipped, an edge dropped, h for g,
an epsilon at w = 0. It is built in a copy of the work tree, and the tests of ``softshadow_scene`` and
``softshadow_native`` must fail, or for WGSL the hard cases on the device and what else judges samples and areas there.
A mutant that survives is a hole in the tests.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MODEL = "crates/softshadow_native/src/depth_complexity"
SCENE = "crates/softshadow_scene/src"
SHADERS = "shaders_wgsl/depth_complexity"
NATIVE = "-p softshadow_scene -p softshadow_native --no-fail-fast --quiet -- --skip real_meshes"
DEVICE = "-p softshadow --test truth --quiet -- hard_cases depth_complexity::"


@dataclass(frozen=True)
class Mutant:
    """What is done wrong, and where."""

    says: str
    file: str
    right: str
    wrong: str
    tests: str = NATIVE


MUTANTS = [
    Mutant(
        "side of a face flipped",
        f"{MODEL}/face.rs",
        "i32::from(height > face.flatness) - i32::from(height < -face.flatness)",
        "i32::from(height < -face.flatness) - i32::from(height > face.flatness)",
    ),
    Mutant(
        "edge-on faces take a side",
        f"{SCENE}/occluders/build.rs",
        "height(b).max(height(c))",
        "0.0 * height(b).max(height(c))",
    ),
    Mutant("winding at an edge ignored", f"{MODEL}/face.rs", "if incidence & 1 == 0 { 1 } else { -1 }", "1"),
    Mutant(
        "own triangle not left out of the edges",
        f"{MODEL}/face.rs",
        "if Some(face.triangle) == receiver.triangle {",
        "if false && Some(face.triangle) == receiver.triangle {",
    ),
    Mutant(
        "own triangle not left out of D(c)",
        f"{MODEL}/depth_of_reference.rs",
        "if Some(face.triangle) != receiver.triangle {",
        "if true || Some(face.triangle) != receiver.triangle {",
    ),
    Mutant(
        "D(c) counts against the side",
        f"{MODEL}/depth_of_reference.rs",
        "side * image.turns_around_reference(side)",
        "image.turns_around_reference(side)",
    ),
    Mutant(
        "D(c) ignores windings",
        f"{MODEL}/depth_of_reference.rs",
        "edge.has_reference_left == is_forward;",
        "edge.has_reference_left;",
    ),
    Mutant(
        "faces beyond a ball of light cover c",
        f"{MODEL}/depth_of_reference.rs",
        "if is_before_limit(view, face) {",
        "if is_before_limit(view, face) || true {",
    ),
    Mutant(
        "D(c) ignores the arc at infinity",
        f"{MODEL}/depth_of_reference.rs",
        "            if_all(arc)\n        } else if out.dot",
        "            either\n        } else if out.dot",
    ),
    Mutant(
        "an arc without length turns around c",
        f"{MODEL}/depth_of_reference.rs",
        "if self.has_wide { either } else { 0 }",
        "either",
    ),
    Mutant(
        "c's side of an edge flipped", f"{MODEL}/edge.rs", "from.perp_dot(to) >= 0.0 }", "from.perp_dot(to) < 0.0 }"
    ),
    Mutant(
        "c's side by the rounded line",
        f"{MODEL}/edge.rs",
        "has_reference_left: from.perp_dot(to) >= 0.0",
        "has_reference_left: line.z >= 0.0 || from.perp_dot(to) > 1e9",
    ),
    Mutant(
        "lines through c know its side",
        f"{MODEL}/edge.rs",
        "if from.dot(to) < 0.0 { self.has_reference_left } else { self.line.z >= 0.0 }",
        "if from.dot(to) < -1e30 { self.has_reference_left } else { self.line.z >= 0.0 }",
    ),
    Mutant(
        "end at infinity reversed",
        f"{MODEL}/edge.rs",
        "[false, true] => Some([-along(), direction(high)]),",
        "[false, true] => Some([along(), direction(high)]),",
    ),
    Mutant(
        "an epsilon at w = 0",
        f"{MODEL}/edge.rs",
        "match [low.z > 0.0, high.z > 0.0] {",
        "match [low.z > 1e-4, high.z > 1e-4] {",
    ),
    Mutant(
        "ends behind the receiver not replaced",
        f"{MODEL}/edge.rs",
        "[true, false] => Some([direction(low), along()]),",
        "[true, false] => Some([direction(low), direction(high)]),",
    ),
    Mutant(
        "line through two corners instead of along the edge",
        f"{MODEL}/edge.rs",
        "let line = nearer.cross(along);",
        "let line = if nearer == along { nearer } else { ends[0].cross(ends[1]) };",
    ),
    Mutant(
        "line from the farther end",
        f"{MODEL}/edge.rs",
        "size(ends[0]) <= size(ends[1])",
        "size(ends[0]) > size(ends[1])",
    ),
    Mutant(
        "edges beyond a ball of light count",
        f"{MODEL}/edge.rs",
        "[false, false] => return None,\n            [low",
        "[low",
    ),
    Mutant("h for g in one row", f"{MODEL}/view.rs", "(x.dot(from_light) - c.x)", "x.dot(from_light)"),
    Mutant(
        "h for g on angular lights",
        f"{MODEL}/view.rs",
        "rows: [x - depth * c.x, y - depth * c.y, depth]",
        "rows: [x, y, depth]",
    ),
    Mutant(
        "ways to the light from its centre",
        f"{MODEL}/view.rs",
        "towards + (x * c.x + y * c.y) * tangent]",
        "towards]",
    ),
    Mutant(
        "a sphere's frame is a mirror",
        f"{MODEL}/view.rs",
        "Self::angular(p, [x, -y, towards]",
        "Self::angular(p, [x, y, towards]",
    ),
    Mutant(
        "a sphere's samples by area",
        f"{MODEL}/view.rs",
        "reach(cap.height, q[0] * q[0] + q[1] * q[1]) / cap.tangent",
        "1.0",
    ),
    Mutant(
        "a sphere's disc through its centre",
        f"{MODEL}/view.rs",
        "limit: Some((towards, distance * outside))",
        "limit: Some((towards, distance))",
    ),
    Mutant(
        "a flat light's frame is a mirror",
        f"{SCENE}/light_frame.rs",
        "let [x, y, z] = [place.x_axis, -place.y_axis, place.emission];",
        "let [x, y, z] = [place.x_axis, place.y_axis, place.emission];",
    ),
    Mutant(
        "crossings in any sense of turning",
        f"{MODEL}/coverage.rs",
        "(left_of_from != left_of_to) & (left_of_from == left) & beyond",
        "(left_of_from != left_of_to) & beyond",
    ),
    Mutant(
        "crossings before the line",
        f"{MODEL}/coverage.rs",
        "(line.x * x + line.y * y + line.z >= 0.0) != line_left",
        "(line.x * x + line.y * y + line.z >= 0.0) == line_left",
    ),
    Mutant(
        "wrap by comparing angles",
        f"{MODEL}/coverage.rs",
        "let wraps = first.y < 0.0 && last.y >= 0.0;",
        "let wraps = pseudo_angle(first) > pseudo_angle(last);",
    ),
    Mutant("no wrap", f"{MODEL}/coverage.rs", "let wraps = first.y < 0.0 && last.y >= 0.0;", "let wraps = false;"),
    Mutant(
        "D changes in the wrong sense",
        f"{MODEL}/evaluate.rs",
        "let change = if left { weight.negated() } else { weight };",
        "let change = if left { weight } else { weight.negated() };",
    ),
    Mutant(
        "no horizon",
        f"{MODEL}/evaluate.rs",
        "u64::from(way + x * s[0] + y * s[1] <= 0.0) << bit",
        "0 * u64::from(way + x * s[0] + y * s[1] <= 0.0) << bit",
    ),
    Mutant(
        "areas over a crossing horizon",
        f"{MODEL}/evaluate.rs",
        "self.exact_area && is_above_horizon(&view, receiver, self.light)",
        "self.exact_area",
    ),
    Mutant(
        "areas of overlapping layers", f"{MODEL}/evaluate.rs", "_ => return None,\n        };", "_ => 2.0,\n        };"
    ),
    Mutant(
        "area of the sector, not of what lies beyond",
        f"{MODEL}/area.rs",
        "(1.0 - share_before(line, p) * share_before(line, q))",
        "1.0",
    ),
    Mutant("sides that turn away count", f"{MODEL}/area.rs", "if turn > 0.0 { beyond } else { -beyond }", "beyond"),
    Mutant("carry lost", f"{MODEL}/counters.rs", "*carried &= digit;", "*carried = 0;"),
    Mutant("sign becomes a digit", f"{MODEL}/counters.rs", "self.grow(self.used + 1);", ""),
    Mutant(
        "boxes too small",
        f"{MODEL}/reach.rs",
        "((low + high) * 0.5, (high - low) * 0.5)",
        "((low + high) * 0.5, (high - low) * 0.49)",
    ),
    Mutant(
        "one side of the light's bounds misplaced",
        f"{MODEL}/edge.rs",
        "outside(a) && outside(b)",
        "outside(a) || outside(b)",
    ),
    Mutant(
        "triangles in a ball of light ignored",
        f"{MODEL}/touching.rs",
        "if triangle.attenuation == OPAQUE {",
        "if triangle.attenuation == OPAQUE && false {",
    ),
    Mutant(
        "some edges dropped",
        f"{MODEL}/reach.rs",
        "(first..first + count).for_each",
        "(first + 1..first + count).for_each",
    ),
    Mutant(
        "geometry through the light's plane not cut",
        f"{SCENE}/occluders/cut.rs",
        "any(|&z| z < 0.0)",
        "any(|&z| z < -1e9)",
    ),
    Mutant(
        "device: line by the wrong end's sign: c's side flipped",
        f"{SHADERS}/edge.wgsl",
        "return EdgeImage(low, high, line, is_left(low.xy, high.xy));",
        "return EdgeImage(low, high, line, !is_left(low.xy, high.xy));",
        DEVICE,
    ),
    Mutant(
        "device: c's side by rounded products",
        f"{SHADERS}/edge.wgsl",
        "is_left(low.xy, high.xy));",
        "low.x * high.y - low.y * high.x >= 0.0);",
        DEVICE,
    ),
    Mutant(
        "device: line from the farther end",
        f"{SHADERS}/edge.wgsl",
        "select(high, low, low_is_nearer)",
        "select(low, high, low_is_nearer)",
        DEVICE,
    ),
    Mutant(
        "device: low end behind: direction reversed",
        f"{SHADERS}/edge.wgsl",
        "select(-along_image(image), image.low.xy",
        "select(along_image(image), image.low.xy",
        DEVICE,
    ),
    Mutant(
        "device: high end behind not replaced",
        f"{SHADERS}/edge.wgsl",
        "select(along_image(image), image.high.xy, image.high.z > 0.0)",
        "image.high.xy",
        DEVICE,
    ),
    Mutant(
        "device: an epsilon at w = 0",
        f"{SHADERS}/edge.wgsl",
        "image.low.xy, image.low.z > 0.0)",
        "image.low.xy, image.low.z > 1e-2)",
        DEVICE,
    ),
    Mutant(
        "device: edges beyond a side by one end",
        f"{SHADERS}/edge.wgsl",
        "(a.x > frame.high.x * a.z && b.x",
        "(a.x > frame.high.x * a.z || b.x",
        DEVICE,
    ),
    Mutant(
        "device: line's own sign near c",
        f"{SHADERS}/edge.wgsl",
        "return select(image.line.z >= 0.0, image.left, dot(low, high) < 0.0);",
        "return image.line.z >= 0.0;",
        DEVICE,
    ),
    Mutant(
        "device: sphere's disc ignored",
        f"{SHADERS}/edge.wgsl",
        "if (view.limited) {",
        "if (view.limited && view.position.x > 1e9) {",
        DEVICE,
    ),
    Mutant(
        "device: >= for < at the end of a sector",
        f"{SHADERS}/coverage.wgsl",
        "c.sector_to.y * s.x < 0.0)",
        "c.sector_to.y * s.x <= 0.0)",
        DEVICE,
    ),
    Mutant(
        "device: sector not closed",
        f"{SHADERS}/coverage.wgsl",
        "(c.sector_from.x * s.y - c.sector_from.y * s.x >= 0.0) & ",
        "(c.sector_from.x > -1e30) & ",
        DEVICE,
    ),
    Mutant(
        "device: before instead of beyond the line",
        f"{SHADERS}/coverage.wgsl",
        "c.line.z >= 0.0) != c.beyond_left",
        "c.line.z >= 0.0) == c.beyond_left",
        DEVICE,
    ),
    Mutant(
        "device: ends of the sector swapped",
        f"{SHADERS}/coverage.wgsl",
        "select(high, low, image.left), select(low, high, image.left)",
        "select(low, high, image.left), select(high, low, image.left)",
        DEVICE,
    ),
    Mutant(
        "device: horizon flipped",
        f"{SHADERS}/fold.wgsl",
        "return slope.z + slope.x * s.x + slope.y * s.y <= 0.0;",
        "return slope.z + slope.x * s.x + slope.y * s.y > 0.0;",
        DEVICE,
    ),
    Mutant(
        "device: whole light above the horizon, wrongly",
        f"{SHADERS}/horizon.wgsl",
        "slope.z + lowest > 0.0",
        "slope.z > 0.0",
        DEVICE,
    ),
    Mutant(
        "device: own triangle counts in the fold",
        f"{SHADERS}/fold.wgsl",
        "sum += select(left, 0, (face.reference >> 1u) == triangle);",
        "sum += left;",
        DEVICE,
    ),
    Mutant(
        "device: own triangle counts in D(c)",
        f"{SHADERS}/reference_depth.wgsl",
        "(face.triangle != triangle) & !turns_away",
        "!turns_away",
        DEVICE,
    ),
    Mutant(
        "device: D changes in the wrong sense",
        f"{SHADERS}/sums.wgsl",
        "^ vec2<u32>(select(0u, 0xffffffffu, left))",
        "^ vec2<u32>(select(0xffffffffu, 0u, left))",
        DEVICE,
    ),
    Mutant(
        "device: last edge of a chunk dropped",
        f"{SHADERS}/fold.wgsl",
        "for (var k = 0u; k < end; k++) {\n        let entry",
        "for (var k = 1u; k < end; k++) {\n        let entry",
        DEVICE,
    ),
    Mutant(
        "device: weights of more than seven kept silent",
        f"{SHADERS}/sums.wgsl",
        "changes.many |= select(0u, bit, size > 7u);",
        "changes.many |= 0u;",
        DEVICE,
    ),
    Mutant(
        "device: list entry's weight negated",
        f"{SHADERS}/cull.wgsl",
        "let weight = select(side_a, side_a + side_b, is_pair);",
        "let weight = -select(side_a, side_a + side_b, is_pair);",
        DEVICE,
    ),
    Mutant(
        "device: three faces at an edge taken for two",
        f"{SHADERS}/cull.wgsl",
        "(edge.incidence_count <= 2u) & (side_a != 0)",
        "(edge.incidence_count <= 3u) & (side_a != 0)",
        DEVICE,
    ),
    Mutant(
        "device: margin of a list removed",
        f"{SHADERS}/cull.wgsl",
        "let margin = dot(abs(face.normal), shaft.half) + MARGIN * (1.0 + size.x + size.y + size.z);",
        "let margin = 0.0;",
        DEVICE,
    ),
    Mutant(
        "device: rounding margin of a list removed",
        f"{SHADERS}/cull.wgsl",
        "+ MARGIN * (1.0 + size.x + size.y + size.z);",
        ";",
        DEVICE,
    ),
    Mutant(
        "device: bundle shaft of the other part",
        f"{SHADERS}/cull.wgsl",
        "        if (slot.depth != NO_VIEW && slot.part == (part & 1u)) {\n            let p",
        "        if (slot.depth != NO_VIEW && slot.part != (part & 1u)) {\n            let p",
        DEVICE,
    ),
    Mutant(
        "device: bundle shaft to the reference point only",
        f"{SHADERS}/cull.wgsl",
        "bundle_shaft(lists[HEAD * position], bundle, whole_light(light_frame))",
        "bundle_shaft(lists[HEAD * position], bundle, reference_point(light_frame))",
        DEVICE,
    ),
    Mutant(
        "device: edges left out by one end",
        f"{SHADERS}/cull.wgsl",
        "dot(plane.xyz, a) > plane.w && dot(plane.xyz, b) > plane.w",
        "dot(plane.xyz, a) > plane.w || dot(plane.xyz, b) > plane.w",
        DEVICE,
    ),
    Mutant(
        "device: faces turn away by the wrong sign",
        f"{SHADERS}/reference_depth.wgsl",
        "((height > margin) & (slope > turn)) | ((height < -margin) & (slope < -turn))",
        "((height > margin) & (slope < -turn)) | ((height < -margin) & (slope > turn))",
        DEVICE,
    ),
    Mutant(
        "device: faces turn away without margin",
        f"{SHADERS}/reference_depth.wgsl",
        "let margin = SLACK * size;",
        "let margin = 0.0 * size;",
        DEVICE,
    ),
    Mutant(
        "device: arc at infinity reversed",
        f"{SHADERS}/cover.wgsl",
        "let arc = select(-1, 1, across >= 0.0);",
        "let arc = select(1, -1, across >= 0.0);",
        DEVICE,
    ),
    Mutant(
        "device: an arc without length turns around c",
        f"{SHADERS}/cover.wgsl",
        "let no_length = select(0, either, border.has_wide);",
        "let no_length = either;",
        DEVICE,
    ),
    Mutant(
        "device: D(c) ignores windings",
        f"{SHADERS}/cover.wgsl",
        "let is_left = image.left == is_forward;",
        "let is_left = image.left;",
        DEVICE,
    ),
    Mutant(
        "device: D(c) ignores which side a face shows",
        f"{SHADERS}/cover.wgsl",
        "return select(0, side * turns, before);",
        "return select(0, turns, before);",
        DEVICE,
    ),
    Mutant(
        "device: faces beyond a ball of light cover c",
        f"{SHADERS}/cover.wgsl",
        "return select(0, side * turns, before);",
        "return side * turns;",
        DEVICE,
    ),
    Mutant(
        "device: shaft's side by the nearest receiver",
        f"{SHADERS}/shaft.wgsl",
        "return Reach(max(before.sides, slopes), max(before.back, z));",
        "return Reach(select(slopes, min(before.sides, slopes), before.sides.x > -1e29), max(before.back, z));",
        DEVICE,
    ),
    Mutant(
        "device: shaft's back one receiver's",
        f"{SHADERS}/shaft.wgsl",
        "max(before.sides, slopes), max(before.back, z));",
        "max(before.sides, slopes), z);",
        DEVICE,
    ),
    Mutant(
        "device: ball reaches to its centre's plane only",
        f"{SHADERS}/shaft.wgsl",
        "select(reach.back, max(reach.back, r), is_sphere)",
        "reach.back",
        DEVICE,
    ),
    Mutant(
        "device: silhouettes without margin",
        f"{SHADERS}/silhouettes.wgsl",
        "let margin = spread + 4e-6 * (1.0 + size + spread);",
        "let margin = 0.0;",
        DEVICE,
    ),
    Mutant(
        "device: area of the sector, not of what lies beyond",
        f"{SHADERS}/area.wgsl",
        "(1.0 - share_before(line, p) * share_before(line, q))",
        "1.0",
        DEVICE,
    ),
    Mutant(
        "device: carry lost",
        f"{SHADERS}/counters.wgsl",
        "next = next | (sum & twos);",
        "next = next | 0u * (sum & twos);",
        DEVICE,
    ),
    Mutant(
        "device: nobody looks closer next to a border",
        f"{SHADERS}/fold.wgsl",
        "~end.surely & beyond_possible & ~mask;",
        "vec2<u32>(0u);",
        DEVICE,
    ),
    Mutant(
        "device: lines looked up in the next cell",
        f"{SHADERS}/coverage_table.wgsl",
        "direction * LINE_DISTANCES + distance",
        "direction * LINE_DISTANCES + min(distance + 1u, LINE_DISTANCES - 1u)",
        DEVICE,
    ),
    Mutant(
        "device: row of the view about the centre",
        f"{SHADERS}/frame.wgsl",
        "frame.z_row * (dot(frame.x_row, from_light) - c.x)",
        "frame.z_row * dot(frame.x_row, from_light)",
        DEVICE,
    ),
]


def main() -> int:
    """Prints a table; the exit code is the number of survivors."""
    survivors = 0
    print("| mutant | tests that fail | among them |\n|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "copy"
        copy.mkdir()
        tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True)
        for name in tracked.stdout.splitlines():
            target = copy / name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, target)
        for tests in (NATIVE, DEVICE):
            if failing := run(copy, tests):
                print(f"the tests fail without any change: {failing}", file=sys.stderr)
                return 1
        for mutant in MUTANTS:
            path = copy / mutant.file
            text = path.read_text()
            if text.count(mutant.right) != 1:
                print(f"'{mutant.says}': {mutant.file} has no single place for it", file=sys.stderr)
                return 1
            path.write_text(text.replace(mutant.right, mutant.wrong))
            failing = run(copy, mutant.tests)
            path.write_text(text)
            survivors += not failing
            shown = ", ".join(f"`{name}`" for name in failing[:2])
            print(f"| {mutant.says} | {len(failing) or '**none**'} | {shown} |", flush=True)
    return survivors


def run(copy: Path, tests: str) -> list[str]:
    """Names of the failing tests; whatever else stops the build stops this."""
    command = f"cargo test --release {tests}"
    environment = os.environ | {"CARGO_TARGET_DIR": str(copy.parent / "target"), "RUST_BACKTRACE": "0"}
    result = subprocess.run(command.split(), cwd=copy, capture_output=True, text=True, env=environment)
    if "error[" in result.stderr or "could not compile" in result.stderr:
        raise SystemExit(result.stderr)
    return sorted(set(re.findall(r"^    ([\w:]+)$", result.stdout, re.MULTILINE)))


if __name__ == "__main__":
    sys.exit(main())
