"""Arguments that a solver hands to a kernel a million times, unpacked once.

Numba takes every array of a call apart into address, shape and strides: for three dozen arrays
that takes as long as a small kernel itself.  Here they are kept as they were taken apart, and a
kernel is given the address.
"""

from collections.abc import Callable
from functools import partial
from typing import Any, TypeVar, cast

import numba
import numpy as np
from llvmlite import ir
from numba.core import types
from numba.core.datamodel import models
from numba.extending import NativeValue, intrinsic, register_model, typeof_impl, unbox

from presswear.tools.compiled import compiled, specialised

T = TypeVar("T")

_NUMBA: Any = numba
_TUPLES: Any = types.BaseTuple
_NATIVE: Any = NativeValue
_LEAF_BYTES = 128
"""Room for an array taken apart; one of three dimensions needs 88."""
_INDEX = ir.IntType(32)


class Bound(int):
    """The address of arguments that are taken apart; keeps them alive."""

    arguments: tuple[Any, ...]
    memory: Any


class _BoundType(types.Type):
    """Numba's type of a ``Bound``: a number that knows of what kind the arguments are."""

    def __init__(self, kept: Any) -> None:
        self.kept = kept
        super().__init__(name=f"Bound({kept})")


@register_model(_BoundType)
class _Address(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: _BoundType) -> None:
        cast(Any, super()).__init__(manager, kind, ir.IntType(64))


@typeof_impl.register(Bound)
def _type_of(bound: Bound, context: Any) -> _BoundType:
    return _BoundType(_NUMBA.typeof(bound.arguments))


def _number_of(kind: _BoundType, bound: Any, context: Any) -> Any:
    return _NATIVE(context.pyapi.long_as_longlong(bound))


cast(Any, unbox)(_BoundType)(_number_of)


def _leaves(kind: Any) -> int:
    return sum(_leaves(part) for part in kind) if isinstance(kind, _TUPLES) else 1


def _writing(typing: Any, arguments: Any, address: Any) -> Any:
    """Write arguments, taken apart, to an address."""

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        value, place = given
        if context.get_abi_sizeof(value.type) > _LEAF_BYTES * _leaves(arguments):
            raise TypeError(f"no room for {arguments}")
        builder.store(value, builder.inttoptr(place, value.type.as_pointer()))
        return context.get_dummy_value()

    return types.none(arguments, types.int64), generate


_write = cast(Callable[[Any, int], None], intrinsic(_writing))


def _reading(typing: Any, bound: Any) -> Any:
    """Read what a ``Bound`` keeps."""

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        constant = builder.module.add_metadata([])

        def value_at(place: Any, kind: Any) -> Any:
            if isinstance(kind, _TUPLES):
                parts = [
                    value_at(builder.gep(place, [_INDEX(0), _INDEX(i)], inbounds=True), part)
                    for i, part in enumerate(kind)
                ]
                return context.make_tuple(builder, kind, parts)
            value = builder.load(place)
            # It is not written again: a kernel reads what it needs where it needs it.
            value.set_metadata("invariant.load", constant)
            return value

        whole = context.get_value_type(bound.kept).as_pointer()
        return value_at(builder.inttoptr(given[0], whole), bound.kept)

    return bound.kept(bound), generate


bound = cast(Callable[[Bound], Any], intrinsic(_reading))
"""The arguments of a ``Bound``, inside a kernel."""


@compiled
def _fill(arguments: Any, address: int) -> None:
    _write(arguments, address)


def bind(kernel: Callable[[Bound, float], T], *arguments: Any) -> Callable[[float], T]:
    """A kernel as a function of its last argument, a number.

    Parameters
    ----------
    kernel : compiled function
        Of a ``Bound``, whose arguments it gets by ``bound``, and a number.
    arguments : arrays, records, or named tuples of such
        Arrays may change what they hold, not where they are.
    """
    memory = np.zeros(_LEAF_BYTES * _leaves(_NUMBA.typeof(arguments)), np.uint8)
    own = Bound(memory.ctypes.data)
    own.arguments, own.memory = arguments, memory
    _fill(arguments, int(own))
    return partial(specialised(kernel, own, 0.0), own)
