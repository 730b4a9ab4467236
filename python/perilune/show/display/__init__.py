"""How samples and simulations show themselves in notebooks.

Their methods `_repr_html_` come here; nothing of Jupyter is imported, and nothing must be loaded.
Tables and small pictures in HTML that stands alone and takes the colours of the page around it.
"""

from perilune.show.display.frame import sample_html
from perilune.show.display.scene import simulation_html

__all__ = ["sample_html", "simulation_html"]
