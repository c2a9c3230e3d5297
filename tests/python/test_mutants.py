"""Every mutant of the heavy checks has its one place in the sources: a changed line must not let one rest."""

import importlib.util
import sys
from pathlib import Path

FILE = Path(__file__).resolve().parents[1] / "evidence" / "mutants.py"


def places(mutants, text_of) -> dict[str, int]:
    """How often the right text of each mutant stands in its file, where that is not once."""
    counts = {mutant.says: text_of(mutant.file).count(mutant.right) for mutant in mutants}
    return {says: count for says, count in counts.items() if count != 1}


def test_every_mutant_has_a_single_place_and_changes_it():
    spec = importlib.util.spec_from_file_location("mutants", FILE)
    module = importlib.util.module_from_spec(spec)
    # Its dataclass looks itself up.
    sys.modules["mutants"] = module
    spec.loader.exec_module(module)

    def text_of(file: str) -> str:
        return (module.ROOT / file).read_text()

    assert places(module.MUTANTS, text_of) == {}
    assert all(mutant.right != mutant.wrong for mutant in module.MUTANTS)
    # What is gone, or stands twice, is named.
    first = module.MUTANTS[0]
    assert places([first], lambda file: text_of(file).replace(first.right, "")) == {first.says: 0}
    assert places([first], lambda file: text_of(file) * 2) == {first.says: 2}
