"""Bottom dead centre at 80 % and at full speed, without work and with it (as GB/T 29548-2024 asks).

Run:  python scenarios/bottom.py [SCENE or FILE.toml]
"""

import sys

import presswear as pw
from presswear.cli.terminal import scene_given
from presswear.scene.settings import changed, settings_of
from presswear.show.report.bottom import bottom_between, bottom_mean, risen


def main(name: str = "press-blanking", cycles: int = 12, replicates: int = 4) -> None:
    scene = changed(
        scene_given(name), {"wear_updates": 0, "cycles": cycles, "replicates": replicates}
    )
    speed = {own.key: own.value for own in settings_of(scene)}[
        "speed"
    ]  # of a press or slider-crank
    ran, texts = [], (bottom_mean("error", 1e6), bottom_between("range", 1e6))
    print("µm, 95 % intervals: over the ideal | range of strokes | risen since the first row")
    for process in ("none", scene.process.kind) if scene.process else ("none",):
        for part in (0.8, 1.0):
            own = changed(scene, {"process": process, "speed": part * speed})
            ran.append(pw.run(own, engine="dae").stages[0])
            told = *(text(ran[-1]) for text in texts), risen(ran[-1], ran[0])
            print(f"work {process}, {part:.0%} of the speed: {' | '.join(told)}")


if __name__ == "__main__":
    main(sys.argv[1] if sys.argv[1:] else "press-blanking")
