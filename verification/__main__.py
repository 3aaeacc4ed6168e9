"""`python -m verification` is `pinball`."""

import sys

from verification.cli import main

sys.exit(main())
