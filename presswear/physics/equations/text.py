"""Text of a function of scalars, and the numbers that it takes from an array.

Terms that are zero by the topology of a linkage are left out of sums and products, as
in equations that are written by hand.
"""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from itertools import chain, count
from typing import NamedTuple

ZERO = "0.0"
ONE = "1.0"
ROUND_OFF = 1e-15  # largest sine or cosine that counts as zero
_ATOM = re.compile(r"-?[\w.]+")
_BRACKETS_AND_SIGNS = re.compile(r"[()\[\]]| [+-] ")
_INDENT = "    "


def is_sum(expression: str) -> bool:
    """Return whether an expression has a plus or minus outside of its brackets."""
    depth = 0
    for bracket_or_sign in _BRACKETS_AND_SIGNS.findall(expression):
        if bracket_or_sign in "([":
            depth += 1
        elif bracket_or_sign in ")]":
            depth -= 1
        elif depth == 0:
            return True
    return False


def negative(expression: str) -> str:
    """Return an expression with the other sign."""
    if expression == ZERO:
        return ZERO
    if is_sum(expression):
        return f"-({expression})"
    return expression[1:] if expression.startswith("-") else f"-{expression}"


def total(*terms: str) -> str:
    """Return a sum."""
    result = ""
    for term in terms:
        if term == ZERO:
            continue
        if not result:
            result = term
        elif term.startswith("-"):
            result += f" - {term[1:]}"
        else:
            result += f" + {term}"
    return result or ZERO


def difference(first: str, second: str) -> str:
    """Return the difference of two expressions."""
    return total(first, negative(second))


@lru_cache(10_000)  # the same products are in the equations of every run of a linkage
def product(*factors: str) -> str:
    """Return a product."""
    if ZERO in factors:
        return ZERO
    sign = ""
    words = list[str]()
    for factor in factors:
        word = f"({factor})" if is_sum(factor) else factor
        if word.startswith("-"):
            sign = "" if sign else "-"
            word = word[1:]
        if word != ONE:
            words.append(word)
    return sign + (" * ".join(words) or ONE)


def quotient(numerator: str, denominator: str) -> str:
    """Return a quotient."""
    if not _ATOM.fullmatch(denominator):
        denominator = f"({denominator})"
    return f"{numerator} / {denominator}"


def square(factor: str) -> str:
    """Return the square of an expression."""
    return product(factor, factor)


class Vector(NamedTuple):
    """Expressions of both components of a vector."""

    x: str = ZERO
    y: str = ZERO

    def plus(self, *vectors: "Vector") -> "Vector":
        """Return the sum of vectors."""
        return Vector(*(total(*terms) for terms in zip(self, *vectors, strict=True)))

    def minus(self, vector: "Vector") -> "Vector":
        """Return the difference of two vectors."""
        return self.plus(vector.times(f"-{ONE}"))

    def times(self, factor: str) -> "Vector":
        """Return the product with a number."""
        return Vector(product(factor, self.x), product(factor, self.y))

    def rotated_at(self, omega: str) -> "Vector":
        """Return the cross product of an angular velocity and this vector."""
        return Vector(negative(product(omega, self.y)), product(omega, self.x))

    def dot(self, vector: "Vector") -> str:
        """Return the scalar product."""
        return total(product(self.x, vector.x), product(self.y, vector.y))

    def cross(self, vector: "Vector") -> str:
        """Return the cross product, as the moment of a force with this vector as arm."""
        return difference(product(self.x, vector.y), product(self.y, vector.x))


def rotated(vector: Vector, cosine: str, sine: str) -> Vector:
    """Return a vector turned by an angle."""
    x = difference(product(vector.x, cosine), product(vector.y, sine))
    return Vector(x, total(product(vector.y, cosine), product(vector.x, sine)))


class Text:
    """Lines of a function, with names for its variables."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.numbers: dict[str, float] = {}  # parameters by name, in their order
        self._prefixes: set[str] = set()
        self._depth = 1

    def prefix(self, name: str) -> str:
        """Return the beginning of the names of variables of a body or joint.

        It is the name with underscores. If another prefix is similar, it is the name
        without underscores, and then with a number.
        """
        word = re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_") or "part"
        word = f"body_{word}" if word[0].isdigit() else word
        without_underscores = word.replace("_", "")
        numbered = (f"{without_underscores}{k}" for k in count(2))
        candidates = chain((word, without_underscores), numbered)
        prefix = next(candidate for candidate in candidates if self._is_new(candidate))
        self._prefixes.add(prefix)
        return prefix

    def _is_new(self, word: str) -> bool:
        """Return whether a prefix is new, and no prefix is another one with more words.

        ``rod`` and ``rod_3`` exclude each other: ``rod_3_x`` could belong to both.
        """
        return not any(
            word == used or word.startswith(f"{used}_") or used.startswith(f"{word}_")
            for used in self._prefixes
        )

    def write(self, line: str) -> None:
        """Append a line; an empty line is not indented."""
        if line:
            line = _INDENT * self._depth + line
        self.lines.append(line)

    def comment(self, words: str) -> None:
        """Write an empty line and a comment.

        Characters of a user's name that cannot be printed, as a line end, become spaces.
        """
        printable = [c if c.isprintable() else " " for c in words]
        self.write("")
        self.write("# " + "".join(printable))

    def let(self, name: str, expression: str) -> str:
        """Assign an expression to a name; return the name, or the expression if it is simple."""
        if _ATOM.fullmatch(expression):
            return expression
        self.write(f"{name} = {expression}")
        return name

    def let_vector(self, name: str, vector: Vector) -> Vector:
        """Assign both components of a vector to names."""
        return Vector(self.let(f"{name}_x", vector.x), self.let(f"{name}_y", vector.y))

    def parameter(self, name: str, value: float) -> str:
        """Return the name of a number of the linkage, or ZERO for zero."""
        if value == 0.0:
            return ZERO
        self.numbers[name] = float(value)
        return name

    def direction(self, name: str, value: float) -> str:
        """Return the name of a sine or cosine, or its value if that is 0, 1 or -1."""
        if abs(value) < ROUND_OFF:
            return ZERO
        if abs(value) == 1.0:
            return ONE if value > 0.0 else f"-{ONE}"
        return self.parameter(name, value)

    @contextmanager
    def block(self, head: str) -> Iterator[None]:
        """Indent what is written inside the context."""
        self.write(head)
        self._depth += 1
        yield
        self._depth -= 1
