"""Several replicates at once: numbers of lanes, which kernels treat like single numbers.

A kernel whose numbers are lanes computes several replicates in the time of one or two. Its source
is that of the kernel for one replicate, but for branches on numbers: those become ``where``. Every
operation is made lane by lane, so that a replicate has the same bits alone and with any others. A
function that exists for single numbers only is called for each lane.
"""

import math
import operator
from collections.abc import Callable
from typing import Any, cast

import numpy as np
from llvmlite import ir
from numba.core import cgutils, extending, types
from numba.core.datamodel import models
from numba.core.typeconv import Conversion
from numba.core.typing.templates import ConcreteTemplate, infer_global
from numba.extending import lower_builtin, lower_cast, register_model, typeof_impl

from presswear.tools.arrays import Array

COUNTS = (2, 4)  # numbers of lanes; eight would take 0.93 of the time of four, for each
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


class Lanes(types.Type):
    """Type of a number, or of a condition, of so many lanes."""

    def __init__(self, count: int, is_condition: bool = False) -> None:
        self.count, self.is_condition = count, is_condition
        super().__init__(f"{count} {'conditions' if is_condition else 'numbers'}")

    def can_convert_from(self, context: Any, kind: Any) -> Any:
        """Allow single numbers and conditions, which are the same in all lanes."""
        is_scalar = isinstance(kind, types.Boolean if self.is_condition else types.Float)
        return Conversion.safe if is_scalar else None

    def unify(self, context: Any, kind: Any) -> Any:
        """Return the type of a variable that is also assigned values of another type."""
        return self if self.can_convert_from(context, kind) is not None else None


@register_model(Lanes)
class _Model(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Lanes) -> None:
        element = _BIT if kind.is_condition else _DOUBLE
        super().__init__(manager, kind, ir.VectorType(element, kind.count))


