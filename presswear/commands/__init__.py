"""The commands, one module each or one for a close pair; the only part that prints.

Every module has ``add(commands)``, which adds its parsers.  Exudyn, matplotlib and what
needs them are imported inside the functions that run a command: a wrong option is
answered, and the scenes are listed, without waiting for them.
"""
