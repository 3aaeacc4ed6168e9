"""Tables by name, one a file: a function of the file's name whose arguments are lengths, each with a number of its own.

Nothing else has to hear of a new file: commands, scene files, `PinballMap` and reports take its name from the folder.
"""

import pkgutil

NAMES: tuple[str, ...] = tuple(sorted(module.name for module in pkgutil.iter_modules(__path__)))
