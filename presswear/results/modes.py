"""What the motion of a stage is: modes of contact, periods, sections, spectra and resonance."""

import numpy as np
from numpy.typing import NDArray

from presswear.analysis.contact_modes import Timeline, resonance_frequency, timeline
from presswear.analysis.periods import Periodicity, periodicity, section, times_at_phase
from presswear.analysis.spectra import Spectrum, power_spectrum
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene

Array = NDArray[np.float64]

HIGHEST_ORDER = 1000.0
"""Highest frequency of a spectrum, in turns of the crank; the film of rows is finer."""


def has_motion(scene: Scene, stage: StageResult) -> bool:
    """True where a whole cycle of a rattling motion was recorded, so that there is one to tell."""
    if stage.failed or not stage.has_joint_series or stage.time.size < 2:
        return False
    begin, end = settled_span(scene, stage)
    return end - begin > 0.99 * scene.mechanism.period


def settled_span(scene: Scene, stage: StageResult) -> tuple[float, float]:
    """Beginning and end of the recorded motion behind the start-up, s; whole cycles."""
    period, run_up = scene.mechanism.period, scene.run_up
    whole = int((float(stage.time[-1]) - run_up) / period + 0.02)
    first = max(min(STARTUP_CYCLES, whole - 1), 0)
    end = run_up + max(whole, first + 1) * period
    return run_up + first * period, min(end, float(stage.time[-1]))


def timeline_of(scene: Scene, stage: StageResult, joint: str) -> Timeline:
    """Modes of a joint in the recorded cycles behind the start-up; time since the run-up, s."""
    begin, end = settled_span(scene, stage)
    own = stage.joints[joint]
    contacts = np.column_stack([own.contact("touchdown"), own.contact("separation")])
    closing = own.contact("closing_speed")
    last = float(contacts[-1, 1]) if len(contacts) else float(stage.time[0])
    # A contact that goes on at the end has not been filed.
    held = (stage.time > last) & (own.penetration > 0.0)
    if held.any():
        contacts = np.append(
            contacts, [[stage.time[held][0], end + scene.mechanism.period]], axis=0
        )
        closing = np.append(closing, 0.0)
    found = timeline(
        (begin, end),
        contacts,
        closing,
        (stage.time, own.sliding),
        scene.bearing(joint).lower_speed,
    )
    return Timeline(found.edges - scene.run_up, found.mode, found.names)


def resonance(stage: StageResult, joint: str) -> float | None:
    """Frequency of the contact, Hz; None where none is known.  See ``resonance_frequency``."""
    own = stage.joints[joint]
    lasting = own.contact("separation") - own.contact("touchdown")
    return resonance_frequency(lasting, own.contact("closing_speed"))


def spectra_of(scene: Scene, stage: StageResult) -> dict[str, Spectrum]:
    """Spectra of the recorded cycles behind the start-up, up to ``HIGHEST_ORDER``.

    Under a joint's name that of its normal force, N^2/Hz, under ``""`` that of the acceleration
    of what is watched, (m/s^2)^2/Hz.
    """
    begin, end = settled_span(scene, stage)
    rows = (stage.time >= begin) & (stage.time <= end)
    series = {"": stage.acceleration}
    series |= {name: own.force[:, 0] for name, own in stage.joints.items()}
    period = scene.mechanism.period
    return {
        name: power_spectrum(stage.time[rows], values[rows], period, HIGHEST_ORDER / period)
        for name, values in series.items()
    }


def section_of(scene: Scene, stage: StageResult, joint: str) -> tuple[Array, float]:
    """Places of a pin once a cycle behind the start-up, shape (n, 2), m, and the phase.

    They are of the first Poincare section of every cycle where sections were kept, else of the
    ends of the recorded cycles.  The phase is a part of the cycle.
    """
    if "sections" in stage.arrays:
        phase = scene.recording.phases[0]
        both = [stage.section(f"eccentricity_{axis}", joint)[:, 0] for axis in "xy"]
        return np.transpose(both)[min(STARTUP_CYCLES, len(both[0]) - 1) :], phase
    begin, end = (moment - scene.run_up for moment in settled_span(scene, stage))
    at = times_at_phase(begin, end, scene.mechanism.period, 0.0)
    places = section(stage.time - scene.run_up, stage.joints[joint].eccentricity, at)
    return places, 1.0


def impacts_of(scene: Scene, stage: StageResult, joint: str) -> tuple[Array, Array]:
    """Touchdowns of a joint in the recorded cycles behind the start-up: a section at that event.

    Returns
    -------
    phase : ndarray, shape (n,)
        Where in the cycle they are, in parts of it, from 0 to 1.
    closing_speed : ndarray, shape (n,)
        Rate of penetration, m/s.
    """
    begin, end = settled_span(scene, stage)
    own = stage.joints[joint]
    moment = own.contact("touchdown")
    inside = (moment >= begin) & (moment <= end)
    phase = (moment[inside] - scene.run_up) / scene.mechanism.period % 1.0
    return phase, own.contact("closing_speed")[inside]


def period_of(scene: Scene, stage: StageResult) -> Periodicity:
    """Period of the places of all pins, in parts of their clearances."""
    places = [section_of(scene, stage, joint)[0] for joint in stage.joint_names]
    scales = [np.full(2, scene.bearing(joint).clearance) for joint in stage.joint_names]
    return periodicity(np.concatenate(places, axis=1), np.concatenate(scales))
