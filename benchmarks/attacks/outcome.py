"""The result of an attack, and a function that runs one in child processes that may die."""

import os
import random
import sys
from collections.abc import Callable
from typing import NamedTuple

Attack = Callable[[random.Random], None]


class Outcome(NamedTuple):
    """The number of attempts, the number of failures, and notes."""

    tried: int
    failed: int
    said: str = ""


def in_children(attack: Attack, executions: int, seed: int, batch: int) -> int:
    """Runs an attack many times, a batch in each forked child; returns how many children died or raised.

    A child that a signal kills is a failure like one that raises: its seed is printed.
    """
    failed = 0
    for first in range(0, executions, batch):
        child = os.fork()
        if child == 0:
            status = 1
            try:
                chance = random.Random(seed * 1_000_003 + first)
                for _ in range(min(batch, executions - first)):
                    attack(chance)
                status = 0
            except BaseException as error:  # whatever it is, the parent counts it
                sys.stderr.write(f"{type(error).__name__}: {error}\n")
            finally:
                os._exit(status)
        _, status = os.waitpid(child, 0)
        if status:
            failed += 1
            sys.stderr.write(f"the child with seed {seed * 1_000_003 + first} ended with {status}\n")
    return failed
