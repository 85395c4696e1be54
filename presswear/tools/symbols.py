"""Symbols of the paper and of the contact laws, by which settings are named, too."""

SYMBOLS = {
    "omega": "speed",
    "c": "clearance",
    "R_i": "bearing_radius",
    "b": "width",
    "E": "youngs_modulus",
    "nu": "poisson_ratio",
    "K_d": "wear_coefficient",
    "bins": "angles",
    "K": "contact_stiffness",
    "n": "exponent",
    "c_e": "restitution",
    "D": "viscous_damping",
    "c_f": "friction",
    "c_s": "static_friction",
    "v_0": "lower_speed",
    "v_1": "upper_speed",
    "v_s": "stribeck_speed",
    "sigma_0": "bristle_stiffness",
    "sigma_1": "bristle_damping",
}
