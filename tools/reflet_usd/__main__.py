"""`python -m reflet_usd`: the same commands as `reflet-usd`."""

from reflet_usd.cli import main

raise SystemExit(main())
