"""Packs: several replicates of one linkage that are computed together, each in a lane."""

import time as clock
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.engines.dae.dynamics import ACCELERATION, AXES, NUMBERS, POSITION, RATE, Members
from presswear.engines.dae.march import DONE, IDLE, RUNNING, TRYING, judge_step, propose_step
from presswear.engines.dae.runge_kutta import Integration, Motion, embedded_step
from presswear.engines.driver import Advance
from presswear.physics.contact import CONTACT
from presswear.physics.prescribed import Tree
from presswear.physics.tree import ARTICULATED
from presswear.recording.soundness import Finding
from presswear.tools.arrays import Array
from presswear.tools.compile import (
    PackedArguments,
    compiled,
    inlined,
    is_compiled_elsewhere,
    pack_arguments,
    specialised,
    unpack,
)
from presswear.tools.lanes import COUNTS, LaneArray, lane_zeros, lanes_of

TURNS = 1000.0  # between two looks at the clock and the keyboard


class Pack(NamedTuple):
    """Several replicates of one linkage.

    ``errors`` to ``onset`` are arrays of ``run`` and ``error`` as numbers, with the lanes as last
    axis.
    """

    run: Integration  # of all together
    address: PackedArguments  # of it
    moment: LaneArray  # time at the start of the steps on trial and their lengths, s, (2,)
    error: LaneArray  # of these steps over the allowed one, (1,)
    errors: Array
    y: Array
    trial: Array
    slopes: Array
    onset: Array
    status: NDArray[np.int64]  # of each replicate, see ``march``, (lanes,)
    end: Array  # time to which each is integrated, s, (lanes,)


class Member(NamedTuple):
    """One replicate of a pack."""

    address: PackedArguments  # of its integration
    start_again: Callable[[], None]  # makes it ready for another march
    # Reports its progress; returns what went wrong, from the status and the wall time, s, it took
    look: Callable[[int, float], Finding | None]


def lanes_for(tree: Tree | str | None) -> int:
    """Return the number of replicates of a linkage that are computed together with error control.

    It is 1 unless the linkage is an open tree whose drives turn bodies without closed loops; see
    ``tree_of``.
    """
    return COUNTS[-1] if isinstance(tree, Tree) and not len(tree.prescribed.closings) else 1


def pack_of(addresses: Sequence[PackedArguments]) -> Pack:
    """Return a pack of replicates of one linkage, at most as many as there are lanes."""
    lanes = next(count for count in COUNTS if count >= len(addresses))
    runs = [address.arguments[0] for address in addresses]
    run: Integration = runs[0]
    system, tree = run.system, run.system.tree
    assert tree is not None
    moment, scratch, error = lane_zeros(2, lanes), lane_zeros(2, lanes), lane_zeros(1, lanes)
    arrays = (system.state, system.torque, system.onset, *run.motion)
    state, torque, onset, y, trial, slopes = (lane_zeros(array.shape, lanes) for array in arrays)
    contacts = lane_zeros(len(system.contacts), lanes, CONTACT)
    # A lane that is not used computes the first replicate without time passing.
    lanes_of(y)[...], lanes_of(slopes)[0] = run.motion.y[:, None], run.motion.slopes[0][:, None]
    members = Members(
        runs=tuple(addresses[min(i, len(runs) - 1)] for i in range(lanes)),
        used=len(runs),
        time=lanes_of(moment)[0],
        length=lanes_of(moment)[1],
        scratch=scratch,
        power=lanes_of(scratch),
        state=lanes_of(state),
        contacts=np.asarray(contacts).view(np.float64).reshape(len(contacts), NUMBERS, lanes),
    )
    together = tree._replace(
        prescribed=tree.prescribed._replace(
            closings=None, work=lane_zeros(tree.prescribed.work.shape, lanes)
        ),
        bodies=lane_zeros(tree.bodies.shape, lanes, ARTICULATED),
        carried=lane_zeros(tree.carried.shape, lanes),
    )
    wide = run._replace(
        system=system._replace(
            tree=together,
            state=state,
            contacts=contacts,
            onset=onset,
            torque=torque,
            alone=None,
            members=members,
        ),
        records=None,
        motion=Motion(y, trial, slopes),
    )
    return Pack(
        run=wide,
        address=pack_arguments(wide),
        moment=moment,
        error=error,
        errors=lanes_of(error),
        y=lanes_of(y),
        trial=lanes_of(trial),
        slopes=lanes_of(slopes),
        onset=lanes_of(onset),
        status=np.zeros(lanes, np.int64),
        end=np.zeros(lanes),
    )


