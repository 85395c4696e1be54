"""Quantities with unit, range and origin, choices, and numbers with units as people type them.

Every value that a person may set is a data class field made by ``quantity``, ``count``,
``choice``, ``free_text``, ``named_set`` or ``one_of``. Help, error messages, files and
reports read its meaning from the field.
"""

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import Field, dataclass, field, replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Context
from numbers import Integral, Real
from typing import Any, ClassVar, cast, get_args

from presswear.tools.errors import InputError, nearest, shown
from presswear.tools.numbers import short_number
from presswear.tools.user_function import UserFunction

NONE = "none"  # word for an optional part that is absent
ON = "on"  # word for an optional part of the only kind there is
SYMBOLS = {  # of the paper and of the contact laws, by which settings are named, too
    **{"omega": "speed", "c": "clearance", "R_i": "bearing_radius", "b": "width"},
    **{"E": "youngs_modulus", "nu": "poisson_ratio", "K_d": "wear_coefficient"},
    "bins": "angles",
    **{
        "K": "contact_stiffness",
        "n": "exponent",
        "c_e": "restitution",
        "D": "viscous_damping",
    },
    **{
        "c_f": "friction",
        "c_s": "static_friction",
        "v_0": "lower_speed",
        "v_1": "upper_speed",
    },
    **{
        "v_s": "stribeck_speed",
        "sigma_0": "bristle_stiffness",
        "sigma_1": "bristle_damping",
    },
}

