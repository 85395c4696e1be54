"""MathML of formulas."""

import re
from pathlib import Path

import pytest

pytest.importorskip("latex2mathml")
from formulas import mathml_of

PAGES = (Path(__file__).parents[2] / "docs").rglob("*.md")
THIN = '<mspace width="0.17em"></mspace>'


def body(text: str) -> str:
    match = re.fullmatch(r"<math [^>]*><mrow>(.*)</mrow></math>", mathml_of(text))
    assert match
    return match[1]


def test_function_names_have_spaces_except_before_a_bracket():
    function = f"<mrow>{THIN}<mi>cos</mi>{THIN}</mrow>"
    assert body(r"e \cos x") == f"<mi>e</mi>{function}<mi>x</mi>"
    assert body(r"\cos x") == f"<mrow><mi>cos</mi>{THIN}</mrow><mi>x</mi>"
    assert body(r"\cos(x)").startswith("<mrow><mi>cos</mi></mrow><mo ")


def test_prime_has_full_size_with_and_without_an_index():
    prime = '<mo lspace="0" rspace="0">&#x02032;</mo>'
    assert body("f'") == f"<mrow><mi>f</mi>{prime}</mrow>"
    assert body("h_b'") == f"<mrow><msub><mi>h</mi><mi>b</mi></msub>{prime}</mrow>"


def test_bars_of_a_magnitude_have_no_inner_space():
    bar = '<mo lspace="0" rspace="0">&#x0007C;</mo>'
    assert body("|x|") == f"{bar}<mi>x</mi>{bar}"


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
