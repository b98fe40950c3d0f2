"""Renders every glTF root of a corpus; puts the pictures on sheets, beside reference pictures.

.venv/bin/python tools/gltf_corpus.py ../shared/corpus/gltf /tmp/sheets

The corpus lists its roots in INDEX.tsv, with the errors that the Khronos validator finds in each.
A reference picture is `Figures/SampleImages/NAME.png` beside or above a root, as in
glTF-Asset-Generator.
"""

from __future__ import annotations

import argparse
import collections
import concurrent.futures
import dataclasses
import os
import re
import subprocess
import time
from pathlib import Path

from measuring import add_program, program_of
from sheet import sheet

SIZE = 192
CELLS = 48
COLUMNS = 8
LIMIT_S = 60


@dataclasses.dataclass
class Root:
    """One file of the corpus, and what became of it."""

    file: str
    is_valid: bool
    picture: Path | None = None
    refused: str = ""
    """Name of the error where there is no picture."""
    warnings: tuple[str, ...] = ()
    seconds: float = 0.0

    @property
    def source(self) -> str:
        return self.file.split("/")[0]


def render(program: Path, corpus: Path, out: Path, root: Root) -> Root:
    """Render `root` alone, from its default view."""
    picture = out / "cells" / (re.sub(r"[^A-Za-z0-9.]+", "_", root.file) + ".png")
    started = time.monotonic()
    command = [program, "render", str(corpus / root.file), "-o", str(picture)]
    command += ["--size", f"{SIZE}x{SIZE}", "--set", "image.samples=4"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S, check=False)
        said, failed = done.stderr, done.returncode != 0
    except subprocess.TimeoutExpired:
        said, failed = "error[time-limit]", True
    root.seconds = time.monotonic() - started
    root.warnings = tuple(sorted(set(re.findall(r"^warning\[([a-z-]+)\]", said, re.M))))
    if failed:
        found = re.search(r"^error\[([a-z-]+)\]", said, re.M)
        root.refused = found.group(1) if found else f"rc {done.returncode}"
    else:
        root.picture = picture
    return root


def reference(corpus: Path, root: Root) -> Path | None:
    """The picture that the corpus gives of a root, if any."""
    file = corpus / root.file
    for folder in (file.parent, file.parent.parent, file.parent.parent.parent):
        found = folder / "Figures" / "SampleImages" / f"{file.stem}.png"
        if found.is_file():
            return found
    return None


def read_index(corpus: Path) -> list[Root]:
    lines = (corpus / "INDEX.tsv").read_text(encoding="utf-8").splitlines()[1:]
    cells = (line.split("\t") for line in lines)
    return [Root(file, errors == "0") for file, errors, *_ in cells]


def write_sheets(corpus: Path, out: Path, roots: list[Root]) -> int:
    """All pictures, those with a reference picture followed by it; returns how many sheets."""
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


def table(roots: list[Root]) -> str:
    """Markdown: what is shown of each source, and why the rest is not."""
    by_source: dict[str, list[Root]] = collections.defaultdict(list)
    for root in roots:
        by_source[root.source].append(root)
    lines = ["| source | roots | valid | valid and shown | broken and refused |", "|---" * 5 + "|"]
    for source, of in [*sorted(by_source.items()), ("all", roots)]:
        valid = [root for root in of if root.is_valid]
        shown = sum(root.picture is not None for root in valid)
        broken = [root for root in of if not root.is_valid]
        refused = sum(root.picture is None for root in broken)
        counts = f"{len(of)} | {len(valid)} | {shown} | {refused} of {len(broken)}"
        lines.append(f"| {source} | {counts} |")
    lines += ["", "| valid, not shown | error |", "|---|---|"]
    missing = [root for root in roots if root.is_valid and root.picture is None]
    lines += [f"| {root.file} | `{root.refused}` |" for root in missing]
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("corpus", type=Path)
    parser.add_argument("out", type=Path, help="folder for the sheets and table.md")
    add_program(parser)
    parser.add_argument("--only", default="", help="roots whose path contains this")
    arguments = parser.parse_args()
    (arguments.out / "cells").mkdir(parents=True, exist_ok=True)
    roots = [root for root in read_index(arguments.corpus) if arguments.only in root.file]

    program = program_of(arguments.reflet)

    def job(root: Root) -> Root:
        return render(program, arguments.corpus, arguments.out, root)

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        roots = list(pool.map(job, roots))
    count = write_sheets(arguments.corpus, arguments.out, roots)
    text = table(roots)
    (arguments.out / "table.md").write_text(text, encoding="utf-8")
    slowest = max(roots, key=lambda root: root.seconds)
    print(f"{len(roots)} roots on {count} sheets; slowest {slowest.file}: {slowest.seconds:.1f} s")


if __name__ == "__main__":
    main()
