"""Tables of the printed numbers beside ours."""

import numpy as np

from presswear.paper.claims import DEPTH_RATIOS
from presswear.paper.evidence import Evidence
from presswear.paper.printed import PRINTED, RANGES, Place, Printed
from presswear.paper.variants import BASE, FRICTION, HIGH_FRICTION, SETTINGS
from presswear.paper.verdicts import Standing, agreement, compared, standing
from presswear.paper.words import (
    as_printed,
    between,
    compared_text,
    joint_text,
    place_text,
    ratio_text,
    value_text,
)
from presswear.show.page import Line, Table
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
_STAGE_NOT_SAID = "the paper does not say before or after which wear; both are shown"
_STARTS_DIFFER = "our starts differ by more than their cycles explain: the interval is over starts"


def _stages_of(item: Printed) -> list[Place]:
    """The stages of ours that a printed number is held against."""
    wear_updates = (0, 1) if item.stage_not_said else (item.place.wear_updates,)
    return [Place(item.place.setting, k, item.place.joint) for k in wear_updates]


def standings(evidence: Evidence) -> list[tuple[Printed, Standing]]:
    """How every printed number stands, by stage where the paper leaves it open."""
    return [
        (item, standing(item, evidence.measured(BASE, place, item.quantity)))
        for item in PRINTED
        for place in _stages_of(item)
    ]


def numbers_table(evidence: Evidence) -> tuple[Table, list[str]]:
    """Every printed number, by section, and the remarks that its rows refer to by number."""
    groups: dict[str, list[Line]] = {}
    remarks: list[str] = []
    for item in PRINTED:
        group = f"Section {item.section}: {SETTINGS[item.place.setting].label}"
        for place in _stages_of(item):
            groups.setdefault(group, []).append(_number_row(evidence, item, place, remarks))
    return Table(_HEAD, tuple((name, tuple(rows)) for name, rows in groups.items())), remarks


def _number_row(evidence: Evidence, item: Printed, place: Place, remarks: list[str]) -> Line:
    """A row; remarks that are new are put behind the others."""
    ours = evidence.measured(BASE, place, item.quantity)
    own = [part for part in item.misprint.split("; ") if part]
    if item.stage_not_said:
        own.append(_STAGE_NOT_SAID)
    if ours is not None and ours.differ:
        own.append(_STARTS_DIFFER)
    remarks += [remark for remark in own if remark not in remarks]
    marks = "".join(f" [{remarks.index(remark) + 1}]" for remark in own)
    quotient = None
    if ours is not None and ours.value > 0.0 and item.quantity != "angle":
        quotient = item.value / ours.value
    return (
        place_text(place, item.quantity) + marks,
        item.figure,
        as_printed(item.value, item.quantity),
        value_text(ours, item.quantity),
        between(ours.draws if ours else None, item.quantity),
        between(ours.first if ours else None, item.quantity),
        readable(quotient),
        str(standing(item, ours)),
    )


def ratios_table(evidence: Evidence) -> Table:
    """Ratios between printed depths, which do not hang on K_d / b."""
    rows = []
    for part in DEPTH_RATIOS:
        printed = part.printed
        assert printed is not None, "only printed depths are compared"
        ours = compared(evidence, BASE, part)
        rows.append(
            (
                compared_text(part),
                readable(printed),
                ratio_text(ours),
                readable(printed / ours.value if ours else None),
                str(agreement(printed, ours)),
            )
        )
    head = ("ratio of deepest wears", "paper", "ours (95 % interval)", "paper / ours", "")
    return Table(head, (("", tuple(rows)),), numeric=False)


def ranges_table(evidence: Evidence) -> Table:
    """Printed ranges of wear: how much of our wear lies inside."""
    rows = []
    for item in RANGES:
        arcs = np.degrees(item.arcs)
        for setting in (FRICTION, HIGH_FRICTION):
            place = Place(setting, 1, item.joint)
            ours = evidence.wear_map(BASE, place)
            inside = "–"
            if ours is not None:
                within = np.zeros(ours.angle.size, dtype=bool)
                for low, high in item.arcs:
                    within |= (ours.angle >= low) & (ours.angle <= high)
                part = float(ours.mean[within].sum() / ours.mean.sum())
                inside = f"{readable(100.0 * part)} %"
            rows.append(
                (
                    joint_text(place),
                    item.figure,
                    ", ".join(f"{low:.4g}° to {high:.4g}°" for low, high in arcs),
                    f"{np.diff(arcs).sum() / 3.6:.3g} %",
                    inside,
                )
            )
    head = ("main wear area", "Fig.", "paper", "part of the circle", "part of our wear inside")
    return Table(head, (("", tuple(rows)),), numeric=False)
