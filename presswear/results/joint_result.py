"""Clearance joint in a stage: recorded series, contacts and wear maps."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from presswear.linkage.surface import SIDES, bin_centres
from presswear.physics.touchdown import CONTACT_COLUMNS
from presswear.recording.columns import (
    FILM_CYCLE,
    JOINT_ARRAYS,
    JOINT_CYCLE,
    JOINT_CYCLE_COUNT,
    JOINT_SERIES,
    Column,
    index_of,
    names_of,
)
from presswear.results.stage_statistics import JointStatistics
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, NotStored, unknown


@dataclass(frozen=True)
class JointResult:
    """Clearance joint in a stage."""

    name: str
    # None if the stage failed before a cycle was complete
    stored: JointStatistics | None
    # By their names in the file, without the name of the joint
    arrays: Mapping[str, Array] = field(repr=False)

    @property
    def statistics(self) -> JointStatistics:
        """Statistics of the joint; raises InputError if no cycle is complete."""
        if self.stored is None:
            raise InputError(f"joint {self.name}: no cycle of the stage is complete")
        return self.stored

    def _series(self, name: str) -> Array:
        if name not in self.arrays:
            has_series = any(series in self.arrays for series in JOINT_ARRAYS)
            advice = "run the scene again" if has_series else "use series = all"
            raise NotStored(f"joint {self.name}: its {name} was not stored; {advice}")
        return self.arrays[name]

    def series(self, name: str) -> Array:
        """Return a recorded series by a name of ``columns.JOINT_SERIES``, shape (n,); SI."""
        for array, names in JOINT_ARRAYS.items():
            if name in names:
                values = self._series(array)
                return values if len(names) == 1 else values[:, names.index(name)]
        raise unknown("series of a joint", name, names_of(JOINT_SERIES))

    @property
    def eccentricity(self) -> Array:
        """Pin centre minus bearing centre, shape (n, 2), m."""
        return self._series("eccentricity")

    @property
    def penetration(self) -> Array:
        """Penetration of the pin, shape (n,), m; negative while open."""
        return self._series("penetration")

    @property
    def force(self) -> Array:
        """Normal and tangential force, shape (n, 2), N."""
        return self._series("force")

    @property
    def sliding(self) -> Array:
        """Sliding speed at the contact, shape (n,), m/s."""
        return self._series("sliding")

    @property
    def angle(self) -> Array:
        """Angles of the bins of the wear maps, shape (bins,), rad."""
        return bin_centres(self.arrays["depth_bearing"].size)

    def contact(self, name: str) -> Array:
        """Return a quantity of each recorded contact, by a name of ``CONTACT_COLUMNS``; SI."""
        place = index_of("quantity of a contact", name, CONTACT_COLUMNS)
        return self.arrays["contacts"][:, place]

    def spans(self, clock: Array, end: float) -> Array:
        """Return touchdown and separation of all contacts, s, shape (k, 2).

        A contact is recorded at its separation. One that lasts beyond the recorded rows,
        which are those of ``clock``, separates at ``end``.
        """
        spans = np.column_stack([self.contact("touchdown"), self.contact("separation")])
        last = float(spans[-1, 1]) if len(spans) else float(clock[0])
        still_closed = clock[(clock > last) & (self.penetration > 0.0)]
        if still_closed.size:
            spans = np.append(spans, [[still_closed[0], end]], axis=0)
        return spans

    @property
    def cycle_columns(self) -> tuple[Column, ...]:
        """Columns of ``each_cycle``."""
        has_film = self.arrays["cycles"].shape[1] > JOINT_CYCLE_COUNT
        return (*JOINT_CYCLE, *FILM_CYCLE) if has_film else JOINT_CYCLE

    def each_cycle(self, name: str) -> Array:
        """Return a quantity of each cycle, shape (cycles,); SI.

        Its name is of ``JOINT_CYCLE``, or of ``FILM_CYCLE`` with an oil film in the run.
        """
        names = names_of(self.cycle_columns)
        place = index_of("quantity of a joint's cycle", name, names)
        return self.arrays["cycles"][:, place]

    def depth(self, side: str) -> Array:
        """Return the wear depth of ``bearing`` or ``pin`` in the stage, shape (bins,), m."""
        return self._of_side("depth", side)

    def wear(self, side: str) -> Array:
        """Return the depth that the next wear update adds to a side, shape (bins,), m."""
        return self._of_side("wear", side)

    def _of_side(self, name: str, side: str) -> Array:
        if side not in SIDES:
            raise unknown("side of a joint", side, SIDES)
        return self.arrays[f"{name}_{side}"]
