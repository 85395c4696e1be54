"""Run the paper's study: ``python -m presswear.paper FOLDER``."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import presswear as pw
from presswear.paper import run_paper


def main(arguments: Sequence[str] | None = None) -> int:
    """Read the command line and run the study; return the exit code."""
    parser = argparse.ArgumentParser("python -m presswear.paper", description=__doc__)
    parser.add_argument(
        "folder", type=Path, help="folder of all runs; an interrupted study resumes"
    )
    parser.add_argument("--engine", help="exudyn (default) or dae")
    parser.add_argument("--jobs", type=int, help="runs at a time (default: all cores)")
    parser.add_argument(
        "--quick", action="store_true", help="run four cycles of each stage"
    )
    try:
        answer, report = run_paper(**vars(parser.parse_args(arguments)))
    except pw.InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted: the same command resumes", file=sys.stderr)
        return 130
    print(f"{answer}\nreport: {report}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
