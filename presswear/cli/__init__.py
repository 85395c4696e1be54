"""Commands; each module is imported when its command is called."""

COMMANDS = {  # module and line of help
    "list": ("scenes", "list the scenes, or the settings of one scene"),
    "new": ("scenes", "write an example file that describes a mechanism"),
    "show": ("scenes", "draw the mechanism of a scene or a file with labels"),
    "run": ("run", "run a scene and write its result folder and report"),
    "life": ("life", "service life: strokes until a limit is exceeded, with an interval"),
    "sweep": ("sweep", "run a scene at many points, on this machine or on a cluster"),
    "dynamics": ("dynamics", "contact modes, periods, exponents and bifurcation diagrams"),
    "report": ("report", "write the figures and the report of a run or a sweep again"),
    "replay": ("replay", "play a stored run, or write it as a film or a picture"),
    "export": ("export", "write the motion of a run, or the rows of a sweep, as a table"),
    "crosscheck": ("crosscheck", "compare two engines, or a run with another program"),
    "verify": ("verify", "compare the engines with published results and hard cases"),
    "benchmark": ("benchmark", "measure speed against error, and the cost of each feature"),
    "completion": ("completion", "print a script for completion in a shell"),
}
