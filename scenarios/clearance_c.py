"""The press with clearance at C alone, unworn.

Run:  python scenarios/clearance_c.py
"""

from pathlib import Path

from presswear.campaign.campaign import Watcher, run_campaign
from presswear.results.folder import ResultFolder
from presswear.results.result import load
from presswear.scene.catalog import clearance_c
from presswear.show.report import write_report


def main() -> None:
    scene = clearance_c()
    folder = ResultFolder(Path("results/clearance-c-script"), scene)
    folder.close(*run_campaign(scene, Watcher(stage=folder.add, keep=folder.keep)))
    result = load(folder.path)
    numbers = result.stages[0].statistics
    peak = numbers["joints"]["C"]["force_max_N"]
    print(f"slider acceleration up to {numbers['slider']['acceleration_max_m_s2']:.0f} m/s^2")
    print(f"joint C: peak force {peak:.0f} N")
    print("report:", write_report(result))


if __name__ == "__main__":
    main()
