"""Renders every glTF root of a corpus; puts the pictures on sheets, beside reference pictures.

.venv/bin/python tools/gltf_corpus.py ../shared/corpus/gltf /tmp/sheets [--page]

The corpus lists its roots in INDEX.tsv, with the errors that the Khronos validator finds in each.
A reference picture is `Figures/SampleImages/NAME.png` beside or above a root, as in
glTF-Asset-Generator. tools/gltf_looks.toml lists the roots that look wrong on the sheets, with
their causes; `--page` writes the table in docs/gltf.md and two small sheets: pictures that have a
reference picture, each before it, and the others.
"""

import argparse
import collections
import concurrent.futures
import dataclasses
import os
import re
import subprocess
import sys
import time
from pathlib import Path

import tables
import tomllib
from gltf_mutations import read_model
from measuring import ROOT, add_program, program_of
from sheet import sheet

PAGE = ROOT / "docs" / "gltf.md"
PAGE_SHEETS = ROOT / "docs" / "images"
LOOKS = ROOT / "tools" / "gltf_looks.toml"

SIZE = 192
SAMPLES = 16
SMALL = 80
SMALL_COLUMNS = 16
CELLS = 48
COLUMNS = 8
CPU_S = 60


@dataclasses.dataclass
class Root:
    """One root file of the corpus, and the outcome of rendering it."""

    file: str
    is_valid: bool
    has_mesh: bool = True
    """Whether a node has a mesh with positions."""
    picture: Path | None = None
    refused: str = ""
    """Name of the error where there is no picture."""
    warnings: tuple[str, ...] = ()
    seconds: float = 0.0

    @property
    def source(self) -> str:
        return self.file.split("/")[0]


def render(program: Path, corpus: Path, out: Path, root: Root, samples: int) -> Root:
    """Render `root` alone, from its default view, with this many samples per pixel."""
    picture = out / "cells" / (re.sub(r"[^A-Za-z0-9.]+", "_", root.file) + ".png")
    started = time.monotonic()
    command = ["sh", "-c", f'ulimit -t {CPU_S}; exec "$@"', "sh", str(program), "render"]
    command += [str(corpus / root.file), "-o", str(picture)]
    command += ["--size", f"{SIZE}x{SIZE}", "--set", f"image.samples={samples}"]
    picture.unlink(missing_ok=True)
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    root.seconds = time.monotonic() - started
    root.warnings = tuple(sorted(set(re.findall(r"^warning\[([a-z-]+)\]", done.stderr, re.M))))
    if done.returncode != 0:
        found = re.search(r"^error\[([a-z-]+)\]", done.stderr, re.M)
        root.refused = found.group(1) if found else f"rc {done.returncode}"
    else:
        root.picture = picture
    return root


def reference(corpus: Path, root: Root) -> Path | None:
    """Reference picture that the corpus holds for a root, if any."""
    file = corpus / root.file
    for folder in (file.parent, file.parent.parent, file.parent.parent.parent):
        found = folder / "Figures" / "SampleImages" / f"{file.stem}.png"
        if found.is_file():
            return found
    return None


def read_index(corpus: Path) -> list[Root]:
    lines = (corpus / "INDEX.tsv").read_text(encoding="utf-8").splitlines()[1:]
    cells = (line.split("\t") for line in lines)
    roots = [Root(file, errors == "0") for file, errors, *_ in cells]
    for root in roots:
        root.has_mesh = root.is_valid and has_mesh(corpus / root.file)
    return roots


def has_mesh(file: Path) -> bool:
    """Whether a valid file has a scene with a node whose mesh has positions."""
    root = read_model(file).root or {}
    nodes, meshes = root.get("nodes", []), root.get("meshes", [])
    shown = [meshes[node["mesh"]] for node in nodes if "mesh" in node]
    attributes = [part["attributes"] for mesh in shown for part in mesh["primitives"]]
    return bool(root.get("scenes")) and any("POSITION" in names for names in attributes)


def write_sheets(corpus: Path, out: Path, roots: list[Root]) -> int:
    """Write sheets of all pictures, each before its reference picture; returns their number."""
    cells: list[tuple[str, Path]] = []
    for root in roots:
        if root.picture is None:
            continue
        cells.append((Path(root.file).stem[-28:], root.picture))
        beside = reference(corpus, root)
        if beside is not None:
            cells.append(("  reference", beside))
    parts = [cells[i : i + CELLS] for i in range(0, len(cells), CELLS)]
    for number, part in enumerate(parts, 1):
        sheet(part, COLUMNS, SIZE).save(out / f"sheet-{number:02}.png")
    return len(parts)


