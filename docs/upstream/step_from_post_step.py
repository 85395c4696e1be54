"""DOPRI5 ignores a step size that is set in PostStep, because it selects the step before the call.

The implicit solvers use it.
"""

import itertools
import sys

import exudyn as exu

WANTED = [1e-3, 7e-4, 9e-4, 5e-4, 8e-4]


def steps_of(kind) -> list[float]:
    """Return the step sizes of a solver if PostStep sets those of WANTED."""
    container = exu.SystemContainer()
    system = container.AddSystem()
    node = system.AddNode({"nodeType": "Point", "initialVelocities": [1.0, 0.0, 0.0]})
    system.AddObject({"objectType": "MassPoint", "mass": 1.0, "nodeNumber": node})
    times = []

    def post_step(mbs, t):
        times.append(t)
        if len(times) <= len(WANTED):
            mbs.sys["dynamicSolver"].it.currentStepSize = WANTED[len(times) - 1]
        return len(times) <= len(WANTED)

    system.SetPostStepUserFunction(post_step)
    system.Assemble()
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.automaticStepSize = True
    settings.timeIntegration.numberOfSteps = 10
    settings.timeIntegration.endTime = 1.0
    settings.timeIntegration.initialStepSize = 1e-4
    system.SolveDynamic(settings, solverType=kind)
    return [round(b - a, 9) for a, b in itertools.pairwise(times)]


implicit = steps_of(exu.DynamicSolverType.TrapezoidalIndex2)
explicit = steps_of(exu.DynamicSolverType.DOPRI5)
print(f"asked for {WANTED}\nimplicit  {implicit}\nexplicit  {explicit}")
sys.exit(explicit[:3] == WANTED[:3])
