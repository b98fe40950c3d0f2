#!/usr/bin/env python3
"""Mutation testing: injects small faults into the code and lists faults that no test detects.

A mutant is one mechanical change of one line: an operator, a sign, a constant, a component, a
comparison. They are drawn from a fixed seed, as many from each file as it has places for them.
Shader mutants stand in a copy of shaders/ that the tests of pictures and of the ray tracer read
through REFLET_TEST_SHADERS, so nothing is built. Rust mutants (metrics and scene parser) stand in
a copy of the tree with a target folder of its own.

A mutant is killed when a test fails; a mutant at which the tests time out or crash is listed as
such. A survivor needs a test, or an entry with a reason in tools/mutants.toml; one without either
makes the exit code 1. A mutant that does not compile is not counted, and another is drawn.
"""

import argparse
import dataclasses
import json
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from typing import Any

import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[1]
SCRATCH = ROOT / "target" / "mutants"
REASONS = ROOT / "tools" / "mutants.toml"
SEED = 2018
# Time limit of a test stage; a longer one hangs in a loop that a mutant made endless.
LIMIT_S = 900
# Modules of the picture tests, the quickest first.
MODULES = [
    "mesh",
    "lamp",
    "material",
    "counts",
    "closed_form",
    "edge_cases",
    "ray_list",
    "agreement",
    "orthographic",
]
# Arguments of `cargo test` for the tests of the metrics.
METRIC = ["--test", "commands", "metric::"]
GROUPS = {
    "shader": (48, ["shaders/**/*.wgsl"]),
    "rust": (32, ["src/metric/*.rs", "src/scene/parse/**/*.rs", "src/scene/parse.rs"]),
}

# Pattern, replacement and name of a mutation. Spaces around operators are how
# this code is formatted; they keep generics, arrows and paths out.
CHANGES = [
    (r"(?<= )\+(?= )", ["-"]),
    (r"(?<= )-(?= )", ["+"]),
    (r"(?<= )\*(?= )", ["/"]),
    (r"(?<= )/(?= )", ["*"]),
    (r"(?<= )\+=(?= )", ["-="]),
    (r"(?<= )-=(?= )", ["+="]),
    (r"(?<= )\*=(?= )", ["/="]),
    (r"(?<= )<(?= )", ["<=", ">"]),
    (r"(?<= )<=(?= )", ["<", ">"]),
    (r"(?<= )>(?= )", [">=", "<"]),
    (r"(?<= )>=(?= )", [">", "<"]),
    (r"(?<= )==(?= )", ["!="]),
    (r"(?<= )!=(?= )", ["=="]),
    (r"(?<= )&&(?= )", ["||"]),
    (r"(?<= )\|\|(?= )", ["&&"]),
    (r"(?<=[ (])!(?=[a-z(*])", [""]),
    (r"(?<=[(,=] )-(?=[a-z(])|(?<=\()-(?=[a-z(])", [""]),
    (r"\bmin(?=\()", ["max"]),
    (r"\bmax(?=\()", ["min"]),
    (r"\btrue\b", ["false"]),
    (r"\bfalse\b", ["true"]),
    (r"(?<=[a-z)\]]\.)x\b(?!\()", ["y"]),
    (r"(?<=[a-z)\]]\.)y\b(?!\()", ["x"]),
    (r"(?<=[a-z)\]]\.)z\b(?!\()", ["x"]),
    (r"(?<![\w.])\d+\.\d+(?:e-?\d+)?\b", ["float"]),
    (r"(?<![\w.#])\d+u?\b(?![.\w])", ["int"]),
]


@dataclasses.dataclass(frozen=True)
class Mutant:
    """One change: the characters from `start` to `end` of a line become `new`."""

    group: str
    file: str
    line: int
    start: int
    end: int
    code: str
    new: str

    @property
    def old(self) -> str:
        return self.code[self.start : self.end]

    @property
    def mutated(self) -> str:
        return self.code[: self.start] + self.new + self.code[self.end :]

    @property
    def name(self) -> str:
        return f"{self.file}:{self.line}:{self.start + 1}: `{self.old}` becomes `{self.new}`"

    def is_named(self, entry: dict[str, str]) -> bool:
        """Whether an entry of tools/mutants.toml names this change; its line may have moved."""
        return (entry["file"], entry["code"], entry["mutant"]) == (
            self.file,
            self.code.strip(),
            self.mutated.strip(),
        )


