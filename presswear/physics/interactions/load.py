"""Forces on a point of a body and moments on a body, with laws of ``physics.loads``."""

from dataclasses import dataclass
from typing import ClassVar, Self

from presswear.linkage.linkage import Linkage
from presswear.linkage.loads import Force, Moment
from presswear.physics.equations.text import Vector, difference, product
from presswear.physics.interactions.page import Kernels, Page
from presswear.physics.loads import load_size
from presswear.physics.packed import Packed
from presswear.tools.arrays import Array
from presswear.tools.compile import Records


@dataclass(frozen=True)
class LoadWithLaw:
    """Load with a law that writes itself into the equations."""

    load: Force | Moment
    record: Records  # dtype LOAD
    number: int  # index among the loads with a law

    kernels: ClassVar[Kernels] = (load_size,)

    @classmethod
    def all_of(cls, linkage: Linkage, packed: Packed) -> list[Self]:
        """Return all loads with a law of a linkage."""
        pairs = zip(linkage.loads_with_law, packed.loads.records, strict=True)
        return [cls(load, record, k) for k, (load, record) in enumerate(pairs)]

    @property
    def bodies(self) -> tuple[str, ...]:
        """The body on which it acts."""
        return (self.load.body,)

    @classmethod
    def stored_energy(cls, linkage: Linkage, position: Array) -> float:
        """Return 0: the work of these loads is in the load work of the ledger."""
        return 0.0

    def write(self, page: Page) -> None:
        """Write the force or moment on the body, and its power."""
        text = page.text
        load = self.load
        name = f"load {self.number + 1}"
        if isinstance(load, Force) and load.name:
            name = load.name
        prefix = text.prefix(name)
        link = page.chain.of(load.body)
        text.comment(f"{name}: on {load.body}")
        zero = text.parameter(f"{prefix}_zero", self.record["zero"])
        direction = Vector(
            text.direction(f"{prefix}_direction_x", self.record["cosine"]),
            text.direction(f"{prefix}_direction_y", self.record["sine"]),
        )
        if isinstance(load, Force):
            arm = link.arm(text, load.attachment, prefix)
            position = direction.dot(link.position.plus(arm))
            speed = direction.dot(link.velocity_at(arm))
        else:
            # The direction of a moment is 1 or -1, and is stored in x.
            position = product(direction.x, link.angle)
            speed = product(direction.x, link.omega)
        position = text.let(f"{prefix}_position", difference(position, zero))
        speed = text.let(f"{prefix}_speed", speed)
        k = self.number
        law = f"data.loads.records[{k}], data.loads.nodes, data.loads.modes[{k}]"
        call = f"load_size({law}, t, {position}, {speed})"
        size = text.let(f"{prefix}_size", call)
        page.add_power("load_work", text.let(f"{prefix}_power", product(size, speed)))
        if isinstance(load, Force):
            force = text.let_vector(f"{prefix}_force", direction.times(size))
            link.add_force(arm, force)
        else:
            link.moments.append(product(direction.x, size))
