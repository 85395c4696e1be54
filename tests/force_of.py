"""The normal force of a law in a state, as the kernels put it together."""

from presswear.linkage.laws import NormalLaw
from presswear.physics.friction_and_normal import elastic_of, normal_force, normal_record
from presswear.tools.compile import Records


def force_of(record: Records, penetration: float, rate: float, onset_speed: float) -> float:
    """Normal force, N, of a record of NORMAL."""
    elastic, _ = elastic_of(record, penetration)
    return float(normal_force(record, elastic, penetration, rate, onset_speed))


def plain(stiffness: float, exponent: float, damping: float) -> Records:
    """K delta^n with a damping factor, as a record of NORMAL."""
    return normal_record(NormalLaw(stiffness, exponent, damping), 1e-3)
