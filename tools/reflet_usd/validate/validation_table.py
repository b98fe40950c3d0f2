"""Owns the printed form of a validation."""

import collections

from .validation import Validation

_SHOWN = 3


def format_validation(validation: Validation) -> str:
    """A table of all checks, the first findings of each, and one verdict line."""
    lines = [f"{validation.out}", *_khronos_lines(validation)]
    if validation.unreadable:
        lines.append(f"unreadable: {validation.unreadable}")
    if validation.checks:
        lines.append(f"{'check':<34} {'compared':>8} {'worst':>11} {'limit':>9}  result")
    for check in validation.checks:
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
    if validation.roots:
        lines.append(f"the stage was read from {', '.join(validation.roots)} alone")
    declared = collections.Counter(warning["name"] for warning in validation.warnings)
    for name, count in sorted(declared.items()):
        lines.append(f"declared by the converter: {name} ×{count}")
    lines.append("passed" if validation.passed else "FAILED")
    return "\n".join(lines)


def _khronos_lines(validation: Validation) -> list[str]:
    report = validation.khronos
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
