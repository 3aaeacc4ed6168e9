"""Fixtures: the independent certificate checker and the scripts beside it, loaded from their files."""

import importlib.util
import sys
from types import ModuleType

import pytest
from committed import FOLDER


def loaded(name: str) -> ModuleType:
    """A script of the folder as a module under its own name, loaded once."""
    if name not in sys.modules:
        spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
        sys.modules[name] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(sys.modules[name])
    return sys.modules[name]


@pytest.fixture(scope="session")
def check() -> ModuleType:
    return loaded("check")


@pytest.fixture(scope="session")
def printed(check) -> ModuleType:
    return loaded("printed")


@pytest.fixture(scope="session")
def make() -> ModuleType:
    return loaded("make")


@pytest.fixture(scope="session")
def long(check) -> ModuleType:
    """The module that proves cycles of many bounces."""
    return check.beside("long")


@pytest.fixture(scope="session")
def crisis(check) -> ModuleType:
    """The module that proves boundary crises and branches of saddles."""
    return check.beside("crisis")
