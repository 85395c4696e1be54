"""Numbers and code of the README are those of the program."""

import re
import textwrap
from pathlib import Path
from typing import Any

from readme import result_table, with_life

import presswear as pw
from presswear.tools.errors import NARROW

ROOT = Path(__file__).parents[2]


def estimates(text: str) -> dict[str, list[float]]:
    plain = text.replace("−", "-").replace(NARROW, "")
    rows = re.findall(r"(?m)^\| (.*) \| (\S+) \| (\S+) to (\S+) \|$", plain)
    return {label: [float(x) for x in numbers] for label, *numbers in rows}


def test_table_in_the_readme_is_that_of_a_run():
    """Intervals of twice the width overlap; chance separates them once in 100,000 runs."""
    (text,) = re.findall(
        r"(?s)<!-- result -->(.*?)<!-- end -->", (ROOT / "README.md").read_text()
    )
    stored = estimates(text)
    computed = estimates(result_table(cycles=8))
    assert list(stored) == list(computed)
    assert len(stored) == 7
    for label, (mean, low, high) in computed.items():
        assert low < mean < high, label
        stored_mean, stored_low, stored_high = stored[label]
        assert abs(stored_mean - mean) < (stored_high - stored_low) + (high - low), (
            label
        )


def test_mechanism_in_the_readme_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (code,) = re.findall(
        r"(?m)^    import presswear as pw\n(?:(?:    .*)?\n)+",
        (ROOT / "README.md").read_text(),
    )
    names: dict[str, Any] = {}
    exec(textwrap.dedent(code), names)
    assert pw.load("results/four-bar").stages[1].joints["B"].statistics.contacts > 0


def test_life_in_the_readme_is_the_stored_one():
    """``python docs/_tools/readme.py life`` computes, stores and writes it."""
    text = (ROOT / "README.md").read_text()
    assert "<!-- life -->" in text
    assert with_life(text) == text
