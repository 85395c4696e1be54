"""Four neighbours of an array at once, as lanes of a register, and functions without branches."""

import operator
from collections.abc import Callable
from typing import Any, cast

import numpy as np
from llvmlite import ir
from numba.core import cgutils, extending, types
from numba.core.datamodel import models
from numba.core.typeconv import Conversion
from numba.core.typing.templates import ConcreteTemplate, infer_global
from numba.extending import lower_builtin, lower_cast, register_model

from presswear.tools.arrays import Array

COUNT = 4  # of lanes
_DOUBLE, _BIT = ir.DoubleType(), ir.IntType(1)


class _Intrinsic(extending._Intrinsic):
    """Code for kernels that also has a function for plain Python."""

    in_python: Callable[..., Any]

    def __call__(self, *arguments: Any) -> Any:
        return self.in_python(*arguments)


def intrinsic_with(in_python: Callable[..., Any]) -> Callable[[Callable[..., Any]], Any]:
    """Define code for kernels, beside a function that does the same in plain Python."""

    def define(code: Callable[..., Any]) -> Any:
        made = _Intrinsic(code.__name__, code)
        made._register()
        made.in_python = in_python
        return made

    return define


class _Lanes(types.Type):
    """Type of a number, or of a condition, of four lanes."""

    def __init__(self, element: Any) -> None:
        self.element = element
        super().__init__(f"four of {element}")

    def can_convert_from(self, context: Any, kind: Any) -> Any:
        """Allow single numbers, which are the same in all lanes."""
        is_single = isinstance(kind, types.Float) and self is NUMBERS
        return Conversion.safe if is_single else None


NUMBERS, CONDITIONS = _Lanes(_DOUBLE), _Lanes(_BIT)


@register_model(_Lanes)
class _Model(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: _Lanes) -> None:
        super().__init__(manager, kind, ir.VectorType(kind.element, COUNT))


@lower_cast(types.Float, _Lanes)
def _from_single(context: Any, builder: Any, kind: Any, to: _Lanes, value: Any) -> Any:
    value = context.cast(builder, value, kind, types.float64)
    vector = ir.Constant(context.get_value_type(to), ir.Undefined)
    vector = builder.insert_element(vector, value, ir.Constant(ir.IntType(32), 0))
    first = ir.Constant(ir.VectorType(ir.IntType(32), COUNT), [0] * COUNT)
    return builder.shuffle_vector(vector, vector, first)


def _operation(function: Any, result: _Lanes, generate: Callable[..., Any]) -> None:
    """Define a function of two numbers of four lanes."""
    signature = result(NUMBERS, NUMBERS)
    infer_global(function)(type("_Template", (ConcreteTemplate,), {"cases": [signature]}))
    lower = lower_builtin(function, *signature.args)
    lower(lambda context, builder, signature, values: generate(builder, *values))


for _function in (operator.add, operator.iadd):
    _operation(_function, NUMBERS, lambda builder, x, y: builder.fadd(x, y))
_operation(operator.sub, NUMBERS, lambda builder, x, y: builder.fsub(x, y))
_operation(operator.mul, NUMBERS, lambda builder, x, y: builder.fmul(x, y))
_operation(operator.gt, CONDITIONS, lambda builder, x, y: builder.fcmp_ordered(">", x, y))


@intrinsic_with(lambda condition, one, second: cast(Any, np.where)(condition, one, second)[()])
def _where(typing: Any, condition: Any, one: Any, second: Any) -> Any:
    is_wide = condition is CONDITIONS
    kind, test = (NUMBERS, CONDITIONS) if is_wide else (types.float64, types.boolean)
    return kind(test, kind, kind), lambda context, builder, _, values: builder.select(*values)


where = cast(Callable[[bool, float, float], float], _where)
"""In a kernel: the first number where a condition holds, else the second; both are computed."""


@intrinsic_with(np.any)
def _anywhere(typing: Any, condition: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return cgutils.is_not_null(builder, builder.bitcast(values[0], ir.IntType(COUNT)))

    return types.boolean(CONDITIONS), generate


anywhere = cast(Callable[[bool], bool], _anywhere)
"""In a kernel: whether a condition holds in any lane."""


@intrinsic_with(lambda array, row, column: array[row, column : column + COUNT])
def _lanes_at(typing: Any, array: Any, row: Any, column: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        source = context.make_array(array)(context, builder, values[0])
        place = cgutils.get_item_pointer(context, builder, array, source, values[1:])
        place = builder.bitcast(place, ir.VectorType(_DOUBLE, COUNT).as_pointer())
        return builder.load(place, align=8)

    return NUMBERS(array, types.intp, types.intp), generate


lanes_at = cast(Callable[[Array, int, int], float], _lanes_at)
"""In a kernel: four neighbours in a row of an array of single numbers, from a column, as lanes."""


@intrinsic_with(lambda lanes, index: lanes[index])
def _lane_of(typing: Any, lanes: Any, index: Any) -> Any:
    signature = types.float64(lanes, types.intp)
    return signature, lambda context, builder, _, values: builder.extract_element(*values)


lane_of = cast(Callable[[float, int], float], _lane_of)
"""In a kernel: the number in one lane."""
