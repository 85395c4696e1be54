"""Written equations against multipliers of all constraints."""

import math
from dataclasses import replace
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np
import pytest
from forces_in_numpy import Forces
from four_bar_linkage import FOUR_BAR
from sub_chains import ARM, PUMP, STEPHENSON

import presswear as pw
from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.friction_law import FRICTION_PARAMETERS, FrictionLaw
from presswear.linkage.friction_settings import LuGreSettings
from presswear.linkage.linkage import Linkage
from presswear.linkage.normal_law import NORMAL_PARAMETERS, NormalLaw
from presswear.linkage.surface import Surface
from presswear.linkage.wear_law import WearLaw
from presswear.physics.constraints import constraints_of
from presswear.physics.contact import CONTACT
from presswear.physics.curve_following import motion_of
from presswear.physics.equations.function import END, function_of, model_of
from presswear.physics.equations.layout import WEAR_INTEGRAL_COUNT
from presswear.physics.equations.writer import Equations, write_equations
from presswear.physics.ideal import Motion
from presswear.physics.load_transitions import place_loads
from presswear.physics.packed import pack
from presswear.physics.prescribed import begin_motion
from presswear.tools.arrays import Array
from presswear.tools.packing import pack_arguments
from presswear.tools.user_function import UserFunction

TIME = 0.0137  # s
IN_CONTACT = 26  # seed with which a joint of every case is in contact
LAW = NormalLaw(1.25e10, 1.5, 0.1425)
RAMP = FrictionLaw(0.1)
WEAR = WearLaw(1e-15, wear_distribution="bin")
_DEPTHS = np.random.default_rng(5).uniform(0.0, 2e-5, (2, 90))
WORN = {"bearing_surface": Surface(_DEPTHS[0]), "pin_surface": Surface(_DEPTHS[1])}


def loose(linkage: Linkage, *names: str, **laws: Any) -> Linkage:
    """Return a linkage with clearance in some of its joints."""
    laws = dict[str, Any](normal=LAW, friction=RAMP, wear=WEAR) | laws
    pins = [joint for joint in linkage.revolutes if joint.name in names]
    joints = tuple(
        ClearanceJoint(pin.name, pin.first, pin.second, 0.015, 1e-4, 0.02, **laws)
        for pin in pins
    )
    rest = tuple(joint for joint in linkage.joints if joint not in pins)
    return replace(linkage, joints=rest, clearances=joints)


def written(linkage: Linkage) -> Equations:
    equations = write_equations(linkage, pack(linkage))
    assert isinstance(equations, Equations), equations
    return equations


@cache
def _motion(ideal: Linkage) -> Motion:
    return motion_of(ideal).at(np.array([TIME]))


class Subject:
    """Equations of a linkage with the arrays that they fill, in a state near its ideal motion."""

    def __init__(self, linkage: Linkage, ideal: Linkage, seed: int) -> None:
        self.linkage = linkage
        self.packed = pack(linkage)
        self.equations = written(linkage)
        generator = np.random.default_rng(seed)
        layout = self.equations.layout
        n = layout.coordinates
        size = layout.size
        motion = _motion(ideal)
        self.y = np.zeros(size)
        self.out = np.zeros(size)
        x, u = self.equations.chain.coordinates(motion.position[0], motion.velocity[0])
        self.y[:n] = x + 1e-3 * generator.standard_normal(n)
        self.y[n : 2 * n] = u + 0.2 * generator.standard_normal(n)
        self.onset = generator.choice([-1.0, 0.0, 0.2], len(self.packed.joints))
        self.states = self.y[layout.first_state : layout.first_energy]
        self.states[:] = 1e-6 * generator.standard_normal(self.states.size)
        contacts = np.zeros(len(self.packed.joints), CONTACT)
        self.model = model_of(
            linkage, self.equations, self.packed, self.onset, contacts
        )
        begin_motion(self.model.prescribed, TIME, motion.position[0])
        place_loads(self.packed.loads, motion.position[0], motion.velocity[0])

    def run(self, *, is_compiled: bool = False) -> Array:
        """Evaluate all that the equations fill; return the rates of the state."""
        kernel = function_of(self.equations.text)
        model = pack_arguments(self.model)
        function = kernel if is_compiled else kernel.py_func
        function(model, TIME, self.y, self.out, END)
        return self.out

    def expected(self) -> "Expected":
        """Solve the equations with the multipliers of all constraints, in the state placed last."""
        q, v, *_ = self.model.bodies
        packed = self.packed
        constraints = constraints_of(self.linkage)
        found = Forces(self.linkage, packed, TIME, q, v).all(self.onset, self.states)
        phi, phi_t, gamma, jacobian = constraints.evaluate(TIME, q, v)
        zero = np.zeros((constraints.rows, constraints.rows))
        matrix = np.block([[np.diag(packed.mass), jacobian.T], [jacobian, zero]])
        solution = np.linalg.solve(matrix, np.concatenate([found.force, gamma]))
        multipliers = solution[q.size :]
        drives = constraints.records["drive"]
        torques = np.array(
            [-multipliers[drives == k][0] for k in range(len(self.linkage.drives))]
        )
        speeds = v[packed.driven["index"]]
        acceleration = solution[: q.size]
        return Expected(speeds, phi, phi_t, acceleration, torques, found)


