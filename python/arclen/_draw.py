"""Pictures of branches: matplotlib where it is wanted, SVG without it in notebooks."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ._branch import Branch

#: Colours that stay apart for the colour-blind.
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00"]


def axes_of(branch: Branch, x: str | None, y: str | None) -> tuple[str, str]:
    """The columns to draw."""
    x = branch.parameter if x is None else x
    if y is None:
        observables = branch.observables
        # of a shell under load what its user looks for
        y = "force" if "force" in observables else observables[0] if observables else "u[0]"
    return x, y


def pieces(branch: Branch) -> list[tuple[slice, bool]]:
    """Parts of the branch that are stable (True) or not; a piece begins where the last one ends."""
    unstable = np.nan_to_num(branch["unstable"], nan=0.0) > 0
    if unstable.size < 2:
        return [(slice(0, unstable.size), True)]
    # of a step that ends at a special point, which has the smaller count of its sides
    step = unstable[:-1] | unstable[1:]
    for event in branch.events:
        at, before, after = event.index, event.unstable_before, event.unstable_after
        if at > 0 and before is not None:
            step[at - 1] = before > 0
        if at < step.size and after is not None:
            step[at] = after > 0
    cuts = [0, *(np.flatnonzero(step[1:] != step[:-1]) + 1), step.size]
    return [(slice(a, b + 1), not step[a]) for a, b in zip(cuts[:-1], cuts[1:])]


def plot(branch: Branch, ax: Any, x: str | None, y: str | None, style: dict[str, Any]) -> Any:
    """See `Branch.plot`."""
    if ax is None:
        import matplotlib.pyplot as plt

        ax = plt.gca()
    x, y = axes_of(branch, x, y)
    across, up = branch[x], branch[y]
    colour = style.pop("color", style.pop("c", None))
    for piece, stable in pieces(branch):
        dashes = {"linestyle": "-" if stable else "--", **style}
        (line,) = ax.plot(across[piece], up[piece], color=colour, **dashes)
        colour = line.get_color()
    for event in branch.events:
        at = (across[event.index], up[event.index])
        ax.plot(*at, marker="o", markersize=4, color=colour, linestyle="none")
        ax.annotate(event.label, at, textcoords="offset points", xytext=(4, 4), fontsize=8)
    ax.set_xlabel(x)
    ax.set_ylabel(y)
    return ax


def svg(branches: Sequence[Branch], width: int = 480, height: int = 300) -> str:
    """A small picture: lines, and dots with labels at special points."""
    left, right, top, bottom = 60, 12, 12, 36
    x, y = axes_of(branches[0], None, None)
    drawn = [b for b in branches if len(b) and x in b and y in b]
    with np.errstate(all="ignore"):
        points = np.concatenate([np.stack([b[x], b[y]]) for b in drawn], axis=1)
    points = points[:, np.isfinite(points).all(axis=0)]
    if points.size == 0:
        return ""
    low, high = points.min(axis=1), points.max(axis=1)
    span = np.where(high > low, high - low, 1.0)

    def place(a: float, b: float) -> tuple[float, float]:
        across = left + (a - low[0]) / span[0] * (width - left - right)
        return across, top + (high[1] - b) / span[1] * (height - top - bottom)

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" ']
    out.append('font-family="sans-serif" font-size="11">')
    out.append(f'<rect x="{left}" y="{top}" width="{width - left - right}" ')
    out.append(f'height="{height - top - bottom}" fill="none" stroke="#999"/>')
    for number, branch in enumerate(drawn):
        colour = COLOURS[number % len(COLOURS)]
        for piece, stable in pieces(branch):
            steps = [place(a, b) for a, b in zip(branch[x][piece], branch[y][piece])]
            line = " ".join(f"{a:.1f},{b:.1f}" for a, b in steps if np.isfinite(a + b))
            dash = "" if stable else ' stroke-dasharray="5 3"'
            out.append(f'<polyline points="{line}" fill="none" stroke="{colour}"{dash}/>')
        for event in branch.events:
            a, b = place(branch[x][event.index], branch[y][event.index])
            if np.isfinite(a + b):
                out.append(f'<circle cx="{a:.1f}" cy="{b:.1f}" r="3" fill="{colour}"/>')
                out.append(f'<text x="{a + 5:.1f}" y="{b - 5:.1f}">{event.label}</text>')
    middle = left + (width - left - right) / 2
    out.append(f'<text x="{middle}" y="{height - 6}" text-anchor="middle">{escape(x)}</text>')
    out.append(f'<text x="{left - 6}" y="{top + 14}" text-anchor="end">{escape(y)}</text>')
    for value, at in ((low[0], left), (high[0], width - right)):
        out.append(f'<text x="{at}" y="{height - 20}" text-anchor="middle">{value:.4g}</text>')
    for value, at in ((high[1], top), (low[1], height - bottom)):
        out.append(f'<text x="{left - 4}" y="{at + 4}" text-anchor="end">{value:.4g}</text>')
    return "".join([*out, "</svg>"])


def html(branches: Sequence[Branch]) -> str:
    """A picture and a table of the special points."""
    rows = []
    for number, branch in enumerate(branches):
        for event in branch.events:
            cells = [event.label, event.kind, event.type or "", f"{event.p:.9g}"]
            cells.append(f"{event.error_estimate:.1e}")
            if len(branches) > 1:
                cells.insert(0, str(number))
            rows.append("<tr>" + "".join(f"<td>{escape(c)}</td>" for c in cells) + "</tr>")
    titles = ["", "kind", "type", branches[0].parameter if branches else "", "error"]
    if len(branches) > 1:
        titles.insert(0, "branch")
    head = "".join(f"<th>{escape(title)}</th>" for title in titles)
    table = f"<table><tr>{head}</tr>{''.join(rows)}</table>" if rows else ""
    ends = ", ".join(sorted({branch.stopped_because for branch in branches}))
    count = sum(map(len, branches))
    picture = svg(branches) if branches else ""
    return f"<div>{picture}<p>{count} points, stopped: {escape(ends)}</p>{table}</div>"
