"""`python -m scenarios` is `sot`."""

import sys

from scenarios.cli import main

sys.exit(main())
