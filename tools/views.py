#!/usr/bin/env python3
"""Compares hybrid with rt in named views at 1280 x 720, and writes docs/views.md.

    tools/views.py measure --assets DIR OUT [--reflet PROGRAM]    # views that OUT lacks
    tools/views.py page OUT [OUT ...]                             # the tables and docs/data

Each OUT is measured on one driver (`eval "$(tools/driver.sh newest)"` has all programs use the
newest one); the page takes errors and counts from the first, and times from each.

Accuracy is that of the reflections against rt with bounces = "auto"; time is processor time of the
reflection passes on a software adapter, frames of both methods in turns.
"""

import argparse
import csv
import math
import pathlib
import re
import statistics
import subprocess
import sys

from measuring import add_program, program_of, table, write_rows, write_tables

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "views.md"
DATA = ROOT / "docs" / "data" / "views.csv"
SIZE = "1280x720"
FRAMES = 5
DEFAULT, STRICTEST = 0.25, 0.0  # reflection.edge_px
COLUMNS = [
    *["view", "method", "edge_px", "repetition", "reflection_cpu_ms", "reflective_px"],
    *["screen_percent", "false_accepts", "mask_px", "mask_flip", "mask_flip_p99", "mask_ssim"],
    *["march_steps", "traversals", "visited_nodes", "tested_triangles", "driver"],
]

Row = dict[str, str]
Rows = list[Row]


def setting(*assignments: str) -> list[str]:
    return [word for assignment in assignments for word in ("--set", assignment)]


ON_FLOOR = "instance.0.translation=[-4.4, 0.0, 0.0]"
LENGTH = "reflection.ray_length_u=16"
# Views by name: the scene, and overrides of its values.
VIEWS: dict[str, list[str]] = {
    "Fig. 1": ["scenes/paper/sponza.toml"],
    "Scenario 1": ["scenes/paper/scenario1.toml"],
    "Scenario 3, ground": ["scenes/paper/scenario3.toml", *setting(LENGTH)],
    "Scenario 3, sphere": [
        "scenes/paper/scenario3.toml",
        *setting(LENGTH, "model.surface.file=sphere_25k.glb", "instance.0.scale=2.0", ON_FLOOR),
    ],
    "Scenario 3, bunny": [
        "scenes/paper/scenario3.toml",
        *setting(LENGTH, "model.surface.file=bunny_69k.glb", "instance.0.scale=2.0"),
        *setting("instance.0.rotation_deg=[0, -90, 0]", ON_FLOOR),
    ],
    "walk, first frame": ["scenes/paper/scenario2.toml"],
    "atrium": ["scenes/atrium.toml"],
    "atrium, shadow rays": [
        "scenes/atrium.toml", *setting("light.sun.shadow=ray", "light.lamp.shadow=ray"),
    ],
    "atrium, eight lamps with shadow rays": ["eight-lamps.toml"],
    "textured wall": ["scenes/fail/27-texture.toml"],
    "rails": ["scenes/fail/03-rails.toml"],
}  # fmt: skip


def eight_lamps() -> str:
    """Write a copy of the atrium with a ring of eight lamps in place of its sun and lamp."""
    lamps = []
    for i in range(8):
        turn = math.tau * i / 8
        position = [round(3.5 * math.cos(turn), 3), 3.2, round(3.5 * math.sin(turn) - 1, 3)]
        lamps.append(
            f'[light.ring{i}]\nkind = "point"\nposition = {position}\nintensity_cd = 4\n'
            'shadow = "ray"\n'
        )
    head = 'version = 1\nbase = "atrium.toml"\nremove = ["light.sun", "light.lamp"]\n'
    return head + "".join(lamps)


