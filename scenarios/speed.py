"""Two speeds, one wear (paper, sections 5.3.3 and 5.4.3).

Run:  python scenarios/speed.py
"""

from dataclasses import replace
from pathlib import Path

from presswear.campaign.campaign import Stage, Watcher, run_campaign
from presswear.results.folder import ResultFolder
from presswear.results.result import load
from presswear.scene.catalog import speed, speed_high
from presswear.show.report import write_report


def main() -> None:
    for scene in (speed(), speed_high()):
        scene = replace(scene, cycles=10)
        folder = ResultFolder(Path("results") / f"{scene.name}-script", scene)

        def finished(stage: Stage, folder: ResultFolder = folder) -> None:
            folder.add(stage)
            for name, joint in stage.statistics["joints"].items():
                print(
                    f"{stage.linkage.drives[0].speed:.3g} rad/s, after "
                    f"{stage.index} wears: joint {name}, one wear is "
                    f"{1e6 * joint['wear_depth_max_both_m']:.1f} µm deep"
                )

        folder.close(*run_campaign(scene, Watcher(stage=finished, keep=folder.keep)))
        print("report:", write_report(load(folder.path)))


if __name__ == "__main__":
    main()
