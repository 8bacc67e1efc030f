"""``python -m sag`` is the same as the console script ``sag``."""

from sag.cli import main

if __name__ == "__main__":
    raise SystemExit(main())
