"""Hypothesis profiles (no deadlines on shared machines, the same examples on every run of CI), fixtures."""

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

import slowness

settings.register_profile("default", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("ci", settings.get_profile("default"), derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") == "true" else "default")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--find-slow", action="store_true", help="measure which tests are slow; see slowness.py")


def pytest_configure(config: pytest.Config) -> None:
    if config.getoption("find_slow"):
        config.pluginmanager.register(slowness.Finder())


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    slowness.mark(items)


@pytest.fixture
def fakes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An installed package of solvers that misbehave; see ``bench_toys``."""
    from bench_toys import install

    site = install(tmp_path / "site")
    monkeypatch.syspath_prepend(str(site))
    monkeypatch.setenv("FAKE_PID", str(tmp_path / "pid"))
    yield site
    sys.modules.pop("fake_solvers", None)
