"""Linkage packed for the kernels: arrays and records instead of objects."""

import math
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.drives import GearedDrive, LinearDrive
from presswear.linkage.guide_corner import GuideCorner
from presswear.linkage.linkage import Linkage
from presswear.linkage.points import GROUND, Attachment
from presswear.linkage.surface import Surface
from presswear.linkage.topology import prescribed_of
from presswear.linkage.wear_law import WEAR_PARAMETERS, WearLaw
from presswear.physics.drive_motion import drive_motion
from presswear.physics.foundation import foundation_stiffness
from presswear.physics.friction_and_normal import (
    FRICTION,
    NORMAL,
    ONSET_SPEED_FLOOR,
    friction_record,
    normal_record,
)
from presswear.physics.loads import Loads
from presswear.physics.packed_loads import pack_loads
from presswear.physics.worn_map import (
    BEARING,
    PIN,
    ROWS,
    SPARE,
    TURNS,
    least_depth,
    pack_rows,
    parts_of,
)
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, address_of, floats, inlined
from presswear.tools.compiled_law import compile_function

# Least closing speed in the damping law of the corners of a slide, m/s. They touch down
# slowly and stay closed under load: with a lower speed the damping would exceed the
# elastic force.
CORNER_SPEED_FLOOR = 0.02

# Clearance joint; SI units
JOINT = np.dtype(
    [
        ("bearing_body", np.int64),  # index in q of the body's x; -1 for the frame
        ("pin_body", np.int64),
        # centres in the axes of their bodies, m
        *floats("bearing_x", "bearing_y", "pin_x", "pin_y"),
        *floats("bearing_radius", "pin_radius", "clearance", "width"),
        ("effective_mass", np.float64),  # lower limit of the mass in an impact, kg
        ("normal", NORMAL),
        ("friction", FRICTION),
        # least closing speed at touchdown in the damping law, m/s
        ("onset_floor", np.float64),
        ("map_turns", np.float64),  # 1 if the wear maps turn with their bodies, else 0
        # stiffness of the foundation k_w b R, N/m^2 per rad; 0 for radial contact
        ("foundation", np.float64),
        ("map_bins", np.int64),  # bins of the wear maps of a cycle
        ("surface_bins", np.int64),  # bins of the worn surfaces; 0 while they are round
        # number of nodes into which ``worn_map.pack_rows`` divides these bins
        ("surface_nodes", np.int64),
        ("cell_width", np.float64),  # between two nodes, rad
        # lower limit of the sum of the depths of both surfaces, m
        ("least_depth", np.float64),
        ("relief", np.float64),  # upper limit of the differences of this sum, m
        ("wear_coefficient", np.float64),  # K_d, 1/Pa; 0: wear is not computed
        ("bearing_share", np.float64),  # share of the bearing in the worn depth
        # m of the wear law; see ``physics.pressure_wear``
        ("pressure_exponent", np.float64),
        # address of a user law of WEAR_PARAMETERS that depends on the pressure; 0: none
        ("wear_address", np.int64),
        ("slip_by_angle", np.bool_),
        ("over_arc", np.bool_),
        ("is_flat", np.bool_),  # a corner on a wall
        ("wall_partner", np.int64),  # number of the second corner on its wall
        ("wall_start", np.float64),  # start of the map along the guide, m
        ("wall_bin", np.float64),  # length of a bin, m
        # 1 where the corner moves along the guide with a positive sliding speed, or -1
        ("wall_sense", np.float64),
        # through oil: a contact without events, with the shape of new surfaces
        ("always_closed", np.bool_),
    ]
)


# Rigid pin joint with friction; SI units
RUBBING = np.dtype(
    [
        ("row", np.int64),  # first of the two rows of its constraints
        ("bearing_body", np.int64),  # index in q of the body's x; -1 for the frame
        ("pin_body", np.int64),
        ("bearing_radius", np.float64),
        ("friction", FRICTION),
        ("moment", np.float64),  # friction moment on the pin, working space, N m
    ]
)


# Coordinate of a body that a drive moves
DRIVEN = np.dtype(
    [
        ("index", np.int64),  # index of the angle of the body in q
        ("is_linear", np.bool_),  # along a guide, by the motion of the drive
        ("is_geared", np.bool_),  # its power is that of its leader
        ("leader", np.int64),  # number of the drive of this leader
        ("ratio", np.float64),  # ratio of gears
    ]
)


class Packed(NamedTuple):
    """Linkage packed for the kernels."""

    joints: Records  # dtype JOINT
    # surfaces, (joints, ROWS, m): a joint uses as many columns as needed, see ``pack_rows``
    surfaces: Array
    loads: Loads  # loads with a law
    mass: Array  # diagonal of the mass matrix, (3 bodies,)
    weight: Array  # constant generalized forces, (3 bodies,)
    driven: Records  # dtype DRIVEN
    rubbing: Records  # rigid joints with friction, dtype RUBBING


