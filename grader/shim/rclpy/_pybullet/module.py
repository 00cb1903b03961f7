"""The module `pybullet` as a script meets it: the real one, with calls recorded and a window imagined.

Names, values, errors and return values are those of the real extension. What differs:

- calls that change the world are recorded (`calls.RECORDED`) and carried out;
- ``connect(p.GUI)`` opens no window, and what a window would answer (sliders, keys, the camera) is made up;
- with ``setRealTimeSimulation(1)`` the simulation takes a step for each 1/240 s of virtual time that passes;
- what could not be carried out again is refused by PyBullet's own exception, with a sentence (`calls.REFUSED`).
"""

from __future__ import annotations

from types import BuiltinFunctionType, FunctionType, ModuleType

from rclpy._kernel import kernel
from rclpy._link import link
from rclpy._patches.install import Builtin
from rclpy._pybullet import calls
from rclpy._pybullet.recorder import recorder

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    Callee = Callable[..., Any]

MOST_CLIENTS = 4
MOST_PIXELS = 200 * 320 * 200
"""Of all pictures of a run together, before pictures are no longer drawn: some six seconds."""

_STEP = "stepSimulation"
_WINDOWS = ("GUI", "GUI_SERVER", "GUI_MAIN_THREAD")
_CAMERA = (1024, 768)


class Function(Builtin):
    """A function that `inspect.isbuiltin` takes for one written in C, as `pybullet_utils.bullet_client` does."""

    @property  # type: ignore[misc]
    def __class__(self) -> Any:
        return BuiltinFunctionType


def module_from(real: ModuleType) -> ModuleType:
    """Return the module that scripts import, made of the real extension."""
    module = ModuleType("pybullet", real.__doc__)
    names = {**vars(real), "__spec__": None, "__loader__": None}
    window = _Window(real)
    for name, value in vars(real).items():
        if isinstance(value, BuiltinFunctionType) and calls.KINDS.get(name) != "computes":
            names[name] = _replacement(name, value, window, real)
    module.__dict__.update(names)
    return module


def _replacement(name: str, real: Callee, window: _Window, extension: ModuleType) -> Function:
    call: Callee
    own = getattr(window, name, None)
    if own is not None:
        call = own
    elif name == _STEP:
        call = _step(real)
    elif name in calls.RECORDED:
        call = _recorded(name, real)
    elif calls.KINDS.get(name) == "looks":
        call = _looked(real)
    else:  # also what a newer PyBullet has and the table lacks: nobody knows what it does
        call = _refused(name, calls.REFUSED.get(name, "new functions"), extension)
    call = _named(call, name)
    call.__doc__ = real.__doc__
    return Function(call, "pybullet")


def _named(call: Callee, name: str) -> Callee:
    def renamed(*args: Any, **options: Any) -> Any:
        return call(*args, **options)

    own = call if isinstance(call, FunctionType) else renamed
    own.__name__ = own.__qualname__ = name
    return own


def _recorded(name: str, real: Callee) -> Callee:
    number = calls.RECORDED.index(name)
    looks = name.startswith("get")
    plain, note = calls.plain, recorder.note

    def call(*args: Any, **options: Any) -> Any:
        if recorder.live:
            recorder.catch_up()
        try:
            plainly = [plain(arg) for arg in args]
            options = {key: plain(options[key]) for key in options}
            if not looks or _recomputes(plainly, options):
                note(number, plainly, options)
        except calls.UnreadableError as error:  # what PyBullet has to say of it comes next
            link.note("bullet_unreadable", f"{name}: {error}")
            return real(*args, **options)
        return real(*plainly, **options)

    return call


def _recomputes(args: list[Any], options: dict[str, Any]) -> bool:
    """Return whether `getLinkState` is to recompute the links' places."""
    return bool(options.get("computeForwardKinematics", args[3] if len(args) > 3 else 0))


def _step(real: Callee) -> Callee:
    number = calls.RECORDED.index(_STEP)

    def call(*args: Any, **options: Any) -> Any:
        answer = real(*args, **options)  # first: a call that is refused is no step
        recorder.note(number, args, options)
        recorder.stepped()
        return answer

    def step_alone() -> None:
        recorder.note(number, (), {})
        real()

    recorder.step = step_alone
    return call


def _looked(real: Callee) -> Callee:
    def call(*args: Any, **options: Any) -> Any:
        if recorder.live:
            kernel.charge()
            recorder.catch_up()
        return real(*args, **options)

    return call


def _refused(name: str, what: str, extension: ModuleType) -> Callee:
    def call(*args: Any, **options: Any) -> Any:
        link.note("bullet_refused", name)
        raise extension.error(f"{name}: {what} cannot be replayed, so the grader does not offer them")

    return call


