"""Study of the paper: all scenes, printed numbers, claims and figures (some minutes).

Run:  python scenarios/paper.py
"""

from presswear.paper import run_paper

if __name__ == "__main__":
    answer, report = run_paper("results/paper", engine="dae")
    print(f"{answer}\nreport: {report}")
