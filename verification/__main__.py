"""`python -m verification` is `pinball`."""

import sys

from verification.app.cli import main

sys.exit(main())