class Expected(NamedTuple):
    speeds: Array
    phi: Array
    phi_t: Array
    acceleration: Array
    torques: Array
    found: Forces


def near(value: Array, expected: Array, relative: float) -> None:
    scale = np.abs(expected).max(initial=0.0)
    np.testing.assert_allclose(value, expected, rtol=relative, atol=relative * scale)


def push(
    penetration: float, rate: float, onset_speed: float, stiffness: float
) -> float:
    return stiffness * penetration**1.5 * (1.0 + 2.0 * rate / onset_speed)


def rub(sliding: float, normal: float, coefficient: float) -> float:
    return -coefficient * normal * 2.0 / math.pi * math.atan(sliding / 2e-4)


def gust(time: float, position: float, speed: float) -> float:
    return 3.0 * math.sin(50.0 * time) - 2.0 * position - 0.1 * speed


def user(function: Any, parameters: tuple[str, ...]) -> UserFunction:
    return UserFunction.read("law", function, parameters)


def four_bars(count: int) -> Linkage:
    """Four-bars side by side, each with a crank of its own."""
    lengths = {"crank": 0.05, "coupler": 0.2, "rocker": 0.12}
    bodies = list[Any]()
    joints = list[Any]()
    drives = list[Any]()
    guess = dict[str, float]()
    for k in range(count):
        bodies += [
            pw.Bar(f"{name} {k}", size, 0.3 + size) for name, size in lengths.items()
        ]
        joints += [
            pw.Pin(f"O{k}", (0.3 * k, 0.0), f"crank {k}.tail"),
            pw.Pin(f"A{k}", f"crank {k}.head", f"coupler {k}.tail"),
            pw.Pin(f"B{k}", f"coupler {k}.head", f"rocker {k}.head"),
            pw.Pin(f"P{k}", (0.3 * k + 0.18, 0.0), f"rocker {k}.tail"),
        ]
        drives.append(pw.Drive(f"crank {k}", 20.0, 0.3 + 0.5 * k))
        guess |= {f"coupler {k}": 0.5, f"rocker {k}": 1.2}
    return pw.assemble(bodies, joints, drives, guess=guess, name="four-bars")


PRESS = pw.Press().linkage()
CRANK = pw.SliderCrank(slide_angle=0.4).linkage()
SPRINGS = (
    pw.Spring("tie", "crank", "coupler", 2e3, 0.05, 30.0),
    pw.Spring("post", (0.3, 0.4), "rocker", 500.0, 0.0, 5.0),
)
LOADS = (
    pw.Load("coupler", 3.0, -2.0, 0.4),
    pw.Force("coupler.head", 0.7, pw.Harmonics(10.0, 40.0, [(3.0, 4.0)]), "beat"),
    pw.Force(
        "rocker.tail",
        -1.0,
        pw.OverPosition([(-2.0, 30.0), (2.0, -20.0)], outside="hold"),
        "table",
    ),
    pw.Force("coupler", 0.1, gust, "gust"),
    pw.Moment("crank", pw.OverTime([(0.0, 1.0), (0.1, 2.0)], period=0.2)),
)
UNEVEN = FOUR_BAR.changed(
    drives=[pw.Drive("crank", 30.0, 0.2, harmonics=[(0.1, 0.2), (0.0, -0.05)])]
)
BRISTLES = FrictionLaw(0.1, name="lugre", settings=LuGreSettings(static_friction=0.15))
CASES: dict[str, tuple[Linkage, str, dict[str, Any]]] = {
    "press": (PRESS, "A C", {}),
    "press, one loop of prescribed bodies": (PRESS, "C", {}),
    "press, three joints": (PRESS, "A C D", {}),
    "press, five joints": (PRESS, "A B C D E", {}),
    "slider-crank": (CRANK, "A", {}),
    "slider-crank, slider open": (CRANK, "B", {}),
    "four-bar": (FOUR_BAR, "A", {}),
    "four-bar, loose coupler": (FOUR_BAR, "A B", {}),
    "four-bar, uneven": (UNEVEN, "B", {}),
    "pump": (PUMP, "A C", {}),
    "six-bar": (STEPHENSON, "A C", {}),
    "arm": (ARM, "W", {}),
    "arm, driven body on a loose one": (ARM, "O W", {}),
    "arm, loose driven body": (ARM, "E K", {}),
    "arm, loose driven body with a child": (ARM, "E P", {}),
    "press, loose crank": (PRESS, "A C O7", {}),
    "eight four-bars": (four_bars(8), " ".join(f"B{k}" for k in range(8)), {}),
    "lugre": (FOUR_BAR, "B", {"friction": BRISTLES}),
    "threlfall": (FOUR_BAR, "B", {"friction": FrictionLaw(0.1, name="threlfall")}),
    "no friction, no damping": (
        FOUR_BAR,
        "B",
        {"friction": FrictionLaw(), "normal": NormalLaw(1e9, 1.3), "wear": None},
    ),
    "liu": (FOUR_BAR, "B", {"normal": replace(LAW, elasticity="liu")}),
    "kelvin-voigt": (
        FOUR_BAR,
        "B",
        {"normal": replace(LAW, damping=0.0, viscosity=100.0)},
    ),
    "round foundation": (FOUR_BAR, "B", {"contact": "foundation"}),
    "wear over the arc": (
        FOUR_BAR,
        "B",
        {"wear": replace(WEAR, wear_distribution="arc")},
    ),
    "slip by angle": (FOUR_BAR, "B", {"wear": replace(WEAR, slip="angle")}),
    "worn foundation": (PRESS, "A C", {"contact": "foundation", **WORN}),
    "worn radial": (PRESS, "A C", WORN),
    "worn in fixed directions": (PRESS, "A C", {**WORN, "map_frame": "fixed"}),
    "user laws": (
        FOUR_BAR,
        "B",
        {
            "normal": replace(LAW, user_law=user(push, NORMAL_PARAMETERS)),
            "friction": replace(RAMP, user_law=user(rub, FRICTION_PARAMETERS)),
        },
    ),
    "springs": (FOUR_BAR.changed(springs=SPRINGS), "B", {}),
    "loads": (FOUR_BAR.changed(loads=LOADS), "B", {}),
}


