"""The equations of motion of a linkage as text, with the numbers that they take.

The text is a Python function that fills the rates of a state y = (x, x', integrals): coordinates
and rates of the open tree, then those of ``integrals``. Topology stands in the text; numbers are in
one array, so that another clearance needs no other text.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from presswear.linkage.linkage import Linkage
from presswear.physics.equations.articulated import solve_tree
from presswear.physics.equations.bodies import place_bodies
from presswear.physics.equations.chain import Chain, Link, loose_chain, open_chain
from presswear.physics.equations.drives import write_drives
from presswear.physics.equations.generalized_forces import write_generalized_forces
from presswear.physics.equations.integrals import Layout
from presswear.physics.equations.joints import JointText
from presswear.physics.equations.loads import write_loads, write_springs, write_weights
from presswear.physics.equations.text import Text, Vector, total
from presswear.physics.forces import JOINT_RATES
from presswear.physics.packed import Packed
from presswear.tools.arrays import Array


@dataclass(frozen=True)
class Equations:
    """Equations of motion of a linkage.

    Attributes
    ----------
    text : str
        Python source of the function ``equations(model, t, y, out, level)``.
    numbers : dict
        Numbers of the linkage by the names in the text, SI units.
    chain : Chain
        Open tree with its coordinates.
    size : int
        Number of components of the state.
    """

    text: str
    numbers: dict[str, float]
    chain: Chain
    size: int

    @property
    def parameters(self) -> Array:
        """Numbers of the linkage as the array that the text reads."""
        return np.array([*self.numbers.values()])

    @property
    def listing(self) -> str:
        """Text with the present numbers beside their names."""
        lines = self.text.splitlines()
        for i, line in enumerate(lines):
            name, equals, value = line.strip().partition(" = ")
            if equals and value.startswith("parameters["):
                lines[i] = f"{line}  # {self.numbers[name]:.6g}"
        return "\n".join(lines)


def write_equations(
    linkage: Linkage, packed: Packed, *, with_forces: bool = False
) -> Equations | str:
    """Return the equations of a linkage, or the reason why none can be written.

    ``packed`` is the linkage for kernels, which tells whether its surfaces are round. With forces,
    those on the coordinates follow in ``out`` behind the rates; no drive may turn a free body then.
    """
    text = Text()
    chain = open_chain(linkage, text)
    if isinstance(chain, str):
        return chain
    layout = Layout.of(chain.size, packed)
    place_bodies(text, chain)
    write_weights(text, chain, packed)
    rates = _write_interactions(text, chain, packed, layout)
    if with_forces:
        write_generalized_forces(text, chain, layout.size)
    bodies = solve_tree(text, chain)
    text.write("")
    with text.block("if level >= RATES:"):
        rates()
        write_drives(text, chain, bodies, layout.drive_work, layout.first_torque)
    text.write("")
    with text.block("if level == END:"):
        text.write("q, v, a, force, axes = data.bodies")
        for link in chain.links:
            _record(text, chain, link)
    return Equations(_function(linkage, text), text.numbers, chain, layout.size)


def write_body_forces(linkage: Linkage, packed: Packed) -> Equations:
    """Return forces and moments of contacts, springs and loads as text, whatever holds the bodies.

    The coordinates are those of all bodies. The function fills the row of forces in ``bodies``, and
    in ``out`` the rates of the integrals of joints and loads. Weights and constant loads are left
    to ``packed.weight``.
    """
    text = Text()
    chain = loose_chain(linkage, text)
    layout = Layout.of(chain.size, packed)
    place_bodies(text, chain)
    rates = _write_interactions(text, chain, packed, layout)
    text.comment("forces and moments about the mass centres")
    text.write("q, v, a, force, axes = data.bodies")
    for link in chain.links:
        for i, part in enumerate((*Vector().plus(*link.forces), total(*link.moments))):
            text.write(f"force[{link.place + i}] = {part}")
    if len(packed.joints) or layout.has_work:
        text.write("")
        with text.block("if level >= RATES:"):
            rates()
    return Equations(_function(linkage, text), text.numbers, chain, layout.size)


def _write_interactions(
    text: Text, chain: Chain, packed: Packed, layout: Layout
) -> Callable[[], None]:
    """Write springs, loads and contacts; return what writes the rates of their integrals."""
    powers = [*write_springs(text, chain), *write_loads(text, chain, packed)]
    joints = [
        JointText(text, chain, k, packed.joints[k], layout.first_joint + JOINT_RATES * k)
        for k in range(layout.joints)
    ]
    for joint in joints:
        joint.write()

    def write_rates() -> None:
        for joint in joints:
            joint.write_rates()
        if layout.has_work:
            text.write(f"out[{layout.load_work}] = {total(*powers)}")

    return write_rates


def _record(text: Text, chain: Chain, link: Link) -> None:
    """Write the motion of a body for the recorder."""
    if link.is_prescribed and chain.has_loops:
        return
    motion = {
        "q": (*link.position, link.angle),
        "v": (*link.velocity, link.omega),
        "a": (*link.acceleration, link.alpha),
    }
    for row, values in motion.items():
        for i, value in enumerate(values):
            text.write(f"{row}[{link.place + i}] = {value}")


def _function(linkage: Linkage, text: Text) -> str:
    """Return the whole function."""
    words = re.sub(r"[^\w .,()-]", "", linkage.name)
    lines = [
        "def equations(model, t, y, out, level):",
        f'    """Fill the rates of the state of {words}.',
        "",
        "    Level RATES adds powers and torques, END also what is recorded. SI units.",
        '    """',
        "    data = unpack(model)[0]",
        "    parameters = data.parameters",
        *(f"    {name} = parameters[{i}]" for i, name in enumerate(text.numbers)),
        *text.lines,
    ]
    return "\n".join(lines) + "\n"
