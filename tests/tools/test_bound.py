"""Arguments that are handed to a kernel once."""

import gc

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from presswear.physics.packed import JOINT, Packed
from presswear.tools.bound import Bound, bind, bound
from presswear.tools.compiled import compiled

# Named tuples of the package: the cache of compiled code outlives those of a test.


@compiled
def gather(run: Bound, x: float) -> float:
    """Sum what is there, and leave the sum behind."""
    one, other, out = bound(run)
    total = x
    for part in (one, other):
        for i in range(part.mass.shape[0]):
            total += part.mass[i]
        for i in range(part.surfaces.shape[0]):
            for j in range(part.surfaces.shape[1]):
                for k in range(part.surfaces.shape[2]):
                    total += part.surfaces[i, j, k]
        for i in range(part.joints.shape[0]):
            if part.joints[i].over_arc:
                total += part.joints[i].clearance
    out[0] = total
    return total


def drawn(seed: int, sizes: tuple[int, int, int]) -> Packed:
    numbers = np.random.default_rng(seed)
    joints = np.zeros(sizes[0], JOINT)
    joints["over_arc"] = numbers.random(sizes[0]) < 0.5
    joints["clearance"] = numbers.random(sizes[0])
    mass, weight = numbers.random((2, sizes[1]))
    return Packed(
        joints, numbers.random(sizes), joints[:0], None, mass, weight, np.zeros(0, np.int64)
    )


def total_of(part: Packed) -> float:
    return float(
        part.mass.sum()
        + part.surfaces.sum()
        + part.joints["clearance"][part.joints["over_arc"]].sum()
    )


sizes = st.tuples(st.integers(0, 3), st.integers(0, 3), st.integers(0, 3))


@given(st.integers(0, 2**32 - 2), sizes, sizes, st.floats(-10.0, 10.0))
def test_a_kernel_reads_what_it_was_bound_to(
    seed: int, first: tuple[int, int, int], second: tuple[int, int, int], x: float
) -> None:
    one, other, out = drawn(seed, first), drawn(seed + 1, second), np.zeros(1)
    call = bind(gather, one, other, out)
    assert abs(call(x) - (x + total_of(one) + total_of(other))) < 1e-12
    assert out[0] == call(x)


def test_it_sees_what_arrays_hold_now_and_keeps_them_alive() -> None:
    """The kernel has addresses: nobody else need keep what stands there."""
    mass = np.ones(2)
    one, other = drawn(1, (2, 2, 2))._replace(mass=mass), drawn(2, (2, 2, 2))
    call = bind(gather, one, other, np.zeros(1))
    before = call(0.0)
    mass[0] += 1.0
    del mass, one, other
    gc.collect()
    others = [np.full(2, 1e9) for _ in range(1000)]  # would take the place of what is freed
    assert abs(call(0.0) - before - 1.0) < 1e-12
    assert len(others) == 1000
