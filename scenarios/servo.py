"""Plain blanking beside the same press with a servo at crank 7: means with 95 % half widths.

Run:  python scenarios/servo.py
"""

import presswear as pw

ROWS = ("error_per_cycle_m", "force_max_per_cycle_N", "dose_per_cycle_Nm")


def main(cycles: int = 7, replicates: int = 4) -> None:
    for name in ("press_blanking", "press_servo_dwell", "press_servo_forming", "press_pendulum"):
        make = getattr(pw.scenes, name)
        scene = make(wear_updates=0, cycles=cycles, replicates=replicates)
        stage = pw.run(scene, engine="dae").stages[0]
        ideal = pw.run(
            make(joints="none", wear_updates=0, replicates=1, cycles=1, drive_torque="on")
        )
        torques = abs(ideal.stages[0].arrays["drive_torque"]).max(axis=0)
        speed = abs(scene.ideal.velocity[:, scene.mechanism.linkage().index("crank 7"), 2]).max()
        print(f"{scene.title}\n  ideal: stroke {scene.stroke:.4f} m, torques of cranks 2 and 7 "
              f"up to {torques} N m, crank 7 up to {speed:.2f} rad/s")  # fmt: skip
        told = {"bottom": stage.bdc, **{name: own.statistics for name, own in stage.joints.items()}}
        for place, own in told.items():
            for row in own.keys() & set(ROWS):
                half = own[row]["half_width"] or float("nan")
                print(f"  {place} {row}: {own[row]['mean']:.4g} ± {half:.2g}")
        print(f"  bottom standard_deviation_m: {stage.bdc['standard_deviation_m']}")


if __name__ == "__main__":
    main()
