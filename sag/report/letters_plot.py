"""The factorial plot: what each letter and each two change, with intervals, a panel for each measure."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import matplotlib

from sag.report.columns import ARROWS
from sag.report.effects import Effect
from sag.report.letters import Letters
from sag.report.measures import Measure
from sag.report.plot import GRID, INK, STYLE

COLOURS = {"better": "#0072B2", "worse": "#D55E00", "": "#7A8294"}
"""Okabe and Ito's blue and vermilion, and grey for what chance may have done."""

NAMES = {
    "better": "better beyond chance (95 %)",
    "worse": "worse beyond chance (95 %)",
    "": "interval includes no effect",
}

ACROSS = 4
"""Panels in a line."""

RATIOS = (
    (1e-6, 1e-4, 0.01, 1, 100, 1e4, 1e6),
    (0.01, 0.1, 1, 10, 100),
    (0.1, 0.2, 0.5, 1, 2, 5, 10),
    (0.3, 0.4, 0.6, 0.8, 1, 1.2, 1.5, 2),
    (0.7, 0.8, 0.9, 1, 1.1, 1.2, 1.3),
    (0.9, 0.95, 1, 1.05, 1.1),
    (0.96, 0.98, 1, 1.02, 1.04),
)
"""Ticks of ratios, the widest first: the first of which three are in range are taken."""


def letters_plot_of(letters: Letters, title: str) -> Any:
    """A matplotlib figure: ratios on logarithmic axes, differences on linear ones, a line where there is no effect."""
    from matplotlib.figure import Figure as Canvas

    panels = {m: [e for e in effects if _can_be_drawn(e)] for m, effects in letters.effects.items()}
    panels = {measure: effects for measure, effects in panels.items() if effects}
    names = list(dict.fromkeys(e.name for effects in letters.effects.values() for e in effects))
    names = [name for name in names if any(e.name == name for effects in panels.values() for e in effects)]
    across = min(ACROSS, len(panels))
    down = math.ceil(len(panels) / across)
    with matplotlib.rc_context(STYLE):
        size = (1.2 + 3.0 * across, 1.7 + down * (0.95 + 0.24 * len(names)))
        canvas = Canvas(figsize=size, layout="constrained")
        canvas.get_layout_engine().set(w_pad=0.12, h_pad=0.1)  # type: ignore[union-attr, call-arg]
        canvas.suptitle(title, fontweight="bold", fontsize=12, color=INK)
        axes = canvas.subplots(down, across, sharey=True, squeeze=False).flatten()
        for panel, (measure, effects) in zip(axes, panels.items()):
            _panel(panel, measure, effects, names)
        for panel in axes[len(panels) :]:
            panel.set_visible(False)
        _legend(canvas)
        canvas.draw_without_rendering()
        canvas.set_layout_engine("none")  # placed once: it is drawn three times
    return canvas


def _can_be_drawn(effect: Effect) -> bool:
    return bool(effect.estimate and effect.source and math.isfinite(effect.estimate.value))


def _panel(axes: Any, measure: Measure, effects: Sequence[Effect], names: Sequence[str]) -> None:
    """Effects from top to bottom, main effects large, what is beyond chance filled."""
    axes.axvline(measure.shown(0.0), color=INK, linewidth=1, zorder=1)
    for effect in effects:
        place, estimate = names.index(effect.name), effect.estimate
        assert estimate and estimate.low is not None and estimate.high is not None
        verdict = measure.verdict(estimate)
        value, low, high = (measure.shown(end) for end in (estimate.value, estimate.low, estimate.high))
        is_main = len(effect.components) == 1
        axes.plot([low, high], [place, place], color=COLOURS[verdict], linewidth=2.2 if is_main else 1.3, zorder=2)
        fill = COLOURS[verdict] if verdict else "white"
        looks = {"markeredgecolor": COLOURS[verdict], "markerfacecolor": fill, "markeredgewidth": 1.4}
        axes.plot(value, place, _marker(verdict), markersize=8 if is_main else 5.5, zorder=3, **looks)
    _frame(axes, measure, names)


def _marker(verdict: str) -> str:
    """Told apart without colours."""
    return {"better": "o", "worse": "s", "": "o"}[verdict]


def _frame(axes: Any, measure: Measure, names: Sequence[str]) -> None:
    from matplotlib.ticker import MaxNLocator

    axes.set_title(f"{measure.name} {ARROWS[measure.better]}", fontsize=10, fontweight="bold", color=INK, loc="left")
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.5, -0.5)
    for place in range(len(names)):
        axes.axhline(place, color=GRID, alpha=0.2, linewidth=0.8, zorder=0)
    mains = sum("×" not in name for name in names)
    if mains < len(names):
        axes.axhline(mains - 0.5, color=INK, linewidth=0.8, alpha=0.6)
    axes.tick_params(labelsize=9)
    axes.xaxis.set_major_locator(MaxNLocator(4))
    if measure.is_ratio:
        _tick_ratios(axes)
    axes.set_xlabel("ratio, on / off" if measure.is_ratio else _difference(measure), fontsize=9)


def _difference(measure: Measure) -> str:
    return " ".join(filter(None, ("on less off", f"({measure.unit})" if measure.unit else "")))


def _tick_ratios(axes: Any) -> None:
    """A few plain ratios, such as 0.5, 0.7 and 1, that hold whatever the range."""
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter

    axes.set_xscale("log")
    low, high = axes.get_xlim()
    places = next((found for ticks in RATIOS if len(found := [t for t in ticks if low <= t <= high]) > 2), [1])
    axes.xaxis.set_major_locator(FixedLocator(places))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def _legend(canvas: Any) -> None:
    from matplotlib.lines import Line2D

    marks = []
    for verdict, name in NAMES.items():
        colour = COLOURS[verdict]
        looks: Any = {"markeredgecolor": colour, "markerfacecolor": colour if verdict else "white"}
        marks.append(Line2D([], [], marker=_marker(verdict), color=colour, label=name, **looks))
    canvas.legend(handles=marks, loc="outside lower center", ncols=len(marks), frameon=False)
