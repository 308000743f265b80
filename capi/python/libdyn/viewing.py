"""Pages of whatever can be seen."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, overload

from . import page
from .errors import ArgumentError
from .live import Viewer, show
from .model import Model
from .recording import Recording
from .simulate import Simulation

if TYPE_CHECKING:
    from .simulate import Controller


@overload
def view(what: Simulation, controller: Controller | None = None, *, open: bool = True) -> Viewer: ...
@overload
def view(what: Model | Recording, *, path: str | os.PathLike[str] | None = None, open: bool = True) -> str: ...


def view(what: Model | Simulation | Recording, controller: Controller | None = None, *,
         path: str | os.PathLike[str] | None = None, open: bool = True) -> Viewer | str:
    """Opens a page in a browser: of a model with joints to be moved, of a recording that plays, or of a simulation that goes on.

    path   of models and recordings: where the page is written; default: the temporary folder. Returned
    open   False: opens no browser

    Of a simulation it returns a Viewer: run() steps in real time with the controller, sync() shows a loop of one's own.
    """
    if isinstance(what, Simulation):
        return Viewer(what, controller, open=open)
    if isinstance(what, Recording):
        text = what._page()
    elif isinstance(what, Model):
        text = page.still(what, what.configuration(what.initial_configuration))
    else:
        raise ArgumentError(f"view takes a Model, a Simulation or a Recording, but was given {what!r}.")
    file = page.write(text, path)
    if open:
        show("file://" + os.path.abspath(file), open)
    return file
