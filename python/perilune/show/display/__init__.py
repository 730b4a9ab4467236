"""How samples, simulations, plans, configurations and labels show themselves in notebooks.

Their methods `_repr_html_` come here; nothing of Jupyter is imported, and nothing must be loaded.
Tables and small pictures in HTML that stands alone and takes the colours of the page around it.
"""

from perilune.show.display.frame import objects_html, plan_html, sample_html
from perilune.show.display.scene import configuration_html, simulation_html, taxonomy_html

__all__ = [
    "configuration_html",
    "objects_html",
    "plan_html",
    "sample_html",
    "simulation_html",
    "taxonomy_html",
]
