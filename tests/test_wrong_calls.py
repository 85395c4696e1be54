"""Every public function and class, called with arguments of wrong types."""

import inspect
import math
from pathlib import Path
from typing import Any

import pytest

import presswear as pw

WRONG = [
    None,
    "text",
    [],
    [1],
    {},
    {"a": 1},
    math.nan,
    10**400,
    object(),
    int,
    True,
    -1,
    (1, 2),
]
NAMES = [name for name in pw.__all__ if callable(getattr(pw, name))]
RUNS = "run", "run_scenes", "sweep"  # these are called with arguments that start no run


def calls_of(name: str) -> list[dict[str, Any]]:
    """Return arguments of a call, each wrong in one argument, and in those that are needed."""
    right = {"changed": {"scene": pw.Scene(), "settings": {}}}.get(name, {})
    calls = []
    for parameter in inspect.signature(getattr(pw, name)).parameters.values():
        if parameter.kind in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD):
            continue
        for value in WRONG:
            arguments = {**right, parameter.name: value}
            for other in inspect.signature(getattr(pw, name)).parameters.values():
                if other.default is other.empty:
                    arguments.setdefault(other.name, value)
            calls.append(arguments)
    return calls


@pytest.mark.parametrize("name", NAMES)
def test_a_wrong_argument_is_named(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A call is right, or raises InputError; never the error of something inside."""
    monkeypatch.chdir(tmp_path)
    for arguments in calls_of(name):
        try:
            getattr(pw, name)(**arguments)
        except pw.InputError:
            continue
        assert name not in RUNS or not arguments.get("scenes"), arguments


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"jobs": "2"}, "jobs = '2': a whole number or None is expected"),
        ({"jobs": 10**6}, "jobs = 1000000: must be at most 10000"),
        ({"engine": {}}, "engine = {}: "),
        ({"engine": "daee"}, "did you mean dae"),
        ({"observers": [1]}, r"observers = \[1\]: a list is expected"),
        ({"folder": 3}, "folder = 3: "),
        ({"scene": {}}, "scene = {}: a Scene is expected"),
    ],
)
def test_run_names_the_wrong_argument(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(pw.InputError, match=message):
        pw.run(**{"scene": pw.scenes.ideal(), **arguments})


@pytest.mark.parametrize(
    "name", ["vary", "responses", "ranges", "on", "shard", "limits", "jobs"]
)
def test_sweep_names_the_wrong_argument(name: str, tmp_path: Path) -> None:
    for value in (1.5, object(), int, -1):
        arguments: dict[str, Any] = {
            "vary": {"speed": "1:2:2 rad/s"},
            "folder": tmp_path / "sweep",
        }
        arguments[name] = value
        with pytest.raises(pw.InputError, match=f"^{name} = "):
            pw.sweep(pw.scenes.ideal(), **arguments)


def test_a_number_of_5000_digits_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.toml"
    file.write_text(f'[mechanism]\nkind = "press"\nspeed = {"1" * 5000}\n')
    with pytest.raises(pw.InputError, match=r"a\.toml.*4300"):
        pw.scene_from(file)
    with pytest.raises(pw.InputError, match="clearance = "):
        pw.Bearing(clearance=10**5000)
