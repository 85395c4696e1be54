"""Sentences of sections 5.3, 5.4 and 6 that claim a trend, as comparisons of quantities."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Literal

from presswear.paper.printed import Place, printed_at
from presswear.paper.settings import FAST, FRICTION, HIGH_FRICTION, JOINTS, SLIDER, SLOW, WEAR

Expected = Literal["more", "less", "same"]
Pairs = list[tuple[Place, Place]]  # each place after the one that it is compared with


@dataclass(frozen=True)
class Comparison:
    """Ratio or difference of quantities, and its expected change."""

    quantity: str  # key of `evidence.QUANTITIES`
    over: tuple[Place, ...]  # numerators; one for a difference
    under: tuple[Place, ...]  # as many denominators
    expected: Expected = "more"  # change of the second against the first

    @property
    def is_difference(self) -> bool:
        """True for quantities that may change their sign, whose differences are compared."""
        return self.quantity in ("angle", "lag")

    @property
    def printed(self) -> float | None:
        """Ratio or difference of the printed numbers; None if one of them is not printed."""
        places = (*self.over, *self.under)
        numbers = [printed_at(place, self.quantity) for place in places]
        values = [number.value for number in numbers if number is not None]
        if len(values) < len(places):
            return None
        if self.is_difference:
            return wrapped_angle(values[0] - values[1])
        count = len(self.over)
        return math.prod(values[:count]) / math.prod(values[count:])


@dataclass(frozen=True)
class Claim:
    """Sentence that claims a trend."""

    where: str  # section and figure
    quote: str  # words of the paper, shortened
    parts: tuple[Comparison, ...]
    note: str = ""  # interpretation of the words, or what is odd about them


def wrapped_angle(angle: float) -> float:
    """Return the angle between -pi and pi, rad."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def more(quantity: str, pairs: Pairs, expected: Expected = "more") -> tuple[Comparison, ...]:
    """Return comparisons of each second place with its first."""
    return tuple(Comparison(quantity, (second,), (first,), expected) for first, second in pairs)


def by_wear(joints: Sequence[str], *wear_updates: int, setting: str = WEAR) -> Pairs:
    """Return pairs of successive numbers of wear updates, at each joint."""
    return [
        (Place(setting, before, joint), Place(setting, after, joint))
        for joint in joints
        for before, after in pairwise(wear_updates)
    ]


def _between(first: str, second: str, joints: Sequence[str], *wear_updates: int) -> Pairs:
    return [
        (Place(first, k, joint), Place(second, k, joint)) for joint in joints for k in wear_updates
    ]


by_friction = partial(_between, FRICTION, HIGH_FRICTION)
by_speed = partial(_between, SLOW, FAST)


def c_and_a(*stages: tuple[str, int]) -> Pairs:
    """Return pairs of joint C and joint A, at settings after some wear updates."""
    return [(Place(*stage, "C"), Place(*stage, "A")) for stage in stages]


def a_grows_more(*pairs: tuple[tuple[str, int], tuple[str, int]]) -> tuple[Comparison, ...]:
    """Return comparisons of the growth of the force at A with that at C between two stages."""
    return tuple(
        Comparison(
            "force",
            (Place(*second, "A"), Place(*first, "C")),
            (Place(*first, "A"), Place(*second, "C")),
        )
        for first, second in pairs
    )


# settings and wear updates whose depths the paper shows
SHOWN_WEARS = ((WEAR, 1), (WEAR, 2), (FRICTION, 1), (HIGH_FRICTION, 1), (SLOW, 1), (FAST, 1))
STAGE_NOT_SAID = "The paper does not say before or after which wear; both are compared."
C_WIDER = "Worn is where the depth is at least 5 % of the deepest."
FREQUENCY = "Amplitude: peak acceleration; frequency: contacts per second."


def _a_deeper_c_wider(where: str, of: str, *stages: tuple[str, int]) -> tuple[Claim, Claim]:
    """Return the two claims that the paper repeats for each picture of depths."""
    pairs = c_and_a(*stages)
    deeper = f"the wear degree {of} clearance A is more serious"
    wider = f"but the wear range {of} clearance C is wider"
    return (
        Claim(where, deeper, more("depth", pairs), "Deepest wear."),
        Claim(where, wider, more("range", pairs, "less"), C_WIDER),
    )


