"""Waiting for what another program does."""

import sys
import time


def wait_until(what, condition, patience_s=25):
    """Ends the test where the condition does not hold in time."""
    give_up = time.monotonic() + patience_s
    while not condition():
        if time.monotonic() > give_up:
            sys.exit(f"{what}: not within {patience_s} s")
        time.sleep(0.02)
