"""Bottom dead centre at 80 % and at full speed, without and with work (GB/T 29548-2024).

Run:  python scenarios/bottom.py [SCENE or FILE.toml]
"""

import sys

import presswear as pw
from presswear.cli.terminal import load_scene
from presswear.show.page import text_of


def main(name: str = "press-blanking", cycles: int = 12, replicates: int = 4) -> None:
    settings = {"wear_updates": 0, "cycles": cycles, "replicates": replicates}
    scene, stages = pw.changed(load_scene(name), settings), []
    assert isinstance(scene.mechanism, pw.Press | pw.SliderCrank)
    print("µm, 95 % intervals: error | range of strokes | change since the first row")
    for process in ("none", scene.process.kind) if scene.process else ("none",):
        for part in (0.8, 1.0):
            slower = {"process": process, "speed": part * scene.mechanism.speed}
            stages.append(pw.run(pw.changed(scene, slower), engine="dae").stages[0])
            bottom = stages[-1].bdc
            values = bottom.error, bottom.range, pw.results.rise(stages[-1], stages[0])
            texts = " | ".join(text_of(value, "µm") for value in values)
            print(f"work {process}, {part:.0%} of the speed: {texts}")


if __name__ == "__main__":
    main(sys.argv[1] if sys.argv[1:] else "press-blanking")
