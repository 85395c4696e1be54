"""Written equations as a function, in plain Python and compiled."""

import linecache
import math
from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from presswear.linkage.linkage import Linkage
from presswear.physics.closed_loops import drive_torques, place_prescribed
from presswear.physics.contact import CONTACT
from presswear.physics.drive_motion import motions_of, uneven_motion
from presswear.physics.equations.writer import Equations
from presswear.physics.friction_and_normal import ONSET_SPEED_FLOOR
from presswear.physics.interactions.kinds import KINDS
from presswear.physics.loads import Loads
from presswear.physics.packed import Packed
from presswear.physics.prescribed import Prescribed, pack_prescribed, subtract_inertia
from presswear.physics.rotation import cos_sin
from presswear.tools.arrays import Array
from presswear.tools.compile import Kernel, Records, call, call_entry, entry_of, inlined
from presswear.tools.files import digest
from presswear.tools.packing import pack_arguments, unpack

# Levels of the equations: ACCELERATIONS fills accelerations; RATES also fills rates of
# integrals; END also fills recorded quantities
ACCELERATIONS, RATES, END = range(3)
FORCE = 3  # row of ``Model.bodies``


class Model(NamedTuple):
    """Arrays that the equations of a linkage read and fill.

    ``contacts`` are the numbers of ``contact_records``, shape (joints, fields of
    CONTACT).
    """

    parameters: Array
    # closing speeds of the joints at touchdown, m/s; 0: use the rate of the state; below
    # zero: the joint has no force
    onset: Array
    contacts: Array
    bodies: Array  # q, v, a, forces and axes of all bodies, (5, 3 bodies)
    joints: Records
    surfaces: Array
    contact_records: Records
    motions: Records
    loads: Loads
    prescribed: Prescribed
    torque: Array  # (drives,)


class Written(NamedTuple):
    """Compiled equations and their arguments, as kernels call them."""

    entry: int  # address of the function, see ``tools.compile.call_entry``
    model: int  # address of the packed Model


_KERNELS = (
    cos_sin,
    drive_torques,
    place_prescribed,
    subtract_inertia,
    uneven_motion,
    *(kernel for kind in KINDS for kernel in kind.kernels),
)
_NAMES = {
    "math": math,
    "ONSET_SPEED_FLOOR": ONSET_SPEED_FLOOR,
    "RATES": RATES,
    "END": END,
    **{kernel.__name__: kernel for kernel in _KERNELS},
    "call": call,
    "unpack": unpack,
}


@cache
def function_of(text: str) -> Kernel:
    """Return the text as a compiled function; its ``py_func`` is the function in plain Python.

    A debugger shows the lines of the text, because ``linecache`` has them.
    """
    text_digest = digest(text.encode())[:16]
    name = f"<equations {text_digest}>"
    names: dict[str, Any] = {**_NAMES, "__name__": __name__}
    linecache.cache[name] = (len(text), None, text.splitlines(keepends=True), name)
    exec(compile(text, name, "exec"), names)
    function: Callable[..., Any] = names["equations"]
    # Each text needs a name of its own, because stored machine code is found by name.
    function.__qualname__ = f"equations_{text_digest}"
    return Kernel(function, file=__file__)


def model_of(
    linkage: Linkage,
    equations: Equations,
    packed: Packed,
    onset: Array,
    contacts: Records,
) -> Model:
    """Return the arrays that the equations of a linkage read and fill.

    ``contacts`` are records of CONTACT. The motion of prescribed bodies in closed loops
    continues from the state that ``begin_motion`` stores in ``prescribed``.
    """
    prescribed = frozenset(link.body.name for link in equations.chain.prescribed)
    fields = len(CONTACT.names or ())
    return Model(
        parameters=equations.parameters,
        onset=onset,
        contacts=contacts.view(np.float64).reshape(len(contacts), fields),
        bodies=np.zeros((5, packed.mass.size)),
        joints=packed.joints,
        surfaces=packed.surfaces,
        contact_records=contacts,
        motions=motions_of(linkage),
        loads=packed.loads,
        prescribed=pack_prescribed(linkage, prescribed),
        torque=np.zeros(packed.driven.size),
    )


def written(equations: Equations, model: Model) -> Written:
    """Return equations for ``fill``."""
    packed = pack_arguments(model)
    y = np.zeros(equations.layout.size)
    entry = entry_of(function_of(equations.text), packed, 0.0, y, y, END)
    return Written(entry, packed)


@inlined
def fill(equations: Written, t: float, y: Array, out: Array, level: int) -> None:
    """Call equations in a kernel."""
    call_entry(equations.entry, (equations.model, t, y, out, level))
