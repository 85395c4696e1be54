"""Blanking press without and with a servo motor at crank 7: means with 95 % half widths.

Run:  python scenarios/servo.py
"""

import presswear as pw

SCENES = (
    "press_blanking",
    "press_servo_dwell",
    "press_servo_forming",
    "press_pendulum",
)


def main(
    scenes: tuple[str, ...] = SCENES, cycles: int = 7, replicates: int = 4
) -> None:
    for name in scenes:
        make = getattr(pw.scenes, name)
        scene = make(wear_updates=0, cycles=cycles, replicates=replicates)
        stage = pw.run(scene, engine="dae").stages[0]
        settings = {
            "joints": "none",
            "replicates": 1,
            "cycles": 1,
            "drive_torque": "on",
        }
        ideal = pw.run(make(wear_updates=0, **settings))
        torques = abs(ideal.stages[0].arrays["drive_torque"]).max(axis=0)
        speed = abs(
            scene.ideal.velocity[:, scene.mechanism.linkage().index("crank 7"), 2]
        ).max()
        print(f"{scene.title}\n  ideal: stroke {scene.stroke:.4f} m, torques of cranks 2 and 7 "
              f"up to {torques} N m, crank 7 up to {speed:.2f} rad/s")  # fmt: skip
        rows = {"error of bottom dead centre, m": stage.bdc.error}
        for name, joint in stage.statistics.joints.items():
            rows[f"peak force of a cycle at {name}, N"] = joint.peak_force_per_cycle
            rows[f"load distance of a cycle at {name}, N m"] = (
                joint.load_distance_per_cycle
            )
        for label, row in rows.items():
            print(f"  {label}: {row.mean:.4g} ± {row.half_width or float('nan'):.2g}")
        print(
            f"  standard deviation of bottom dead centre, m: {stage.bdc.standard_deviation}"
        )


if __name__ == "__main__":
    main()
