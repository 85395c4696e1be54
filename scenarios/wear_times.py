"""The paper's central study: the press with clearance at A and C, worn twice.

Run:  python scenarios/wear_times.py
"""

from dataclasses import replace
from pathlib import Path

from presswear.campaign.campaign import Stage, Watcher, run_campaign
from presswear.results.folder import ResultFolder
from presswear.results.result import load
from presswear.scene.catalog import wear_times
from presswear.show.report import write_report


def main() -> None:
    scene = replace(wear_times(), cycles=5)
    folder = ResultFolder(Path("results/wear-times-script"), scene)

    def finished(stage: Stage) -> None:
        folder.add(stage)
        for name, joint in stage.statistics["joints"].items():
            print(
                f"after {stage.index} wears: joint {name} peak force {joint['force_max_N']:.0f} N, "
                f"worn volume of the next wear {1e9 * joint['wear_volume_m3']:.3g} mm^3"
            )

    folder.close(*run_campaign(scene, Watcher(stage=finished, keep=folder.keep)))
    print("report:", write_report(load(folder.path)))


if __name__ == "__main__":
    main()
