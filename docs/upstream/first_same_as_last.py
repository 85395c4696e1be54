"""DOPRI5 evaluates the right-hand side seven times per step; six are sufficient.

The state of its seventh stage is the end of the step, which is the first stage of the
next step.
"""

import itertools
import sys

import exudyn as exu

container = exu.SystemContainer()
system = container.AddSystem()
calls = []


def force(mbs, t, item, q, q_t):
    """Store the time of each call."""
    calls.append(t)
    return [-q[0]]


node = system.AddNode(
    {
        "nodeType": "GenericODE2",
        "numberOfODE2Coordinates": 1,
        "referenceCoordinates": [0.0],
        "initialCoordinates": [1.0],
        "initialCoordinates_t": [0.0],
    }
)
system.AddObject(
    {
        "objectType": "GenericODE2",
        "nodeNumbers": [node],
        "massMatrix": [[1.0]],
        "forceUserFunction": force,
    }
)
system.Assemble()
settings = exu.SimulationSettings()
settings.solution.file.write = False
settings.timeIntegration.verboseMode = 0
settings.timeIntegration.automaticStepSize = False
settings.timeIntegration.numberOfSteps = 100
settings.timeIntegration.endTime = 1.0
settings.timeIntegration.explicit.computeEndOfStepAccelerations = False
system.SolveDynamic(settings, solverType=exu.DynamicSolverType.DOPRI5)
twice = sum(one == other for one, other in itertools.pairwise(calls))
print(f"{len(calls)} evaluations in 100 steps; at {twice} instants twice in a row")
sys.exit(len(calls) < 650)
