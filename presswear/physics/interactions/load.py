"""Loads with a law, on a point of a body or on its angle; the laws are in ``physics.loads``."""

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
    """A load with a law, as text."""

    load: Force | Moment
    record: Records  # of LOAD
    number: int  # among the loads with a law

    kernels: ClassVar[Kernels] = (load_size,)

    @classmethod
    def all_of(cls, linkage: Linkage, packed: Packed) -> list[Self]:
        """Return all loads with a law of a linkage."""
        if packed.loads is None:
            return []
        pairs = zip(linkage.live_loads, packed.loads.records, strict=True)
        return [cls(load, record, k) for k, (load, record) in enumerate(pairs)]

    @property
    def bodies(self) -> tuple[str, ...]:
        """The body on which it acts."""
        return (self.load.body,)

    @classmethod
    def stored_energy(cls, linkage: Linkage, position: Array) -> float:
        """Return nothing: what loads with a law do is load work."""
        return 0.0

    def write(self, page: Page) -> None:
        """Write the force or moment on the body, and its power."""
        text, load, record = page.text, self.load, self.record
        name = (
            load.name if isinstance(load, Force) else ""
        ) or f"load {self.number + 1}"
        prefix, link = text.prefix(name), page.chain.of(load.body)
        text.comment(f"{name}: on {load.body}")
        zero = text.parameter(f"{prefix}_zero", record["zero"])
        along = Vector(
            text.direction(f"{prefix}_direction_x", record["cosine"]),
            text.direction(f"{prefix}_direction_y", record["sine"]),
        )
        if isinstance(load, Force):
            arm = link.arm(text, load.attachment, prefix)
            place, speed = (
                along.dot(link.position.plus(arm)),
                along.dot(link.velocity_at(arm)),
            )
        else:
            place, speed = product(along.x, link.angle), product(along.x, link.omega)
        place = text.let(f"{prefix}_place", difference(place, zero))
        speed = text.let(f"{prefix}_speed", speed)
        k = self.number
        law = f"data.loads.records[{k}], data.loads.nodes, data.loads.modes[{k}]"
        size = text.let(f"{prefix}_size", f"load_size({law}, t, {place}, {speed})")
        page.add_power("load_work", text.let(f"{prefix}_power", product(size, speed)))
        if isinstance(load, Force):
            link.add_force(arm, text.let_vector(f"{prefix}_force", along.times(size)))
        else:
            link.moments.append(product(along.x, size))