_DEGREE = math.pi / 180.0
_PER_MINUTE = dict.fromkeys(
    ("rpm", "spm", "1/min", "/min", "rev/min", "r/min"), math.pi / 30.0
)
_PER_SECOND = dict.fromkeys(("rps", "rev/s", "r/s", "Hz"), 2.0 * math.pi)
_UNITS: dict[str, dict[str, float]] = {  # sizes of units by the SI unit
    "": {"": 1.0, "%": 0.01, "percent": 0.01},
    "m": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "in": 0.0254},
    "rad/s": {"rad/s": 1.0, "deg/s": _DEGREE, **_PER_MINUTE, **_PER_SECOND},
    "rad": {"rad": 1.0, "deg": _DEGREE, "°": _DEGREE},
    "m/m": {"m/m": 1.0, "mm/m": 1e-3, "um/m": 1e-6, "µm/m": 1e-6},
    "kg": {"kg": 1.0, "g": 1e-3, "t": 1e3},
    "kg m^2": {
        "kg m^2": 1.0,
        "kgm^2": 1.0,
        "kg cm^2": 1e-4,
        "kg mm^2": 1e-6,
        "g mm^2": 1e-9,
    },
    "Pa": {
        "Pa": 1.0,
        "kPa": 1e3,
        "MPa": 1e6,
        "GPa": 1e9,
        "bar": 1e5,
        "N/m^2": 1.0,
        "N/mm^2": 1e6,
    },
    "W/m^2": {
        "W/m^2": 1.0,
        "Pa m/s": 1.0,
        **dict.fromkeys(("MPa m/s", "N/mm^2 m/s"), 1e6),
    },
    "1/Pa": {
        **dict.fromkeys(("1/Pa", "/Pa", "m^2/N"), 1.0),
        **dict.fromkeys(("1/MPa", "/MPa", "mm^2/N"), 1e-6),
        **dict.fromkeys(("mm^3/Nm", "mm^3/N m", "mm^3/(N m)"), 1e-9),
    },
    "Pa s": {"Pa s": 1.0, "Pas": 1.0, "mPa s": 1e-3, "mPas": 1e-3, "cP": 1e-3},
    "m^3": {"m^3": 1.0, "cm^3": 1e-6, "mm^3": 1e-9},
    "m/s": {"m/s": 1.0, "mm/s": 1e-3, "m/min": 1.0 / 60.0},
    "m/s^2": {"m/s^2": 1.0, "mm/s^2": 1e-3},
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "min": 60.0},
    "N/m": {
        "N/m": 1.0,
        "kN/m": 1e3,
        "N/mm": 1e3,
        "MN/m": 1e6,
        "kN/mm": 1e6,
        "GN/m": 1e9,
    },
    "N/m^n": dict.fromkeys(("N/m^n", "N/m^1.5", "N/m1.5", "N/m"), 1.0),
    "N": {"N": 1.0, "kN": 1e3, "MN": 1e6, "tf": 9806.65},
    "N m": {"N m": 1.0, "Nm": 1.0, "N mm": 1e-3, "Nmm": 1e-3, "kN m": 1e3, "kNm": 1e3},
    "N m/rad": {
        **dict.fromkeys(("N m/rad", "Nm/rad"), 1.0),
        **dict.fromkeys(("kN m/rad", "kNm/rad"), 1e3),
        **dict.fromkeys(("MN m/rad", "MNm/rad"), 1e6),
    },
    "N m s/rad": {
        **dict.fromkeys(("N m s/rad", "Nms/rad"), 1.0),
        **dict.fromkeys(("kN m s/rad", "kNms/rad"), 1e3),
    },
    "1/m": {"1/m": 1.0, "/m": 1.0, "1/mm": 1e3, "/mm": 1e3},
    "s/m": {"s/m": 1.0, "s/mm": 1e3},
    "N s/m": {"N s/m": 1.0, "Ns/m": 1.0, "N s/mm": 1e3, "Ns/mm": 1e3},
}
_WRITTEN_IN = {  # units of engineers, the largest first
    **{
        "m": ("mm",),
        "rad": ("deg",),
        "m/m": ("um/m",),
        "rad/s": ("rpm",),
        "W/m^2": ("MPa m/s",),
    },
    **{
        "Pa": ("GPa", "MPa"),
        "N": ("kN", "N"),
        "N m": ("kN m", "N m"),
        "kg": ("kg", "g"),
    },
    **{
        "kg m^2": ("kg m^2", "kg mm^2"),
        "1/Pa": ("mm^3/(N m)",),
        "m/s": ("m/s", "mm/s"),
    },
    **{"s": ("s", "ms"), "N/m": ("kN/mm", "N/mm")},
}
_SIGNS = str.maketrans({"²": "^2", "³": "^3", "μ": "µ", "·": " ", "*": " ", "_": " "})
_POWER = re.compile(r"(?<=[a-z])(?=[23]\b)")  # where a power has no sign, as in mm2
_SEPARATED = {  # forms of numbers that are refused, and what becomes of their signs
    "use no separator of thousands": (
        r"\d{1,3}([,'’]\d{3})+(\.\d*)?",
        str.maketrans("", "", ",'’"),
    ),
    "use a decimal point": (
        r"(\d{1,3}(\.\d{3})+|\d*),\d+",
        str.maketrans(",", ".", "."),
    ),
}
_NUMBER = re.compile(
    r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*(.*)$"
)


def plain_number(value: Any) -> Any:
    """Return a number of any kind as an int or a float; anything else as it is."""
    if isinstance(value, bool) or not isinstance(value, Real):
        return value
    try:
        number = float(value)
    except OverflowError:
        return math.inf if int(cast(Any, value)) > 0 else -math.inf
    return int(value) if isinstance(value, Integral) else number


