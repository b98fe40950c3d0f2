"""Breaks glTF files at random and tables how Reflet answers, for docs/gltf.md.

.venv/bin/python tools/gltf_mutants.py ../shared/corpus/gltf [--count 2500] [--seed 1] [--only N]

Each broken file is read by `reflet check` within 5 s of processor time and 1.5 GiB of address
space, and rendered at 16 × 16 where that finds nothing wrong. File N of a seed is always the
same; files that are answered wrongly are kept in the folder that `--keep` names.

Without a folder it makes panoramas, each part of which is odd in one of twenty files. With
`--parts` each has one wrong part of the kinds of `gltf_mutations.PARTS` instead: all the rest
must be shown, with a warning about the part, which `--strict` makes an error; files with a wrong
part of geometry, skins or transforms may also be refused.
"""

import argparse
import collections
import concurrent.futures
import contextlib
import dataclasses
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import tables
from gltf_mutations import KINDS, PARTS, Model, break_part, mutate, parts_of, read_model
from measuring import ROOT, used

PAGE = ROOT / "docs" / "gltf.md"
CPU_S = 5
MEMORY_MIB = 1536
RENDER_SPACE_MIB = 4096
"""Address space of `render`: compilers of shaders reserve more than they use."""
WALL_S = 300
SHADERS_S = 60
"""Processor time of a first picture, whose shaders are compiled."""


@dataclasses.dataclass
class Answer:
    """Outcome of one command."""

    what: str
    """`fine`, `refused`, `panic`, `abort`, `time`, `memory` or `unnamed`."""
    error: str = ""
    """Name of the error."""
    cpu_s: float = 0.0
    memory_mib: float = 0.0
    said: str = ""


@dataclasses.dataclass
class Mutant:
    """One broken file, and the outcomes of checking and rendering it."""

    number: int
    kind: str
    model: Model
    check: Answer
    render: Answer | None = None

    @property
    def answers(self) -> list[Answer]:
        return [self.check, self.render] if self.render else [self.check]

    @property
    def end(self) -> str:
        """`refused`, `shown`, or the kind of failure."""
        wrong = [a.what for a in self.answers if a.what not in ("fine", "refused")]
        if wrong:
            return wrong[0]
        return "refused" if any(a.what == "refused" for a in self.answers) else "shown"


def run(command: list[str], space_mib: int, cpu_s: int = CPU_S) -> Answer:
    """Run a command within limits of address space, processor time and wall-clock time."""
    limited = f'ulimit -v {space_mib * 1024}; ulimit -t {cpu_s}; exec "$@"'
    ran = used(["sh", "-c", limited, "sh", *command], WALL_S)
    answer = judge(ran.code, ran.said)
    answer.cpu_s, answer.memory_mib = ran.processor_s, ran.memory_mib
    if answer.what in ("fine", "refused") and answer.memory_mib > MEMORY_MIB:
        answer.what = "memory"
    return answer


def judge(code: int, said: str) -> Answer:
    """Answer that an exit status and standard error stand for."""
    found = re.search(r"^error\[([a-z0-9-]+)\]", said, re.M)
    name = found.group(1) if found else ""
    if "panicked at" in said or name == "internal" or code == 101:
        return Answer("panic", name, said=said)
    if code in (-signal.SIGXCPU, -signal.SIGKILL):
        return Answer("time", name, said=said)
    if "memory allocation of" in said:
        return Answer("memory", name, said=said)
    if code < 0 or code > 128:
        return Answer("abort", name, said=said)
    if code == 0:
        return Answer("fine", said=said)
    return Answer("refused" if name else "unnamed", name, said=said)


def roots(corpus: Path) -> list[Path]:
    """The corpus's roots, and the models of this repository."""
    lines = (corpus / "INDEX.tsv").read_text(encoding="utf-8").splitlines()[1:]
    own = [path for path in sorted(ROOT.glob("scripts/*.gl[bt]*")) if path.is_file()]
    return [corpus / line.split("\t")[0] for line in lines] + own


@contextlib.contextmanager
def written(files: dict[str, bytes]) -> Iterator[Path]:
    """A temporary folder of the files."""
    with tempfile.TemporaryDirectory() as name:
        for place, data in files.items():
            path = Path(name, place)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
        yield Path(name)


def one(
    number: int,
    seed: int,
    models: list[Model],
    reflet: str,
    keep: Path | None,
    *,
    render: bool = True,
) -> Mutant:
    """Make, check and render broken file `number`."""
    kind, model, files = mutate(models, number, random.Random(f"{seed} {number}"))
    with written(files) as folder:
        file = str(folder / model.name)
        mutant = Mutant(number, kind, model, run([reflet, "check", file], MEMORY_MIB))
        if render and mutant.check.what == "fine":
            picture = str(folder / "out.png")
            command = [reflet, "render", file, "-o", picture, "--size", "16x16"]
            command += ["--set", "image.samples=1"]
            mutant.render = run(command, RENDER_SPACE_MIB, SHADERS_S)
            if mutant.render.cpu_s > CPU_S:
                # Software drivers compile shaders for seconds, and cache them for this run.
                mutant.render = run(command, RENDER_SPACE_MIB)
            if mutant.render.what == "refused" and Path(picture).exists():
                mutant.render.what = "unnamed"  # no picture may be left by a refusal
        if keep and mutant.end not in ("refused", "shown"):
            shutil.copytree(folder, keep / str(number), dirs_exist_ok=True)
    return mutant


COUNTED = "triangles_stored triangles_placed instances materials textures lights animations cameras"
"""Counts of `reflet info --json` that one wrong part does not change."""


