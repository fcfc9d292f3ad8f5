"""The directive that a fenced block `mermaid` is: its flowchart is drawn while the site is built."""

from typing import Any

from docutils import nodes
from flowchart import drawing
from sphinx.util.docutils import SphinxDirective


class Mermaid(SphinxDirective):
    """The directive that a fenced block `mermaid` is."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        try:
            return [nodes.raw("", drawing("\n".join(self.content)), format="html")]
        except ValueError as error:
            raise self.error(f"flowchart: {error}") from error


def setup(app: Any) -> dict[str, bool]:
    """Called by Sphinx."""
    app.add_directive("mermaid", Mermaid)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
