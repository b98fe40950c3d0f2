"""Documents of the project that are told from tables, by name."""

from documents import acceptance, films, gpu, light, paper, views

DOCUMENTS = {
    "acceptance": acceptance.DOCUMENT,
    "films": films.DOCUMENT,
    "gpu": gpu.DOCUMENT,
    "light": light.DOCUMENT,
    "paper": paper.DOCUMENT,
    "views": views.DOCUMENT,
}
