"""Words for things of machines that presswear does not model, with what it has instead.

A user who types such a word gets the answer in place of "unknown key".
"""

import re

PAGE = "docs/theory/not-modelled.md"

# What is not modelled, and what there is instead, by the words that users type
NOT_MODELLED = {
    ("gear", "tooth", "teeth", "backlash", "pinion"): (
        "gears with teeth and play; a motor has a ratio"
    ),
    ("cam", "follower", "tappet"): (
        "cams; a servo drive follows a motion over the crank angle"
    ),
    ("slot", "yoke", "scotch"): "slots; joints are pins and straight guides",
    ("ball", "spherical", "screw", "thread"): (
        "ball joints and screws; joints are pins and straight guides"
    ),
    ("belt", "chain", "clutch", "brake"): (
        "belts, chains, clutches and brakes; a motor has a slip and an inertia"
    ),
    ("grease", "starved", "starvation"): (
        "grease and starved bearings; such a bearing is nearer to a dry one"
    ),
    ("temperature", "heat", "thermal", "cooling"): (
        "heat; the viscosity is that at running temperature"
    ),
    ("bending", "flexible", "buckling", "beam", "fem"): (
        "bending of links; a pin has a stiffness, and the frame of a mechanism, too"
    ),
    ("3d", "spatial", "misalignment", "tilting"): (
        "motion out of the plane; all motion is in one plane"
    ),
    ("fatigue", "crack", "fretting", "corrosion"): (
        "fatigue, fretting and corrosion; wear is that of Archard"
    ),
    ("hydraulic", "pneumatic", "voltage", "current", "winding"): (
        "hydraulic and electric transients; a motor has a line of torque over speed"
    ),
    ("elastoplastic", "plastic", "yield", "hardness"): (
        "plastic deformation and hardness; contact is elastic, wear has a coefficient"
    ),
}


def not_modelled(name: str) -> str:
    """Return the sentence about a name with a word for something not modelled, or nothing."""
    words = re.findall(r"[a-z0-9]+", name.lower())
    singular = {word.removesuffix("s") for word in words} | set(words)
    for terms, answer in NOT_MODELLED.items():
        if not singular.isdisjoint(terms):
            return f"Not modelled: {answer}; see {PAGE}"
    return ""
