"""Elements of arrays, loops over ranges, and ``max`` and ``min`` in a few instructions.

Numba writes 30 instructions for an element, 100 for a loop and a function for ``max``.
LLVM takes nearly all of them out again, which takes a quarter of a compilation.
"""

import operator
from collections.abc import Sequence
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.cpython.rangeobj import range_impl_map
from numba.extending import lower_builtin
from numba.np import arrayobj

ITEMS, ITEM_SIZE, DATA, SHAPE, STRIDES = range(2, 7)  # places in an array's structure
RANGE, LOOP = range_impl_map[types.int64]


def integer(value: int) -> Any:
    """Return a number for the code."""
    return ir.Constant(ir.IntType(64), value)


class Elements:
    """Array in the code of a kernel whose items follow each other without gaps."""

    def __init__(self, context: Any, builder: Any, kind: Any, value: Any) -> None:
        self.context = context
        self.builder = builder
        self.kind = kind
        self.value = value

    def size(self, axis: int) -> Any:
        """Return the number of items along an axis."""
        return self.builder.extract_value(self.value, [SHAPE, axis])

    def position(self, axis: int, kind: Any, index: Any) -> Any:
        """Return an index from the start of an axis; below zero it counts from the end."""
        builder = self.builder
        position = self.context.cast(builder, index, kind, types.intp)
        if isinstance(position, ir.Constant) and position.constant >= 0:
            return position
        if not kind.signed:
            return position
        is_negative = builder.icmp_signed("<", position, integer(0))
        from_end = builder.add(position, self.size(axis))
        return builder.select(is_negative, from_end, position)

    def place(self, kinds: Sequence[Any], indices: Sequence[Any]) -> Any:
        """Return the address of the item with these indices; further ones are 0."""
        builder = self.builder
        place = self.position(0, kinds[0], indices[0])
        for axis in range(1, self.kind.ndim):
            place = builder.mul(place, self.size(axis))
            if axis < len(indices):
                position = self.position(axis, kinds[axis], indices[axis])
                place = builder.add(place, position)
        return builder.gep(builder.extract_value(self.value, DATA), [place])

    def load(self, place: Any, result: Any) -> Any:
        """Return the item at an address, or the array of all items that begins there."""
        if not isinstance(result, types.Array):
            return arrayobj.load_item(self.context, self.builder, self.kind, place)
        builder = self.builder
        view = cgutils.get_null_value(self.context.get_value_type(result))
        items = integer(1)
        for axis in range(result.ndim):
            of_all = axis + self.kind.ndim - result.ndim
            stride = builder.extract_value(self.value, [STRIDES, of_all])
            items = builder.mul(items, self.size(of_all))
            view = builder.insert_value(view, self.size(of_all), [SHAPE, axis])
            view = builder.insert_value(view, stride, [STRIDES, axis])
        item_size = builder.extract_value(self.value, ITEM_SIZE)
        view = builder.insert_value(view, items, ITEMS)
        view = builder.insert_value(view, item_size, ITEM_SIZE)
        return builder.insert_value(view, place, DATA)

    def store(self, place: Any, kind: Any, number: Any) -> Any:
        """Store a number at an address."""
        value = self.context.cast(self.builder, number, kind, self.kind.dtype)
        arrayobj.store_item(self.context, self.builder, self.kind, value, place)
        return self.context.get_dummy_value()


def is_short(context: Any, array: Any, kinds: Sequence[Any]) -> bool:
    """Return whether ``Elements`` has the code for indices of these types."""
    are_integers = all(isinstance(kind, types.Integer) for kind in kinds)
    return are_integers and array.layout == "C" and not context.enable_boundscheck


