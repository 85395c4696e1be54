"""The command line: what commands there are, and how they end.

Exit codes: 0 success; 1 a run that failed; 2 bad input; 130 and 143 stopped by SIGINT and
SIGTERM.
"""

import sys
from collections.abc import Sequence
from importlib.metadata import version

from presswear.tools.errors import InputError, RunFailed, one_line
from presswear.tools.stopping import exit_code, is_stopped, stoppable


def main(argv: Sequence[str] | None = None) -> int:
    """Entry point of ``presswear`` and ``python -m presswear``; returns the exit code."""
    try:
        with stoppable():
            words = sys.argv[1:] if argv is None else argv
            if list(words) == ["--version"]:
                print(f"presswear {version('presswear')}")
                return 0
            # Imported when a signal is answered already.
            from presswear.commands.parser import parser_of

            arguments = parser_of(words).parse_args(words)
            from rich.console import Console

            from presswear.commands.logs import logged

            with logged("verbose" in arguments):
                return int(arguments.run(arguments, Console()))
    except InputError as error:
        _tell(str(error))
        return 2
    except RunFailed as error:
        _tell(str(error))
        return 1
    except OSError as error:
        _tell(f"{error.strerror}: {error.filename}")
        return 1
    except KeyboardInterrupt as error:
        _tell(str(error) if error.args else "interrupted")
        return exit_code()
    # Behind a signal any error is one of being stopped: see ``tools.stopping``.
    except Exception:
        if not is_stopped():
            raise
        _tell("interrupted")
        return exit_code()


def _tell(problem: str) -> None:
    print(one_line(f"presswear: {problem}"), file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