class _Record(types.Record):
    """Record whose numbers are lanes."""

    def __init__(self, dtype: np.dtype[Any]) -> None:
        self._dtype = dtype
        assert dtype.fields is not None
        fields = [
            (name, {"type": Lanes(field.itemsize // 8), "offset": offset})
            for name, (field, offset, *_) in dtype.fields.items()
        ]
        super().__init__(fields, dtype.itemsize, False)

    @property
    def dtype(self) -> np.dtype[Any]:
        return self._dtype


register_model(_Record)(models.RecordModel)


class LaneArray(np.ndarray[Any, Any]):
    """Array whose elements, or the numbers of whose records, are lanes; see ``lane_zeros``."""


@typeof_impl.register(LaneArray)
def _type_of(array: LaneArray, context: Any) -> Any:
    element = _Record(array.dtype) if array.dtype.names else Lanes(array.itemsize // 8)
    # Memory of numpy does not start where vectors of the processor do.
    return types.Array(element, array.ndim, "C", aligned=False)


def lane_zeros(shape: int | tuple[int, ...], count: int, dtype: np.dtype[Any] | None = None) -> Any:
    """Return zeros of so many lanes, or records of such; see ``lanes_of`` for the numbers."""
    number = np.dtype((np.void, 8 * count))
    kind = number if dtype is None else np.dtype([(name, number) for name in dtype.names or ()])
    return np.zeros(shape, kind).view(LaneArray)


def lanes_of(array: LaneArray) -> Array:
    """Return the numbers of an array without records, with the lanes as last axis; a view."""
    return np.asarray(array).view(np.float64).reshape(*array.shape, array.itemsize // 8)


@lower_cast(types.Float, Lanes)
@lower_cast(types.Boolean, Lanes)
def _from_scalar(context: Any, builder: Any, kind: Any, to: Lanes, value: Any) -> Any:
    value = context.cast(builder, value, kind, types.boolean if to.is_condition else types.float64)
    vector = ir.Constant(context.get_value_type(to), ir.Undefined)
    vector = builder.insert_element(vector, value, ir.Constant(ir.IntType(32), 0))
    first = ir.Constant(ir.VectorType(ir.IntType(32), to.count), [0] * to.count)
    return builder.shuffle_vector(vector, vector, first)


def _operation(
    function: Any, generate: Any, arguments: int, result: bool = False, argument: bool = False
) -> None:
    """Define a function of lanes; ``result`` and ``argument``: of conditions."""
    signatures = [Lanes(count, result)(*(Lanes(count, argument),) * arguments) for count in COUNTS]
    infer_global(function)(type("_Template", (ConcreteTemplate,), {"cases": signatures}))
    for signature in signatures:
        lower = lower_builtin(function, *signature.args)
        lower(lambda context, builder, signature, values: generate(builder, *values))


def _by_name(name: str) -> Any:
    def generate(builder: Any, *values: Any) -> Any:
        kind = values[0].type
        suffix = "f64" if kind == _DOUBLE else f"v{kind.count}f64"
        function_type = ir.FunctionType(kind, [kind] * len(values))
        full_name = f"{name}.{suffix}"
        function = cgutils.get_or_insert_function(builder.module, function_type, full_name)
        return builder.call(function, values)

    return generate


def lane_by_lane(generate: Any) -> Any:
    """Return the code of a function of lanes that calls one of single numbers, or a tuple, each."""

    def of_lanes(builder: Any, *values: Any) -> Any:
        is_wide = [isinstance(value.type, ir.VectorType) for value in values]
        kind = values[is_wide.index(True)].type
        vectors: list[Any] = []
        for i in range(kind.count):
            place = ir.Constant(ir.IntType(32), i)
            each = [
                builder.extract_element(value, place) if wide else value
                for value, wide in zip(values, is_wide, strict=True)
            ]
            result = generate(builder, *each)
            is_number = result.type == _DOUBLE
            parts = [result] if is_number else cgutils.unpack_tuple(builder, result)
            vectors = vectors or [ir.Constant(kind, ir.Undefined)] * len(parts)
            pairs = zip(vectors, parts, strict=True)
            vectors = [builder.insert_element(vector, part, place) for vector, part in pairs]
        return vectors[0] if is_number else cgutils.pack_array(builder, vectors)

    return of_lanes


def _by_scalar(function: Any, arguments: int) -> None:
    """Define a function of lanes that calls numba's of single numbers for each lane."""
    scalar = types.float64(*(types.float64,) * arguments)
    signatures = [Lanes(count)(*(Lanes(count),) * arguments) for count in COUNTS]
    infer_global(function)(type("_Template", (ConcreteTemplate,), {"cases": signatures}))

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        of_scalar = context.get_function(function, scalar)
        return lane_by_lane(lambda builder, *each: of_scalar(builder, each))(builder, *values)

    for signature in signatures:
        lower_builtin(function, *signature.args)(generate)


for _functions, _generate in {
    (operator.add, operator.iadd): lambda builder, x, y: builder.fadd(x, y),
    (operator.sub, operator.isub): lambda builder, x, y: builder.fsub(x, y),
    (operator.mul, operator.imul): lambda builder, x, y: builder.fmul(x, y),
    (operator.truediv, operator.itruediv): lambda builder, x, y: builder.fdiv(x, y),
    (operator.pow,): lane_by_lane(_by_name("llvm.pow")),
    (math.copysign,): _by_name("llvm.copysign"),
    # The same result as for single numbers, also with NaN
    (max,): lambda builder, x, y: builder.select(builder.fcmp_ordered(">", y, x), y, x),
    (min,): lambda builder, x, y: builder.select(builder.fcmp_ordered("<", y, x), y, x),
}.items():
    for _function in _functions:
        _operation(_function, _generate, 2)
_operation(operator.neg, lambda builder, x: builder.fneg(x), 1)
_operation(abs, _by_name("llvm.fabs"), 1)
_operation(math.sqrt, _by_name("llvm.sqrt"), 1)
_operation(math.exp, lane_by_lane(_by_name("llvm.exp")), 1)
for _function in (math.sin, math.cos, math.tan, math.asin, math.acos, math.atan, math.sinh):
    _by_scalar(_function, 1)
for _function in (math.cosh, math.tanh, math.expm1, math.log, math.log1p, math.log10):
    _by_scalar(_function, 1)
for _function in (math.atan2, math.hypot):
    _by_scalar(_function, 2)
_COMPARISONS = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge}
for _word, _compare in (_COMPARISONS | {"==": operator.eq}).items():
    _operation(_compare, lambda b, x, y, word=_word: b.fcmp_ordered(word, x, y), 2, result=True)
_operation(operator.ne, lambda builder, x, y: builder.fcmp_unordered("!=", x, y), 2, result=True)
_operation(operator.and_, lambda builder, x, y: builder.and_(x, y), 2, True, True)


@intrinsic_with(lambda condition, one, second: cast(Any, np.where)(condition, one, second)[()])
def _where(typing: Any, condition: Any, one: Any, second: Any) -> Any:
    counts = [kind.count for kind in (condition, one, second) if isinstance(kind, Lanes)]
    kind: Any = Lanes(counts[0]) if counts else types.float64
    test: Any = Lanes(counts[0], True) if counts else types.boolean
    return kind(test, kind, kind), lambda context, builder, signature, values: builder.select(
        *values
    )


where = cast(Callable[[bool, float, float], float], _where)
"""In a kernel: the first number where a condition holds, else the second; both are computed."""


@intrinsic_with(np.any)
def _anywhere(typing: Any, condition: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        if not isinstance(condition, Lanes):
            return values[0]
        bits = builder.bitcast(values[0], ir.IntType(condition.count))
        return cgutils.is_not_null(builder, bits)

    return types.boolean(condition), generate


anywhere = cast(Callable[[bool], bool], _anywhere)
"""In a kernel: whether a condition holds in any lane; of a single number, whether it holds."""


@intrinsic_with(np.rint)
def _rounded(typing: Any, x: Any) -> Any:
    rint = _by_name("llvm.rint")
    return x(x), lambda context, builder, signature, values: rint(builder, *values)


rounded = cast(Callable[[float], float], _rounded)
"""In a kernel: the nearest whole number, of two the even one."""


@intrinsic_with(lambda array, row, column: array[row, column : column + COUNTS[-1]])
def _lanes_at(typing: Any, array: Any, row: Any, column: Any) -> Any:
    count = COUNTS[-1]

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        source = context.make_array(array)(context, builder, values[0])
        place = cgutils.get_item_pointer(context, builder, array, source, values[1:])
        place = builder.bitcast(place, ir.VectorType(_DOUBLE, count).as_pointer())
        return builder.load(place, align=8)

    return Lanes(count)(array, types.intp, types.intp), generate


lanes_at = cast(Callable[[Array, int, int], float], _lanes_at)
"""In a kernel: four neighbours in a row of an array of single numbers, from a column, as lanes."""


@intrinsic_with(lambda lanes, index: lanes[index])
def _lane_of(typing: Any, lanes: Any, index: Any) -> Any:
    signature = types.float64(lanes, types.intp)
    return signature, lambda context, builder, _, values: builder.extract_element(*values)


lane_of = cast(Callable[[float, int], float], _lane_of)
"""In a kernel: the number in one lane."""
