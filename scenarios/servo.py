"""Plain blanking beside the same press with a servo at crank 7: a table with 95 % half widths.

Run:  python scenarios/servo.py
"""

import numpy as np

import presswear as pw


def main(cycles: int = 12, starts: int = 4) -> None:
    for name in ("press_blanking", "press_servo_dwell", "press_servo_forming", "press_pendulum"):
        make = getattr(pw.scenes, name)
        scene = make(wears=0, cycles=cycles, starts=starts)
        stage = pw.run(scene, engine="dae").stages[0]
        ideal = pw.run(make(joints="none", wears=0, starts=1, cycles=1, drive_torque="on"))
        torque = np.abs(ideal.stages[0].arrays["drive_torque"]).max(axis=0)
        k = scene.mechanism.linkage().index("crank 7")
        speed = np.abs(scene.ideal.velocity[:, k, 2]).max()
        a, c = (stage.joints[joint].statistics for joint in "AC")
        wear = scene.bearings.materials.wear_coefficient / 1e-18  # um^3 per N m
        bdc = stage.bdc
        print(f"{name}: stroke {1e3 * scene.stroke:.1f} mm, crank 7 up to {speed:.2f} rad/s")
        print(f"  torque at most, ideal: {torque[0]:.1f} and {torque[1]:.1f} N m")
        for text, own, size in (
            ("bottom dead centre less ideal, um", bdc["error_per_cycle_m"], 1e6),
            ("peak force at A, N", a["force_max_per_cycle_N"], 1.0),
            ("peak force at C, N", c["force_max_per_cycle_N"], 1.0),
            ("worn at A in a stroke, um^3", a["dose_per_cycle_Nm"], wear),
            ("worn at C in a stroke, um^3", c["dose_per_cycle_Nm"], wear),
        ):
            half = own["half_width"]
            print(f"  {text}: {size * own['mean']:.4g} ± {np.nan if half is None else size * half:.2g}")
        print(f"  repeatability, um: {1e6 * (bdc['standard_deviation_m'] or np.nan):.3g}")


if __name__ == "__main__":
    main()