class _Window:
    """PyBullet's window, which is not there: its methods stand for the functions of their names."""

    def __init__(self, real: ModuleType) -> None:
        self._real = real
        self._items = 0
        self._sliders: dict[int, float] = {}
        self._clients: set[int] = set()
        self._camera = (0.0, 0.0, 0.0, 5.0, 50.0, -35.0)
        self._logs = 0
        self._drawn = 0
        self._pictures: dict[tuple[int, int], Any] = {}  # the last one

    def connect(self, method: int, *args: Any, **options: Any) -> int:
        """Open a world without a window; of a server that nobody has started there is no answer."""
        real = self._real
        windows = [getattr(real, name) for name in _WINDOWS if hasattr(real, name)]
        if method not in (*windows, real.DIRECT) or len(self._clients) >= MOST_CLIENTS:
            return -1
        recorder.note(calls.RECORDED.index("connect"), (real.DIRECT,), {})
        client = int(real.connect(real.DIRECT))
        self._clients.add(client)
        return client

    def disconnect(self, physicsClientId: int = 0) -> None:
        recorder.catch_up()
        recorder.note(calls.RECORDED.index("disconnect"), (int(physicsClientId),), {})
        self._clients.discard(physicsClientId)
        self._real.disconnect(physicsClientId)

    def setRealTimeSimulation(self, enableRealTimeSimulation: int, physicsClientId: int = 0) -> None:
        recorder.set_live(bool(enableRealTimeSimulation))

    def setTimeStep(self, timeStep: float, physicsClientId: int = 0) -> None:
        self._set("setTimeStep", timeStep, {"physicsClientId": physicsClientId}, (timeStep,))

    def setPhysicsEngineParameter(self, fixedTimeStep: float = -1.0, *args: Any, **options: Any) -> Any:
        self._set("setPhysicsEngineParameter", fixedTimeStep, options, (fixedTimeStep, *args))

    def _set(self, name: str, step: Any, options: dict[str, Any], args: tuple[Any, ...]) -> None:
        recorder.catch_up()
        plainly = [calls.plain(arg) for arg in args], {key: calls.plain(options[key]) for key in options}
        recorder.note(calls.RECORDED.index(name), *plainly)
        getattr(self._real, name)(*plainly[0], **plainly[1])
        if float(step) > 0.0:
            recorder.set_step(float(step))

    def addUserDebugParameter(
        self,
        paramName: str,
        rangeMin: float = 0.0,
        rangeMax: float = 1.0,
        startValue: float = 0.0,
        physicsClientId: int = 0,
    ) -> int:
        item = self._item()
        self._sliders[item] = float(startValue)
        return item

    def readUserDebugParameter(self, itemUniqueId: int, physicsClientId: int = 0) -> float:
        """Return what a slider shows that nobody moves."""
        if itemUniqueId not in self._sliders:
            raise self._real.error("Failed to read parameter.")
        return self._sliders[itemUniqueId]

    def removeAllUserParameters(self, physicsClientId: int = 0) -> None:
        self._sliders.clear()

    def addUserDebugLine(self, *args: Any, replaceItemUniqueId: int = -1, **options: Any) -> int:
        return self._item(replaceItemUniqueId)

    def addUserDebugText(self, *args: Any, replaceItemUniqueId: int = -1, **options: Any) -> int:
        return self._item(replaceItemUniqueId)

    def addUserDebugPoints(self, *args: Any, replaceItemUniqueId: int = -1, **options: Any) -> int:
        return self._item(replaceItemUniqueId)

    def _item(self, replaced: int = -1) -> int:
        if replaced >= 0:
            return replaced
        self._items += 1
        return self._items - 1

    def removeUserDebugItem(self, itemUniqueId: int, physicsClientId: int = 0) -> None:
        return None

    def removeAllUserDebugItems(self, physicsClientId: int = 0) -> None:
        return None

    def resetDebugVisualizerCamera(
        self,
        cameraDistance: float,
        cameraYaw: float,
        cameraPitch: float,
        cameraTargetPosition: Any,
        physicsClientId: int = 0,
    ) -> None:
        distance, yaw, pitch = (float(value) for value in (cameraDistance, cameraYaw, cameraPitch))
        x, y, z = (float(coordinate) for coordinate in cameraTargetPosition)
        self._camera = (x, y, z, distance, yaw, pitch)
        number = calls.RECORDED.index("resetDebugVisualizerCamera")
        recorder.note(number, (distance, yaw, pitch, [x, y, z]), {})

    def getDebugVisualizerCamera(self, physicsClientId: int = 0) -> tuple[Any, ...]:
        """Return what the window's camera would see, whose size is the usual one."""
        real, (width, height) = self._real, _CAMERA
        x, y, z, distance, yaw, pitch = self._camera
        view = real.computeViewMatrixFromYawPitchRoll((x, y, z), distance, yaw, pitch, 0, 2)
        lens = real.computeProjectionMatrixFOV(60.0, width / height, 0.01, 1000.0)
        ahead, up = (-view[2], -view[6], -view[10]), (0.0, 0.0, 1.0)
        across = tuple(20.0 * width / height * component for component in (view[0], view[4], view[8]))
        above = tuple(20.0 * component for component in (view[1], view[5], view[9]))
        return (width, height, view, lens, up, ahead, across, above, yaw, pitch, distance, (x, y, z))

    def getCameraImage(self, width: int, height: int, *args: Any, **options: Any) -> Any:
        """Return what a camera sees; once very much was drawn, the last picture again.

        Without a graphics card a picture takes thirty milliseconds; PyBullet's own examples draw one at each step.
        """
        kernel.charge()
        recorder.catch_up()
        size = (int(width), int(height))
        if self._drawn > MOST_PIXELS and self._pictures.get(size) is not None:
            link.note_once("bullet_pictures")
            return self._pictures[size]
        self._drawn += size[0] * size[1]
        answer = self._real.getCameraImage(*size, *args, **options)
        self._pictures = {size: answer}
        return answer

    def startStateLogging(self, *args: Any, **options: Any) -> int:
        """Return a number, as PyBullet without a window does for a video; no file is written."""
        link.note_once("bullet_no_log")
        self._logs += 1
        return self._logs - 1

    def stopStateLogging(self, loggingId: int, physicsClientId: int = 0) -> None:
        return None
