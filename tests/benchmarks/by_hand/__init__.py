"""The press written by hand: its equations, the accounts of a run, and an adaptive loop.

It is the measure of speed: it knows this mechanism only, keeps the accounts of the
engines, and shares no kernel with them.
"""
