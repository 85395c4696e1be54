"""Tables of the printed numbers beside ours."""

import math

import numpy as np

from presswear.show.report.parts import Row, Table
from presswear.studies.paper.claims import depth_ratios
from presswear.studies.paper.evidence import Evidence, Place, WearMap
from presswear.studies.paper.printed import PRINTED, RANGES, Printed
from presswear.studies.paper.report.trends import compared_text
from presswear.studies.paper.variants import BASE, SETTINGS
from presswear.studies.paper.verdicts import Standing, compared, ratio_standing, standing
from presswear.studies.paper.words import (
    QUANTITIES,
    as_printed,
    between,
    place_text,
    ratio_text,
    value_with_interval,
)
from presswear.tools.numbers import readable

_HEAD = (
    "printed number",
    "Fig.",
    "paper",
    "ours (95 % interval)",
    "single cycles (95 %)",
    "first cycles",
    "paper / ours",
    "",
)
STAGE_NOT_SAID = "the paper does not say before or after which wear; both are shown"
STARTS_DIFFER = "our starts differ by more than their cycles explain: the interval is over starts"


def stages_of(item: Printed) -> list[Place]:
    """The stages of ours that a printed number is held against."""
    if not item.stage_not_said:
        return [item.place]
    place = item.place
    return [Place(place.setting, wears, place.joint) for wears in (0, 1)]


def standings(evidence: Evidence) -> list[tuple[Printed, Standing]]:
    """How every printed number stands, by stage where the paper leaves it open."""
    return [
        (item, standing(item, evidence.measured(BASE, place, item.quantity)))
        for item in PRINTED
        for place in stages_of(item)
    ]


def numbers_table(evidence: Evidence) -> tuple[Table, list[str]]:
    """Every printed number, by section, and the remarks that its rows refer to by number."""
    groups: dict[str, list[Row]] = {}
    remarks: list[str] = []
    for item in PRINTED:
        group = f"Section {item.section}: {SETTINGS[item.place.setting][0]}"
        for place in stages_of(item):
            groups.setdefault(group, []).append(_number_row(evidence, item, place, remarks))
    return Table(_HEAD, tuple((name, tuple(rows)) for name, rows in groups.items())), remarks


def _number_row(evidence: Evidence, item: Printed, place: Place, remarks: list[str]) -> Row:
    """A row; remarks that are new are put behind the others."""
    shown = QUANTITIES[item.quantity]
    ours = evidence.measured(BASE, place, item.quantity)
    own = [part for part in item.misprint.split("; ") if part]
    if item.stage_not_said:
        own.append(STAGE_NOT_SAID)
    if ours is not None and ours.differ:
        own.append(STARTS_DIFFER)
    remarks += [remark for remark in own if remark not in remarks]
    marks = "".join(f" [{remarks.index(remark) + 1}]" for remark in own)
    is_ratio = ours is not None and ours.value > 0.0 and item.quantity != "angle"
    return (
        f"{shown.label}, {place_text(place, item.quantity)} ({shown.unit}){marks}",
        item.figure,
        as_printed(item.value, item.quantity),
        value_with_interval(ours, item.quantity),
        between(*ours.draws, item.quantity) if ours is not None and ours.draws else "–",
        between(*ours.first, item.quantity) if ours is not None and ours.first else "–",
        readable(item.value / ours.value) if ours is not None and is_ratio else "–",
        str(standing(item, ours)),
    )


def ratios_table(evidence: Evidence) -> Table:
    """Ratios between printed depths, which do not hang on K_d / b."""
    rows = []
    for part in depth_ratios():
        printed = part.printed
        assert printed is not None, "only printed depths are compared"
        ours = compared(evidence, BASE, part)
        quotient = readable(printed / ours.value) if ours is not None else "–"
        rows.append(
            (
                compared_text(part),
                readable(printed),
                ratio_text(ours),
                quotient,
                str(ratio_standing(printed, ours)),
            )
        )
    head = ("ratio of deepest wears", "paper", "ours (95 % interval)", "paper / ours", "")
    return Table(head, (("", tuple(rows)),), numeric=False)


def ranges_table(evidence: Evidence) -> Table:
    """Printed ranges of wear: how much of our wear lies inside."""
    rows = []
    for item in RANGES:
        arcs = ", ".join(
            f"{math.degrees(low):.4g}° to {math.degrees(high):.4g}°" for low, high in item.arcs
        )
        width = sum(math.degrees(high - low) for low, high in item.arcs)
        for setting in ("friction-0.05", "friction-0.1"):
            ours = evidence.wear_map(BASE, setting, item.joint, 1)
            inside = "–" if ours is None else f"{readable(100.0 * _inside(ours, item.arcs))} %"
            rows.append(
                (
                    f"joint {item.joint}, {SETTINGS[setting][0]}",
                    item.figure,
                    arcs,
                    f"{width / 3.6:.3g} %",
                    inside,
                )
            )
    head = ("main wear area", "Fig.", "paper", "part of the circle", "part of our wear inside")
    return Table(head, (("", tuple(rows)),), numeric=False)


def _inside(ours: WearMap, arcs: tuple[tuple[float, float], ...]) -> float:
    """Part of the depth, summed over the angle, that lies in some arcs."""
    within = np.zeros(ours.angle.size, dtype=bool)
    for low, high in arcs:
        within |= (ours.angle >= low) & (ours.angle <= high)
    return float(ours.mean[within].sum() / ours.mean.sum())
