"""Values that are varied, as they are typed.

=====================================  ====================================================
``clearance=0.2mm:1.0mm:9``            a range or a list, see ``presswear.scene.settings``
``engine=dae,exudyn``                  words
``A.friction=0.1,0.2 & C.friction=0.1,0.3``  together, place by place, not every one with every
                                       other
=====================================  ====================================================
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from presswear.scene.scene import Scene
from presswear.scene.settings import Setting, setting_of, values_of
from presswear.sweeps.table import Array, Column
from presswear.tools.errors import InputError, shown
from presswear.tools.quantities import Choice, Quantity

TOGETHER = "&"
Typed = str | float | int


@dataclass(frozen=True)
class Factor:
    """Something that is varied.

    Attributes
    ----------
    column : Column
    is_whole : bool
        True where it takes whole numbers only.
    """

    column: Column
    is_whole: bool

    @staticmethod
    def of(setting: Setting, words: tuple[str, ...] = ()) -> "Factor":
        """The factor that changes a setting, among words where it is no number."""
        meaning = setting.meaning
        is_whole = isinstance(meaning, Quantity) and meaning.whole
        return Factor(Column(setting.key, meaning.unit, meaning.text, words), is_whole)

    def typed(self, value: float) -> Typed:
        """A value of a table as a setting."""
        if self.column.words:
            return self.column.words[int(value)]
        return int(value) if self.is_whole else float(value)


@dataclass(frozen=True)
class Group:
    """Factors that are varied together.

    Attributes
    ----------
    factors : tuple of Factor
    values : ndarray, shape (n, factors)
        Of a word its place among the words.
    """

    factors: tuple[Factor, ...]
    values: Array


def group_of(scene: Scene, text: str) -> Group:
    """What one ``--vary`` says; InputError names what is unknown, empty or out of range."""
    factors, columns = [], []
    for part in text.split(TOGETHER):
        key, equals, given = (own.strip() for own in part.partition("="))
        if not equals or not given:
            raise InputError(f"--vary {text}: KEY=VALUES is expected, such as friction=0.02,0.05")
        setting = setting_of(scene, key)
        words: tuple[str, ...] = ()
        if isinstance(setting.meaning, Quantity):
            values = values_of(key, given, setting.meaning)
        else:
            words = tuple(own.strip() for own in given.split(","))
            if isinstance(setting.meaning, Choice):
                for own in words:
                    setting.meaning.check(key, own)
            values = list(range(len(words)))
        different = len(set(words)) if words else len(set(values))
        if different < len(values) and TOGETHER not in text:
            raise InputError(f"--vary {text}: a value is there twice")
        factors.append(Factor.of(setting, words))
        columns.append(values)
    if len({len(own) for own in columns}) > 1:
        counts = " and ".join(f"{len(own)}" for own in columns)
        raise InputError(f"--vary {text}: as many values of each are expected, not {counts}")
    return Group(tuple(factors), np.array(columns, dtype=float).T)


def texts_of(scene: Scene, varied: Mapping[str, object]) -> tuple[str, ...]:
    """What a script varies, as it would be typed.

    Parameters
    ----------
    varied : mapping of str to str, sequence or array
        Values by key: as they are typed, or a list of numbers, SI, or words.  Of several keys
        joined by ``&`` a list of rows.

    Raises
    ------
    InputError
        Naming the key and what cannot be read.
    """
    return tuple(_text_of(scene, key, values) for key, values in varied.items())


def _text_of(scene: Scene, key: str, values: object) -> str:
    if isinstance(values, str):
        return f"{key}={values}"
    keys = [own.strip() for own in key.split(TOGETHER)]
    if isinstance(values, np.ndarray):
        values = values.tolist()
    if not isinstance(values, Sequence) or len(values) == 0:
        raise InputError(f"{key} = {shown(values)}: a text or a list of values is expected")
    rows = [list(own) if len(keys) > 1 and isinstance(own, Sequence) else [own] for own in values]
    if any(len(own) != len(keys) for own in rows):
        raise InputError(f"{key}: rows of {len(keys)} values are expected")
    settings = [setting_of(scene, own) for own in keys]
    columns = [
        f"{own}={','.join(_typed_text(setting, row[place]) for row in rows)}"
        for place, (own, setting) in enumerate(zip(keys, settings, strict=True))
    ]
    return f" {TOGETHER} ".join(columns)


def _typed_text(setting: Setting, value: object) -> str:
    if isinstance(value, str):
        return value
    if not isinstance(value, int | float | np.number) or isinstance(value, bool):
        raise InputError(f"{setting.key} = {shown(value)}: a number or a text is expected")
    number = value.item() if isinstance(value, np.number) else value
    if not math.isfinite(number):
        raise InputError(f"{setting.key} = {number}: a finite number is expected")
    return f"{number!r} {setting.meaning.unit}".strip()
