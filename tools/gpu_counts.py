#!/usr/bin/env python3
"""Writes the tables of docs/gpu.md: what the frames of docs/views.md read and write, and what rates
of GPUs make of their counts.

    tools/gpu_counts.py --assets DIR [--reflet PROGRAM]

Counts come from docs/data/views.csv, bytes from `reflet info --frame`, costs from docs/costs.md.
"""

import argparse
import csv
import json
import pathlib
import re
import subprocess
import tempfile
from typing import Any

import views
from measuring import add_program, program_of, table, write_tables

PAGE = views.ROOT / "docs" / "gpu.md"
COSTS = views.ROOT / "docs" / "costs.md"
PIXELS = 1280 * 720
SIZES = {"1280 × 720": 1, "1920 × 1080": 2.25, "3840 × 2160": 9}
# Passes whose work is for the pixels of a list, and which list.
LISTED = {"ssr": "listed", "hits": "accepted", "trace": "refused"}
NODE_BYTES, TRIANGLE_BYTES, STEP_BYTES = 80, 48, 4
# Memory bandwidth by the makers' data sheets, GB/s.
CARDS = {"GTX 780 Ti": 336, "RTX 4090": 1008, "H100 SXM": 3350}

Frame = dict[str, Any]


def frames(program: pathlib.Path, assets: pathlib.Path) -> dict[str, dict[str, list[Frame]]]:
    """Passes of each view by each method, as `info --frame` has them for GPUs."""
    found: dict[str, dict[str, list[Frame]]] = {}
    with tempfile.TemporaryDirectory() as folder:
        lamps = pathlib.Path(folder) / "eight-lamps.toml"
        lamps.write_text(views.eight_lamps())
        for view, (name, *changes) in views.VIEWS.items():
            scene = lamps if name == lamps.name else views.ROOT / name
            found[view] = {}
            for method in ("hybrid", "rt"):
                command: list[str | pathlib.Path] = [program, "info", scene, "--frame", "--json"]
                command += ["--assets", assets, "--assets", views.ROOT / "scenes", *changes]
                command += ["--set", f'reflection.method="{method}"']
                text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
                found[view][method] = json.loads(text)[0]["passes"]
    return found


def gpu_costs() -> dict[str, float]:
    """Costs of GPUs in nanoseconds: the last column of the table of costs."""
    rows = re.findall(r"^\| `(\w+)` \|.*\| ([0-9.,]+) \|$", COSTS.read_text(), re.MULTILINE)
    return {name: float(value.replace(",", "")) for name, value in rows}


class View:
    """Counts of a view at 1280 × 720."""

    def __init__(self, rows: views.Rows, name: str) -> None:
        self.hybrid = views.of(rows, name, "hybrid", views.DEFAULT)[0]
        self.rt = views.of(rows, name, "rt")[0]
        listed = float(self.rt["reflective_px"])
        accepted = listed * float(self.hybrid["screen_percent"]) / 100
        refused = listed - accepted
        self.pixels = {"listed": listed, "accepted": accepted, "refused": refused}

    def traced(self, method: str) -> tuple[float, float, float]:
        """Traversals, nodes and triangles of reflections, as counted."""
        row = self.hybrid if method == "hybrid" else self.rt
        columns = ("traversals", "visited_nodes", "tested_triangles")
        return tuple(float(row[c]) for c in columns)  # type: ignore[return-value]

    def megabytes(self, method: str, passes: list[Frame]) -> tuple[float, float]:
        """Bytes of intermediate textures, and of what reflections read beside them, in millions."""
        pixels = self.pixels | ({} if method == "hybrid" else {"refused": self.pixels["listed"]})
        textures = 0.0
        for each in passes:
            both = each["read_bytes_per_pixel"] + each["written_bytes_per_pixel"]
            textures += both * pixels.get(LISTED.get(each["pass"], ""), PIXELS)
        _, nodes, triangles = self.traced(method)
        beside = nodes * NODE_BYTES + triangles * TRIANGLE_BYTES
        if method == "hybrid":
            beside += float(self.hybrid["march_steps"]) * STEP_BYTES
        return textures / 1e6, beside / 1e6

    def reflection_ms(self, method: str, scale: float, ns: dict[str, float]) -> float:
        """Time of the reflections by the costs of GPUs, with counts in proportion to the pixels."""
        rays, nodes, _ = self.traced(method)
        trace = rays * ns["mirror_ray"] + nodes * ns["mirror_node"]
        if method == "rt":
            return (trace * scale + ns["pass"]) / 1e6
        march = PIXELS * ns["pyramid_pixel"] + self.pixels["listed"] * ns["march_ray"]
        march += float(self.hybrid["march_steps"]) * ns["march_node"]
        march += self.pixels["accepted"] * ns["hit"]
        return ((1.3 * trace + march) * scale + 5 * ns["pass"]) / 1e6


def main() -> None:
    parser = argparse.ArgumentParser(description="Write the tables of docs/gpu.md.")
    parser.add_argument("--assets", type=pathlib.Path, required=True)
    add_program(parser)
    arguments = parser.parse_args()
    with views.DATA.open(newline="") as file:
        rows = list(csv.DictReader(file))
    each = {name: View(rows, name) for name in views.VIEWS}
    passes = frames(program_of(arguments.reflet), arguments.assets.resolve())
    ns = gpu_costs()

    def counts(name: str) -> list[str]:
        view = each[name]
        listed = view.pixels["listed"]
        rays, nodes, triangles = view.traced("rt")
        own = view.traced("hybrid")
        steps = float(view.hybrid["march_steps"]) / listed
        shares = [f"{own[1] / nodes:.2f}", f"{own[2] / triangles:.2f}"]
        per_ray = [f"{nodes / rays:.1f}", f"{triangles / rays:.1f}"]
        return [name, f"{listed:,.0f}", f"{steps:.1f}", *per_ray, *shares]

    def data(name: str) -> list[str]:
        cells = [name]
        for method in ("rt", "hybrid"):
            textures, beside = each[name].megabytes(method, passes[name][method])
            cells += [f"{textures:.0f}", f"{beside:.0f}"]
            cells += [f"{(textures + beside) / rate:.2f}" for rate in CARDS.values()]
        return cells

    def times(name: str) -> list[str]:
        cells = [name]
        for scale in SIZES.values():
            rt, hybrid = (each[name].reflection_ms(m, scale, ns) for m in ("rt", "hybrid"))
            cells += [f"{rt:.2f}", f"{hybrid / rt:.2f}"]
        return cells

    per_method = ["textures, MB", "beside, MB", *CARDS]
    heads = {
        "counts": [
            "view", "listed pixels", "steps a pixel", "nodes a ray", "triangles a ray",
            "`hybrid` ÷ `rt`: nodes", "triangles",
        ],
        "data": ["view", *(f"`{m}`: {head}" for m in ("rt", "hybrid") for head in per_method)],
        "times": ["view", *(h for size in SIZES for h in (f"{size}: `rt`, ms", "`hybrid` ÷ `rt`"))],
    }  # fmt: skip
    lines = {"counts": counts, "data": data, "times": times}
    tables = {name: table(head, map(lines[name], each)) for name, head in heads.items()}
    write_tables(PAGE, tables)


if __name__ == "__main__":
    main()
