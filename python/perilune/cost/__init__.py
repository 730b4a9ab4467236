"""What accuracy costs in a scene: its knobs, what each setting errs and takes, and advice."""

from perilune.cost.report import Advice, Point, Report, Setting
from perilune.cost.study import Study

__all__ = ["Advice", "Point", "Report", "Setting", "Study"]
