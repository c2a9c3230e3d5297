"""One change at a time to the silhouette edges, each of which the tests have to notice.

Every mutant is a line of ``crates/`` written wrong: a sign flipped, an edge dropped, h for g, an epsilon at w = 0. It
is built in a copy of the work tree, and the tests of ``softshadow_scene`` and ``softshadow_native`` must fail. A mutant
that survives is a hole in the tests.
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


@dataclass(frozen=True)
class Mutant:
    """What is done wrong, and where."""

    says: str
    file: str
    right: str
    wrong: str


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
        if failing := run(copy):
            print(f"the tests fail without any change: {failing}", file=sys.stderr)
            return 1
        for mutant in MUTANTS:
            path = copy / mutant.file
            text = path.read_text()
            if text.count(mutant.right) != 1:
                print(f"'{mutant.says}': {mutant.file} has no single place for it", file=sys.stderr)
                return 1
            path.write_text(text.replace(mutant.right, mutant.wrong))
            failing = run(copy)
            path.write_text(text)
            survivors += not failing
            shown = ", ".join(f"`{name}`" for name in failing[:2])
            print(f"| {mutant.says} | {len(failing) or '**none**'} | {shown} |", flush=True)
    return survivors


def run(copy: Path) -> list[str]:
    """Names of the failing tests; whatever else stops the build stops this."""
    command = (
        "cargo test --release -p softshadow_scene -p softshadow_native --no-fail-fast --quiet -- --skip real_meshes"
    )
    environment = os.environ | {"CARGO_TARGET_DIR": str(copy.parent / "target"), "RUST_BACKTRACE": "0"}
    result = subprocess.run(command.split(), cwd=copy, capture_output=True, text=True, env=environment)
    if "error[" in result.stderr or "could not compile" in result.stderr:
        raise SystemExit(result.stderr)
    return sorted(set(re.findall(r"^    ([\w:]+)$", result.stdout, re.MULTILINE)))


if __name__ == "__main__":
    sys.exit(main())
