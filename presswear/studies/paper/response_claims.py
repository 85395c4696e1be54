"""Claims of section 5.4: how wear, friction and speed shape the motion and the forces."""

from presswear.studies.paper.claim import (
    JOINTS,
    SLIDER,
    STAGE_NOT_SAID,
    Claim,
    a_grows_more,
    by_friction,
    by_speed,
    by_wear,
    more,
)
from presswear.studies.paper.printed import FAST, FRICTION, HIGH_FRICTION, SLOW, WEAR

RESPONSE_CLAIMS: tuple[Claim, ...] = (
    # 5.4.1
    Claim(
        "5.4.1",
        "17a",
        "the actual displacement curve of slider lags behind after wear",
        more("lag", by_wear(SLIDER, 0, 1, 2)),
        "Read as: lags more behind the ideal motion after each wear (least squares over a cycle).",
    ),
    Claim(
        "5.4.1",
        "17a",
        "the peak value [of displacement] increases",
        more("displacement", by_wear(SLIDER, 0, 1, 2)),
    ),
    Claim(
        "5.4.1",
        "17a",
        "when the second wear occurs, the displacement curve shows obvious vibration",
        more("displacement_off", by_wear(SLIDER, 0, 1, 2)),
        "Read as: the root mean square distance from the ideal motion grows.",
    ),
    Claim(
        "5.4.1",
        "17b",
        "the peak values of velocity are 0.9925, 1.005 and 1.106 m/s",
        more("velocity", by_wear(SLIDER, 0, 1, 2)),
        "Read as: they increase with each wear.",
    ),
    Claim(
        "5.4.1",
        "17b",
        "the velocity curve of slider fluctuates obviously after the second wear",
        more("velocity_off", by_wear(SLIDER, 1, 2)),
        "Fluctuation: root mean square distance of the velocity from the ideal.",
    ),
    Claim(
        "5.4.1",
        "17c",
        "the peak values of acceleration are 1221, 1523 and 3629 m/s², … fluctuates obviously "
        "after the second wear",
        more("acceleration", by_wear(SLIDER, 0, 1, 2)),
        "Read as: they increase with each wear.",
    ),
    Claim(
        "5.4.1",
        "17",
        "with the increase of wear times, the errors of slider output response are also increasing",
        (
            *more("displacement_off", by_wear(SLIDER, 0, 1, 2)),
            *more("velocity_off", by_wear(SLIDER, 0, 1, 2)),
        ),
    ),
    Claim(
        "5.4.1",
        "18a",
        "the peak value of collision force at clearance A increases after first wear, and after "
        "second wear",
        more("force", by_wear(("A",), 0, 1, 2)),
    ),
    Claim(
        "5.4.1",
        "18b",
        "the peak value of collision force at clearance [C] increases after first wear, and after "
        "second wear",
        more("force", by_wear(("C",), 0, 1, 2)),
        "Printed of joint A a second time.",
    ),
    Claim(
        "5.4.1",
        "18",
        "the collision force at clearance A increases more serious than that at clearance C after "
        "wear",
        a_grows_more([((WEAR, 0), (WEAR, 1)), ((WEAR, 0), (WEAR, 2))]),
        "Read as: its peak grows by a larger factor.",
    ),
    Claim(
        "5.4.1",
        "19",
        "with the increase of wear times, the movement of center trajectories … becomes more "
        "chaotic",
        more("flight", by_wear(JOINTS, 0, 1, 2)),
        "Read as: the pin is out of contact for a larger part of the time.",
    ),
    Claim(
        "5.4.1",
        "19",
        "and the collision range becomes more wide",
        more("contact_range", by_wear(JOINTS, 1, 2, 3)),
        "Read as: the range of directions in which the stage wears the surfaces.",
    ),
    # 5.4.2
    Claim(
        "5.4.2",
        "20a",
        "different friction coefficients have little effect on displacement response",
        more("displacement", by_friction(SLIDER, 0, 1), "same"),
        f"Little: less than 2 % in the peak. {STAGE_NOT_SAID}",
    ),
    Claim(
        "5.4.2",
        "20b",
        "from 0.05 to 0.1, the velocity curve of slider fluctuates more violently",
        more("velocity_off", by_friction(SLIDER, 0, 1)),
        f"The paper's own conclusion 3 says the opposite. {STAGE_NOT_SAID}",
    ),
    Claim(
        "5.4.2",
        "20c",
        "the smaller the friction coefficient is, the larger the acceleration fluctuation range is",
        more("acceleration", by_friction(SLIDER, 0, 1), "less"),
        STAGE_NOT_SAID,
    ),
    Claim(
        "5.4.2",
        "21",
        "from 0.05 to 0.1, the peak value [of the collision force] changes from 2363 N to 448.5 N "
        "(A), from 650.3 N to 258.8 N (C)",
        more("force", by_friction(JOINTS, 0, 1), "less"),
        f"Printed as peaks of acceleration. {STAGE_NOT_SAID}",
    ),
    Claim(
        "5.4.2",
        "21",
        "the collision force at clearance A increases more serious than that at clearance C",
        a_grows_more([((HIGH_FRICTION, k), (FRICTION, k)) for k in (0, 1)]),
        f"Read as: with less friction its peak grows by a larger factor. {STAGE_NOT_SAID}",
    ),
    Claim(
        "5.4.2",
        "22",
        "with the increase of friction coefficient, the center trajectory of shaft becomes stable",
        more("flight", by_friction(JOINTS, 0, 1), "less"),
        f"Read as: the pin is out of contact for less of the time. {STAGE_NOT_SAID}",
    ),
    # 5.4.3
    Claim(
        "5.4.3",
        "23a",
        "at 4π the displacement curve is close to the ideal curve; at 8π it shows obvious "
        "deviation",
        more("displacement_off", by_speed(SLIDER, 0, 1)),
        "Read as: the root mean square distance from the ideal motion grows.",
    ),
    Claim(
        "5.4.3",
        "23b",
        "the greater the drive velocity, the greater the speed curve fluctuates",
        more("velocity_off", by_speed(SLIDER, 0, 1)),
    ),
    Claim(
        "5.4.3",
        "23c",
        "compared with no wear, the peak value of acceleration of first wear is larger",
        (
            *more("acceleration", by_wear(SLIDER, 0, 1, setting=SLOW)),
            *more("acceleration", by_wear(SLIDER, 0, 1, setting=FAST)),
        ),
    ),
    Claim(
        "5.4.3",
        "23c",
        "the larger the driving velocities are, the larger the peak value of acceleration is",
        more("acceleration", by_speed(SLIDER, 0, 1)),
    ),
    Claim(
        "5.4.3",
        "24",
        "the collision force at the clearance considering first wear is much greater than no wear",
        (
            *more("force", by_wear(JOINTS, 0, 1, setting=SLOW)),
            *more("force", by_wear(JOINTS, 0, 1, setting=FAST)),
        ),
    ),
    Claim(
        "5.4.3",
        "24",
        "the greater the driving velocities, the greater the collision force at the clearance",
        more("force", by_speed(JOINTS, 0, 1)),
    ),
    Claim(
        "5.4.3",
        "25",
        "with the increase of driving velocities, the movement of center trajectory … becomes "
        "chaotic",
        more("flight", by_speed(JOINTS, 0, 1)),
        "Read as: the pin is out of contact for a larger part of the time.",
    ),
    Claim(
        "5.4.3",
        "25",
        "the greater the drive velocity, the higher the collision frequency",
        more("contact_rate", by_speed(JOINTS, 0, 1)),
        "Contacts in a second.",
    ),
)