# Of worn surfaces the position is known to 1e-16 m, which is more beside a slight
# penetration.
WITHIN = {name: 1e-10 for name in CASES if name.startswith("worn")}


def subject_of(name: str, seed: int = IN_CONTACT) -> Subject:
    ideal, joints, laws = CASES[name]
    return Subject(loose(ideal, *joints.split(), **laws), ideal, seed)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("seed", [4, IN_CONTACT])
def test_equations_agree_with_multipliers(name, seed):
    subject = subject_of(name, seed)
    close = partial(near, relative=WITHIN.get(name, 1e-11))
    subject.run()
    expected = subject.expected()
    n = subject.equations.chain.size
    out = subject.out
    q, _, a, *_ = subject.model.bodies
    assert np.abs(expected.phi).max() < 1e-12
    assert np.abs(expected.phi_t).max() < 1e-9
    assert seed != IN_CONTACT or subject.model.contact_records["normal"].any()
    close(a, expected.acceleration)
    close(out[:n], subject.y[n : 2 * n])
    close(out[n : 2 * n], subject.equations.chain.coordinates(q, a)[1])
    found = expected.found
    layout = subject.equations.layout
    close(out[layout.first_state : layout.first_energy], np.array(found.state_rates))
    energies = out[layout.first_energy : layout.first_wear_integral]
    wear_rates = out[layout.first_wear_integral : layout.first_torque].reshape(
        -1, WEAR_INTEGRAL_COUNT
    )
    for kind, reference in zip(wear_rates.T, found.wear_rates.T, strict=True):
        close(kind, reference)
    drives = out[layout.first_torque :].reshape(-1, 4)
    powers = expected.torques * expected.speeds
    close(drives[:, 0], expected.torques)
    close(drives[:, 1], expected.torques**2)
    close(drives[:, 2], powers)
    close(drives[:, 3], powers**2)
    close(energies[:2], np.array([powers.sum(), abs(powers.sum())]))
    for energy, reference in zip(energies[2:], found.energies, strict=True):
        close(energy, reference)
    for field in CONTACT.names or ():
        close(subject.model.contact_records[field], found.contacts[field])


def test_a_penetration_whose_force_rounds_to_zero_bears_nothing(
    monkeypatch,
):
    """A pin 1e-19 m deep in a worn bearing moves as one that does not touch."""
    subject = subject_of("worn foundation")
    found = list[Array]()
    names = function_of(subject.equations.text).py_func.__globals__
    for penetration in (-1e-19, 1e-19):

        def barely(
            joint: Any,
            surfaces: Array,
            contact: Any,
            is_complete: bool,
            depth: float = penetration,
        ) -> None:
            contact["penetration"] = depth
            contact["elastic"] = contact["couple"] = contact["energy"] = 0.0

        monkeypatch.setitem(names, "note_foundation", barely)
        found.append(subject.run().copy())
    assert np.isfinite(found[0]).all()
    np.testing.assert_array_equal(found[0], found[1])
