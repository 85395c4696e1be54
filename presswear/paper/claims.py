"""Every sentence of sections 5.3, 5.4 and 6 that claims a trend, as comparisons."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from presswear.paper.evidence import Place
from presswear.paper.printed import FAST, FRICTION, HIGH_FRICTION, SLOW, WEAR
from presswear.paper.verdicts import Comparison, Expected

JOINTS = ("A", "C")
FIRST_WEARS = ((WEAR, 1), (WEAR, 2), (FRICTION, 1), (HIGH_FRICTION, 1), (SLOW, 1), (FAST, 1))
"""Settings and wears whose depths the paper shows."""


@dataclass(frozen=True)
class Claim:
    """A sentence that claims a trend, and the comparisons that it comes down to.

    Attributes
    ----------
    section, figure : str
    quote : str
        The paper's words, shortened.
    parts : tuple of Comparison
    note : str
        How the words were read, or what is odd about them.
    """

    section: str
    figure: str
    quote: str
    parts: tuple[Comparison, ...]
    note: str = ""


def _more(
    quantity: str,
    pairs: Sequence[tuple[Place, Place]],
    expected: Expected = "more",
) -> tuple[Comparison, ...]:
    """Comparisons of each second place with its first."""
    return tuple(Comparison(quantity, (second,), (first,), expected) for first, second in pairs)


def _by_wear(joints: Sequence[str], *wears: int, setting: str = WEAR) -> list[tuple[Place, Place]]:
    """Each number of wears and the next one, at each joint."""
    return [
        (Place(setting, before, joint), Place(setting, after, joint))
        for joint in joints
        for before, after in pairwise(wears)
    ]


def _by_friction(joints: Sequence[str], *wears: int) -> list[tuple[Place, Place]]:
    """The lower and the higher friction coefficient."""
    return [
        (Place(FRICTION, k, joint), Place(HIGH_FRICTION, k, joint))
        for joint in joints
        for k in wears
    ]


def _by_speed(joints: Sequence[str], *wears: int) -> list[tuple[Place, Place]]:
    """The lower and the higher speed."""
    return [(Place(SLOW, k, joint), Place(FAST, k, joint)) for joint in joints for k in wears]


def _c_and_a(places: Sequence[tuple[str, int]]) -> list[tuple[Place, Place]]:
    """Joint C and joint A."""
    return [(Place(setting, wears, "C"), Place(setting, wears, "A")) for setting, wears in places]


def _a_grows_more(
    pairs: Sequence[tuple[tuple[str, int], tuple[str, int]]],
) -> tuple[Comparison, ...]:
    """The force at A changes by a larger factor than that at C, from a first to a second."""
    return tuple(
        Comparison(
            "force",
            (Place(*second, "A"), Place(*first, "C")),
            (Place(*first, "A"), Place(*second, "C")),
        )
        for first, second in pairs
    )


SLIDER = ("",)
_STAGE_NOT_SAID = "The paper does not say before or after which wear; both are compared."
_A_DEEPER = "Deepest wear."
_C_WIDER = "Worn is where the depth is at least 5 % of the deepest."

CLAIMS: tuple[Claim, ...] = (
    # 5.3.1
    Claim(
        "5.3.1",
        "8",
        "the wear depth of clearance A increases … after considering second wear; that of C "
        "increases",
        _more("depth", _by_wear(JOINTS, 1, 2)),
        "Depths add up: this holds for any second wear.",
    ),
    Claim(
        "5.3.1",
        "8",
        "the angle of peak value changes from 100.7° to 132.7° (A), from 225.1° to 297.4° (C)",
        _more("angle", _by_wear(JOINTS, 1, 2)),
    ),
    Claim(
        "5.3.1",
        "8",
        "the wear phenomenon of clearance is more severe when the second wear is considered",
        _more("added_depth", _by_wear(JOINTS, 1, 2)),
        "Read as: the second wear adds more than the first did.",
    ),
    Claim(
        "5.3.1",
        "8",
        "the wear degree of clearance A is more serious",
        _more("depth", _c_and_a([(WEAR, 1), (WEAR, 2)])),
        _A_DEEPER,
    ),
    Claim(
        "5.3.1",
        "8",
        "but the wear range of clearance C is wider",
        _more("range", _c_and_a([(WEAR, 1), (WEAR, 2)]), "less"),
        _C_WIDER,
    ),
    Claim(
        "5.3.1",
        "9, 10",
        "non-uniform wear occurs on the surface of shaft and bearing, and the second wear is more "
        "serious",
        _more("unevenness", _by_wear(JOINTS, 1, 2)),
        "Unevenness: standard deviation of the depth over the angle.",
    ),
    Claim(
        "5.3.1",
        "9, 10",
        "compared with clearance C, the wear phenomenon of clearance A is more obvious",
        _more("unevenness", _c_and_a([(WEAR, 1), (WEAR, 2)])),
    ),
    # 5.3.2
    Claim(
        "5.3.2",
        "11",
        "the wear depth at the friction coefficient of 0.05 is much greater than that of 0.1",
        _more("depth", _by_friction(JOINTS, 1), "less"),
    ),
    Claim(
        "5.3.2",
        "11",
        "the wear degree of clearance A is more serious",
        _more("depth", _c_and_a([(FRICTION, 1), (HIGH_FRICTION, 1)])),
        _A_DEEPER,
    ),
    Claim(
        "5.3.2",
        "11",
        "but the wear range of clearance C is wider",
        _more("range", _c_and_a([(FRICTION, 1), (HIGH_FRICTION, 1)]), "less"),
        _C_WIDER,
    ),
    Claim(
        "5.3.2",
        "12, 13",
        "the smaller the friction coefficient is, the more serious the non-uniform wear of shaft "
        "and bearing surface is",
        _more("unevenness", _by_friction(JOINTS, 1), "less"),
    ),
    # 5.3.3
    Claim(
        "5.3.3",
        "14",
        "the driving velocities are greater, the wear depth is greater",
        _more("depth", _by_speed(JOINTS, 1)),
    ),
    Claim(
        "5.3.3",
        "14",
        "the angle of peak value [at A] changes from 95.76° to 65.52°",
        _more("angle", _by_speed(("A",), 1), "less"),
    ),
    Claim(
        "5.3.3",
        "14",
        "the angle of peak [at C] increases from 310.3° to 312.8°",
        _more("angle", _by_speed(("C",), 1)),
    ),
    Claim(
        "5.3.3",
        "14",
        "the wear degree at clearance A is more serious",
        _more("depth", _c_and_a([(SLOW, 1), (FAST, 1)])),
        _A_DEEPER,
    ),
    Claim(
        "5.3.3",
        "14",
        "but the wear range at clearance C is wider",
        _more("range", _c_and_a([(SLOW, 1), (FAST, 1)]), "less"),
        _C_WIDER,
    ),
    Claim(
        "5.3.3",
        "15, 16",
        "the higher the driving velocities, the more serious the non-uniform wear",
        _more("unevenness", _by_speed(JOINTS, 1)),
    ),
    # 5.4.1
    Claim(
        "5.4.1",
        "17a",
        "the actual displacement curve of slider lags behind after wear",
        _more("lag", _by_wear(SLIDER, 0, 1, 2)),
        "Read as: lags more behind the ideal motion after each wear (least squares over a cycle).",
    ),
    Claim(
        "5.4.1",
        "17a",
        "the peak value [of displacement] increases",
        _more("displacement", _by_wear(SLIDER, 0, 1, 2)),
    ),
    Claim(
        "5.4.1",
        "17a",
        "when the second wear occurs, the displacement curve shows obvious vibration",
        _more("displacement_off", _by_wear(SLIDER, 0, 1, 2)),
        "Read as: the root mean square distance from the ideal motion grows.",
    ),
    Claim(
        "5.4.1",
        "17b",
        "the peak values of velocity are 0.9925, 1.005 and 1.106 m/s",
        _more("velocity", _by_wear(SLIDER, 0, 1, 2)),
        "Read as: they increase with each wear.",
    ),
    Claim(
        "5.4.1",
        "17b",
        "the velocity curve of slider fluctuates obviously after the second wear",
        _more("velocity_off", _by_wear(SLIDER, 1, 2)),
        "Fluctuation: root mean square distance of the velocity from the ideal.",
    ),
    Claim(
        "5.4.1",
        "17c",
        "the peak values of acceleration are 1221, 1523 and 3629 m/s², … fluctuates obviously "
        "after the second wear",
        _more("acceleration", _by_wear(SLIDER, 0, 1, 2)),
        "Read as: they increase with each wear.",
    ),
    Claim(
        "5.4.1",
        "17",
        "with the increase of wear times, the errors of slider output response are also increasing",
        (
            *_more("displacement_off", _by_wear(SLIDER, 0, 1, 2)),
            *_more("velocity_off", _by_wear(SLIDER, 0, 1, 2)),
        ),
    ),
    Claim(
        "5.4.1",
        "18a",
        "the peak value of collision force at clearance A increases after first wear, and after "
        "second wear",
        _more("force", _by_wear(("A",), 0, 1, 2)),
    ),
    Claim(
        "5.4.1",
        "18b",
        "the peak value of collision force at clearance [C] increases after first wear, and after "
        "second wear",
        _more("force", _by_wear(("C",), 0, 1, 2)),
        "Printed of joint A a second time.",
    ),
    Claim(
        "5.4.1",
        "18",
        "the collision force at clearance A increases more serious than that at clearance C after "
        "wear",
        _a_grows_more([((WEAR, 0), (WEAR, 1)), ((WEAR, 0), (WEAR, 2))]),
        "Read as: its peak grows by a larger factor.",
    ),
    Claim(
        "5.4.1",
        "19",
        "with the increase of wear times, the movement of center trajectories … becomes more "
        "chaotic",
        _more("flight", _by_wear(JOINTS, 0, 1, 2)),
        "Read as: the pin is out of contact for a larger part of the time.",
    ),
    Claim(
        "5.4.1",
        "19",
        "and the collision range becomes more wide",
        _more("contact_range", _by_wear(JOINTS, 1, 2, 3)),
        "Read as: the range of directions in which the stage wears the surfaces.",
    ),
    # 5.4.2
    Claim(
        "5.4.2",
        "20a",
        "different friction coefficients have little effect on displacement response",
        _more("displacement", _by_friction(SLIDER, 0, 1), "same"),
        f"Little: less than 2 % in the peak. {_STAGE_NOT_SAID}",
    ),
    Claim(
        "5.4.2",
        "20b",
        "from 0.05 to 0.1, the velocity curve of slider fluctuates more violently",
        _more("velocity_off", _by_friction(SLIDER, 0, 1)),
        f"The paper's own conclusion 3 says the opposite. {_STAGE_NOT_SAID}",
    ),
    Claim(
        "5.4.2",
        "20c",
        "the smaller the friction coefficient is, the larger the acceleration fluctuation range is",
        _more("acceleration", _by_friction(SLIDER, 0, 1), "less"),
        _STAGE_NOT_SAID,
    ),
    Claim(
        "5.4.2",
        "21",
        "from 0.05 to 0.1, the peak value [of the collision force] changes from 2363 N to 448.5 N "
        "(A), from 650.3 N to 258.8 N (C)",
        _more("force", _by_friction(JOINTS, 0, 1), "less"),
        f"Printed as peaks of acceleration. {_STAGE_NOT_SAID}",
    ),
    Claim(
        "5.4.2",
        "21",
        "the collision force at clearance A increases more serious than that at clearance C",
        _a_grows_more([((HIGH_FRICTION, k), (FRICTION, k)) for k in (0, 1)]),
        f"Read as: with less friction its peak grows by a larger factor. {_STAGE_NOT_SAID}",
    ),
    Claim(
        "5.4.2",
        "22",
        "with the increase of friction coefficient, the center trajectory of shaft becomes stable",
        _more("flight", _by_friction(JOINTS, 0, 1), "less"),
        f"Read as: the pin is out of contact for less of the time. {_STAGE_NOT_SAID}",
    ),
    # 5.4.3
    Claim(
        "5.4.3",
        "23a",
        "at 4π the displacement curve is close to the ideal curve; at 8π it shows obvious "
        "deviation",
        _more("displacement_off", _by_speed(SLIDER, 0, 1)),
        "Read as: the root mean square distance from the ideal motion grows.",
    ),
    Claim(
        "5.4.3",
        "23b",
        "the greater the drive velocity, the greater the speed curve fluctuates",
        _more("velocity_off", _by_speed(SLIDER, 0, 1)),
    ),
    Claim(
        "5.4.3",
        "23c",
        "compared with no wear, the peak value of acceleration of first wear is larger",
        (
            *_more("acceleration", _by_wear(SLIDER, 0, 1, setting=SLOW)),
            *_more("acceleration", _by_wear(SLIDER, 0, 1, setting=FAST)),
        ),
    ),
    Claim(
        "5.4.3",
        "23c",
        "the larger the driving velocities are, the larger the peak value of acceleration is",
        _more("acceleration", _by_speed(SLIDER, 0, 1)),
    ),
    Claim(
        "5.4.3",
        "24",
        "the collision force at the clearance considering first wear is much greater than no wear",
        (
            *_more("force", _by_wear(JOINTS, 0, 1, setting=SLOW)),
            *_more("force", _by_wear(JOINTS, 0, 1, setting=FAST)),
        ),
    ),
    Claim(
        "5.4.3",
        "24",
        "the greater the driving velocities, the greater the collision force at the clearance",
        _more("force", _by_speed(JOINTS, 0, 1)),
    ),
    Claim(
        "5.4.3",
        "25",
        "with the increase of driving velocities, the movement of center trajectory … becomes "
        "chaotic",
        _more("flight", _by_speed(JOINTS, 0, 1)),
        "Read as: the pin is out of contact for a larger part of the time.",
    ),
    Claim(
        "5.4.3",
        "25",
        "the greater the drive velocity, the higher the collision frequency",
        _more("contact_rate", _by_speed(JOINTS, 0, 1)),
        "Contacts in a second.",
    ),
    # 6
    Claim(
        "6",
        "8, 14",
        "when wear times or driving velocities are larger, the wear degree is more serious",
        (
            *_more("added_mean", _by_wear(JOINTS, 1, 2)),
            *_more("added_mean", _by_speed(JOINTS, 1)),
        ),
        "Read as: one wear takes more off, on average over the angle.",
    ),
    Claim(
        "6",
        "11",
        "when friction coefficient is larger, the wear degree … [is] reduced",
        _more("added_mean", _by_friction(JOINTS, 1), "less"),
        "Read as: one wear takes less off, on average over the angle.",
    ),
    Claim(
        "6",
        "11",
        "when friction coefficient is larger, the … wear range [is] reduced and relatively "
        "concentrated",
        _more("range", _by_friction(JOINTS, 1), "less"),
        _C_WIDER,
    ),
    Claim(
        "6",
        "8, 11, 14",
        "the wear degree of clearance A is more serious than that of clearance C",
        _more("depth", _c_and_a(FIRST_WEARS)),
        "The reason given, that A is closer to the driving rod, is not tested: both joints are "
        "one rod from a crank.",
    ),
    Claim(
        "6",
        "17, 18, 23, 24",
        "when wear times and driving velocities increase, the frequency and amplitude of the … "
        "oscillation increase",
        (
            *_more("acceleration", _by_wear(SLIDER, 0, 1, 2)),
            *_more("acceleration", _by_speed(SLIDER, 0, 1)),
            *_more("contact_rate", _by_wear(JOINTS, 0, 1, 2)),
            *_more("contact_rate", _by_speed(JOINTS, 0, 1)),
        ),
        "Amplitude: peak acceleration; frequency: contacts in a second.",
    ),
    Claim(
        "6",
        "20, 21",
        "when the friction coefficient is larger, the frequency and amplitude of response of "
        "mechanism decreases",
        (
            *_more("acceleration", _by_friction(SLIDER, 0, 1), "less"),
            *_more("contact_rate", _by_friction(JOINTS, 0, 1), "less"),
        ),
        f"Amplitude: peak acceleration; frequency: contacts in a second. {_STAGE_NOT_SAID}",
    ),
)


def depth_ratios() -> tuple[Comparison, ...]:
    """Ratios between printed depths: what remains a prediction with K_d / b free."""
    pairs = [
        *_by_wear(JOINTS, 1, 2),
        *[(a, c) for c, a in _c_and_a(FIRST_WEARS)],
        *_by_friction(JOINTS, 1),
        *_by_speed(JOINTS, 1),
    ]
    return _more("depth", pairs)
