"""Tables of a model and a data for notebooks."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from typing import Any

from .errors import Error
from .tables import FIELDS


def _table(heads: Iterable[str], rows: Iterable[Iterable[Any]]) -> str:
    cells = lambda tag, row: "".join(f"<{tag}>{escape(str(x))}</{tag}>" for x in row)
    body = "".join(f"<tr>{cells('td', row)}</tr>" for row in rows)
    return f"<table><thead><tr>{cells('th', heads)}</tr></thead><tbody>{body}</tbody></table>"


def _range(first: int, n: int) -> str:
    return "" if n == 0 else str(first) if n == 1 else f"{first}:{first + n}"


def model(m: Any) -> str:
    """Its joints."""
    rows = []
    for j in m.joints[1:]:
        own = slice(j.idx_q, j.idx_q + j.nq)
        limits = [f"{a:g} to {b:g}" for a, b in zip(m.lower_limit[own], m.upper_limit[own]) if a > -1e300 or b < 1e300]
        follows = f"{j.mimic_ratio:g} {m.joint_name(j.mimic_leader)} + {j.mimic_offset:g}" if j.mimic_leader >= 0 else ""
        kind = getattr(j.type, "name", str(j.type)).lower()
        rows.append((j.id, j.name, kind, m.joint_name(j.parent), _range(j.idx_q, j.nq), _range(j.idx_v, j.nv),
                     follows or ", ".join(limits)))
    head = f"<b>dyn.Model {escape(m.name)}</b>: nq {m.nq}, nv {m.nv}, {m.nbodies} links, {m.nframes} frames, {m.nshapes} shapes, {m.total_mass:.6g} kg"
    return head + _table(("joint", "name", "type", "parent", "q", "v", "limits, or what it follows"), rows)


def data(d: Any) -> str:
    """The fields that hold for its state; of the others which call computes them."""
    rows = []
    for info in FIELDS.values():
        try:
            value = d.field(info.name)
        except Error:
            continue
        shown = (f"{value:.6g}" if isinstance(value, float) else " ".join(f"{x:.4g}" for x in value.ravel())
                 if value.size <= 8 else f"array {value.shape}")
        rows.append((info.name, shown, info.unit, info.frame, info.sentence))
    return (f"<b>{escape(repr(d)[1:-1])}</b>; what was not computed is not shown"
            + _table(("field", "value", "unit", "frame", ""), rows))
