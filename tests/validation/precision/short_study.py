"""A study so small that tests can afford it."""

from presswear.validation.precision.methods import Rungs
from presswear.validation.precision.study import PrecisionExtent

SHORT = PrecisionExtent(
    quick=True,
    repeats=2,
    rungs=Rungs(
        free_steps=(150, 300, 600),
        smooth_steps=(150, 300, 600),
        impact_steps=(25, 50, 100),
        fixed_steps=(1e-5,),
        contact_steps=(2e-5, 1e-5),
        tolerances=(1e-6, 1e-9),
        tree_tolerances=(1e-5, 1e-7),
    ),
    longest=0.025,
)
"""Long enough for the paper's step to blow up, at 0.0217 s."""


def silent(name: str, part: float) -> None:
    """No progress."""