@inlined
def copy_lane(target: Array, lanes: Array, i: int) -> None:
    """Copy the numbers of one replicate from those of all, shape (n, lanes)."""
    for c in range(target.shape[0]):
        target[c] = lanes[c, i]


@compiled
def propose_steps(address: PackedArguments) -> bool:
    """Choose the next trial steps of several replicates; return False if one is at its end."""
    (pack,) = unpack(address)
    members = pack.run.system.members
    is_ended = False
    for i in range(members.used):
        (run,) = unpack(members.runs[i])
        if pack.status[i] == RUNNING:
            is_proposed = propose_step(members.runs[i], pack.end[i])
            pack.status[i] = TRYING if is_proposed else DONE
        is_trying = pack.status[i] == TRYING
        is_ended |= not is_trying and pack.status[i] != IDLE
        members.time[i] = run.control[0].time
        members.length[i] = run.control[0].length if is_trying else 0.0
        for k in range(run.records.onset.shape[0]):
            pack.onset[k, i] = run.records.onset[k]
    return not is_ended


@compiled
def judge_steps(address: PackedArguments) -> None:
    """Judge the trial steps of several replicates, each alone."""
    (pack,) = unpack(address)
    members, last = pack.run.system.members, pack.run.last
    for i in range(members.used):
        if pack.status[i] != TRYING:
            continue
        (run,) = unpack(members.runs[i])
        copy_lane(run.motion.trial, pack.trial, i)
        copy_lane(run.motion.slopes[last], pack.slopes[last], i)
        for r in (POSITION, RATE, ACCELERATION, AXES):  # forces are not needed any more
            copy_lane(run.system.state[r], members.state[r], i)
        for k in range(run.system.contacts.shape[0]):
            copy_lane(run.system.contact_rows[k], members.contacts[k], i)
            if not pack.errors[0, i] < 1e30:
                # The next trial does not fill contacts that are held open until it ends.
                members.contacts[k, :, i] = 0.0
        steps, error, end = run.control[0].steps, pack.errors[0, i], pack.end[i]
        tableau, classical = pack.run.tableau, pack.run.classical
        pack.status[i] = judge_step(members.runs[i], tableau, classical, error, end)
        if run.control[0].steps > steps:
            for c in range(run.motion.y.shape[0]):
                pack.y[c, i] = run.motion.y[c]
                pack.slopes[0, c, i] = run.motion.slopes[0, c]


@compiled
def march_together(address: PackedArguments, most: float) -> None:
    """Integrate several replicates until one of them is at its end, for at most ``most`` turns.

    Each has its own time and step; in a turn every one makes one trial step.
    """
    (pack,) = unpack(address)
    for _ in range(int(most)):
        if not propose_steps(address):
            break
        tableau, moment = pack.run.tableau, pack.moment
        pack.error[0] = embedded_step(pack.address, tableau, moment[0], moment[1])
        judge_steps(address)


def together(members: Sequence[Member]) -> Advance | None:
    """Return a function that integrates several replicates together.

    None if some have worn surfaces where others have round ones, and while another process compiles
    the function.
    """
    bins = [member.address.arguments[0].system.packed.joints["surface_bins"] for member in members]
    if np.any(bins != bins[0]):
        return None
    pack = pack_of([member.address for member in members])
    packed = pack_arguments(pack)
    if is_compiled_elsewhere(march_together, packed, 0.0):
        return None
    march = partial(specialised(march_together, packed, 0.0), packed)
    pack.status[:] = IDLE

    def start_again(k: int, end: float) -> None:
        member = members[k]
        member.start_again()
        motion: Motion = member.address.arguments[0].motion
        pack.y[:, k], pack.slopes[0, :, k] = motion.y, motion.slopes[0]
        pack.status[k], pack.end[k] = RUNNING, end

    def advance(ends: Mapping[int, float]) -> dict[int, Finding | None]:
        for k, end in ends.items():
            if pack.status[k] == IDLE:
                start_again(k, end)
        ended: dict[int, Finding | None] = {}
        while not ended:
            began = clock.perf_counter()
            march(TURNS)
            wall = (clock.perf_counter() - began) / len(ends)
            for k in ends:
                status = int(pack.status[k])
                finding = members[k].look(status, wall)
                if finding or status not in (RUNNING, TRYING):
                    ended[k] = finding
                    pack.status[k] = IDLE
        return ended

    return advance
