"""Tables by name, one a file: a function of the file's name whose arguments are lengths, each with a number of its own.

Nothing else has to hear of a new file: commands, scene files, `PinballMap` and reports take its name from the folder.
"""

import os

NAMES: tuple[str, ...] = tuple(
    sorted(
        name.removesuffix(".py")
        for name in os.listdir(__path__[0])  # noqa: PTH208  (pathlib takes 3 ms to import, pkgutil one)
        if name.endswith(".py") and not name.startswith("_")
    )
)
