"""Blanking with ever smaller clearances and stiffer joints: differences from the ideal press.

Run:  python tests/stiff_joints.py
"""

import numpy as np

import presswear as pw
from presswear.physics.inverse_dynamics import constraint_forces


def off(clearance: float, power: float = 0.75, **changes: str) -> dict[str, float]:
    joint = {
        "clearance": clearance,
        "contact_stiffness": 1e12 * (1e-4 / clearance) ** power,
    }
    scene = pw.scenes.press_blanking(
        **joint, friction=0.0, wear_updates=0, cycles=3, **changes
    )
    result = pw.run(scene, engine="dae")
    time = result.stages[0].time
    ideal = scene.ideal
    rows = time > 2.0 * ideal.period
    needed = constraint_forces(scene.loaded, ideal, time)
    places = {joint.name: 2 * k for k, joint in enumerate(scene.loaded.revolutes)}
    path = ideal.at(time).output(scene.linkage())[:, 0] - scene.bottom
    numbers = {"bottom (m)": result.stages[0].bdc.error.mean}
    numbers["slider (m)"] = np.abs(result.height(0) - path)[rows].max()
    for name, joint_result in result.stages[0].joints.items():
        ideal_force = needed[:, places[name] : places[name] + 2]
        force, without = (
            np.hypot(*some[rows].T) for some in (joint_result.force, ideal_force)
        )
        numbers[f"{name} peak (N)"] = force.max() - without.max()
        numbers[f"{name} mean (N)"] = (
            np.trapezoid(force - without, time[rows]) / ideal.period
        )
    for name, drive in result.drives(0).items():
        duty = drive.duty.torque
        without = drive.ideal.torque
        numbers[f"{name} peak (N m)"] = abs(duty.peak) - abs(without.peak)
        numbers[f"{name} rms (N m)"] = duty.rms - without.rms
    return numbers


def main(clearances: tuple[float, ...] = (1e-4, 1e-5, 1e-6, 1e-7)) -> None:
    table = [off(clearance) for clearance in clearances]
    for name in table[0]:
        values = [abs(row[name]) for row in table]
        order = np.polyfit(np.log(clearances), np.log(values), 1)[0]
        print(
            f"{name:20}"
            + "".join(f"{value:10.2g}" for value in values)
            + f"{order:8.2f}"
        )


if __name__ == "__main__":
    main()