def other_number(text: str, kind: str) -> str:
    if kind == "float":
        return "1.0" if float(text) == 0.0 else repr(float(text) * 2.0)
    suffix = "u" if text.endswith("u") else ""
    return f"{int(text.rstrip('u')) + 1}{suffix}"


def code_lines(path: pathlib.Path) -> Iterator[tuple[int, str, str]]:
    """Numbered lines of code, without comments, declarations, bindings and unit tests."""
    for number, line in enumerate(path.read_text().splitlines(), 1):
        text = line.strip()
        if text.startswith("#[cfg(test)]"):
            return
        code = re.sub(r"//.*", lambda match: " " * len(match[0]), line)
        if '"' in code:  # strings: messages, and names
            code = re.sub(r'"(?:[^"\\]|\\.)*"', lambda match: "\0" * len(match[0]), code)
            if '"' in code:
                continue
        skipped = ("#", "@group", "use ", "pub use", "mod ", "pub mod", "struct ", "@compute")
        if text.startswith(skipped) or "@workgroup_size" in code or "@location" in code:
            continue
        yield number, line, code


def places(group: str, path: pathlib.Path) -> Iterator[Mutant]:
    file = path.relative_to(ROOT).as_posix()
    for number, line, code in code_lines(path):
        for pattern, news in CHANGES:
            for match in re.finditer(pattern, code):
                for new in news:
                    if new in ("float", "int"):
                        new = other_number(match[0], new)
                    start, end = match.span()
                    yield Mutant(group, file, number, start, end, line, new)


def drawn(group: str, seed: int) -> list[Mutant]:
    """All mutants of a group in the order in which they are tried; files alternate."""
    chance = random.Random(f"{seed} {group}")
    _, patterns = GROUPS[group]
    paths = sorted({path for pattern in patterns for path in ROOT.glob(pattern)})
    heaps = []
    for path in paths:
        heap = list(places(group, path))
        chance.shuffle(heap)
        heaps.append(heap)
    # A file's turns are spread in proportion to its number of places; every file gets one first.
    order = []
    for heap in heaps:
        order += [((i + 0.5) / len(heap), chance.random(), m) for i, m in enumerate(heap)]
    order.sort(key=lambda entry: entry[:2])
    firsts = [heap[0] for heap in heaps if heap]
    chance.shuffle(firsts)
    rest = [mutant for *_, mutant in order if mutant not in set(firsts)]
    return firsts + rest


def run(command: list[Any], timeout_s: float, **options: Any) -> tuple[int | None, str]:
    """Exit code (None: timeout) and all output."""
    try:
        done = subprocess.run(
            command,
            timeout=timeout_s,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            check=False,
            **options,
        )
    except subprocess.TimeoutExpired:
        return None, ""
    return done.returncode, done.stdout


def killer(code: int | None, output: str) -> str:
    """The test that noticed the mutant: the first that fails."""
    if code is None:
        return "out of time"
    failed = re.search(r"^test (\S+) \.\.\. FAILED", output, re.MULTILINE)
    return failed[1] if failed else f"exit code {code}"


def verdict(code: int | None, output: str) -> tuple[str, str]:
    """Verdict on a mutant that did not pass a stage. Only a failing test kills it."""
    by = killer(code, output)
    if code is None:
        return "timed out", by
    return ("crashed" if by == f"exit code {code}" else "killed"), by


