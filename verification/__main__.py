"""`python -m verification` is `pinball`."""

import sys

from verification.app.shell.cli import main

sys.exit(main())
