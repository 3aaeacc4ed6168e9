"""`python -m verification` is `pinball`."""

import gc
import sys


def main() -> int:
    """Runs `pinball` and returns its exit status: 130 after Ctrl-C, also while the program is being loaded."""
    try:
        from verification.app.cli import main as pinball

        return pinball()
    except KeyboardInterrupt:
        sys.stderr.write("pinball: interrupted\n")
        return 130
    finally:
        gc.freeze()  # at its end Python would search all objects of SymPy for cycles, which takes seconds


if __name__ == "__main__":
    sys.exit(main())