def copy_tree(to: pathlib.Path) -> None:
    """Copy the files that Git tracks or would add; unchanged files keep their modification time."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, check=True).stdout
    for name in filter(None, listed.decode().split("\0")):
        source, target = ROOT / name, to / name
        if not source.is_file():
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.is_file() or target.read_bytes() != source.read_bytes():
            shutil.copyfile(source, target)


class Shaders:
    """Runs shader mutants; the tests are built once."""

    def __init__(self) -> None:
        self.folder = SCRATCH / "shaders"
        tests = ["cargo", "build", "--locked", "--message-format=json"]
        tests += ["--test", "pictures"]
        built = subprocess.run(tests, cwd=ROOT, stdout=subprocess.PIPE, check=True, text=True)
        messages = [json.loads(line) for line in built.stdout.splitlines() if line[:1] == "{"]
        # Test programs are copied: another build must not change them meanwhile.
        programs = SCRATCH / "programs"
        programs.mkdir(parents=True, exist_ok=True)
        self.programs = {
            m["target"]["name"]: shutil.copy2(m["executable"], programs / m["target"]["name"])
            for m in messages
            if m.get("executable")
        }
        self.environment = os.environ | {
            "REFLET_TEST_SHADERS": str(self.folder),
            "REFLET_REQUIRE_GPU": "1",
        }
        self.reset()
        for stage in self.stages("bvh.wgsl"):
            code, output = run(stage, 3600, cwd=ROOT, env=self.environment)
            if code != 0:
                sys.exit(f"without a mutant, {killer(code, output)} fails:\n{output[-3000:]}")

    def stages(self, file: str) -> Iterator[list[Any]]:
        """Test commands that can notice a change of this file, the quickest first."""
        if file.endswith("bvh.wgsl"):
            yield [self.programs["pictures"], "trace_oracle::"]
        for module in MODULES:
            yield [self.programs["pictures"], f"{module}::"]

    def reset(self) -> None:
        shutil.rmtree(self.folder, ignore_errors=True)
        shutil.copytree(ROOT / "shaders", self.folder)

    def attempt(self, mutant: Mutant) -> tuple[str, str]:
        self.reset()
        write_mutant(self.folder.parent, mutant)
        for stage in self.stages(mutant.file):
            code, output = run(stage, LIMIT_S, cwd=ROOT, env=self.environment)
            refused = re.search(rf"^{re.escape(str(self.folder))}/\S+\.wgsl:\d+.*", output, re.M)
            if code and refused:
                return "does not compile", refused[0]
            if code != 0:
                return verdict(code, output)
        return "survived", ""


class Rust:
    """Runs Rust mutants in a copy of the tree."""

    def __init__(self) -> None:
        self.tree = SCRATCH / "tree"
        target = SCRATCH / "target"
        copy_tree(self.tree)
        if not target.exists() and (ROOT / "target" / "debug").is_dir():
            # Dependencies need not be built again.
            warm = ["cp", "-r", "--reflink=auto", "--preserve=timestamps"]
            target.mkdir(parents=True)
            subprocess.run([*warm, ROOT / "target" / "debug", target / "debug"], check=True)
        self.environment = os.environ | {
            "CARGO_TARGET_DIR": str(target),
            "CARGO_PROFILE_DEV_DEBUG": "0",
        }
        for stage in [METRIC, ["--test", "scene"], ["--workspace", "--lib"]]:
            code, output = self.cargo(stage, 3600)
            if code != 0:
                sys.exit(f"without a mutant, {killer(code, output)} fails:\n{output[-3000:]}")

    def cargo(self, what: list[str], timeout_s: float) -> tuple[int | None, str]:
        command = ["cargo", "test", "--locked", *what]
        return run(command, timeout_s, cwd=self.tree, env=self.environment)

    def attempt(self, mutant: Mutant) -> tuple[str, str]:
        write_mutant(self.tree, mutant)
        try:
            if "src/metric/" in mutant.file:
                stages = [METRIC, ["-p", "reflet-metric", "--lib"]]
            else:
                stages = [["--test", "scene"], ["-p", "reflet-scene", "--lib"]]
            for stage in stages:
                code, output = self.cargo(stage, LIMIT_S)
                if code is not None and "error: could not compile" in output:
                    return "does not compile", first_error(output)
                if code != 0:
                    return verdict(code, output)
            return "survived", ""
        finally:
            shutil.copyfile(ROOT / mutant.file, self.tree / mutant.file)


def write_mutant(tree: pathlib.Path, mutant: Mutant) -> None:
    path = tree / mutant.file
    lines = path.read_text().splitlines(keepends=True)
    assert lines[mutant.line - 1].rstrip("\n") == mutant.code, mutant.name
    lines[mutant.line - 1] = mutant.mutated + "\n"
    path.write_text("".join(lines))


def first_error(output: str) -> str:
    found = re.search(r"^error.*$", output, re.MULTILINE)
    return found[0] if found else ""


def reason_for(mutant: Mutant, reasons: list[dict[str, str]]) -> str | None:
    return next((entry["reason"] for entry in reasons if mutant.is_named(entry)), None)


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seed", type=int, default=SEED, help=f"seed of the random draw ({SEED})")
    parser.add_argument("--group", choices=GROUPS, help="only shader or only rust mutants")
    parser.add_argument("--count", type=int, help="number of mutants of each group")
    parser.add_argument("--only", metavar="TEXT", help="all mutants whose name contains this")
    parser.add_argument("--list", action="store_true", help="print their names, run nothing")
    parser.add_argument("--json", metavar="FILE", help="write the outcome of each mutant there")
    parser.add_argument("--resume", action="store_true", help="keep what that file holds already")
    return parser.parse_args()


def main() -> int:
    args = arguments()
    reasons = tomllib.loads(REASONS.read_text()).get("survivor", []) if REASONS.exists() else []
    results = []
    log = Log(args.json, args.resume)
    for group in [args.group] if args.group else GROUPS:
        mutants = drawn(group, args.seed)
        wanted = args.count or GROUPS[group][0]
        if args.only:
            mutants = [mutant for mutant in mutants if args.only in mutant.name]
            wanted = args.count or len(mutants)
        if args.list:
            print("\n".join(mutant.name for mutant in mutants[:wanted]))
            continue
        results += attempts(group, mutants, wanted, reasons, log)
    return 0 if args.list else summary(results)


class Log:
    """Outcomes by the name of their mutant, kept as a JSON file where one is named."""

    def __init__(self, file: str | None, resume: bool) -> None:
        self.path = pathlib.Path(file) if file else None
        self.results: dict[str, dict[str, Any]] = {}
        if resume and self.path and self.path.exists():
            known = json.loads(self.path.read_text())
            self.results = {result["name"]: result for result in known}

    def add(self, result: dict[str, Any]) -> None:
        self.results[result["name"]] = result
        if self.path:
            text = json.dumps(list(self.results.values()), indent=1)
            self.path.write_text(text + "\n")


def attempts(
    group: str, mutants: list[Mutant], wanted: int, reasons: list[dict[str, str]], log: Log
) -> list[dict[str, Any]]:
    tester: Shaders | Rust | None = None
    results: list[dict[str, Any]] = []
    counted = 0
    for mutant in mutants:
        if counted == wanted:
            break
        started = time.monotonic()
        result = log.results.get(mutant.name)
        if result is None:
            tester = tester or (Shaders() if group == "shader" else Rust())
            outcome, by = tester.attempt(mutant)
            result = {
                "group": group,
                "name": mutant.name,
                "file": mutant.file,
                "code": mutant.code.strip(),
                "mutant": mutant.mutated.strip(),
                "outcome": outcome,
                "by": by,
            }
            log.add(result)
            note = f" ({by})" if by else ""
            seconds = time.monotonic() - started
            print(f"{outcome:<17}{mutant.name}{note}, {seconds:.0f} s", flush=True)
        counted += result["outcome"] != "does not compile"
        survived = result["outcome"] == "survived"
        results.append(result | {"reason": reason_for(mutant, reasons) if survived else None})
    return results


def summary(results: list[dict[str, Any]]) -> int:
    of = {
        outcome: [result for result in results if result["outcome"] == outcome]
        for outcome in ("killed", "timed out", "crashed", "survived", "does not compile")
    }
    tried = len(results) - len(of["does not compile"])
    open_ones = [result for result in of["survived"] if not result["reason"]]
    print(
        f"\n{tried} mutants: {len(of['killed'])} killed by a test, {len(of['timed out'])} out of "
        f"time, {len(of['crashed'])} ended without a failing test, {len(of['survived'])} survived, "
        "of which "
        f"{len(of['survived']) - len(open_ones)} have a reason; {len(of['does not compile'])} more "
        "did not compile"
    )
    for outcome in ("killed", "timed out", "crashed"):
        for result in of[outcome]:
            print(f"  {outcome}: {result['name']}, {result['by']}")
    for result in of["survived"]:
        print(f"  {result['name']}\n    {result['mutant']}")
        print(f"    reason: {result['reason'] or 'none; write a test, or say why not'}")
    return 1 if open_ones else 0


if __name__ == "__main__":
    sys.exit(main())
