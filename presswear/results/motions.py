"""Sentences on the motions on which the replicates of a stage settled."""

from collections.abc import Callable

from presswear.recording.settling import REPEATED, Motion, Settling
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.recording.statistics.estimate import key_of_greatest
from presswear.tools.numbers import counted, quantity_text, readable

SETTLE_ADVICE = (
    "presswear dynamics settle shows how likely each motion is, and how long it lasts"
)


def sentence_of(settling: Settling) -> str:
    """Return on which motions the replicates settled, in a sentence without a full stop."""
    if settling.verdict == "unwatched":
        return f"{_too_few(settling)} to see whether the motion settles"
    return _SENTENCES[settling.verdict](settling)


def _too_few(settling: Settling) -> str:
    verb = "is" if settling.watched == 1 else "are"
    return f"{counted(settling.watched, 'stroke')} {verb} too few"


def state_of(settling: Settling) -> str:
    """Return whether the replicates have settled, in a few words."""
    runs = counted(settling.runs, "run")
    strokes = counted(settling.watched, "stroke")
    regular = len(_regular(settling))
    if settling.verdict == "unwatched":
        return f"{_too_few(settling)} to see whether it settles"
    if settling.verdict == "irregular":
        return f"not settled, irregular in {runs} of {strokes}"
    if settling.verdict == "mixed":
        return f"not settled, regular in {settling.settled} of {runs}"
    if settling.verdict == "coexisting":
        return f"settled on {regular} different regular motions in {runs}"
    return f"settled, regular in {runs} after {_strokes_before(settling)}"


def needs_warning(settling: Settling) -> bool:
    """Return whether a mean over the motions, or over the first strokes, misleads."""
    if settling.is_mixture:
        return True
    latest = max((start for start in settling.starts if start is not None), default=0)
    return settling.verdict == "settled" and latest > STARTUP_CYCLES + REPEATED


def peak_force(motion: Motion) -> str:
    """Return the peak force of a motion at the joint where it is greatest."""
    joint = key_of_greatest(motion.peak_force)
    return f"{quantity_text(motion.peak_force[joint].mean, 'N')} at {joint}"


def _mixed(settling: Settling) -> str:
    runs = counted(settling.runs, "run")
    peaks = " or ".join(map(peak_force, _regular(settling)))
    text = f"{settling.settled} of {runs} came to rest on a regular motion (peak force {peaks}) "
    text += f"after {_strokes_before(settling)}; {_irregular(settling)}"
    return f"{text}: after a disturbance expect both"


def _coexisting(settling: Settling) -> str:
    regular = _regular(settling)
    kinds = ", ".join(
        f"{motion.replicates} with {peak_force(motion)}" for motion in regular
    )
    text = f"{counted(settling.runs, 'run')} came to rest on {len(regular)} different "
    text += f"regular motions (peak force: {kinds}) after {_strokes_before(settling)}: which one a "
    return f"{text}machine shows depends on how it starts"


def _settled(settling: Settling) -> str:
    count = counted(settling.runs, "run")
    before = _strokes_before(settling)
    if not needs_warning(settling):
        return f"The motion is regular: {count} repeat after {before}"
    text = f"All {count} came to rest on the same regular motion (peak force "
    text += f"{peak_force(settling.motions[0])}) after {before}, and the numbers are those of this "
    return f"{text}motion; {_irregular(settling)}: after a disturbance expect both"


def _only_irregular(settling: Settling) -> str:
    text = f"The motion is irregular: none of {counted(settling.runs, 'run')} came to rest "
    text += f"on a regular motion in {settling.watched} strokes"
    least = settling.least_half_life
    if least >= 1.0:
        text += (
            f", so that half of such runs last longer than {least:.0f} strokes (95 %)"
        )
    return text


def _regular(settling: Settling) -> list[Motion]:
    return [motion for motion in settling.motions if motion.period is not None]


def _strokes_before(settling: Settling) -> str:
    starts = [start for start in settling.starts if start is not None]
    first = min(starts)
    last = max(starts)
    return f"{first} strokes" if first == last else f"{first} to {last} strokes"


def _irregular(settling: Settling) -> str:
    """Return how long the irregular motion lasts, and its peak force."""
    irregular = [motion for motion in settling.motions if motion.period is None]
    peak = f" (peak force {peak_force(irregular[0])})" if irregular else ""
    text = f"irregular motion{peak} lasts"
    half_life = settling.half_life
    if half_life is None or half_life.low is None or half_life.high is None:
        return f"{text} an unknown time"
    interval = f"{readable(half_life.low, 2)} to {readable(half_life.high, 2)}"
    return f"{text} {readable(half_life.mean, 2)} strokes at the median ({interval})"


_SENTENCES: dict[str, Callable[[Settling], str]] = {
    "settled": _settled,
    "coexisting": _coexisting,
    "mixed": _mixed,
    "irregular": _only_irregular,
}
