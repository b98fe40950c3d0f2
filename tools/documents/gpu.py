"""Bytes of the frames of docs/views.md, and times that rates of GPUs make of their counts.

Counts are from docs/data/views.csv, bytes from `reflet info --frame`, costs from docs/costs.md
(docs/gpu.md).
"""

import json
import pathlib
import re
import shutil
import subprocess
from typing import Any

from measuring import ROOT, settings
from tables import Rows, count, read_rows, table, write_rows

from documents import views
from documents.document import DATA, DOCS, Document, Run, accepted_px, in_places

PIXELS = 1280 * 720
SIZES = {"1280 × 720": 1, "1920 × 1080": 2.25, "3840 × 2160": 9}
# Passes whose work is for the pixels of a list, and which list.
LISTED = {"ssr": "listed", "hits": "accepted", "trace": "refused"}
NODE_BYTES, TRIANGLE_BYTES, STEP_BYTES = 80, 48, 4
# Memory bandwidth by the makers' data sheets, GB/s.
CARDS = {"GTX 780 Ti": 336, "RTX 4090": 1008, "H100 SXM": 3350}


def measure(run: Run) -> None:
    """Writes the bytes a pixel of the passes of each view by each method, as of GPUs."""
    lamps = run.out / "eight-lamps.toml"
    lamps.write_text(views.eight_lamps())
    rows: list[dict[str, Any]] = []
    for view, (name, *changes) in views.VIEWS.items():
        scene = lamps if name == lamps.name else ROOT / name
        for method in ("hybrid", "rt"):
            command = [run.program, "info", scene, "--frame", "--json", *changes, *run.models()]
            command += ["--assets", ROOT / "scenes", *settings(f'reflection.method="{method}"')]
            text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
            for each in json.loads(text)[0]["passes"]:
                both = each["read_bytes_per_pixel"] + each["written_bytes_per_pixel"]
                of = {"view": view, "method": method, "pass": each["pass"]}
                rows.append(of | {"bytes_per_pixel": both})
    write_rows(run.out / "gpu.csv", rows)


def gpu_costs() -> dict[str, float]:
    """Costs of GPUs in nanoseconds: the last column of the table of costs."""
    text = (DOCS / "costs.md").read_text()
    rows = re.findall(r"^\| `(\w+)` \|.*\| ([0-9.,]+) \|$", text, re.MULTILINE)
    return {name: float(value.replace(",", "")) for name, value in rows}


class View:
    """Counts of a view at 1280 × 720."""

    def __init__(self, rows: Rows, passes: Rows, name: str) -> None:
        self.passes = [row for row in passes if row["view"] == name]
        self.hybrid = views.of(rows, name, "hybrid", views.DEFAULT)[0]
        self.rt = views.of(rows, name, "rt")[0]
        listed, accepted = float(self.rt["reflective_px"]), accepted_px(self.hybrid)
        self.pixels = {"listed": listed, "accepted": accepted, "refused": listed - accepted}

    def traced(self, method: str) -> tuple[float, float, float]:
        """Traversals, nodes and triangles of reflections, as counted."""
        row = self.hybrid if method == "hybrid" else self.rt
        columns = ("traversals", "visited_nodes", "tested_triangles")
        return tuple(float(row[c]) for c in columns)  # type: ignore[return-value]

    def megabytes(self, method: str) -> tuple[float, float]:
        """Bytes of intermediate textures, and of other data of reflections, in millions."""
        pixels = self.pixels | ({} if method == "hybrid" else {"refused": self.pixels["listed"]})
        textures = 0.0
        for each in (row for row in self.passes if row["method"] == method):
            area = pixels.get(LISTED.get(each["pass"], ""), PIXELS)
            textures += float(each["bytes_per_pixel"]) * area
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


def tables() -> dict[str, str]:
    rows, passes = (read_rows(DATA / f"{name}.csv") for name in ("views", "gpu"))
    each = {name: View(rows, passes, name) for name in views.VIEWS}
    ns = gpu_costs()

    def counts(name: str) -> list[str]:
        view = each[name]
        listed = view.pixels["listed"]
        rays, nodes, triangles = view.traced("rt")
        own = view.traced("hybrid")
        steps = float(view.hybrid["march_steps"]) / listed
        shares = [f"{own[1] / nodes:.2f}", f"{own[2] / triangles:.2f}"]
        per_ray = [f"{nodes / rays:.1f}", f"{triangles / rays:.1f}"]
        return [name, count(listed), f"{steps:.1f}", *per_ray, *shares]

    def data(name: str) -> list[str]:
        cells = [name]
        for method in ("rt", "hybrid"):
            textures, beside = each[name].megabytes(method)
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
    return {name: table(head, map(lines[name], each)) for name, head in heads.items()}


def store(outs: list[pathlib.Path]) -> None:
    shutil.copyfile(outs[0] / "gpu.csv", DATA / "gpu.csv")


DOCUMENT = Document("gpu.md", in_places(tables), store, measure)