def pack(linkage: Linkage, wearing: bool = False) -> Packed:
    """Pack a linkage for the kernels; ``wearing``: round surfaces will wear during the run."""
    offset = {body.name: 3 * i for i, body in enumerate(linkage.bodies)} | {GROUND: -1}
    joints = _pack_joints(linkage, offset, wearing)
    weight = np.zeros(3 * len(linkage.bodies))
    weight[1::3] = [-linkage.gravity * body.mass for body in linkage.bodies]
    for load in linkage.constant_loads:
        i = offset[load.body]
        weight[i : i + 3] += load.x, load.y, load.moment
    nodes = int(joints["surface_nodes"].max(initial=0))
    columns = TURNS * nodes + SPARE if nodes else 0
    packed = Packed(
        joints=joints,
        surfaces=np.zeros((len(joints), ROWS, columns)),
        loads=pack_loads(linkage),
        mass=mass_of(linkage),
        weight=weight,
        driven=_pack_driven(linkage, offset),
        rubbing=_pack_rubbing(linkage, offset),
    )
    for k, joint in enumerate(linkage.clearances):
        pack_surfaces(packed, k, (joint.bearing_surface, joint.pin_surface))
    return packed


def _pack_joints(linkage: Linkage, offset: Mapping[str, int], wearing: bool) -> Records:
    """Return the clearance joints as records of JOINT."""
    joints = np.zeros(len(linkage.clearances), JOINT)
    for record, joint in zip(joints, linkage.clearances, strict=True):
        for end, point in (("bearing", joint.bearing), ("pin", joint.pin)):
            record[f"{end}_body"] = offset[point.body]
            record[f"{end}_x"] = point.x
            record[f"{end}_y"] = point.y
        record["effective_mass"] = effective_mass(linkage, (joint.bearing, joint.pin))
        for name in ("bearing_radius", "pin_radius", "clearance", "width"):
            record[name] = getattr(joint, name)
        record["normal"] = normal_record(joint.round_normal, joint.clearance)
        record["friction"] = friction_record(joint.friction)
        record["onset_floor"] = onset_floor(joint)
        record["is_flat"] = isinstance(joint, GuideCorner)
        record["always_closed"] = joint.oil is not None
        record["map_bins"] = joint.bins
        record["map_turns"] = float(joint.map_frame == "body")
        if joint.contact == "foundation":
            record["foundation"] = foundation_stiffness(
                joint.normal.stiffness, joint.clearance
            )
        if joint.wear is not None:
            _pack_wear(record, joint.wear)
        bins = _surface_bins(joint, wearing)
        record["surface_bins"] = bins
        if bins:
            record["surface_nodes"] = bins * parts_of(bins)
            record["cell_width"] = 2.0 * math.pi / record["surface_nodes"]
    _pack_walls(joints, linkage)
    return joints


def _pack_wear(record: Records, wear: WearLaw) -> None:
    """Fill in the numbers of a wear law."""
    record["wear_coefficient"] = wear.coefficient
    record["bearing_share"] = wear.bearing_share
    record["pressure_exponent"] = wear.pressure_exponent
    if wear.depends_on_pressure:
        record["wear_address"] = wear_address(wear)
    record["slip_by_angle"] = wear.slip == "angle"
    record["over_arc"] = wear.wear_distribution == "arc"


def wear_address(wear: WearLaw) -> int:
    """Return the address of the user law of wear, compiled."""
    assert wear.user_law is not None
    law = compile_function(wear.user_law, WEAR_PARAMETERS)
    return address_of(law, len(WEAR_PARAMETERS))


def _pack_driven(linkage: Linkage, offset: Mapping[str, int]) -> Records:
    """Return the coordinates of drives as records of DRIVEN."""
    driven = np.zeros(len(linkage.drives), DRIVEN)
    for record, drive in zip(driven, linkage.drives, strict=True):
        record["index"] = offset[drive.body]
        if isinstance(drive, LinearDrive):
            record["is_linear"] = True
        elif isinstance(drive, GearedDrive):
            record["is_geared"] = True
            record["ratio"] = drive.ratio
            record["leader"] = linkage.number_of_drive(drive.leader)
        record["index"] += 2
    return driven


@inlined
def drive_rate(driven: Records, motions: Records, k: int, t: float, v: Array) -> float:
    """Return the rate, rad/s or along a guide m/s, with which drive ``k`` gives power."""
    if driven[k].is_geared:  # its leader gives its power
        return 0.0
    if driven[k].is_linear:
        return drive_motion(motions[k], t)[1]
    return v[driven[k].index]


