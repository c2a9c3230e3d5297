"""Memory stays flat over many calls; ``tests/evidence/memory.py`` makes ten thousand."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parents[1] / "evidence"
CALLS = 600
# An allocator keeps some pages; a receiver's buffer that is not given back, or a context, is larger.
ALLOWED_BYTES_A_CALL = 4096

pytestmark = pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="this system tells no resident size")


def held(before: str = "") -> list[int]:
    """Resident bytes after each tenth of the calls, in a process of their own."""
    script = f"""
import json, sys
sys.path.insert(0, {str(FOLDER)!r})
import memory
{before}
print(json.dumps(memory.growth({CALLS}, 'native')))
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=300, check=True)
    return json.loads(done.stdout)


def is_flat(held: list[int]) -> bool:
    """From the third tenth on."""
    return held[-1] - held[2] < 0.7 * CALLS * ALLOWED_BYTES_A_CALL


def test_memory_is_flat():
    bytes_held = held()
    assert is_flat(bytes_held), bytes_held


def test_a_leak_is_seen():
    leak = """
kept, call = [], memory.call
def leaking(index, device):
    kept.append(b"x" * 10_000)
    call(index, device)
memory.call = leaking
"""
    bytes_held = held(leak)
    assert not is_flat(bytes_held), bytes_held
