"""The equations of motion of a linkage as text, with the numbers that they take.

The text is a Python function that fills the rates of a state vector y: coordinates and
rates of the open tree, states of interactions, and integrals (``layout``). The topology
is in the text. The numbers are in an array, so that the text does not change with a
clearance.
"""

import re
from dataclasses import dataclass

import numpy as np

from presswear.linkage.linkage import Linkage
from presswear.physics.equations.articulated import solve_tree
from presswear.physics.equations.bodies import place_bodies
from presswear.physics.equations.chain import Chain, Link, loose_chain, open_chain
from presswear.physics.equations.drives import write_drives
from presswear.physics.equations.generalized_forces import write_generalized_forces
from presswear.physics.equations.layout import Layout, State
from presswear.physics.equations.text import Text, Vector, total
from presswear.physics.interactions.kinds import interactions_of
from presswear.physics.interactions.page import Page
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
    states : tuple of State
        States of interactions.
    layout : Layout
        Order of the numbers in the state vector.
    """

    text: str
    numbers: dict[str, float]
    chain: Chain
    states: tuple[State, ...]
    layout: Layout

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

    ``packed`` is the packed linkage; the text depends on whether its surfaces are round.
    If ``with_forces``, the generalized forces on the coordinates follow in ``out`` after
    the rates; no drive may then prescribe the angle of a free body.
    """
    text = Text()
    chain = open_chain(linkage, text)
    if isinstance(chain, str):
        return chain
    place_bodies(text, chain)
    write_weights(text, chain, packed)
    page = _written_interactions(text, chain, packed)
    layout = page.layout
    if with_forces:
        write_generalized_forces(text, chain, layout.size)
    bodies = solve_tree(text, chain)
    text.write("")
    with text.block("if level >= RATES:"):
        write_drives(page, bodies)
        page.write_rates()
    text.write("")
    with text.block("if level == END:"):
        text.write("q, v, a, force, axes = data.bodies")
        for link in chain.links:
            _record(text, chain, link)
    return _equations(linkage, page)


def write_body_forces(linkage: Linkage, packed: Packed) -> Equations:
    """Return the forces and moments of contacts, springs and loads on all bodies as text.

    The coordinates are those of all bodies, without joints and drives. The function
    fills the row of forces in ``bodies``. In ``out`` it fills the rates of states and
    integrals, without those of drives. Weights and constant loads are not included; they
    are in ``packed.weight``.
    """
    text = Text()
    chain = loose_chain(linkage, text)
    place_bodies(text, chain)
    page = _written_interactions(text, chain, packed)
    text.comment("forces and moments about the mass centres")
    text.write("q, v, a, force, axes = data.bodies")
    for link in chain.links:
        force = Vector().plus(*link.forces)
        text.write(f"force[{link.index}] = {force.x}")
        text.write(f"force[{link.index + 1}] = {force.y}")
        text.write(f"force[{link.index + 2}] = {total(*link.moments)}")
    if page.has_rates:
        text.write("")
        with text.block("if level >= RATES:"):
            page.write_rates()
    return _equations(linkage, page)


def _written_interactions(text: Text, chain: Chain, packed: Packed) -> Page:
    """Write springs, loads and contacts; return the page with their states and powers."""
    page = Page(text, chain)
    for interaction in interactions_of(chain.linkage, packed):
        interaction.write(page)
    return page


def write_weights(text: Text, chain: Chain, packed: Packed) -> None:
    """Add weights and constant loads to the forces on the bodies."""
    for link in chain.links:
        fx, fy, moment = packed.weight[link.index : link.index + 3]
        force = Vector(
            text.parameter(f"{link.prefix}_weight_x", fx),
            text.parameter(f"{link.prefix}_weight_y", fy),
        )
        link.forces.append(force)
        link.moments.append(text.parameter(f"{link.prefix}_constant_moment", moment))


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
            text.write(f"{row}[{link.index + i}] = {value}")


def _equations(linkage: Linkage, page: Page) -> Equations:
    """Return the equations from a finished page."""
    return Equations(
        text=_function(linkage, page.text),
        numbers=page.text.numbers,
        chain=page.chain,
        states=tuple(page.states),
        layout=page.layout,
    )


def _function(linkage: Linkage, text: Text) -> str:
    """Return the text of the function with its head and its parameters."""
    name_of_linkage = re.sub(r"[^\w .,()-]", "", linkage.name)
    lines = [
        "def equations(model, t, y, out, level):",
        f'    """Fill the rates of the state of {name_of_linkage}.',
        "",
        "    Level RATES also fills powers and torques, END also recorded quantities. SI units.",
        '    """',
        "    data = unpack(model)[0]",
        "    parameters = data.parameters",
        *(f"    {name} = parameters[{i}]" for i, name in enumerate(text.numbers)),
        *text.lines,
    ]
    return "\n".join(lines) + "\n"