CLAIMS: tuple[Claim, ...] = (
    Claim(
        "5.3.1, Fig. 8",
        "the wear depth of clearance A increases … after considering second wear; that of C "
        "increases",
        more("depth", by_wear(JOINTS, 1, 2)),
        "Depths add up: this holds for any second wear.",
    ),
    Claim(
        "5.3.1, Fig. 8",
        "the angle of peak value changes from 100.7° to 132.7° (A), from 225.1° to 297.4° (C)",
        more("angle", by_wear(JOINTS, 1, 2)),
    ),
    Claim(
        "5.3.1, Fig. 8",
        "the wear phenomenon of clearance is more severe when the second wear is considered",
        more("added_depth", by_wear(JOINTS, 1, 2)),
        "Read as: the second wear adds more than the first did.",
    ),
    *_a_deeper_c_wider("5.3.1, Fig. 8", "of", (WEAR, 1), (WEAR, 2)),
    Claim(
        "5.3.1, Fig. 9, 10",
        "non-uniform wear occurs on the surface of shaft and bearing, and the second wear is more "
        "serious",
        more("unevenness", by_wear(JOINTS, 1, 2)),
        "Unevenness: standard deviation of the depth over the angle.",
    ),
    Claim(
        "5.3.1, Fig. 9, 10",
        "compared with clearance C, the wear phenomenon of clearance A is more obvious",
        more("unevenness", c_and_a((WEAR, 1), (WEAR, 2))),
    ),
    Claim(
        "5.3.2, Fig. 11",
        "the wear depth at the friction coefficient of 0.05 is much greater than that of 0.1",
        more("depth", by_friction(JOINTS, 1), "less"),
    ),
    *_a_deeper_c_wider("5.3.2, Fig. 11", "of", (FRICTION, 1), (HIGH_FRICTION, 1)),
    Claim(
        "5.3.2, Fig. 12, 13",
        "the smaller the friction coefficient is, the more serious the non-uniform wear of shaft "
        "and bearing surface is",
        more("unevenness", by_friction(JOINTS, 1), "less"),
    ),
    Claim(
        "5.3.3, Fig. 14",
        "the driving velocities are greater, the wear depth is greater",
        more("depth", by_speed(JOINTS, 1)),
    ),
    Claim(
        "5.3.3, Fig. 14",
        "the angle of peak value [at A] changes from 95.76° to 65.52°",
        more("angle", by_speed(("A",), 1), "less"),
    ),
    Claim(
        "5.3.3, Fig. 14",
        "the angle of peak [at C] increases from 310.3° to 312.8°",
        more("angle", by_speed(("C",), 1)),
    ),
    *_a_deeper_c_wider("5.3.3, Fig. 14", "at", (SLOW, 1), (FAST, 1)),
    Claim(
        "5.3.3, Fig. 15, 16",
        "the higher the driving velocities, the more serious the non-uniform wear",
        more("unevenness", by_speed(JOINTS, 1)),
    ),
    Claim(
        "5.4.1, Fig. 17a",
        "the actual displacement curve of slider lags behind after wear",
        more("lag", by_wear(SLIDER, 0, 1, 2)),
        "Read as: lags more behind the ideal motion after each wear (least squares over a cycle).",
    ),
    Claim(
        "5.4.1, Fig. 17a",
        "the peak value [of displacement] increases",
        more("displacement", by_wear(SLIDER, 0, 1, 2)),
    ),
    Claim(
        "5.4.1, Fig. 17a",
        "when the second wear occurs, the displacement curve shows obvious vibration",
        more("displacement_off", by_wear(SLIDER, 0, 1, 2)),
        "Read as: the root mean square distance from the ideal motion grows.",
    ),
    Claim(
        "5.4.1, Fig. 17b",
        "the peak values of velocity are 0.9925, 1.005 and 1.106 m/s",
        more("velocity", by_wear(SLIDER, 0, 1, 2)),
        "Read as: they increase with each wear.",
    ),
    Claim(
        "5.4.1, Fig. 17b",
        "the velocity curve of slider fluctuates obviously after the second wear",
        more("velocity_off", by_wear(SLIDER, 1, 2)),
        "Fluctuation: root mean square distance of the velocity from the ideal.",
    ),
    Claim(
        "5.4.1, Fig. 17c",
        "the peak values of acceleration are 1221, 1523 and 3629 m/s², … fluctuates obviously "
        "after the second wear",
        more("acceleration", by_wear(SLIDER, 0, 1, 2)),
        "Read as: they increase with each wear.",
    ),
    Claim(
        "5.4.1, Fig. 17",
        "with the increase of wear times, the errors of slider output response are also increasing",
        more("displacement_off", by_wear(SLIDER, 0, 1, 2))
        + more("velocity_off", by_wear(SLIDER, 0, 1, 2)),
    ),
    Claim(
        "5.4.1, Fig. 18a",
        "the peak value of collision force at clearance A increases after first wear, and after "
        "second wear",
        more("force", by_wear(("A",), 0, 1, 2)),
    ),
    Claim(
        "5.4.1, Fig. 18b",
        "the peak value of collision force at clearance [C] increases after first wear, and after "
        "second wear",
        more("force", by_wear(("C",), 0, 1, 2)),
        "Printed of joint A a second time.",
    ),
    Claim(
        "5.4.1, Fig. 18",
        "the collision force at clearance A increases more serious than that at clearance C after "
        "wear",
        a_grows_more(((WEAR, 0), (WEAR, 1)), ((WEAR, 0), (WEAR, 2))),
        "Read as: its peak grows by a larger factor.",
    ),
    Claim(
        "5.4.1, Fig. 19",
        "with the increase of wear times, the movement of center trajectories … becomes more "
        "chaotic",
        more("flight", by_wear(JOINTS, 0, 1, 2)),
        "Read as: the pin is out of contact for a larger part of the time.",
    ),
    Claim(
        "5.4.1, Fig. 19",
        "and the collision range becomes more wide",
        more("contact_range", by_wear(JOINTS, 1, 2, 3)),
        "Read as: the range of directions in which the stage wears the surfaces.",
    ),
    Claim(
        "5.4.2, Fig. 20a",
        "different friction coefficients have little effect on displacement response",
        more("displacement", by_friction(SLIDER, 0, 1), "same"),
        f"Little: less than 2 % in the peak. {STAGE_NOT_SAID}",
    ),
    Claim(
        "5.4.2, Fig. 20b",
        "from 0.05 to 0.1, the velocity curve of slider fluctuates more violently",
        more("velocity_off", by_friction(SLIDER, 0, 1)),
        f"The paper's own conclusion 3 says the opposite. {STAGE_NOT_SAID}",
    ),
    Claim(
        "5.4.2, Fig. 20c",
        "the smaller the friction coefficient is, the larger the acceleration fluctuation range is",
        more("acceleration", by_friction(SLIDER, 0, 1), "less"),
        STAGE_NOT_SAID,
    ),
    Claim(
        "5.4.2, Fig. 21",
        "from 0.05 to 0.1, the peak value [of the collision force] changes from 2363 N to 448.5 N "
        "(A), from 650.3 N to 258.8 N (C)",
        more("force", by_friction(JOINTS, 0, 1), "less"),
        f"Printed as peaks of acceleration. {STAGE_NOT_SAID}",
    ),
    Claim(
        "5.4.2, Fig. 21",
        "the collision force at clearance A increases more serious than that at clearance C",
        a_grows_more(((HIGH_FRICTION, 0), (FRICTION, 0)), ((HIGH_FRICTION, 1), (FRICTION, 1))),
        f"Read as: with less friction its peak grows by a larger factor. {STAGE_NOT_SAID}",
    ),
    Claim(
        "5.4.2, Fig. 22",
        "with the increase of friction coefficient, the center trajectory of shaft becomes stable",
        more("flight", by_friction(JOINTS, 0, 1), "less"),
        f"Read as: the pin is out of contact for less of the time. {STAGE_NOT_SAID}",
    ),
    Claim(
        "5.4.3, Fig. 23a",
        "at 4π the displacement curve is close to the ideal curve; at 8π it shows obvious "
        "deviation",
        more("displacement_off", by_speed(SLIDER, 0, 1)),
        "Read as: the root mean square distance from the ideal motion grows.",
    ),
    Claim(
        "5.4.3, Fig. 23b",
        "the greater the drive velocity, the greater the speed curve fluctuates",
        more("velocity_off", by_speed(SLIDER, 0, 1)),
    ),
    Claim(
        "5.4.3, Fig. 23c",
        "compared with no wear, the peak value of acceleration of first wear is larger",
        more(
            "acceleration",
            by_wear(SLIDER, 0, 1, setting=SLOW) + by_wear(SLIDER, 0, 1, setting=FAST),
        ),
    ),
    Claim(
        "5.4.3, Fig. 23c",
        "the larger the driving velocities are, the larger the peak value of acceleration is",
        more("acceleration", by_speed(SLIDER, 0, 1)),
    ),
    Claim(
        "5.4.3, Fig. 24",
        "the collision force at the clearance considering first wear is much greater than no wear",
        more("force", by_wear(JOINTS, 0, 1, setting=SLOW) + by_wear(JOINTS, 0, 1, setting=FAST)),
    ),
    Claim(
        "5.4.3, Fig. 24",
        "the greater the driving velocities, the greater the collision force at the clearance",
        more("force", by_speed(JOINTS, 0, 1)),
    ),
    Claim(
        "5.4.3, Fig. 25",
        "with the increase of driving velocities, the movement of center trajectory … becomes "
        "chaotic",
        more("flight", by_speed(JOINTS, 0, 1)),
        "Read as: the pin is out of contact for a larger part of the time.",
    ),
    Claim(
        "5.4.3, Fig. 25",
        "the greater the drive velocity, the higher the collision frequency",
        more("contact_rate", by_speed(JOINTS, 0, 1)),
        "Contacts per second.",
    ),
    Claim(
        "6, Fig. 8, 14",
        "when wear times or driving velocities are larger, the wear degree is more serious",
        more("added_mean", by_wear(JOINTS, 1, 2) + by_speed(JOINTS, 1)),
        "Read as: one wear takes more off, on average over the angle.",
    ),
    Claim(
        "6, Fig. 11",
        "when friction coefficient is larger, the wear degree … [is] reduced",
        more("added_mean", by_friction(JOINTS, 1), "less"),
        "Read as: one wear takes less off, on average over the angle.",
    ),
    Claim(
        "6, Fig. 11",
        "when friction coefficient is larger, the … wear range [is] reduced and relatively "
        "concentrated",
        more("range", by_friction(JOINTS, 1), "less"),
        C_WIDER,
    ),
    Claim(
        "6, Fig. 8, 11, 14",
        "the wear degree of clearance A is more serious than that of clearance C",
        more("depth", c_and_a(*SHOWN_WEARS)),
        "The paper's reason, that A is closer to the driving rod, is not tested: both joints are "
        "one rod from a crank.",
    ),
    Claim(
        "6, Fig. 17, 18, 23, 24",
        "when wear times and driving velocities increase, the frequency and amplitude of the … "
        "oscillation increase",
        more("acceleration", by_wear(SLIDER, 0, 1, 2) + by_speed(SLIDER, 0, 1))
        + more("contact_rate", by_wear(JOINTS, 0, 1, 2) + by_speed(JOINTS, 0, 1)),
        FREQUENCY,
    ),
    Claim(
        "6, Fig. 20, 21",
        "when the friction coefficient is larger, the frequency and amplitude of response of "
        "mechanism decreases",
        more("acceleration", by_friction(SLIDER, 0, 1), "less")
        + more("contact_rate", by_friction(JOINTS, 0, 1), "less"),
        f"{FREQUENCY} {STAGE_NOT_SAID}",
    ),
)

DEPTH_RATIOS = more(  # what the printed depths predict although K_d / b is not printed
    "depth",
    by_wear(JOINTS, 1, 2)
    + [(a, c) for c, a in c_and_a(*SHOWN_WEARS)]
    + by_friction(JOINTS, 1)
    + by_speed(JOINTS, 1),
)

HIGHLIGHTS = {  # comparisons at joint A that the report states first
    "second wear": more("depth", by_wear(("A",), 1, 2))[0],
    "friction, wear": more("depth", by_friction(("A",), 1))[0],
    "friction, force": more("force", by_friction(("A",), 0))[0],
    "speed": more("depth", by_speed(("A",), 1))[0],
    "joints": more("depth", c_and_a((FAST, 1)))[0],
}