def write_page_sheets(corpus: Path, roots: list[Root]) -> None:
    """Write the small sheets for the page, without captions."""
    compared, others = [], []
    for root in roots:
        beside = reference(corpus, root)
        if root.picture is not None and beside is not None:
            compared += [("", root.picture), ("", beside)]
        elif root.picture is not None:
            others.append(("", root.picture))
    for name, cells in (("compared", compared), ("others", others)):
        small = sheet(cells, SMALL_COLUMNS, SMALL)
        small.save(PAGE_SHEETS / f"gltf-{name}.png", optimize=True)


@dataclasses.dataclass
class Looks:
    """Judgments from looking at the sheets: causes by file."""

    wrong: dict[str, str]
    """Files that are shown, but not right."""
    refused: dict[str, str]
    """Files that are refused, rightly."""


def read_looks(roots: list[Root]) -> Looks:
    """Read tools/gltf_looks.toml; entries that no longer hold are left out and reported."""
    listed = tomllib.loads(LOOKS.read_text(encoding="utf-8"))
    valid = [root for root in roots if root.is_valid]
    found = {
        "wrong": {root.file for root in valid if root.picture},
        "refused": {root.file for root in valid if not root.picture},
    }
    for kind, files in found.items():
        for file in listed[kind].keys() - files:
            print(f"{LOOKS}: {file} is not {kind}; remove it", file=sys.stderr)
        listed[kind] = {file: why for file, why in listed[kind].items() if file in files}
    return Looks(listed["wrong"], listed["refused"])


def table(roots: list[Root], looks: Looks) -> str:
    """Markdown table by source: roots shown, and why others are not, or are wrong."""
    by_source: dict[str, list[Root]] = collections.defaultdict(list)
    for root in roots:
        by_source[root.source].append(root)
    head = ["source", "roots", "valid", "to show", "shown", "right", "broken, refused"]
    rows = []
    for source, of in [*sorted(by_source.items()), ("all", roots)]:
        valid = [root for root in of if root.is_valid]
        shown = sum(root.picture is not None for root in valid)
        broken = [root for root in of if not root.is_valid]
        refused = sum(root.picture is None for root in broken)
        right = shown - sum(root.file in looks.wrong for root in of)
        to_show = sum(root.has_mesh and root.file not in looks.refused for root in valid)
        counts = [str(count) for count in (len(of), len(valid), to_show, shown, right)]
        rows.append([source, *counts, f"{refused} of {len(broken)}"])
    valid = [root for root in roots if root.is_valid and root.file not in looks.refused]
    whole = [root for root in valid if root.has_mesh]
    empty = [root for root in valid if not root.has_mesh]
    named = sum(root.refused == "nothing-to-show" for root in empty)
    lines = [[r.file, f"not shown: `{r.refused}`"] for r in whole if r.picture is None]
    lines += [[file, why] for file, why in sorted(looks.wrong.items())]
    right = len(whole) - len(lines)
    share = (
        f"{right} of {len(whole)} valid roots with something to show ({right / len(whole):.1%}) "
        f"load and look right. Of the other valid ones {named} of {len(empty)} place no mesh and "
        f"are refused as `nothing-to-show`, and {len(looks.refused)} must be refused: "
        + "; ".join(f"{file} ({why})" for file, why in sorted(looks.refused.items()))
    )
    wrong = [tables.table(["not right", "why"], lines)] if lines else []
    return "\n\n".join([f"{share}.", *wrong, tables.table(head, rows)])


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("corpus", type=Path)
    parser.add_argument("out", type=Path, help="folder for the sheets and table.md")
    add_program(parser)
    parser.add_argument("--only", default="", help="roots whose path contains this")
    parser.add_argument("--samples", type=int, default=SAMPLES, help="samples of each pixel")
    parser.add_argument("--page", action="store_true", help="write the table into docs/gltf.md")
    arguments = parser.parse_args()
    (arguments.out / "cells").mkdir(parents=True, exist_ok=True)
    roots = [root for root in read_index(arguments.corpus) if arguments.only in root.file]

    program = program_of(arguments.reflet)

    def job(root: Root) -> Root:
        return render(program, arguments.corpus, arguments.out, root, arguments.samples)

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        roots = list(pool.map(job, roots))
    count = write_sheets(arguments.corpus, arguments.out, roots)
    text = table(roots, read_looks(roots))
    (arguments.out / "table.md").write_text(text + "\n", encoding="utf-8")
    if arguments.page and not arguments.only:
        tables.write_tables(PAGE, {"corpus": text})
        write_page_sheets(arguments.corpus, roots)
    slowest = max(roots, key=lambda root: root.seconds)
    print(f"{len(roots)} roots on {count} sheets; slowest {slowest.file}: {slowest.seconds:.1f} s")


if __name__ == "__main__":
    main()
