"""DOPRI5 repeats a step forever if its error is too large at the smallest step size.

The implicit solvers end with an error in this case.
"""

import sys

import exudyn as exu

MOST = 100_000
container = exu.SystemContainer()
system = container.AddSystem()
calls = 0


def force(mbs, t, item, q, q_t):
    """Return a force that no step size resolves."""
    global calls
    calls += 1
    if calls > MOST:
        raise RuntimeError("still at it")
    return [1e12 * (-1.0) ** calls]


node = system.AddNode(
    {
        "nodeType": "GenericODE2",
        "numberOfODE2Coordinates": 1,
        "referenceCoordinates": [0.0],
        "initialCoordinates": [0.0],
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
settings.timeIntegration.automaticStepSize = True
settings.timeIntegration.numberOfSteps = 100
settings.timeIntegration.endTime = 1.0
settings.timeIntegration.minimumStepSize = 1e-6
settings.timeIntegration.absoluteTolerance = 1e-8
settings.timeIntegration.relativeTolerance = 0.0
exu.config.printToConsole = False
try:
    system.SolveDynamic(settings, solverType=exu.DynamicSolverType.DOPRI5)
except (exu.ExudynError, RuntimeError) as error:
    if calls > MOST:
        print(f"{MOST} evaluations without a way on, until they were stopped")
        sys.exit(0)
    print(f"ended by itself after {calls} evaluations: {error}")
sys.exit(1)
