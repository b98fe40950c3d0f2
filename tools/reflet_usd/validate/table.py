"""Owns how a proof is printed for people."""

from __future__ import annotations

from .proof import Proof

_SHOWN = 3


def format_proof(proof: Proof) -> str:
    """A table of all checks, the first findings of each, and one verdict line."""
    lines = [f"{proof.out}", *_khronos_lines(proof)]
    if proof.unreadable:
        lines.append(f"unreadable: {proof.unreadable}")
    if proof.checks:
        lines.append(f"{'check':<34} {'compared':>8} {'worst':>11} {'limit':>9}  result")
    for check in proof.checks:
        verdict = "ok" if check.passed else f"{check.silent} deviate"
        if check.declared:
            verdict += f", {check.declared} declared"
        lines.append(
            f"{check.bar.title:<34} {check.compared:>8} {check.worst:>11.3g}"
            f" {check.bar.limit:>9.3g}  {verdict} ({check.bar.unit})"
        )
        silent = [finding for finding in check.findings if finding.declared is None]
        for finding in silent[:_SHOWN]:
            lines.append(f"    {finding.prim}: {finding.value:.3g} {finding.text}")
    if proof.roots:
        lines.append(f"the stage was read from {', '.join(proof.roots)} alone")
    for name, count in sorted(_counts(proof).items()):
        lines.append(f"declared by the converter: {name} ×{count}")
    lines.append("passed" if proof.passed else "FAILED")
    return "\n".join(lines)


def _khronos_lines(proof: Proof) -> list[str]:
    report = proof.khronos
    if report is None:
        return []
    lines = [
        f"Khronos validator {report.version}: {report.errors} errors, {report.warnings} warnings"
    ]
    errors = [message for message in report.messages if message.get("severity") == 0]
    for message in errors[:_SHOWN]:
        lines.append(
            f"    {message['code']} at {message.get('pointer', '?')}: {message['message']}"
        )
    return lines


def _counts(proof: Proof) -> dict[str, int]:
    counts: dict[str, int] = {}
    for warning in proof.warnings:
        counts[warning["name"]] = counts.get(warning["name"], 0) + 1
    return counts
