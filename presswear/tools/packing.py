"""Arguments of kernels, stored once as machine code reads them.

Numba unpacks every array of a call from Python. A kernel that is called a million times
takes the address of its arguments instead, and reads from there what it needs. Named
tuples that are stored are passed on between kernels by their addresses, too: as values
they are hundreds of numbers.
"""

import ctypes
from collections.abc import Callable
from functools import cache, cached_property, partial
from typing import Any, TypeVar, cast

import numba
import numpy as np
from llvmlite import ir
from numba.core import config, types
from numba.core.datamodel.models import OpaqueModel
from numba.core.typing.templates import AttributeTemplate
from numba.extending import (
    NativeValue,
    infer_getattr,
    lower_getattr_generic,
    register_model,
    typeof_impl,
    unbox,
)

from presswear.tools.compile import readable, specialised
from presswear.tools.files import digest
from presswear.tools.intrinsic import intrinsic_with
from presswear.tools.kernel_digest import fields_of

T = TypeVar("T")


class _Reference(types.Type):
    """Type of the address of a stored tuple, which does not change.

    Its name is short, and no other tuple has it.
    """

    def __init__(self, kind: Any) -> None:
        self.kind = kind
        word = (
            kind.instance_class.__name__
            if isinstance(kind, types.BaseNamedTuple)
            else "tuple"
        )
        short = digest(f"{kind} {[*fields_of(kind)]}".encode())[:16]
        super().__init__(name=f"{word}_{short}")


register_model(_Reference)(OpaqueModel)


class PackedArguments(int):
    """Address of stored arguments, which it keeps alive."""

    stored: tuple[Any, ...]
    kind: _Reference
    memory: Any

    @cached_property
    def arguments(self) -> Any:
        """Arguments for kernels in plain Python."""
        return readable(self.stored)


@typeof_impl.register(PackedArguments)
def _type_of(packed: PackedArguments, context: Any) -> Any:
    return packed.kind


@unbox(_Reference)
def _unbox_address(kind: Any, packed: Any, context: Any) -> Any:
    address = context.pyapi.long_as_longlong(packed)
    return NativeValue(
        context.builder.inttoptr(address, context.context.get_value_type(kind))
    )


_NUMBERS = {
    types.float64: ctypes.c_double,
    types.int64: ctypes.c_int64,
    types.boolean: ctypes.c_bool,
}


@cache
def _layout(kind: Any) -> Any:
    """Return the layout in memory of a value of a numba type."""
    if isinstance(kind, types.BaseTuple):
        parts = [_layout(part) for part in kind]
    elif isinstance(kind, types.Array):
        parts = [
            ctypes.c_void_p,  # memory that numba manages: none
            ctypes.c_void_p,  # Python object that owns the memory: none
            ctypes.c_int64,  # number of items
            ctypes.c_int64,  # size of an item, bytes
            ctypes.c_void_p,  # address of the items
            ctypes.c_int64 * kind.ndim,  # shape
            ctypes.c_int64 * kind.ndim,  # strides, bytes
        ]
    else:
        return _NUMBERS.get(kind, ctypes.c_void_p)  # also for None
    fields = [(f"part_{k}", part) for k, part in enumerate(parts)]
    return type("Layout", (ctypes.Structure,), {"_fields_": fields})


def _stored(kind: Any, value: Any) -> Any:
    """Return an argument in the layout of its type."""
    if value is None:
        return None
    if isinstance(kind, types.BaseTuple):
        return _layout(kind)(*map(_stored, kind, value))
    if isinstance(kind, types.Array):
        return _layout(kind)(
            None,
            None,
            value.size,
            value.itemsize,
            value.ctypes.data,
            value.shape,
            value.strides,
        )
    return value


def _key(argument: Any) -> Any:
    """Return a key that is equal for arguments of one numba type.

    ``numba.typeof`` takes 100 times as long.
    """
    if isinstance(argument, tuple):
        return type(argument), *map(_key, argument)
    if isinstance(argument, np.ndarray):
        return argument.dtype, argument.ndim, argument.flags.num
    return getattr(argument, "kind", type(argument))


_references: dict[Any, _Reference] = {}  # by key of the arguments


def pack_arguments(*arguments: Any) -> PackedArguments:
    """Return arguments for kernels that unpack them; arrays may change, but not their memory."""
    if config.DISABLE_JIT:
        packed = PackedArguments()
        packed.stored = arguments
        return packed
    key = _key(arguments)
    if key not in _references:
        _references[key] = _Reference(numba.typeof(arguments))
    reference = _references[key]
    memory = _stored(reference.kind, arguments)
    packed = PackedArguments(ctypes.addressof(memory))
    packed.stored = arguments
    packed.kind = reference
    packed.memory = memory
    return packed


def bind(
    kernel: Callable[[PackedArguments, float], T], packed: PackedArguments
) -> "partial[T]":
    """Return a kernel of packed arguments and a number as a function of the number."""
    return partial(specialised(kernel, packed, 0.0), packed)


@cache
def _read_kind(kind: Any) -> Any:
    """Return the type in which kernels read a part: an address for a named tuple."""
    return _Reference(kind) if isinstance(kind, types.BaseNamedTuple) else kind


def _read(
    context: Any, builder: Any, reference: _Reference, address: Any, index: int
) -> Any:
    """Generate code that reads a part of a stored tuple."""
    kind = reference.kind[index]
    offset = getattr(_layout(reference.kind), f"part_{index}").offset
    place = builder.gep(address, [ir.IntType(64)(offset)], inbounds=True)
    if isinstance(kind, types.BaseNamedTuple):
        return place
    return builder.load(
        builder.bitcast(place, context.get_value_type(kind).as_pointer())
    )


@infer_getattr
class _Attributes(AttributeTemplate):
    key = _Reference

    def generic_resolve(self, reference: _Reference, name: str) -> Any:
        fields = getattr(reference.kind, "fields", ())
        if name not in fields:
            return None
        return _read_kind(reference.kind[fields.index(name)])


@lower_getattr_generic(_Reference)
def _read_attribute(
    context: Any, builder: Any, reference: Any, address: Any, name: str
) -> Any:
    return _read(
        context, builder, reference, address, reference.kind.fields.index(name)
    )


@intrinsic_with(lambda packed: packed.arguments)
def _load(typing: Any, packed: Any) -> Any:
    kinds = types.Tuple([_read_kind(kind) for kind in packed.kind])

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        indices = range(len(packed.kind))
        parts = [_read(context, builder, packed, values[0], index) for index in indices]
        return context.make_tuple(builder, signature.return_type, parts)

    return kinds(packed), generate


# In a kernel: the arguments of ``PackedArguments``.
unpack = cast(Callable[[PackedArguments], Any], _load)
