"""Forces from outside: weights, springs with dampers, and loads with a law."""

from presswear.linkage.loads import Force
from presswear.physics.equations.chain import Chain
from presswear.physics.equations.text import ONE, Text, Vector, difference, product
from presswear.physics.packed import Packed


def write_weights(text: Text, chain: Chain, packed: Packed) -> None:
    """Add weights and constant loads to the forces on the bodies."""
    for link in chain.links:
        fx, fy, moment = packed.weight[link.place : link.place + 3]
        force = Vector(
            text.parameter(f"{link.prefix}_weight_x", fx),
            text.parameter(f"{link.prefix}_weight_y", fy),
        )
        link.forces.append(force)
        link.moments.append(text.parameter(f"{link.prefix}_constant_moment", moment))


def write_springs(text: Text, chain: Chain) -> list[str]:
    """Write the forces of springs; return the powers of their dampers."""
    powers = []
    for spring in chain.linkage.springs:
        prefix = text.prefix(spring.name)
        first, second = (chain.of(end.body) for end in spring.ends)
        text.comment(f"{spring.name}: spring between {first.body.name} and {second.body.name}")
        arms = [
            link.arm(text, end, prefix)
            for link, end in zip((first, second), spring.ends, strict=True)
        ]
        across = second.position.plus(arms[1]).minus(first.position.plus(arms[0]))
        across = text.let_vector(prefix, across)
        velocity = second.velocity_at(arms[1]).minus(first.velocity_at(arms[0]))
        velocity = text.let_vector(f"{prefix}_v", velocity)
        numbers = [
            text.parameter(f"{prefix}_{word}", getattr(spring, word))
            for word in ("stiffness", "damping", "length")
        ]
        called = f"spring_pull({', '.join((*across, *velocity, *numbers))})"
        pull = Vector(f"{prefix}_force_x", f"{prefix}_force_y")
        text.write(f"{pull.x}, {pull.y}, {prefix}_power = {called}")
        if spring.damping != 0.0:
            powers.append(f"{prefix}_power")
        first.add_force(arms[0], pull)
        second.add_force(arms[1], pull.times(f"-{ONE}"))
    return powers


def write_loads(text: Text, chain: Chain, packed: Packed) -> list[str]:
    """Write the loads with a law; return their powers."""
    powers = []
    for k, load in enumerate(chain.linkage.live_loads):
        assert packed.loads is not None
        record = packed.loads.records[k]
        name = (load.name if isinstance(load, Force) else "") or f"load {k + 1}"
        prefix, link = text.prefix(name), chain.of(load.body)
        text.comment(f"{name}: on {load.body}")
        zero = text.parameter(f"{prefix}_zero", record["zero"])
        along = Vector(
            text.direction(f"{prefix}_direction_x", record["cosine"]),
            text.direction(f"{prefix}_direction_y", record["sine"]),
        )
        if isinstance(load, Force):
            arm = link.arm(text, load.attachment, prefix)
            place, speed = along.dot(link.position.plus(arm)), along.dot(link.velocity_at(arm))
        else:
            place, speed = product(along.x, link.angle), product(along.x, link.omega)
        place = text.let(f"{prefix}_place", difference(place, zero))
        speed = text.let(f"{prefix}_speed", speed)
        law = f"data.loads.records[{k}], data.loads.nodes, data.loads.modes[{k}]"
        size = text.let(f"{prefix}_size", f"load_size({law}, t, {place}, {speed})")
        powers.append(text.let(f"{prefix}_power", product(size, speed)))
        if isinstance(load, Force):
            link.add_force(arm, text.let_vector(f"{prefix}_force", along.times(size)))
        else:
            link.moments.append(product(along.x, size))
    return powers