@dataclass(frozen=True)
class Quantity:
    """Unit, range with its ends (not the lower if ``open_low``), origin and meaning."""

    unit: str = ""
    low: float = -math.inf
    high: float = math.inf
    origin: str = ""
    text: str = ""
    open_low: bool = False
    whole: bool = False
    size: float = 1.0  # of the unit, SI

    def with_unit(self, value: str) -> str:
        """Return a value as text with the unit behind it."""
        return f"{value} {self.unit}".rstrip()

    def written(self, value: float, digits: int = 6) -> str:
        """Return a value with the unit in which engineers write it."""
        shown = self.in_unit_of(value)
        return shown.with_unit(f"{value / shown.size:.{digits}g}")

    def texts(self, *values: Any) -> tuple[list[str], str]:
        """Return values as text in the unit in which engineers write the largest, and that unit."""
        numbers = [abs(value) for value in values if isinstance(value, int | float)]
        shown = self.in_unit_of(max(numbers, default=0.0))
        size = shown.size
        texts = (
            short_number(x / size) if isinstance(x, float | int) else f"{x}"
            for x in values
        )
        return [*texts], shown.unit.replace("^2", "²").replace("^3", "³")

    def in_unit_of(self, value: float) -> "Quantity":
        """Return the quantity in the unit in which engineers write a value."""
        sizes = _UNITS.get(self.unit, {self.unit: 1.0})
        units = _WRITTEN_IN.get(self.unit, (self.unit,))
        unit = next((unit for unit in units if abs(value) >= sizes[unit]), units[-1])
        return self.in_unit(unit, sizes[unit])

    def in_unit(self, unit: str, size: float) -> "Quantity":
        """Return the quantity in a unit of a size, SI."""
        low, high = (float(f"{end / size:.12g}") for end in (self.low, self.high))
        return replace(self, unit=unit, low=low, high=high, size=size)

    def range_text(self) -> str:
        """Return the allowed range in words, with the unit, its ends rounded inward."""
        if math.isinf(self.high) and math.isinf(self.low):
            return self.with_unit(f"any finite number{' in' if self.unit else ''}")
        low = _six_digits(self.low, ROUND_CEILING)
        if math.isinf(self.high):
            return self.with_unit(f"{'above' if self.open_low else 'at least'} {low}")
        first = f"above {low} up to" if self.open_low else f"{low} to"
        return self.with_unit(f"{first} {_six_digits(self.high, ROUND_FLOOR)}")

    def check(self, name: str, value: Any) -> None:
        """Raise InputError unless the value is a finite number in range."""
        kind = int if self.whole else (int, float)
        if not isinstance(value, kind) or isinstance(value, bool):
            number = "a whole number" if self.whole else "a number"
            allowed = f"{number} is expected; allowed is {self.range_text()}"
            raise InputError(f"{name} = {shown(value)}: {allowed}")
        is_above = self.low < value if self.open_low else self.low <= value
        if not (is_above and value <= self.high) or math.isinf(value):
            text = f"{value:g}"
            if (
                self.low <= float(text) <= self.high
            ):  # outside by less than six digits show
                text = f"{value!r}"
            raise InputError(
                f"{name} = {self.with_unit(text)}: allowed is {self.range_text()}"
            )

    def convert(self, name: str, value: Any) -> Any:
        """Return a number, SI, or a text with a unit as a number in range; raise InputError."""
        if isinstance(value, str):
            return parse_quantity(name, value, self)
        number = plain_number(value)
        self.check(name, number)
        return number if self.whole else float(number)


def written(value: float, unit: str) -> str:
    """Return an SI value in the unit in which engineers write it, in up to six digits."""
    return Quantity(unit).written(value)


def _six_digits(value: float, rounding: str) -> str:
    return f"{float(Context(6, rounding).create_decimal(repr(value))):g}"


def parse_quantity(name: str, text: str, meaning: Quantity) -> float | int:
    """Return a number, SI, from a text with its unit, and check its range.

    A quantity with a dimension needs its unit, except for 0: 0.8 could be metres or
    millimetres. ``m or rad`` has the units of both. A unit that the table lacks is the
    only one of its dimension.

    Raises
    ------
    InputError
        With the name, and the known units or the allowed range.
    """
    units: dict[str, float] = {}
    for unit in meaning.unit.split(" or "):
        units |= _UNITS.get(unit, {unit: 1.0})
    label = f"{name} = {text!r}"
    allowed = f"allowed is {meaning.in_unit_of(meaning.low).range_text()}"
    advice = [
        f"{words}, {digits[0].translate(signs) + text[digits.end() :]!r}"
        for words, (form, signs) in _SEPARATED.items()
        if (digits := re.match(rf"\s*[+-]?{form}(?![\d.,'’])", text, re.ASCII))
    ]
    if advice:
        raise InputError(f"{label}: {'; or '.join(advice)}")
    match = _NUMBER.match(text)
    if match is None:
        raise InputError(
            f"{label} is not a number{' with a unit' * bool(meaning.unit)}; {allowed}"
        )
    value, symbol = float(match[1]), _POWER.sub("^", match[2].translate(_SIGNS))
    symbol = re.sub(r"\s+", " ", symbol).strip()
    if symbol.startswith("pi") and "rad" in meaning.unit:
        value, symbol = value * math.pi, symbol[2:].strip()
    if meaning.unit and not symbol:
        if value != 0.0:
            raise InputError(
                f"{label} has no unit; known are {', '.join(units)}; {allowed}"
            )
        symbol = next(iter(units))
    if symbol not in units:
        pure = f"a pure number{', or one in %,' * (not meaning.whole)} is expected"
        fault = f"unknown unit {shown(symbol)}; known are {', '.join(units)}"
        raise InputError(f"{label}: {fault if meaning.unit else pure}")
    value *= units[symbol]
    number: float | int = int(value) if meaning.whole and value.is_integer() else value
    try:
        meaning.check(name, number)
    except InputError:
        if meaning.unit:  # in the unit of the text
            size = units[symbol]
            meaning.in_unit(symbol, size).check(name, float(f"{number / size:.12g}"))
        raise
    return number


