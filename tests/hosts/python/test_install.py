"""Installed packages: from the tree and from the source archive, into an environment of its own."""
import os
import re
import shutil
import subprocess
import sys
import venv
from pathlib import Path

import pytest

TREE = Path(os.environ["ILAW_SOURCE"])
USE = "import ilaw; print(ilaw.__version__, ilaw.Interface('coulomb', friction=0.3))"


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    """A copy of the package, since building writes beside the sources."""
    copy = tmp_path_factory.mktemp("tree") / "python"
    shutil.copytree(TREE / "api/python", copy, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info", "build"))
    return copy


def archive(package, folder):
    name = "from setuptools import build_meta; print(build_meta.build_sdist(%r))" % str(folder)
    done = subprocess.run([sys.executable, "-c", name], cwd=package, check=True, capture_output=True, text=True)
    return folder / done.stdout.split()[-1]


@pytest.mark.parametrize("source", ["tree", "archive"])
def test_pip_installs(package, source, tmp_path):
    what = package if source == "tree" else archive(package, tmp_path)
    home = tmp_path / "environment"
    venv.create(home, system_site_packages=True, with_pip=False)
    python = home / "bin/python"
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    install = [python, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--no-build-isolation", what]
    subprocess.run(install, check=True, env=environment)
    used = subprocess.run([python, "-c", USE], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert used.returncode == 0, used.stderr
    assert (home / "lib").is_dir() and list(home.glob("lib/python3*/site-packages/ilaw/py.typed"))
    version = re.search(r"project\(ilaw VERSION (\S+)", (TREE / "CMakeLists.txt").read_text())[1]
    assert used.stdout.startswith(version + " <ilaw.Interface coulomb")


def test_a_missing_loader_is_named(tmp_path):
    environment = {**os.environ, "ILAW_LOADER": str(tmp_path / "none.so")}
    used = subprocess.run([sys.executable, "-c", USE], env=environment, capture_output=True, text=True)
    assert used.returncode == 1
    assert "ilaw.errors.NotFound: libilaw_loader.so.1 cannot be loaded" in used.stderr
    assert str(tmp_path / "none.so") in used.stderr and "ILAW_LOADER" in used.stderr


def test_the_loader_is_found_in_the_environment(tmp_path):
    home = tmp_path / "environment"
    venv.create(home, system_site_packages=True, with_pip=False)
    (home / "lib/libilaw_loader.so.1").symlink_to(os.environ["ILAW_LOADER"])
    environment = {name: value for name, value in os.environ.items() if name != "ILAW_LOADER"}
    used = subprocess.run([home / "bin/python", "-c", USE], env=environment, capture_output=True, text=True)
    assert used.returncode == 0, used.stderr
