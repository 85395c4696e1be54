"""The commands of the command line; each is imported when it is called."""

COMMANDS = {
    "list": ("scenes", "the scenes, one line each; or everything that can be set in one"),
    "new": ("scenes", "write a file that describes a mechanism, to begin with"),
    "show": ("scenes", "draw the mechanism of a scene or a file, labelled"),
    "run": ("run", "run a scene and write its folder and report"),
    "life": ("life", "how many strokes until a limit is passed, and how sure that is"),
    "sweep": ("sweep", "a scene at many points, on this machine or a cluster"),
    "dynamics": ("dynamics", "modes of contact, periods, exponents and bifurcation diagrams"),
    "report": (
        "run",
        "figures and report anew from the folder of a run or a sweep",
    ),
    "replay": ("replay", "play a stored run in the Exudyn renderer, or make a film or a still"),
    "export": ("export", "write the motion of a run, or the rows of a sweep, for other programs"),
    "crosscheck": ("crosscheck", "engine against engine, or a run against a solver of yours"),
    "verify": ("verify", "both engines against published references; --hard: on hard cases"),
    "benchmark": ("benchmark", "speed against error of every engine; cost of each feature"),
    "completion": ("completion", "a script by which a shell completes commands and options"),
}
"""Module and one line of help of each command."""