@dataclass(frozen=True)
class Choice:
    """Field that takes one of a few words, a named instance, a kind of part, or a free text."""

    # allowed words, or a function of the owner that returns them
    words: tuple[str, ...] | Any
    text: str = ""
    parameters: tuple[str, ...] = ()  # allowed in a user function in place of a word
    # Words can be combined, except for the last one, which stands for none of them.
    # Words of one letter may be written side by side, others with commas between.
    several: bool = False
    # by name; the field holds one, or a changed one
    instances: Mapping[str, Any] | None = None
    # fields that no named instance states: they stay when another name is chosen
    stays: tuple[str, ...] = ()
    # classes by kind; the field holds an instance, or None
    kinds: Mapping[str, Any] | None = None
    # first values of a part that is either ``on`` or absent: those without a default
    needed: Mapping[str, Any] = field(default_factory=dict, hash=False)
    example: str = ""  # of a free text that its owner reads

    unit: ClassVar[str] = ""

    @property
    def is_part(self) -> bool:
        """True where the field holds a data class."""
        return self.instances is not None or self.kinds is not None

    def combine(self, words: Iterable[str]) -> str:
        """Return several words as one value, in the order in which they are allowed."""
        chosen = set(words)
        used = [word for word in self.words[:-1] if word in chosen]
        joined = "".join(used)
        is_plain = len(joined) == len(used) and joined not in self.words
        return (joined if is_plain else ",".join(used)) or self.words[-1]

    def split(self, value: str) -> tuple[str, ...]:
        """Return the words of a combined value."""
        if value == self.words[-1]:
            return ()
        if value not in self.words and set(value) <= set(self.words):
            return tuple(value)
        return tuple(part.strip() for part in value.split(","))

    def allowed(self) -> tuple[str, ...]:
        """Return the allowed values in words."""
        if self.example:
            return (f"such as {self.example}",)
        can_combine = self.several and len(self.words) > 2
        several = (
            [f"several together, as {self.combine(self.words)}"] if can_combine else []
        )
        return (
            *self.words,
            *several,
            *(["FILE.py:FUNCTION"] if self.parameters else []),
        )

    def shown(self, value: Any) -> Any:
        """Return the word by which a field value is set: a name, a kind, or the value itself."""
        if self.instances is not None:
            return next(
                (
                    name
                    for name, one in self.instances.items()
                    if self._with_fields_that_stay(one, value) == value
                ),
                "custom",
            )
        if self.kinds is not None:
            return NONE if value is None else getattr(value, "kind", ON)
        return value

    def chosen(self, name: str, value: Any, before: Any) -> Any:
        """Return the field value as ``convert`` does, with the fields that stay as before."""
        result = self.convert(name, value)
        is_word = isinstance(value, str)
        return self._with_fields_that_stay(result, before) if is_word else result

    def _with_fields_that_stay(self, value: Any, before: Any) -> Any:
        if not self.stays:
            return value
        return replace(value, **{key: getattr(before, key) for key in self.stays})

    def convert(self, name: str, value: Any) -> Any:
        """Return the field value for a word, an instance or stored data; raise InputError."""
        if self.kinds is not None and value is not None:
            if isinstance(value, tuple(self.kinds.values())):
                return value
            data = _by_name(value) if isinstance(value, Mapping) else {"kind": value}
            if isinstance(value, str) and value == ON:
                data |= self.needed
            kind = data.pop("kind", ON if self.needed else None)
            self.check(name, kind)
            return None if kind == NONE else self.kinds[kind](**data)
        if self.instances is not None:
            class_ = type(next(iter(self.instances.values())))
            if isinstance(value, class_):
                return value
            if isinstance(value, Mapping):
                return class_(**_by_name(value))
            self.check(name, value)
            return self.instances[value]
        is_function = callable(value) or isinstance(value, UserFunction | dict)
        if self.parameters and (is_function or ".py:" in str(value)):
            return UserFunction.read(name, value, self.parameters)
        if self.kinds is None:
            self.check(name, value)
        return value

    def check(self, name: str, value: Any) -> None:
        """Raise InputError unless the value is one of the words, or a text where one is free."""
        if isinstance(value, str):
            parts = self.split(value) if self.several else ()
            is_combined = len(set(parts)) == len(parts) and set(parts) <= set(
                self.words[:-1]
            )
            if self.example or value in self.words or (parts and is_combined):
                return
        if self.example:
            raise InputError(f"{name} = {shown(value)}: a text is expected")
        allowed = ", ".join(self.allowed()) + nearest(f"{value}", self.words)
        raise InputError(f"{name} = {shown(value)}: allowed is one of {allowed}")


