"""Every sentence of sections 5.3, 5.4 and 6 that claims a trend."""

from presswear.studies.paper.claim import (
    C_WIDER,
    FIRST_WEARS,
    JOINTS,
    SLIDER,
    STAGE_NOT_SAID,
    Claim,
    by_friction,
    by_speed,
    by_wear,
    c_and_a,
    more,
)
from presswear.studies.paper.response_claims import RESPONSE_CLAIMS
from presswear.studies.paper.verdicts import Comparison
from presswear.studies.paper.wear_claims import WEAR_CLAIMS

CONCLUSIONS: tuple[Claim, ...] = (
    # 6
    Claim(
        "6",
        "8, 14",
        "when wear times or driving velocities are larger, the wear degree is more serious",
        (
            *more("added_mean", by_wear(JOINTS, 1, 2)),
            *more("added_mean", by_speed(JOINTS, 1)),
        ),
        "Read as: one wear takes more off, on average over the angle.",
    ),
    Claim(
        "6",
        "11",
        "when friction coefficient is larger, the wear degree … [is] reduced",
        more("added_mean", by_friction(JOINTS, 1), "less"),
        "Read as: one wear takes less off, on average over the angle.",
    ),
    Claim(
        "6",
        "11",
        "when friction coefficient is larger, the … wear range [is] reduced and relatively "
        "concentrated",
        more("range", by_friction(JOINTS, 1), "less"),
        C_WIDER,
    ),
    Claim(
        "6",
        "8, 11, 14",
        "the wear degree of clearance A is more serious than that of clearance C",
        more("depth", c_and_a(FIRST_WEARS)),
        "The reason given, that A is closer to the driving rod, is not tested: both joints are "
        "one rod from a crank.",
    ),
    Claim(
        "6",
        "17, 18, 23, 24",
        "when wear times and driving velocities increase, the frequency and amplitude of the … "
        "oscillation increase",
        (
            *more("acceleration", by_wear(SLIDER, 0, 1, 2)),
            *more("acceleration", by_speed(SLIDER, 0, 1)),
            *more("contact_rate", by_wear(JOINTS, 0, 1, 2)),
            *more("contact_rate", by_speed(JOINTS, 0, 1)),
        ),
        "Amplitude: peak acceleration; frequency: contacts in a second.",
    ),
    Claim(
        "6",
        "20, 21",
        "when the friction coefficient is larger, the frequency and amplitude of response of "
        "mechanism decreases",
        (
            *more("acceleration", by_friction(SLIDER, 0, 1), "less"),
            *more("contact_rate", by_friction(JOINTS, 0, 1), "less"),
        ),
        f"Amplitude: peak acceleration; frequency: contacts in a second. {STAGE_NOT_SAID}",
    ),
)
"""Claims of section 6."""

CLAIMS: tuple[Claim, ...] = (*WEAR_CLAIMS, *RESPONSE_CLAIMS, *CONCLUSIONS)


def depth_ratios() -> tuple[Comparison, ...]:
    """Ratios between printed depths: what remains a prediction with K_d / b free."""
    pairs = [
        *by_wear(JOINTS, 1, 2),
        *[(a, c) for c, a in c_and_a(FIRST_WEARS)],
        *by_friction(JOINTS, 1),
        *by_speed(JOINTS, 1),
    ]
    return more("depth", pairs)
