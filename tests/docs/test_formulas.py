"""MathML of formulas."""

import re
from pathlib import Path

import pytest

pytest.importorskip("latex2mathml")
from formulas import mathml_of

PAGES = (Path(__file__).parents[2] / "docs").rglob("*.md")


def test_unknown_command_is_refused():
    with pytest.raises(ValueError, match=r"cannot be converted to MathML: \\foo x"):
        mathml_of(r"\foo x")


@pytest.mark.parametrize("page", sorted(PAGES), ids=lambda page: page.stem)
def test_every_formula_of_a_page_is_converted(page):
    prose = re.sub(r"```.*?```|`[^`]*`", "", page.read_text(), flags=re.DOTALL)
    for block, formula in re.findall(
        r"\$\$(.*?)\$\$|\$([^$\n]+?)\$", prose, flags=re.DOTALL
    ):
        assert mathml_of(block or formula, bool(block))