def folder_of(view: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", view.lower()).strip("-")


def measure(out: pathlib.Path, assets: pathlib.Path, program: pathlib.Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    (out / "eight-lamps.toml").write_text(eight_lamps())
    for view, (name, *changes) in VIEWS.items():
        scene = out / name if name == "eight-lamps.toml" else ROOT / name
        print(f"== {view}", flush=True)
        command: list[str | pathlib.Path] = [
            program,
            "bench",
            scene,
            "--assets",
            assets,
            "--assets",
            ROOT / "scenes",
            *changes,
            "--sizes",
            SIZE,
        ]
        command += ["--methods", "hybrid,rt", "--parameter", "edge_px"]
        command += ["--values", f"{STRICTEST},{DEFAULT}", "--frames", str(FRAMES)]
        command += ["--warm-up", "1", "--counters", "--resume", "-o", out / folder_of(view)]
        subprocess.run(command, cwd=ROOT, check=True)


def read(out: pathlib.Path) -> Rows:
    rows: Rows = []
    for view in VIEWS:
        path = out / folder_of(view) / "samples.csv"
        if not path.exists():
            sys.exit(f"{path} is missing; run `measure` first")
        with path.open(newline="") as file:
            rows += [row | {"view": view} for row in csv.DictReader(file)]
    return [{column: row[column] for column in COLUMNS} for row in rows]


def of(rows: Rows, view: str, method: str, edge_px: float | None = None) -> Rows:
    found = [r for r in rows if r["view"] == view and r["method"] == method]
    return [r for r in found if edge_px is None or float(r["edge_px"]) == edge_px]


def median(rows: Rows, column: str) -> float:
    return statistics.median(float(row[column] or 0) for row in rows)


def wrong_permille(row: Row) -> float:
    hits = float(row["reflective_px"]) * float(row["screen_percent"]) / 100
    return 1000 * float(row["false_accepts"] or 0) / max(hits, 1.0)


def errors(rows: Rows) -> str:
    def line(view: str, edge_px: float) -> list[str]:
        row = of(rows, view, "hybrid", edge_px)[0]
        return [
            view, f"{edge_px:g}", f"{float(row['mask_flip']):.4f}",
            f"{float(row['mask_flip_p99']):.3f}", f"{float(row['mask_ssim']):.4f}",
            f"{wrong_permille(row):.1f}", f"{float(row['screen_percent']):.0f} %",
        ]  # fmt: skip

    head = [
        "view",
        "`edge_px`",
        "FLIP",
        "p99",
        "SSIM",
        "wrong surfaces, ‰ of the hits",
        "on screen",
    ]
    return table(head, (line(v, e) for v in VIEWS for e in (DEFAULT, STRICTEST)))


def times(measured: list[Rows]) -> str:
    """Times on each driver: that of rt, and those of hybrid over it."""

    def cells(rows: Rows, view: str) -> list[str]:
        rt_ms = median(of(rows, view, "rt"), "reflection_cpu_ms")
        own = [of(rows, view, "hybrid", edge_px) for edge_px in (DEFAULT, STRICTEST)]
        ratios = [f"{median(rs, 'reflection_cpu_ms') / rt_ms:.2f}" for rs in own]
        return [f"{rt_ms:.0f}", *ratios]

    head = ["view"]
    for rows in measured:
        mesa = re.search(r"Mesa [0-9.]+", rows[0]["driver"])
        name = mesa[0] if mesa else rows[0]["driver"]
        head += [f"{name}: `rt`, ms", "`hybrid` ÷ `rt`", "`edge_px` 0"]
    lines = ([view, *(c for rows in measured for c in cells(rows, view))] for view in VIEWS)
    return table(head, lines)


def counts(rows: Rows) -> str:
    def line(view: str) -> list[str]:
        rt = of(rows, view, "rt")
        own = [of(rows, view, "hybrid", edge_px) for edge_px in (DEFAULT, STRICTEST)]
        nodes = [float(rs[0]["visited_nodes"]) for rs in (*own, rt)]
        share = [f"{n / nodes[2]:.2f}" for n in nodes[:2]]
        steps = f"{float(own[0][0]['march_steps']):,.0f}"
        return [view, *share, steps, f"{nodes[2]:,.0f}"]

    head = ["view", "nodes ÷ `rt`", "`edge_px` 0", "march steps", "nodes that `rt` visits"]
    return table(head, map(line, VIEWS))


def page(outs: list[pathlib.Path]) -> None:
    measured = [read(out) for out in outs]
    first = measured[0]
    tables = {"errors": errors(first), "times": times(measured), "counts": counts(first)}
    write_tables(PAGE, tables)
    write_rows(DATA, [row for rows in measured for row in rows])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    commands = parser.add_subparsers(required=True, dest="command")
    measuring = commands.add_parser("measure", help="measure what OUT lacks")
    measuring.add_argument("--assets", type=pathlib.Path, required=True)
    add_program(measuring)
    writing = commands.add_parser("page", help="write the tables of docs/views.md")
    measuring.add_argument("out", type=pathlib.Path, metavar="OUT")
    writing.add_argument("out", type=pathlib.Path, metavar="OUT", nargs="+")
    arguments = parser.parse_args()
    if arguments.command == "measure":
        measure(arguments.out.resolve(), arguments.assets.resolve(), program_of(arguments.reflet))
    else:
        page(arguments.out)


if __name__ == "__main__":
    main()
