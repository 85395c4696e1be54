"""Normal force, friction ramp and stiffness against closed forms."""

import math
from decimal import Decimal, localcontext

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from two_bodies import force_of, normal_law

import presswear as pw
from presswear.linkage.normal_law import (
    StiffnessReading,
    conforming_stiffness,
    delivered_restitution,
    hertz_stiffness,
    liu_stiffness,
)
from presswear.physics.friction_and_normal import friction_force, friction_record


@given(
    depth=st.floats(-1.0, 1e-3),
    rate=st.floats(-20.0, 20.0),
    onset=st.floats(1e-6, 20.0),
    exponent=st.sampled_from([1.0, 1.5, math.nextafter(1.5, 2.0), 2.0, 2.2, 2.5]),
    damping=st.floats(0.0, 30.0),
)
def test_normal_force_is_equation_8_and_never_pulls(
    depth, rate, onset, exponent, damping
):
    force = force_of(normal_law(1.25e10, exponent, damping), depth, rate, onset)
    elastic = 1.25e10 * max(depth, 0.0) ** exponent
    damped = elastic * damping * rate / onset
    # A power costs a few ulp, and the two parts may cancel.
    bound = 2e-14 * (elastic + abs(damped))
    assert force == pytest.approx(max(elastic + damped, 0.0), rel=0.0, abs=bound)
    assert force >= 0.0


@given(
    speed=st.floats(-2e-3, 2e-3) | st.floats(-1.0, 1.0),
    normal=st.floats(0.0, 1e4),
    coefficient=st.floats(0.0, 0.8),
    lower=st.sampled_from([0.0, 1e-4]),
)
@example(1e-4, 1.0, 0.5, 1e-4)
@example(-1e-3, 1.0, 0.5, 1e-4)
@example(9.5e-5, 1.0, 0.5, 1e-4)
@example(0.0, 1.0, 0.5, 0.0)
def test_friction_law(speed, normal, coefficient, lower):
    """Against sliding, without any up to v_0, full from v_1 on and linear between them."""
    law = friction_record(pw.linkage.FrictionLaw(coefficient, lower, 1e-3))
    force = friction_force(speed, normal, law)
    full = coefficient * normal
    part = np.interp(abs(speed), [lower, 1e-3], [0.0, 1.0])
    expected = -math.copysign(part * full, speed)
    assert force == pytest.approx(expected, rel=0.0, abs=1e-14 * full + 1e-300)
    assert force == -friction_force(-speed, normal, law)
    assert force * speed <= 0.0
    assert abs(force) == full if abs(speed) >= 1e-3 else abs(force) <= full


@pytest.mark.parametrize(
    ("pin", "modulus", "poisson", "reading", "expected"),
    [
        # (1 - 0.09) / 200e9 = 4.55e-12; 4 / (3 * 9.1e-12) = 1.465201465e11;
        # 0.015 * 0.0142 / 0.0292 = 7.294520548e-3, root 8.540796540e-2.
        (0.0142, 200e9, 0.3, "paper", 1.2513987e10),
        # 0.015 * 0.0142 / 0.0008 = 0.26625, root 0.515994186.
        (0.0142, 200e9, 0.3, "refined", 7.5603544e10),
        # 0.015 * 0.0144 / 0.0294 and / 0.0006: roots 8.571428571e-2 and 0.6.
        (0.0144, 200e9, 0.3, "paper", 1.2558870e10),
        (0.0144, 200e9, 0.3, "refined", 8.7912088e10),
        (0.0142, 100e9, 0.3, "paper", 0.5 * 1.2513987e10),
        (0.0142, 200e9, 0.5, "paper", 0.91 / 0.75 * 1.2513987e10),
    ],
)
def test_stiffness_as_printed_and_of_a_pin_in_a_hole(
    pin,
    modulus,
    poisson,
    reading: StiffnessReading,
    expected,
):
    stiffness = hertz_stiffness(0.015, pin, 2.0 * (1.0 - poisson**2) / modulus, reading)
    assert stiffness == pytest.approx(expected, rel=1e-7)


def test_a_deep_pin_of_conforming_stiffness_is_as_stiff_as_by_liu():
    """At 1,000 clearances both laws are linear; for small contacts K is 1.2 times Liu's."""
    width, clearance, compliance = 0.15, 4e-5, 1.3e-11
    stiffness = conforming_stiffness(width, clearance, compliance)
    liu = liu_stiffness(width, clearance, compliance)
    assert stiffness / liu == pytest.approx(8.0 * math.sqrt(2.0) / (3.0 * math.pi))
    depth = 1000.0 * clearance
    deep = liu * depth**1.5 / math.sqrt(1.0 + depth / clearance)
    half = math.acos(1.0 / 1001.0)
    bed = 0.75 * stiffness * math.sqrt(0.5 * clearance)
    force = bed * ((clearance + depth) * half - clearance * math.sin(half))
    assert force == pytest.approx(deep, rel=2e-3)
    assert deep == pytest.approx(
        math.pi * width * depth / (2.0 * math.sqrt(2.0) * compliance), rel=2e-3
    )


@given(
    st.floats(1e-10, 100.0)
    | st.floats(1e-10, 1e-3)
    | st.sampled_from([1e-10, 1e-7, 1e-5, 0.0999, 0.1425, 8.0, 38.4, 100.0])
)
def test_delivered_restitution_for_any_damping(damping):
    """It solves (1 + e') chi = ln[(1 + chi) / (1 - chi e')], to fifty digits, within 1e-8."""
    with localcontext() as context:
        context.prec = 50
        chi = Decimal(damping)
        delivered = Decimal(delivered_restitution(damping))

        def excess(restitution: Decimal) -> Decimal:
            # Beyond the pole of the logarithm there is no force.
            rest = 1 - chi * restitution
            return (
                (1 + restitution) * chi - ((1 + chi) / rest).ln()
                if rest > 0
                else Decimal(-1)
            )

        assert excess(delivered * (1 - Decimal("1e-8"))) > 0
        assert excess(delivered * (1 + Decimal("1e-8"))) < 0
