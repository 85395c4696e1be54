"""A linkage as the kernels see it: arrays and records instead of objects."""

import math
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import (
    GROUND,
    Attachment,
    ClearanceJoint,
    GuideCorner,
    Joint,
    ends_of,
)
from presswear.linkage.linkage import Linkage
from presswear.linkage.loads import Spring
from presswear.linkage.surface import Surface
from presswear.linkage.topology import prescribed_of
from presswear.physics.foundation import (
    BEARING,
    PIN,
    ROWS,
    TURNS,
    foundation_stiffness,
    least_depth,
    pack_rows,
    parts_of,
)
from presswear.physics.friction_and_normal import (
    FRICTION,
    NORMAL,
    ONSET_SPEED_FLOOR,
    friction_record,
    normal_record,
)
from presswear.physics.loads import Loads, pack_loads
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, floats

# Corners of a slide touch down quietly and stay closed under load. A damping that is
# divided by so small a speed would rule their force, m/s.
CORNER_SPEED_FLOOR = 0.02

# A clearance joint as the kernels see it; SI units
JOINT = np.dtype(
    [
        ("bearing_body", np.int64),  # index in q of the body's x; -1 for the frame
        ("pin_body", np.int64),
        *floats(
            "bearing_x", "bearing_y", "pin_x", "pin_y"
        ),  # centres in the bodies' frames, m
        *floats("bearing_radius", "pin_radius", "clearance", "width"),
        ("effective_mass", np.float64),  # lower bound of the mass that meets in it, kg
        ("normal", NORMAL),
        ("friction", FRICTION),
        # speed at touchdown by which the rate is divided, at least, m/s
        ("onset_floor", np.float64),
        ("map_turns", np.float64),  # 1 where the wear maps turn with their bodies
        # its stiffness k_w b R, N/m^2 per rad; 0 for radial contact
        ("foundation", np.float64),
        ("map_bins", np.int64),  # of the wear maps of a cycle
        ("surface_bins", np.int64),  # of the worn surfaces; 0 while they are round
        # of the same maps, as ``foundation.pack_rows`` divides them
        ("surface_nodes", np.int64),
        # lower bound of the depths of both surfaces together, m
        ("least_depth", np.float64),
        ("relief", np.float64),  # greatest difference of depth that a pin can meet, m
        ("wear_coefficient", np.float64),  # K_d, 1/Pa; 0 keeps no account
        ("bearing_share", np.float64),  # part of the worn depth that the bearing loses
        # m of the wear law; see ``physics.pressure_wear``
        ("pressure_exponent", np.float64),
        ("slip_by_angle", np.bool_),
        ("over_arc", np.bool_),
        ("is_flat", np.bool_),  # a corner on a wall
        ("wall", np.int64),  # row of its map; see ``physics.wall_wear``
        ("wall_start", np.float64),  # of the map along the guide, m
        ("wall_bin", np.float64),  # length of a bin, m
        # 1 where the corner moves along the guide with a positive sliding speed, or -1
        ("wall_sense", np.float64),
        ("oiled", np.bool_),  # always closed, without events
    ]
)


# A rigid pin joint with friction as the kernels see it; SI units
RUBBING = np.dtype(
    [
        ("row", np.int64),  # first of the two rows of its constraint
        ("bearing_body", np.int64),  # index in q of the body's x; -1 for the frame
        ("pin_body", np.int64),
        ("bearing_radius", np.float64),
        ("friction", FRICTION),
        ("moment", np.float64),  # on the pin, working space
    ]
)


class Packed(NamedTuple):
    """A linkage as the kernels see it."""

    joints: Records
    # (joints, ROWS, m); each in the first of the m columns, see ``pack_rows``
    surfaces: Array
    loads: Loads | None
    mass: Array  # diagonal of the mass matrix, (3 bodies,)
    weight: Array  # constant generalized forces, (3 bodies,)
    driven: NDArray[np.int64]  # indices of the angles of the driven bodies in q
    rubbing: Records | None  # of RUBBING; None without friction in rigid joints


