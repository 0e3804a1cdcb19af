"""The explorer in a notebook: the same module of JavaScript, carried by anywidget. Its only user."""

from contextlib import suppress
from typing import Any

from regrasp.errors import InvalidInput, shown
from regrasp.explore.dialogue import reply
from regrasp.explore.placing import question_of
from regrasp.explore.question import Question, Shape
from regrasp.explore.server import MODULES
from regrasp.explore.start import Start, of_shape, start_of
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.mesh.mesh import Mesh
from regrasp.outline.outline import Outline
from regrasp.web.modules import module, style

try:
    import anywidget
    import traitlets
except ImportError:
    raise ImportError("the explorer in a notebook needs anywidget: pip install 'regrasp[widget]'") from None

_RENDER = """
let asked_so_far = 0;
export default {
  render({ model, el }) {
    const open = new Map();
    const hear = ({ id, answer }) => {
      open.get(id)?.(answer);
      open.delete(id);
    };
    model.on("msg:custom", hear);
    const ask = (asked) => new Promise((done) => {
      const id = `${Date.now()} ${asked_so_far++}`;
      open.set(id, done);
      model.send({ id, asked });
    });
    const close = open_explorer(el, model.get("begin"), ask);
    return () => { model.off("msg:custom", hear); close(); };
  },
};
"""


class Explorer(anywidget.AnyWidget):
    """A widget in which contacts, load and friction are dragged; made by ``explorer``.

    ``grasp`` and ``load`` are what is seen, to go on with in the next cell.
    """

    _esm = module(*MODULES) + _RENDER
    _css = style(whole=False)
    begin = traitlets.Dict().tag(sync=True)

    def __init__(self, start: Start) -> None:
        super().__init__(begin=start.to_dict())
        self._start, self._question = start, start.question
        self.on_msg(self._heard)

    @property
    def grasp(self) -> Grasp:
        """The contacts as they are now."""
        return self._question.on(self._start.shape).grasp

    @property
    def load(self) -> Wrench:
        """The load as it is now, object frame [N, N m]."""
        return self._question.wrench

    def _heard(self, _: Any, message: Any, __: Any) -> None:
        if not isinstance(message, dict):
            return
        asked = message.get("asked")
        with suppress(InvalidInput):  # which the reply says
            self._question = Question.of(asked.get("question") if isinstance(asked, dict) else None)
        self.send({"id": message.get("id"), "answer": reply(self._start, asked)})


def explorer(
    given: Grasp | Shape | str | None = None, load: Wrench | None = None, *, outline: Shape | None = None
) -> Explorer:
    """A widget to drag contacts, load and friction in, and see what holds.

    Args:
        given: a grasp; an outline or a mesh, on which fingers are put; or, as for ``regrasp explore``, a
            scenario, a drawing, a mesh or the name of a part; the paper's example without any.
        load: of a grasp, the external wrench on the object, object frame [N, N m].
        outline: of a grasp, the outline or mesh its contacts stay on.

    Raises:
        InvalidInput: For anything else.
        ImportError: Without anywidget, the extra ``regrasp[widget]``.
    """
    if isinstance(given, Grasp):
        if not isinstance(load, Wrench):
            raise InvalidInput(f"the explorer of a grasp needs its load, a Wrench; got {shown(load)}")
        if load.dimension != given.dimension:
            raise InvalidInput(f"load must have dimension {given.dimension}, got {load.dimension}")
        return Explorer(Start("grasp", question_of(given, load), outline))
    if load is not None or outline is not None:
        raise InvalidInput("load and outline go with a Grasp; set the load in the explorer")
    if isinstance(given, Outline | Mesh):
        return Explorer(of_shape(given))
    if given is not None and not isinstance(given, str):
        raise InvalidInput(f"the explorer takes a Grasp, an Outline, a Mesh or a name, got {shown(given)}")
    return Explorer(start_of(given))
