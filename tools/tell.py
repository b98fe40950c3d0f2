#!/usr/bin/env python3
"""Writes pages of docs from their tables in docs/data, and measures what the tables are of.

    tools/tell.py DOCUMENT                # the page anew, from the tables in docs/data
    tools/tell.py DOCUMENT OUT...         # first takes tables and charts from the runs in OUT
    tools/tell.py DOCUMENT OUT --measure  # measures what OUT lacks, and writes no page
    tools/tell.py DOCUMENT --pictures     # renders pictures of the page that no run makes

Each OUT is measured on one driver (`eval "$(tools/driver.sh newest)"` has all programs use the
newest one); where a page compares drivers, it takes an OUT of each.
"""

import argparse
import pathlib

from documents import DOCUMENTS
from documents.document import DOCS, Document, Run
from measuring import add_program, program_of


def told(document: Document) -> str:
    """The text of a page anew."""
    return document.tell((DOCS / document.page).read_text())


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "document", choices=DOCUMENTS, metavar="DOCUMENT", help=", ".join(DOCUMENTS)
    )
    parser.add_argument("out", type=pathlib.Path, nargs="*", metavar="OUT", help="folder of runs")
    parser.add_argument("--measure", action="store_true", help="measure what OUT lacks")
    parser.add_argument("--pictures", action="store_true", help="render pictures of the page")
    parser.add_argument(
        "--only", metavar="PATTERN", help="parts of the measurement, by their names"
    )
    parser.add_argument("--assets", type=pathlib.Path, help="folder of the paper's models")
    parser.add_argument(
        "--suite", type=pathlib.Path, help="folder with clones of the suites of docs/suites.md"
    )
    add_program(parser)
    arguments = parser.parse_args()
    document = DOCUMENTS[arguments.document]
    outs = [out.resolve() for out in arguments.out]
    work = document.measure if arguments.measure else document.pictures
    if arguments.measure or arguments.pictures:
        if work is None or arguments.measure != (len(outs) == 1):
            parser.error("--measure needs one OUT, --pictures none, and not all pages have both")
        assets = arguments.assets.resolve() if arguments.assets else None
        out = outs[0] if outs else DOCS
        out.mkdir(parents=True, exist_ok=True)
        suite = arguments.suite.resolve() if arguments.suite else None
        work(Run(out, program_of(arguments.reflet), assets, arguments.only, suite))
        return
    if outs:
        document.store(outs)
    page = DOCS / document.page
    page.write_text(told(document))
    print(f"wrote {page}")


if __name__ == "__main__":
    main()
