"""Functions of one's own: read, told, refused, compiled."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from presswear.tools.compiled import address_of, call, compiled, own_kernel
from presswear.tools.errors import InputError
from presswear.tools.own import OwnFunction

KNOWN = ("a", "b", "c")


def spring(b: float, a: float) -> float:
    return 2.0 * a - b


def test_a_function_is_its_text(tmp_path: Path) -> None:
    """Given as itself, as a file or as it is stored, it is the same law where the text is."""
    own = OwnFunction.of("law", spring)
    assert own.name == "spring"
    assert own.source.startswith("def spring(")
    file = tmp_path / "laws.py"
    file.write_text(own.source)
    assert OwnFunction.of("law", f"{file}:spring") == own
    assert OwnFunction.of("law", {"name": own.name, "source": own.source}) == own
    assert own.parameters("law", KNOWN) == ("b", "a")
    assert own.number("law", KNOWN, {"a": 3.0, "b": 1.0, "c": 9.0}) == 5.0
    assert own.digest in str(own)
    assert OwnFunction(own.name, own.source + "\n").digest != own.digest


@compiled
def _through(address: int, a: float, b: float, c: float) -> float:
    return call(address, (a, b, c))


@given(a=st.floats(-1e3, 1e3), b=st.floats(-1e3, 1e3))
def test_compiled_it_gives_the_same_by_its_address(a: float, b: float) -> None:
    address = address_of(own_kernel(OwnFunction.of("law", spring), KNOWN), 3)
    assert _through(address, a, b, 7.0) == spring(b, a)


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("def law(a:\n", "is no Python"),
        ("def laws(a):\n    return a\n", "did you mean laws"),
        ("def law(aa):\n    return aa\n", "did you mean a"),
        ("def law(*a):\n    return a\n", "plain names alone"),
        ("def law(a, *, b):\n    return a\n", "plain names alone"),
        ("law = 3\n", "unknown function in normal_law 'law'; there is none"),
        ("\0", "is no Python"),
        ("def law(a):\n    while a > 0:\n        a -= 1\n    return a\n", "line 2: a law gives"),
        ("def law(a):\n    for k in range(a):\n        a += k\n    return a\n", "loops over other"),
        (
            "def law(a):\n    for k in range(10**9):\n        pass\n",
            "loops over other than a range",
        ),
        ("def law(a):\n    for k in range(0, 2000):\n        pass\n", "written numbers up to 1000"),
        (
            "def law(a):\n    for k in range(99):\n        for j in range(99):\n            pass\n",
            "law loops over other than a range of written numbers up to 1000 in line 2",
        ),
        ("def law(a):\n    return sum(x for x in iter(int, 1))\n", "makes a list in line 2"),
        ("def law(a):\n    return [x for x in (1, 2)][0]\n", "in line 2"),
    ],
)
def test_texts_that_define_no_law_are_refused_unread(source: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        OwnFunction("law", source).parameters("normal_law", KNOWN)


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("1.0 / (a - a)", "division by zero"),
        ("unheard", "unheard"),
        ("a > 0", "gives True"),
        ("1e400 * a", "gives inf"),
        ("None", "gives None"),
    ],
)
def test_what_is_no_number_is_told_with_its_place(body: str, words: str) -> None:
    own = OwnFunction("law", f"def law(a):\n    return {body}\n").trusted()
    with pytest.raises(InputError, match=words) as told:
        own.number("normal_law", KNOWN, {"a": 2.5})
    assert "a = 2.5" in str(told.value)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize(
    "given_value", ["nothing.py:law", "nothing.py:", ":law", ".py:x", "/:law", print, len]
)
def test_what_cannot_be_read_is_refused(given_value: object) -> None:
    with pytest.raises(InputError, match="law"):
        OwnFunction.of("law", given_value)


def test_short_loops_are_laws() -> None:
    text = "def law(a):\n    for k in range(1, 9):\n        a += k\n    return a\n"
    own = OwnFunction("law", text).trusted()
    assert own.parameters("law", KNOWN) == ("a",)
    assert own_kernel(own, KNOWN)(3.0, 0.0, 0.0) == 39.0


def test_what_cannot_be_compiled_is_told_with_its_key() -> None:
    own = OwnFunction("law", "def law(a):\n    return a + open('x').fileno()\n").trusted()
    with pytest.raises(InputError, match=r"^B\.normal_law: law cannot be compiled: ") as refusal:
        own.check_compiles("B.normal_law", KNOWN)
    assert len(str(refusal.value).splitlines()) == 1


def test_helpers_are_compiled_with_it() -> None:
    text = "K = 2.0\ndef half(x):\n    return 0.5 * x\ndef law(a):\n    return K * half(a)\n"
    assert own_kernel(OwnFunction("law", text).trusted(), KNOWN)(3.0, 0.0, 0.0) == 3.0
