"""Tables by name: each file holds a function of the file's name, whose arguments are lengths with default values.

Commands, scene files, `PinballMap` and reports find a new file by themselves: they take the names from the folder.
"""

import os

NAMES: tuple[str, ...] = tuple(
    sorted(
        name.removesuffix(".py")
        for name in os.listdir(__path__[0])  # noqa: PTH208  (pathlib takes 3 ms to import, pkgutil one)
        if name.endswith(".py") and not name.startswith("_")
    )
)