@dataclasses.dataclass
class Facts:
    """Output of `reflet info` for a file."""

    counts: dict[str, object] | None
    """None for a file that is refused."""
    said: str
    """Warnings or errors, without the file's folder."""


def facts(reflet: str, file: Path, *options: str) -> Facts:
    command = [reflet, "info", str(file), "--json", *options]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=WALL_S, check=False)
    counts = None
    if ran.returncode == 0:
        told = json.loads(ran.stdout)
        counts = {name: told[name] for name in COUNTED.split()}
        counts["variants"] = [model["variants"] for model in told["models"]]
    return Facts(counts, ran.stderr.replace(str(file.parent), ""))


def part(reflet: str, whole: Facts, kind: str, model: Model, chance: random.Random) -> str:
    """Fault in the answer to a model of one wrong part; empty for a right answer."""
    said, files = break_part(model, kind, chance)
    with written(files) as folder:
        shown = facts(reflet, folder / model.name)
        strict = facts(reflet, folder / model.name, "--strict")
    said = f"{model.file} {said}"
    may_change = PARTS[kind][1]
    if shown.counts is None:
        is_right = may_change is None and judge(1, shown.said).what == "refused"
        return "" if is_right else f"refused: {said}: {shown.said[-300:]}"
    if may_change is None:
        may_change = (*COUNTED.split(), "variants")
    for count, value in (whole.counts or {}).items():
        if count not in may_change and shown.counts[count] != value:
            return f"lost more: {said}: {count} {value} -> {shown.counts[count]}"
    if shown.said == whole.said:
        return f"silent: {said}"
    return "" if strict.counts is None else f"not strict: {said}: {shown.said[-300:]}"


def parts(reflet: str, models: list[Model], count: int, seed: int) -> tuple[str, list[str]]:
    """Table of `count` files with a wrong part of each kind, and the faults in their answers."""
    whole = {model.file: facts(reflet, model.file) for model in models if model.root}
    good = [m for m in models if m.file in whole and whole[m.file].counts is not None]
    lines, wrong = [], []
    for kind in PARTS:
        chance = random.Random(f"{seed} {kind}")
        having = [model for model in good if parts_of(model.root, kind)]
        chosen = chance.choices(having, k=count) if having else []
        jobs = [(kind, model, random.Random(chance.random())) for model in chosen]
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            found = list(pool.map(lambda job: part(reflet, whole[job[1].file], *job), jobs))
        wrong += [f"{kind}: {end}" for end in found if end]
        lines.append([kind, f"{len(found):,}", f"{sum(not end for end in found):,}"])
    return tables.table(["a wrong part of", "files", "right"], lines, tight=True), wrong


ENDS = {
    "refused": "refused by name",
    "shown": "shown",
    "panic": "panics",
    "abort": "aborts",
    "time": f"over {CPU_S} s",
    "memory": f"over {MEMORY_MIB / 1024:.1f} GiB",
    "unnamed": "without a name",
}


def table(mutants: list[Mutant], seed: int, sources: int) -> str:
    """Markdown table: number of files by kind of damage and outcome."""
    lines = []
    for kind, words in [*KINDS.items(), ("", "all")]:
        ends = collections.Counter(m.end for m in mutants if kind in ("", m.kind))
        if ends:
            lines.append([words, f"{ends.total():,}", *(f"{ends[end]:,}" for end in ENDS)])
    renders = [m.render for m in mutants if m.render]
    packed = sum(m.model.is_compressed for m in mutants)
    made = f", {sources} models, {packed:,} of the broken files made of those that hold compressed"
    made = made + " geometry or images" if sources else ""
    most = worst([m.check for m in mutants], "reading")
    most += f", {worst(renders, 'rendering')}" if renders else ""
    text = tables.table(["what is broken", "files", *ENDS.values()], lines, tight=True)
    return f"{text}\n\nSeed {seed}{made}. At most {most}."


def worst(of: list[Answer], doing: str) -> str:
    cpu, memory = max(a.cpu_s for a in of), max(a.memory_mib for a in of)
    return f"{cpu:.1f} s of processor time and {memory:,.0f} MiB for {doing}"


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("corpus", type=Path, nargs="?", help="without it, panoramas are broken")
    parser.add_argument("--reflet", default="target/release/reflet")
    parser.add_argument("--count", type=int, default=2500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, help="number of one file to run; prints its answers")
    parser.add_argument("--keep", type=Path, help="folder for files that are answered wrongly")
    parser.add_argument("--parts", action="store_true", help="break one part; --count of each kind")
    parser.add_argument("--page", action="store_true", help="write the table into docs/gltf.md")
    arguments = parser.parse_args()
    models = [read_model(f) for f in roots(arguments.corpus)] if arguments.corpus else []
    if arguments.parts:
        text, said = parts(arguments.reflet, models, arguments.count, arguments.seed)
        print(text, *said, sep="\n")
        if arguments.page:
            tables.write_tables(PAGE, {"parts": text})
        sys.exit(bool(said))
    numbers = range(arguments.count) if arguments.only is None else [arguments.only]

    def job(number: int) -> Mutant:
        return one(number, arguments.seed, models, arguments.reflet, arguments.keep)

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        mutants = list(pool.map(job, numbers))
    text = table(mutants, arguments.seed, len(models))
    print(text)
    wrong = [m for m in mutants if m.end not in ("refused", "shown")]
    for mutant in wrong if arguments.only is None else mutants:
        said = [answer.said[-400:] for answer in mutant.answers]
        print(f"{mutant.number} {mutant.kind} {mutant.model.file}: {mutant.end}: {said}")
    if arguments.page:
        tables.write_tables(PAGE, {"mutants" if models else "panoramas": text})
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