def _surface_bins(joint: ClearanceJoint, wearing: bool) -> int:
    """Return the number of bins of the worn surfaces of a joint; 0 if they stay round."""
    sizes = [
        surface.depth.size
        for surface in (joint.bearing_surface, joint.pin_surface)
        if surface.is_worn
    ]
    if sizes:
        return max(sizes)
    wall = joint.wall if isinstance(joint, GuideCorner) else None
    return joint.bins if wearing and (joint.wear or wall) else 0


def onset_floor(joint: ClearanceJoint) -> float:
    """Return the least closing speed at touchdown in the damping law of a joint, m/s."""
    return CORNER_SPEED_FLOOR if isinstance(joint, GuideCorner) else ONSET_SPEED_FLOOR


def _pack_walls(joints: Records, linkage: Linkage) -> None:
    """Write the maps of the walls into the records of the corners that wear them."""
    partners = partners_of(linkage)
    for k, (record, joint) in enumerate(zip(joints, linkage.clearances, strict=True)):
        if not isinstance(joint, GuideCorner) or joint.wall is None:
            continue
        record["wear_coefficient"] = joint.wall.coefficient
        record["wall_partner"] = partners[k]
        record["wall_start"] = joint.wall.start
        record["wall_bin"] = joint.wall.bin_length
        # Tangent of a contact: the direction into the wall turned by +90 degrees.
        record["wall_sense"] = -joint.side


def partners_of(linkage: Linkage) -> dict[int, int]:
    """Return the number of the second corner on the wall of each corner of a slide."""
    on_wall: dict[tuple[str, float], list[int]] = {}
    for k, joint in enumerate(linkage.clearances):
        if isinstance(joint, GuideCorner):
            on_wall.setdefault((joint.guide.name, joint.side), []).append(k)
    partners = {}
    for first, second in on_wall.values():
        partners[first] = second
        partners[second] = first
    return partners


def _pack_rubbing(linkage: Linkage, offset: Mapping[str, int]) -> Records:
    """Return the rigid joints with friction as records of RUBBING."""
    names = [joint.name for joint in linkage.revolutes]
    records = np.zeros(len(linkage.rubbing_pins), RUBBING)
    for record, joint in zip(records, linkage.rubbing_pins, strict=True):
        record["row"] = 2 * names.index(joint.name)
        record["bearing_body"] = offset[joint.bearing.body]
        record["pin_body"] = offset[joint.pin.body]
        record["bearing_radius"] = joint.bearing_radius
        record["friction"] = friction_record(joint.friction)
    return records


def effective_mass(linkage: Linkage, points: Iterable[Attachment]) -> float:
    """Return the effective mass for a force between two points, kg; infinite if neither moves.

    Its reciprocal is the sum of 1/m + r^2/I of the bodies of both points. A driven body
    contributes 1/m only, a body with prescribed motion nothing. Other joints are
    ignored, so that the mass is rather too small.
    """
    driven = {drive.body for drive in linkage.prescribed_drives}
    prescribed = prescribed_of(linkage)
    bodies = {body.name: body for body in linkage.bodies if body.name not in prescribed}
    mobility = 0.0
    for point in points:
        if body := bodies.get(point.body):
            mobility += 1.0 / body.mass
            if body.name not in driven:
                mobility += (point.x**2 + point.y**2) / body.effective_inertia
    return 1.0 / mobility if mobility > 0.0 else math.inf


def mass_of(linkage: Linkage) -> Array:
    """Return the diagonal of the mass matrix, shape (3 bodies,): m, m, I of each body."""
    mass = np.zeros(3 * len(linkage.bodies))
    for k, body in enumerate(linkage.bodies):
        mass[3 * k : 3 * k + 3] = body.mass, body.mass, body.effective_inertia
    return mass


def depths_of(packed: Packed) -> Array:
    """Return depths of bearings and pins, m, shape (joints, 2, n); n = 0 while all are round."""
    most = int(packed.joints["surface_bins"].max(initial=0))
    depths = np.zeros((len(packed.joints), 2, most))
    for depth, joint, rows in zip(depths, packed.joints, packed.surfaces, strict=True):
        if bins := int(joint["surface_bins"]):
            parts = parts_of(bins)
            centres = slice(parts // 2, bins * parts, parts)
            depth[:, :bins] = rows[BEARING, centres], rows[PIN, centres]
    return depths


def pack_surfaces(packed: Packed, k: int, surfaces: tuple[Surface, Surface]) -> None:
    """Set the surfaces of bearing and pin of joint ``k`` of a packed linkage."""
    count = int(packed.joints[k]["surface_bins"])
    if count == 0:
        return
    rows = pack_rows(*surfaces, count)
    packed.surfaces[k, :, : rows.shape[1]] = rows
    depths = [surface.depth for surface in surfaces if surface.is_worn]
    packed.joints[k]["least_depth"] = least_depth(rows)
    packed.joints[k]["relief"] = sum(float(np.ptp(depth)) for depth in depths)
