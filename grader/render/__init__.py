"""Graded results made readable: terminal tables, plots, JSON.

Every public name is loaded on first use, so that importing this package costs neither rich nor matplotlib::

    from grader import render
    render.console().print(render.render_report(report, language="zh", file_name=name, title=title))
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from grader.render.dashboard import render_dashboard as render_dashboard
    from grader.render.documents import json_report as json_report
    from grader.render.documents import to_gradescope as to_gradescope
    from grader.render.documents import to_prairielearn as to_prairielearn
    from grader.render.plot import plot_png as plot_png
    from grader.render.plot import plot_svg as plot_svg
    from grader.render.terminal import console as console
    from grader.render.terminal import render_report as render_report
    from grader.render.timeline import render_timeline as render_timeline

_HOME = {
    "console": "terminal",
    "json_report": "documents",
    "plot_png": "plot",
    "plot_svg": "plot",
    "render_dashboard": "dashboard",
    "render_report": "terminal",
    "render_timeline": "timeline",
    "to_gradescope": "documents",
    "to_prairielearn": "documents",
}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        message = f"module {__name__!r} has no attribute {name!r}"
        raise AttributeError(message)
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
