"""Command line and pictures of the cases of this folder."""
# SPDX-License-Identifier: BSD-3-Clause
import argparse
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams.update({"svg.hashsalt": "ilaw", "axes.spines.top": False, "axes.spines.right": False})


def parser_of(doc, runs_scenes=True):
    """Options that all cases have; runs_scenes: the case needs the program ilaw."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    if runs_scenes:
        parser.add_argument("program", metavar="ILAW", type=lambda file: Path(file).resolve())
    parser.add_argument("--picture", metavar="FILE", type=Path)
    return parser


def save(figure, file):
    """The same bytes from the same numbers."""
    figure.tight_layout()
    figure.savefig(file, dpi=100, metadata={"Date": None} if file.suffix == ".svg" else {"Software": None})
