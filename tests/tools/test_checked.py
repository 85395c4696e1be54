"""Arguments by their annotations: settled, or refused in one line that names them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, Any, Literal, TypeVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from typing_extensions import TypeAliasType

from presswear.scene.catalog import ideal
from presswear.tools.checked import LARGEST, checked
from presswear.tools.errors import InputError
from presswear.tools.quantities import Meaning, check_fields, quantity

BELOW_TEN = Meaning("m", 0.0, 10.0, "", "")


@checked
@dataclass(frozen=True)
class Part:
    name: str
    size: Annotated[float, BELOW_TEN]
    rows: Sequence[tuple[float, float]] = ()
    places: Mapping[str, float] | None = None
    sense: Literal["along", "against"] = "along"
    law: float | Callable[..., float] = 1.0
    count: int = 1
    depth: float = quantity(0.0, "m", 0.0, 5.0, "", "")

    def __post_init__(self) -> None:
        check_fields(self)


@checked
def joined(parts: Sequence[Part], whole: bool = False) -> int:
    return len(parts)


number = st.floats(-LARGEST, LARGEST)
kinds_of_numbers = st.one_of(
    number,
    st.integers(-(10**9), 10**9),
    st.fractions(-100, 100),
    number.map(np.float64),
    st.floats(-1e3, 1e3, width=32).map(np.float32),
    st.integers(-100, 100).map(np.int64),
)


@given(st.lists(st.tuples(kinds_of_numbers, kinds_of_numbers), max_size=4), st.booleans())
def test_numbers_and_lists_of_any_kind_become_pythons_own(rows: list[Any], as_array: bool) -> None:
    given_rows: Any = np.array([[float(own) for own in row] for row in rows]) if as_array else rows
    found = Part("a", 1.0, given_rows).rows
    assert found == tuple((float(one), float(other)) for one, other in rows)
    assert all(type(own) is float for row in found for own in row)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({}, "Part: missing a required argument: 'name'"),
        ({"name": "a", "size": 1, "siz": 2}, "unknown argument of Part 'siz'; did you mean size"),
        ({"name": 3, "size": 1}, "name = 3: a text is expected"),
        ({"name": "a", "size": "3"}, "size of a = '3': a number is expected; allowed is 0 to 10 m"),
        ({"name": "a", "size": Fraction(21, 2)}, "size of a = 10.5 m: allowed is 0 to 10 m"),
        ({"name": "a", "size": True}, "size of a = True: a number"),
        ({"name": "a", "size": 1, "rows": None}, "rows of a = None: a list of"),
        ({"name": "a", "size": 1, "rows": "ab"}, "rows of a = 'ab': a list of"),
        ({"name": "a", "size": 1, "rows": {1: 2}}, "rows of a = {1: 2}: a list of"),
        ({"name": "a", "size": 1, "rows": np.array(2.0)}, "rows of a = array.*: a list of"),
        ({"name": "a", "size": 1, "rows": [(1, 2), (1,)]}, r"rows\[1\] of a = \(1,\): a \(finite"),
        ({"name": "a", "size": 1, "rows": [(1, "x")]}, r"rows\[0\]\[1\] of a = 'x': a finite"),
        ({"name": "a", "size": 1, "rows": [(1, 1e300)]}, r"\[1\] of a = 1e\+300: .*1e\+15 at most"),
        ({"name": "a", "size": 1, "rows": [(1, 10**400)]}, r"rows\[0\]\[1\] of a = 10*\.\.\.: a"),
        ({"name": "a", "size": 1, "places": {"p": "x"}}, "places.p of a = 'x': a finite number"),
        ({"name": "a", "size": 1, "places": {3: 1}}, "name in places of a = 3: a text"),
        ({"name": "a", "size": 1, "places": 3}, "places of a = 3: a mapping of text to .* or None"),
        ({"name": "a", "size": 1, "sense": "allong"}, "sense of a .*one of along.*did you mean al"),
        ({"name": "a", "size": 1, "sense": np.zeros(2)}, "sense of a = array"),
        ({"name": "a", "size": 1, "law": "f"}, "law of a = 'f': a finite number or function"),
        ({"name": "a", "size": 1, "law": np.inf}, "law of a = inf: a finite number is expected"),
        ({"name": "a", "size": 1, "count": 1.5}, "count of a = 1.5: a whole number"),
        ({"name": "a", "size": 1, "depth": 6}, "depth of a = 6 m: allowed is 0 to 5 m"),
    ],
)
def test_what_does_not_fit_is_named(arguments: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says) as refusal:
        Part(**arguments)
    assert len(str(refusal.value).splitlines()) == 1


def test_functions_are_checked_as_classes_are() -> None:
    part = Part("a", 1)
    assert joined([part, part]) == 2
    untyped: Any = joined
    with pytest.raises(InputError, match=r"parts\[1\] = 3: a Part is expected"):
        untyped([part, 3])
    with pytest.raises(InputError, match="whole = 1: a True or False is expected"):
        untyped([part], whole=1)
    with pytest.raises(InputError, match="ideal: too many positional arguments"):
        ideal(3)
    with pytest.raises(InputError, match="joined: too many positional arguments"):
        untyped([part], True, 3)


S = TypeVar("S", bound=np.generic)
PARAMETERS: Any = (S,)
ListOf: Any = TypeAliasType("ListOf", np.ndarray[Any, np.dtype[S]], type_params=PARAMETERS)
Size: Any = TypeAliasType("Size", float)


def test_an_alias_is_what_it_stands_for() -> None:
    """The kinds of numpy are aliases from its 2.5 on, which need Python 3.12."""

    @checked
    def told(depth: ListOf[np.float64], size: Size | None = None) -> tuple[Any, ...]:
        return depth.tolist(), size

    assert told([1, 2], np.float32(3.0)) == ([1.0, 2.0], 3.0)
    with pytest.raises(InputError, match=r"depth = \['a'\]: a list of numbers is expected"):
        told(["a"])
    with pytest.raises(InputError, match="size = 'a': a finite number or None is expected"):
        told([1], "a")
