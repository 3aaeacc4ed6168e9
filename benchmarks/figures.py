"""Seconds per figure at draft resolution, data and drawing apart, and their total.

    python benchmarks/figures.py [RESOLUTION]

The bar: all of them within 3 minutes on two cores. A resolution of 8 is that of `pinball figure --full`.
"""

import sys
import time

from verification.paper.figures.catalogue import DRAFT, pictures

BAR = 180.0  # seconds


def main() -> int:
    """Prints a line for each figure and the total beside the bar."""
    fine = float(sys.argv[1]) if len(sys.argv) > 1 else DRAFT
    total = 0.0
    sys.stdout.write(f"{'figure':<26}{'data':>8}{'drawing':>9}   seconds, at resolution {fine:g}\n")
    for picture in pictures().values():
        start = time.perf_counter()
        panels = picture.data(fine)
        computed = time.perf_counter()
        picture.image(panels, ".png")
        end = time.perf_counter()
        total += end - start
        sys.stdout.write(f"{picture.name:<26}{computed - start:>8.2f}{end - computed:>9.2f}\n")
    sys.stdout.write(f"{'all':<26}{total:>8.1f}            {total / BAR:.2f} of the bar of {BAR:.0f} s\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
