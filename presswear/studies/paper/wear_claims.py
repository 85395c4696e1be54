"""Claims of section 5.3: how wear, friction and speed shape the wear."""

from presswear.studies.paper.claim import (
    A_DEEPER,
    C_WIDER,
    JOINTS,
    Claim,
    by_friction,
    by_speed,
    by_wear,
    c_and_a,
    more,
)
from presswear.studies.paper.printed import FAST, FRICTION, HIGH_FRICTION, SLOW, WEAR

WEAR_CLAIMS: tuple[Claim, ...] = (
    # 5.3.1
    Claim(
        "5.3.1",
        "8",
        "the wear depth of clearance A increases … after considering second wear; that of C "
        "increases",
        more("depth", by_wear(JOINTS, 1, 2)),
        "Depths add up: this holds for any second wear.",
    ),
    Claim(
        "5.3.1",
        "8",
        "the angle of peak value changes from 100.7° to 132.7° (A), from 225.1° to 297.4° (C)",
        more("angle", by_wear(JOINTS, 1, 2)),
    ),
    Claim(
        "5.3.1",
        "8",
        "the wear phenomenon of clearance is more severe when the second wear is considered",
        more("added_depth", by_wear(JOINTS, 1, 2)),
        "Read as: the second wear adds more than the first did.",
    ),
    Claim(
        "5.3.1",
        "8",
        "the wear degree of clearance A is more serious",
        more("depth", c_and_a([(WEAR, 1), (WEAR, 2)])),
        A_DEEPER,
    ),
    Claim(
        "5.3.1",
        "8",
        "but the wear range of clearance C is wider",
        more("range", c_and_a([(WEAR, 1), (WEAR, 2)]), "less"),
        C_WIDER,
    ),
    Claim(
        "5.3.1",
        "9, 10",
        "non-uniform wear occurs on the surface of shaft and bearing, and the second wear is more "
        "serious",
        more("unevenness", by_wear(JOINTS, 1, 2)),
        "Unevenness: standard deviation of the depth over the angle.",
    ),
    Claim(
        "5.3.1",
        "9, 10",
        "compared with clearance C, the wear phenomenon of clearance A is more obvious",
        more("unevenness", c_and_a([(WEAR, 1), (WEAR, 2)])),
    ),
    # 5.3.2
    Claim(
        "5.3.2",
        "11",
        "the wear depth at the friction coefficient of 0.05 is much greater than that of 0.1",
        more("depth", by_friction(JOINTS, 1), "less"),
    ),
    Claim(
        "5.3.2",
        "11",
        "the wear degree of clearance A is more serious",
        more("depth", c_and_a([(FRICTION, 1), (HIGH_FRICTION, 1)])),
        A_DEEPER,
    ),
    Claim(
        "5.3.2",
        "11",
        "but the wear range of clearance C is wider",
        more("range", c_and_a([(FRICTION, 1), (HIGH_FRICTION, 1)]), "less"),
        C_WIDER,
    ),
    Claim(
        "5.3.2",
        "12, 13",
        "the smaller the friction coefficient is, the more serious the non-uniform wear of shaft "
        "and bearing surface is",
        more("unevenness", by_friction(JOINTS, 1), "less"),
    ),
    # 5.3.3
    Claim(
        "5.3.3",
        "14",
        "the driving velocities are greater, the wear depth is greater",
        more("depth", by_speed(JOINTS, 1)),
    ),
    Claim(
        "5.3.3",
        "14",
        "the angle of peak value [at A] changes from 95.76° to 65.52°",
        more("angle", by_speed(("A",), 1), "less"),
    ),
    Claim(
        "5.3.3",
        "14",
        "the angle of peak [at C] increases from 310.3° to 312.8°",
        more("angle", by_speed(("C",), 1)),
    ),
    Claim(
        "5.3.3",
        "14",
        "the wear degree at clearance A is more serious",
        more("depth", c_and_a([(SLOW, 1), (FAST, 1)])),
        A_DEEPER,
    ),
    Claim(
        "5.3.3",
        "14",
        "but the wear range at clearance C is wider",
        more("range", c_and_a([(SLOW, 1), (FAST, 1)]), "less"),
        C_WIDER,
    ),
    Claim(
        "5.3.3",
        "15, 16",
        "the higher the driving velocities, the more serious the non-uniform wear",
        more("unevenness", by_speed(JOINTS, 1)),
    ),
)