def pack(linkage: Linkage, wearing: bool = False) -> Packed:
    """Pack a linkage for the kernels; ``wearing``: surfaces that are round now wear in a run."""
    offset = {body.name: 3 * i for i, body in enumerate(linkage.bodies)} | {GROUND: -1}
    joints = np.zeros(len(linkage.clearances), JOINT)
    for record, joint in zip(joints, linkage.clearances, strict=True):
        for end, point in (("bearing", joint.bearing), ("pin", joint.pin)):
            record[f"{end}_body"] = offset[point.body]
            record[f"{end}_x"], record[f"{end}_y"] = point.x, point.y
        record["effective_mass"] = effective_mass(linkage, (joint.bearing, joint.pin))
        for name in ("bearing_radius", "pin_radius", "clearance", "width"):
            record[name] = getattr(joint, name)
        record["normal"] = normal_record(joint.round_normal, joint.clearance)
        record["friction"] = friction_record(joint.friction)
        record["onset_floor"] = onset_floor(joint)
        record["is_flat"] = isinstance(joint, GuideCorner)
        record["oiled"] = joint.oil is not None
        record["map_bins"] = joint.bins
        record["map_turns"] = float(joint.map_frame == "body")
        if joint.contact == "foundation":
            record["foundation"] = foundation_stiffness(
                joint.normal.stiffness, joint.clearance
            )
        if joint.wear is not None:
            record["wear_coefficient"] = joint.wear.coefficient
            record["bearing_share"] = joint.wear.bearing_share
            record["pressure_exponent"] = joint.wear.pressure_exponent
            record["slip_by_angle"] = joint.wear.slip == "angle"
            record["over_arc"] = joint.wear.wear_distribution == "arc"
        pair = joint.bearing_surface, joint.pin_surface
        sizes = (surface.depth.size for surface in pair if surface.is_worn)
        later = joint.bins if wearing and joint.wear else 0
        bins = max(sizes, default=later)
        record["surface_bins"] = bins
        record["surface_nodes"] = bins * parts_of(bins) if bins else 0
    _pack_walls(joints, linkage)
    weight = np.zeros(3 * len(linkage.bodies))
    weight[1::3] = [-linkage.gravity * body.mass for body in linkage.bodies]
    for load in linkage.dead_loads:
        i = offset[load.body]
        weight[i : i + 3] += load.x, load.y, load.moment
    most = int(joints["surface_nodes"].max(initial=0))
    surfaces = np.zeros((len(joints), ROWS, TURNS * most + 2 if most else 0))
    driven = np.array(
        [offset[drive.body] + 2 for drive in linkage.drives], dtype=np.int64
    )
    loads = pack_loads(linkage)
    rubbing = _pack_rubbing(linkage, offset)
    packed = Packed(joints, surfaces, loads, mass_of(linkage), weight, driven, rubbing)
    for k, joint in enumerate(linkage.clearances):
        pack_surfaces(packed, k, (joint.bearing_surface, joint.pin_surface))
    return packed


def onset_floor(joint: ClearanceJoint) -> float:
    """Return the least speed at touchdown, m/s, that the damping of a joint is divided by."""
    return CORNER_SPEED_FLOOR if isinstance(joint, GuideCorner) else ONSET_SPEED_FLOOR


def _pack_walls(joints: Records, linkage: Linkage) -> None:
    """Write the maps of the walls into the records of the corners that wear them."""
    guides = linkage.worn_guides
    for record, joint in zip(joints, linkage.clearances, strict=True):
        if not isinstance(joint, GuideCorner) or joint.wall is None:
            continue
        record["wear_coefficient"] = joint.wall.coefficient
        record["wall"] = 2 * guides.index(joint.guide) + (joint.side < 0.0)
        record["wall_start"] = joint.wall.start
        record["wall_bin"] = joint.wall.bin_length
        # Tangent of a contact: the direction into the wall turned by +90 degrees.
        record["wall_sense"] = -joint.side


def _pack_rubbing(linkage: Linkage, offset: Mapping[str, int]) -> Records | None:
    """Return the rigid joints with friction as records of RUBBING."""
    if not linkage.rubbing_pins:
        return None
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
    """Return the mass, kg, that resists a force between two points; infinite if neither can move.

    1/m is the sum of 1/m + r^2/I of the free bodies. Drives hold angles, and prescribed
    bodies whole; other joints are left out, so that the mass is rather too small.
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


def spring_period(linkage: Linkage) -> float:
    """Return the shortest period of a body on a spring or elastic joint, s: 2 pi sqrt(m / k)."""
    shortest = math.inf
    springs: list[Spring | Joint] = [*linkage.springs, *linkage.elastic_joints]
    for spring in springs:
        if spring.stiffness:
            ends = spring.ends if isinstance(spring, Spring) else ends_of(spring)
            mass = effective_mass(linkage, ends)
            shortest = min(shortest, 2.0 * math.pi * math.sqrt(mass / spring.stiffness))
    return shortest


def mass_of(linkage: Linkage) -> Array:
    """Return the diagonal of the mass matrix, shape (3 bodies,): m, m, I of each body."""
    return np.ravel(
        [(item.mass, item.mass, item.effective_inertia) for item in linkage.bodies]
    )


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
    """Give joint ``k`` of a packed linkage its surfaces, bearing and pin."""
    count = int(packed.joints[k]["surface_bins"])
    if count == 0:
        return
    rows = pack_rows(*surfaces, count)
    packed.surfaces[k, :, : rows.shape[1]] = rows
    depths = [surface.depth for surface in surfaces if surface.is_worn]
    packed.joints[k]["least_depth"] = least_depth(rows)
    packed.joints[k]["relief"] = sum(float(np.ptp(depth)) for depth in depths)
