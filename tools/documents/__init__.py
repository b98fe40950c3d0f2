"""Documents of the project that are told from tables, by name."""

from documents import acceptance, comparators, films, gpu, light, paper, stability, suites, views

DOCUMENTS = {
    "acceptance": acceptance.DOCUMENT,
    "comparators": comparators.DOCUMENT,
    "films": films.DOCUMENT,
    "gpu": gpu.DOCUMENT,
    "light": light.DOCUMENT,
    "paper": paper.DOCUMENT,
    "stability": stability.DOCUMENT,
    "suites": suites.DOCUMENT,
    "views": views.DOCUMENT,
}