@lower_builtin("static_getitem", types.Array, types.IntegerLiteral)
def _read_constant(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    kind = signature.args[0]
    if not is_short(context, kind, ()):
        raise NotImplementedError  # numba does it as ever
    array = Elements(context, builder, kind, arguments[0])
    place = array.place((types.intp,), (integer(arguments[1]),))
    return array.load(place, signature.return_type)


@lower_builtin("static_setitem", types.Array, types.Integer, types.Number)
def _write_constant(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    array, index, value = arguments
    kind, _, number = signature.args
    of_integer = signature.replace(args=(kind, types.intp, number))
    return _write(context, builder, of_integer, (array, integer(index), value))


@lower_builtin(operator.getitem, types.Array, types.Integer)
def _read(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    kind, index = signature.args
    if not is_short(context, kind, (index,)):
        return arrayobj.getitem_arraynd_intp(context, builder, signature, arguments)
    array = Elements(context, builder, kind, arguments[0])
    place = array.place((index,), arguments[1:])
    return array.load(place, signature.return_type)


@lower_builtin(operator.getitem, types.Array, types.BaseTuple)
def _read_at(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    kind, kinds = signature.args
    if not is_short(context, kind, kinds.types):
        return arrayobj.getitem_array_tuple(context, builder, signature, arguments)
    array = Elements(context, builder, kind, arguments[0])
    place = array.place(kinds.types, cgutils.unpack_tuple(builder, arguments[1]))
    return array.load(place, signature.return_type)


@lower_builtin(operator.setitem, types.Array, types.Integer, types.Number)
def _write(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    kind, index, number = signature.args
    if kind.ndim > 1 or not is_short(context, kind, (index,)):
        return arrayobj.setitem_array(context, builder, signature, arguments)
    array = Elements(context, builder, kind, arguments[0])
    place = array.place((index,), arguments[1:2])
    return array.store(place, number, arguments[2])


@lower_builtin(operator.setitem, types.Array, types.BaseTuple, types.Number)
def _write_at(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    kind, kinds, number = signature.args
    if kind.ndim > len(kinds) or not is_short(context, kind, kinds.types):
        return arrayobj.setitem_array(context, builder, signature, arguments)
    array = Elements(context, builder, kind, arguments[0])
    place = array.place(kinds.types, cgutils.unpack_tuple(builder, arguments[1]))
    return array.store(place, number, arguments[2])


def structure(context: Any, builder: Any, kind: Any, *parts: Any) -> Any:
    """Return the value of a structure of numba."""
    value = cgutils.get_null_value(context.get_value_type(kind))
    for k, part in enumerate(parts):
        value = builder.insert_value(value, part, k)
    return value


@lower_builtin("getiter", RANGE)
def _start_loop(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    """Return address of the next value, end, step, and address of the count of values to come."""
    start, stop, step = cgutils.unpack_tuple(builder, arguments[0], 3)
    is_upwards = builder.icmp_signed(">", step, integer(0))
    way = builder.sub(stop, start)
    unit = builder.select(is_upwards, integer(1), integer(-1))
    count = builder.add(builder.sdiv(builder.sub(way, unit), step), integer(1))
    ahead = builder.select(is_upwards, way, builder.neg(way))
    is_empty = builder.icmp_signed("<=", ahead, integer(0))
    count = builder.select(is_empty, integer(0), count)
    following = cgutils.alloca_once_value(builder, start)
    to_come = cgutils.alloca_once_value(builder, count)
    loop = signature.return_type
    return structure(context, builder, loop, following, stop, step, to_come)


@lower_builtin("iternext", LOOP)
def _next_in_loop(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    """Return the next value of a loop, and whether there is one."""
    loop = arguments[0]
    following, _, step, to_come = (builder.extract_value(loop, k) for k in range(4))
    value = builder.load(following)
    count = builder.load(to_come)
    builder.store(builder.add(value, step), following)
    builder.store(builder.sub(count, integer(1), flags=["nsw"]), to_come)
    is_valid = builder.icmp_signed(">", count, integer(0))
    return structure(context, builder, signature.return_type, value, is_valid)


def _choose(comparison: Any) -> Any:
    """Return code for the second number if it compares with the first, else for the first."""

    def choose(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        first, second = arguments
        kind = signature.return_type
        compare = context.get_function(comparison, types.boolean(kind, kind))
        return builder.select(compare(builder, (second, first)), second, first)

    return choose


for function, comparison in ((max, operator.gt), (min, operator.lt)):
    lower_builtin(function, types.Number, types.Number)(_choose(comparison))
