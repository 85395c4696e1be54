"""Words for things of machines that presswear does not model, or has under another name.

A user who types such a word gets the answer in place of "unknown key".
"""

import re

PAGE = "docs/theory/not-modelled.md"

# What is not modelled, and what there is instead, by the words that users type
NOT_MODELLED = {
    ("gear", "tooth", "teeth", "backlash", "pinion", "rack", "worm", "planetary"): (
        "gears with teeth and play; two cranks have a leader and a ratio, a motor has a ratio"
    ),
    ("cam", "follower", "tappet"): (
        "cams; a servo drive follows a motion over the crank angle"
    ),
    ("roller", "rolling", "needle"): "rolling bearings; bearings are plain bearings",
    ("ball", "spherical", "screw", "thread"): (
        "ball bearings, ball joints and screws; joints are pins, straight guides and slots"
    ),
    ("belt", "pulley", "chain", "clutch", "brake"): (
        "belts, chains, clutches and brakes; a motor has a slip and an inertia"
    ),
    ("grease", "greased", "starved", "starvation"): (
        "grease and starved bearings; such a bearing is nearer to a dry one"
    ),
    ("temperature", "heat", "thermal", "cooling"): (
        "heat; the viscosity is that at running temperature"
    ),
    ("bending", "flexible", "flexibility", "buckling", "beam", "fem"): (
        "bending of links; a pin has a stiffness, and the frame of a mechanism, too"
    ),
    ("3d", "spatial", "plane", "axial", "thrust", "misalignment", "tilting"): (
        "motion out of the plane; all motion is in one plane"
    ),
    ("fatigue", "crack", "pitting", "fretting", "scuffing", "corrosion"): (
        "fatigue, fretting, scuffing and corrosion; wear is that of Archard"
    ),
    ("dirt", "debris", "particle", "abrasion"): (
        "particles between the surfaces; a wear coefficient can be that of a dirty joint"
    ),
    ("hydraulic", "pneumatic", "voltage", "current", "winding"): (
        "hydraulic and electric transients; a motor has a line of torque over speed"
    ),
    ("elastoplastic", "plastic", "yield", "hardness"): (
        "plastic deformation and hardness; contact is elastic, wear has a coefficient"
    ),
}


# What is modelled under another name: keys, or where it is described, by such words
OTHER_NAMES = {
    ("oil", "lubricant", "lubrication", "lubricated"): (
        "an oil film has a viscosity, and film = run takes it into the run"
    ),
    ("flywheel", "rotor"): "a flywheel is motor.inertia, on the shaft of the motor",
    ("fit", *(f"h{grade}" for grade in range(6, 12))): (
        "a fit is a clearance, such as clearance = 110 H8/f7"
    ),
    ("spring", "rubber"): (
        "a spring is in mechanism.springs of a mechanism of bodies; presswear new points"
    ),
    ("balancer", "counterbalance", "counterweight", "balance"): (
        "a slide on balancers has gravity = 0; their force is a spring or a load of a mechanism "
        "of bodies; presswear new points"
    ),
    ("bush", "bushing", "liner", "shell"): (
        "a bushing is a bearing: [bearings.JOINT] has its diameter, width, fit and materials"
    ),
    ("stroke", "strokes"): (
        "the stroke follows from the lengths, as twice the crank_length of an eccentric press"
    ),
    ("spm", "rpm"): "strokes a minute are the speed, such as speed = 50 spm",
    ("shim", "preload"): (
        "shims change the clearance at a count of strokes; presswear life --replace JOINT@STROKES"
    ),
    ("cylinder", "actuator"): (
        "a cylinder is a drive of a mechanism of bodies with along = the guide of its body"
    ),
    ("slot", "yoke", "scotch"): (
        "a slot is a guide of a mechanism of bodies with on = its body"
    ),
    ("play", "gap"): "the radial play of a pin is its clearance",
    ("tonnage", "load"): "the force of the work is process.force",
}


def not_modelled(name: str) -> str:
    """Return a sentence about a word for what is not modelled or named otherwise, or nothing."""
    words = re.findall(r"[a-z0-9]+", name.lower())
    singular = {word.removesuffix("s") for word in words} | set(words)
    for terms, answer in NOT_MODELLED.items():
        if not singular.isdisjoint(terms):
            return f"Not modelled: {answer}; see {PAGE}"
    for terms, answer in OTHER_NAMES.items():
        if not singular.isdisjoint(terms):
            return f"{answer[0].upper()}{answer[1:]}"
    return ""
