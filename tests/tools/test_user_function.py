"""User functions: read, refused, run in Python, compiled."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from presswear.tools.compile import address_of, call, compiled
from presswear.tools.compiled_law import check_compiles, compile_function
from presswear.tools.errors import InputError
from presswear.tools.user_function import UserFunction

KNOWN = ("a", "b", "c")


def spring(b: float, a: float) -> float:
    return 2.0 * a - b


def test_a_lambda_is_refused_with_the_remedy():
    with pytest.raises(InputError, match="law: a lambda has no name; define"):
        UserFunction.read("law", lambda a: a)


def test_same_text_is_the_same_law(tmp_path):
    function = UserFunction.read("law", spring)
    assert function.name == "spring"
    assert function.source.startswith("def spring(")
    file = tmp_path / "laws.py"
    file.write_text(function.source)
    assert UserFunction.read("law", f"{file}:spring") == function
    assert (
        UserFunction.read("law", {"name": function.name, "source": function.source})
        == function
    )
    assert function.parameters("law", KNOWN) == ("b", "a")
    assert function.evaluate("law", KNOWN, {"a": 3.0, "b": 1.0, "c": 9.0}) == 5.0
    assert str(UserFunction(function.name, function.source + "\n")) != str(function)


@compiled
def _through(address: int, a: float, b: float, c: float) -> float:
    return call(address, (a, b, c))


@given(a=st.floats(-1e3, 1e3), b=st.floats(-1e3, 1e3))
def test_compiled_function_is_called_by_address(a, b):
    address = address_of(compile_function(UserFunction.read("law", spring), KNOWN), 3)
    assert _through(address, a, b, 7.0) == spring(b, a)


def law(body: str) -> UserFunction:
    """Return a law of one parameter with an expression as its value."""
    return UserFunction("law", f"def law(a):\n    return {body}\n").trusted()


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("def law(a:\n", "is no Python"),
        ("def laws(a):\n    return a\n", "did you mean laws"),
        ("def law(aa):\n    return aa\n", "did you mean a"),
        ("def law(*a):\n    return a\n", "plain parameters"),
        ("def law(a, *, b):\n    return a\n", "plain parameters"),
        ("law = 3\n", "unknown function in normal_law 'law'; there is none"),
        ("\0", "is no Python"),
    ],
)
def test_text_without_law_is_refused_without_execution(source, words):
    with pytest.raises(InputError, match=words):
        UserFunction("law", source).parameters("normal_law", KNOWN)


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
def test_message_names_the_place_without_number(body, words):
    with pytest.raises(InputError, match=words) as refusal:
        law(body).evaluate("normal_law", KNOWN, {"a": 2.5})
    assert "a = 2.5" in str(refusal.value)


def test_message_of_a_failure_between_the_points_has_the_line():
    failing = law("(1.0, 2.0)[2] if 0.01 < a < 0.1 else a")
    with pytest.raises(
        InputError, match=r'at a = 0\.01.*: line 2, "return .*out of range'
    ):
        failing.jump("a", {"a": 0.0})


@pytest.mark.parametrize(
    "value", ["nothing.py:law", "nothing.py:", ":law", ".py:x", "/:law", print, len]
)
def test_unreadable_function_is_refused(value):
    with pytest.raises(InputError, match="law"):
        UserFunction.read("law", value)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        # Loops, subscripts and helpers.
        (
            "def law(a):\n    k = 0\n    while k < 8:\n        k += 1\n        a += (0, k)[1]\n"
            "    return a\n",
            39.0,
        ),
        (
            "K = 2.0\ndef half(x):\n    return 0.5 * x\ndef law(a):\n    return K * half(a)\n",
            3.0,
        ),
        # Fails at a = 0 alone.
        ("def law(a):\n    return math.sqrt(a) / a\n", 3.0**-0.5),
    ],
)
def test_any_python_of_numba_is_compiled(text, value):
    function = UserFunction("law", text).trusted()
    check_compiles(function, "F1", KNOWN)
    assert compile_function(function, KNOWN)(3.0, 0.0, 0.0) == pytest.approx(value)


@pytest.mark.parametrize(
    ("body", "message"),
    [
        # It is run in Python before it is compiled.
        (
            "unknown_name * a",
            "^F1: law fails: line 2, .return unknown_name .*: name 'unknown_name'",
        ),
        (
            "a + eval('2.0')",
            '^F1: law cannot be compiled: line 2, "return a .*": .*eval',
        ),
    ],
)
def test_a_law_that_cannot_be_compiled_is_refused_by_name(body, message):
    with pytest.raises(InputError, match=message):
        check_compiles(law(body), "F1", KNOWN)


def test_a_law_file_is_executed_once_in_python_and_once_to_be_compiled(
    tmp_path,
):
    """A file may take seconds to execute, or print."""
    log = tmp_path / "log"
    text = f"with open({str(log)!r}, 'a') as file:\n    file.write('x')\n"
    text += "def law(a):\n    return a\n"
    function = UserFunction("law", text).trusted()
    for value in range(50):
        assert function.evaluate("F1", KNOWN, {"a": value}) == value
    check_compiles(function, "F1", KNOWN)
    compile_function(function, KNOWN)
    assert log.read_text() == "xx"


def test_a_law_file_that_fails_is_refused_by_name():
    function = UserFunction(
        "law", "import not_there\ndef law(a):\n    return a\n"
    ).trusted()
    with pytest.raises(
        InputError,
        match=r"^F1: law fails: line 1, \"import not_there\": No module named 'not_there'",
    ):
        check_compiles(function, "F1", KNOWN)
