"""Extent of a study of speed against error: its steps, tolerances and lengths."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Rungs:
    """Steps and tolerances of the families, coarse to fine.

    The setting that a scene takes by itself is added to its family where it is missing.

    Attributes
    ----------
    free_steps : tuple of int
        Steps in the run of the trapezoidal rule on smooth motion.
    smooth_steps : tuple of int
        Steps in the run of RK4 on smooth motion.
    impact_steps : tuple of int
        Steps in an impact of the trapezoidal rule with contacts.
    fixed_steps, contact_steps : tuple of float
        Equal steps of the trapezoidal rule and of RK4 with contacts, s.
    tolerances : tuple of float
        Those of DOP853 and DOPRI5 in the in-house solver.
    tree_tolerances : tuple of float
        Those of the open tree.
    """

    free_steps: tuple[int, ...]
    smooth_steps: tuple[int, ...]
    impact_steps: tuple[int, ...]
    fixed_steps: tuple[float, ...]
    contact_steps: tuple[float, ...]
    tolerances: tuple[float, ...]
    tree_tolerances: tuple[float, ...]


FEW = Rungs(
    free_steps=(300, 1000, 3000),
    smooth_steps=(300, 1000, 3000, 10_000),
    impact_steps=(20, 50, 100, 200),
    fixed_steps=(1e-5, 5e-6, 2e-6),
    contact_steps=(5e-5, 2e-5, 1e-5, 5e-6, 2e-6, 1e-6),
    tolerances=(1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-12),
    tree_tolerances=(1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10),
)
"""For a quick look."""
ALL = Rungs(
    free_steps=(300, 1000, 3000, 10_000, 30_000, 100_000),
    smooth_steps=(150, 300, 1000, 3000, 10_000, 30_000, 100_000),
    impact_steps=(20, 35, 50, 100, 200, 400, 800),
    fixed_steps=(1e-5, 5e-6, 2e-6, 1e-6, 5e-7),
    contact_steps=(5e-5, 2e-5, 1e-5, 5e-6, 2e-6, 1e-6, 5e-7, 2e-7, 1e-7),
    tolerances=(1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12),
    tree_tolerances=(1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11),
)


@dataclass(frozen=True)
class PrecisionExtent:
    """Extent of a study of speed against error.

    Attributes
    ----------
    quick : bool
        True where statistics and wear are studied in short as well.
    repeats : int
        How often each method is timed.
    rungs : Rungs
        Steps and tolerances.
    longest : float
        Longest horizon up to which trajectories are compared, s.
    """

    quick: bool
    repeats: int
    rungs: Rungs
    longest: float


QUICK = PrecisionExtent(quick=True, repeats=5, rungs=FEW, longest=0.05)
"""A few steps and tolerances of each family."""
FULL = PrecisionExtent(quick=False, repeats=5, rungs=ALL, longest=1.0)
