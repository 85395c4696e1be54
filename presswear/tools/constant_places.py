"""Elements of arrays at constant indices, as in written equations, in a few instructions.

Numba writes 20 instructions for each element, which find its address from the end of the
array and the strides of all axes. The compiler removes most of them, which takes time.
"""

from typing import Any

from llvmlite import ir
from numba.core import types
from numba.extending import lower_builtin
from numba.np.arrayobj import load_item, setitem_array, store_item

_DATA = 4  # place of the address of the first item in an array


def _is_simple(context: Any, array: Any, index: Any) -> bool:
    """Return whether the address is that of the data plus the index."""
    is_checked = context.enable_boundscheck
    return array.ndim == 1 and array.layout == "C" and not is_checked and index >= 0


def _place(builder: Any, array: Any, index: int) -> Any:
    """Return the address of an element."""
    return builder.gep(builder.extract_value(array, _DATA), [ir.IntType(64)(index)])


@lower_builtin("static_getitem", types.Array, types.IntegerLiteral)
def _read(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    """Return the code that reads an element."""
    array, index = arguments
    kind = signature.args[0]
    if not _is_simple(context, kind, index):
        raise NotImplementedError  # numba then uses its general code
    return load_item(context, builder, kind, _place(builder, array, index))


@lower_builtin("static_setitem", types.Array, types.Integer, types.Number)
def _write(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    """Return the code that writes an element."""
    array, index, value = arguments
    kind, _, number = signature.args
    if not _is_simple(context, kind, index):
        place = context.get_constant(types.intp, index)
        general = signature.replace(args=(kind, types.intp, number))
        return setitem_array(context, builder, general, (array, place, value))
    value = context.cast(builder, value, number, kind.dtype)
    store_item(context, builder, kind, value, _place(builder, array, index))
    return context.get_dummy_value()
