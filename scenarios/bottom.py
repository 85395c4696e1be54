"""Bottom dead centre at 80 % and at full speed, without work and with it (as GB/T 29548-2024 asks).

Run:  python scenarios/bottom.py [SCENE or FILE.toml]
"""

import sys

import presswear as pw
from presswear.cli.terminal import scene_given
from presswear.results.bottom import rise
from presswear.scene.settings import changed, settings_of
from presswear.show.page import text_of


def main(name: str = "press-blanking", cycles: int = 12, replicates: int = 4) -> None:
    scene = changed(
        scene_given(name), {"wear_updates": 0, "cycles": cycles, "replicates": replicates}
    )
    speed = {own.key: own.value for own in settings_of(scene)}[
        "speed"
    ]  # of a press or slider-crank
    stages = []
    print("µm, 95 % intervals: over the ideal | range of strokes | change since the first row")
    for process in ("none", scene.process.kind) if scene.process else ("none",):
        for part in (0.8, 1.0):
            own = changed(scene, {"process": process, "speed": part * speed})
            stage = pw.run(own, engine="dae").stages[0]
            stages.append(stage)
            values = stage.bdc.error, stage.bdc.range, rise(stage, stages[0])
            texts = " | ".join(text_of(value, "µm") for value in values)
            print(f"work {process}, {part:.0%} of the speed: {texts}")


if __name__ == "__main__":
    main(sys.argv[1] if sys.argv[1:] else "press-blanking")