def _by_name(data: Mapping[Any, Any]) -> dict[str, Any]:
    return {f"{key}": value for key, value in data.items()}


def quantity(
    default: float | None,
    unit: str,
    low: float,
    high: float,
    origin: str,
    text: str,
    **more: bool,
) -> Any:
    """Return a field for a number with a unit; ``more`` are fields of ``Quantity``."""
    return _field(default, Quantity(unit, low, high, origin, text, **more))


def _field(default: Any, meaning: Quantity | Choice) -> Any:
    return field(default=default, metadata={"meaning": meaning})


def count(default: int | None, low: int, high: int, origin: str, text: str) -> Any:
    """Return a data class field for a whole number without a unit."""
    return quantity(default, "", low, high, origin, text, whole=True)


def choice(
    default: str | None,
    words: Any,
    text: str,
    parameters: Any = (),
    several: bool = False,
) -> Any:
    """Return a data class field for one of a few words, also those of a Literal; see ``Choice``."""
    return _field(default, Choice(get_args(words) or words, text, parameters, several))


def free_text(default: str, example: str, text: str) -> Any:
    """Return a data class field for a text that its owner reads."""
    return _field(default, Choice((), text, example=example))


def named_set(
    default: str,
    instances: Mapping[str, Any],
    text: str,
    stays: tuple[str, ...] = (),
) -> Any:
    """Return a data class field for one of some data class instances, or a changed one.

    ``stays`` are fields that no instance states: they stay when a name is chosen.
    """
    choice = Choice(tuple(instances), text, instances=instances, stays=stays)
    return _field(instances[default], choice)


def one_of(kinds: Mapping[str, Any], text: str) -> Any:
    """Return a data class field for an instance of one of some data classes, or None."""
    return _field(None, Choice((NONE, *kinds), text, kinds=kinds))


def optional(kind: Any, needed: Mapping[str, Any], text: str) -> Any:
    """Return a data class field for an instance of a data class, or None.

    ``needed`` are first values of the fields that have no default.
    """
    return _field(None, Choice((NONE, ON), text, kinds={ON: kind}, needed=needed))


def meaning_of(item: Field[Any], owner: Any = None) -> Quantity | Choice | None:
    """Return the meaning of a field, None without; the words of a choice may need the owner."""
    for meaning in (
        item.metadata.get("meaning"),
        *getattr(item.type, "__metadata__", ()),
    ):
        if isinstance(meaning, Choice) and callable(meaning.words):
            return replace(meaning, words=meaning.words(owner))
        if isinstance(meaning, Quantity | Choice):
            return meaning
    return None
