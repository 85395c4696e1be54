"""Search for the length of a trial step that ends on its first event."""

from presswear.engines.dae.events import BEHIND, MAX_BEHIND, event_value, first_event
from presswear.physics.dormand_prince import Tableau
from presswear.physics.load_transitions import count_transitions
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled
from presswear.tools.packing import PackedArguments, unpack

# Largest number of repetitions that locate an event. Newton's method needs four; where
# it leaves the interval, the interval is halved.
MAX_NEWTON_STEPS = 60
MIN_MOVE = 1e-15  # change of a step, s, below which Newton's method ends
# Ratio of the penetration at which an event is located to the resolution of the
# coordinates. A smaller penetration is round-off.
EVENT_PART = 0.125
# Penetration up to which an event counts as located if round-off prevents a smaller one, m
DEPTH_TOL = 1e-12


@compiled
def start_search(control: Records, h: float) -> None:
    """Start to search for the event that ends a trial step of length ``h``."""
    state = control[0]
    state.whole = state.length = h
    state.searches = 0
    state.moves = 0
    state.event = -1
    state.is_located = True


@compiled
def search_event(
    address: PackedArguments,
    tableau: Tableau | None,
    classical: int | None,
    t: float,
    joints: int,
) -> bool:
    """Search in a trial step for the first event; return whether a trial of another length follows.

    At the end of the step that is found a joint has zero penetration, or is just closed
    if its force begins with a jump, and a load is just behind the change of its law.
    """
    (run,) = unpack(address)
    state = run.control[0]
    if state.moves > 0:
        if move_towards_event(address, classical, t):
            return True
        if not state.is_located:
            return False
    # The cubics may see events of two joints in the wrong order. Each event is searched
    # once: three of each contact, the transitions of loads, the end of a section.
    contacts = run.system.contacts.shape[0]
    events = 3 * contacts + count_transitions(run.system.packed.loads)
    if run.records.nominal[0].column >= 0:
        events += 1
    if state.searches > events:
        return False
    state.searches += 1
    earlier, fraction = first_event(
        address, tableau, t, state.length, state.event, joints
    )
    if earlier < 0:
        return False
    state.event = earlier
    state.moves = 1
    state.low = 0.0
    state.high = state.length
    state.extension = MIN_MOVE
    state.is_last = False
    state.length *= fraction
    return True


@compiled
def move_towards_event(
    address: PackedArguments, classical: int | None, t: float
) -> bool:
    """Change the length of a trial step towards its event; return whether the step is repeated.

    Newton's method, which stays between the ends of the trial step: where a surface is
    steep it would leave them.
    """
    (run,) = unpack(address)
    state = run.control[0]
    aim, near, accepted = event_tolerances(address)
    value, rate = event_value(address, classical, state.event, t, state.length)
    value -= aim
    following = state.length
    is_found = abs(value) <= near or state.is_last
    if not is_found:
        following = newton_length(run.control, value, rate)
        if abs(following - state.length) <= MIN_MOVE:
            is_found = aim == 0.0 or value > 0.0
            if not is_found:
                # Round-off keeps the step from ending just behind the event: longer
                # steps are tried.
                following = min(state.length + state.extension, state.high)
                state.extension *= 4.0
                state.is_last = following == state.high
    if not is_found and state.moves < MAX_NEWTON_STEPS:
        state.length = following
        state.moves += 1
        return True
    state.moves = 0
    if aim == 0.0:
        state.is_located = abs(value) <= accepted
    else:
        state.is_located = -near <= value <= accepted
    return False


@compiled
def newton_length(control: Records, value: float, rate: float) -> float:
    """Return the next length of the trial step; narrow the interval of the event.

    ``value`` is the switching function at the end of the step, ``rate`` its rate.
    """
    state = control[0]
    if value > 0.0:
        state.high = state.length
    else:
        state.low = state.length
    following = state.length - value / rate if rate != 0.0 else -1.0
    if not state.low < following < state.high:
        following = 0.5 * (state.low + state.high)
    return following


@compiled
def event_tolerances(address: PackedArguments) -> tuple[float, float, float]:
    """Return the value at which the event of a trial step is located, and two tolerances.

    The first tolerance ends the search, the second one accepts an event that round-off
    keeps from the first.
    """
    (run,) = unpack(address)
    state = run.control[0]
    joints = run.system.packed.joints
    if state.event >= run.system.contacts.shape[0]:
        return BEHIND, 0.5 * BEHIND, MAX_BEHIND
    near = EVENT_PART * state.resolution
    is_abrupt = is_abrupt_touchdown(joints, run.records.onset, state.event)
    aim = 2.0 * near if is_abrupt else 0.0
    return aim, near, max(DEPTH_TOL, state.resolution)


@compiled
def is_abrupt_touchdown(joints: Records, onset: Array, k: int) -> bool:
    """Return whether the force of a joint jumps at the event that ends its open state.

    Such a step must end with the pin in the wall. A step from the open side of the
    touchdown starts without the force, and no step is short enough for the jump within
    it.
    """
    return bool(onset[k] <= 0.0 and joints[k].normal.abrupt)
