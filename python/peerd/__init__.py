"""A peer of a shared 3D world inside a Python program.

    import peerd

    with peerd.Peer(world="town.wrl", name="ada", own=["CAR"]) as peer:
        car = peer.find("CAR")
        peer.take(car)
        while peer.poll(0.01):
            peer.move(car, [0, 1, 0, 0, 0, 0, 1])
            for event in peer.events():
                print(event.kind, event.time)

Metres, seconds and radians; places are in the world's frame, right-handed with y up. A pose is seven numbers: x, y, z, and
the unit quaternion x, y, z, w that turns the object's axes into the world's. An object is a number that is the same at all
peers. What can't be done raises peerd.Error.
"""
from __future__ import annotations

import asyncio
import json
from typing import Any, AsyncIterator, Callable, Iterable, Iterator, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _peerd
from ._peerd import NO_OBJECT, Error, Event, EventKind, Operation, Pose

__all__ = ["Error", "Event", "EventKind", "NO_OBJECT", "Operation", "Peer", "Pose"]
__version__ = _peerd.version()

Object = int
Log = Callable[[int, str], None]
_EVENT_PERIOD_S = 0.01


def _options(log: Optional[Log], values: dict[str, Any]) -> _peerd.Options:
    options = _peerd.Options()
    for name, value in values.items():
        name = name.replace("_", "-")
        if isinstance(value, bool):
            options.set(name, "yes" if value else "no")
        elif isinstance(value, (list, tuple)):
            for each in value:
                options.set(name, str(each))
        elif value is not None:
            options.set(name, str(value))
    if log is not None:
        options.log_to(log)
    return options


class Peer:
    """A peer. Its options are those of `peerd run`, with _ for -; own and set take lists, flags take True or False.

    `log` gets lines of the peer's log: a level from 0 (debug) to 3 (error), and the text. It must not call the peer.
    """

    def __init__(self, *, log: Optional[Log] = None, **options: Any) -> None:
        self._peer: Optional[_peerd.Peer] = _peerd.Peer(_options(log, options))

    def _open(self) -> _peerd.Peer:
        if self._peer is None:
            raise Error("the peer is closed")
        return self._peer

    def __enter__(self) -> "Peer":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Says goodbye to the others, and ends the peer. It may be closed twice."""
        self._peer = None

    # -- driving
    def poll(self, at_most_s: float = 0.0) -> bool:
        """Does what is due, and waits for it at most so long. False: the peer has left."""
        return self._open().poll(at_most_s)

    def start(self) -> "Peer":
        """From now on the peer runs in a thread of its own, and nobody polls it."""
        self._open().start()
        return self

    def leave(self) -> None:
        self._open().leave()

    # -- the session
    @property
    def id(self) -> int:
        return self._open().id()

    @property
    def in_session(self) -> bool:
        """Whether it has the time that all of the session's peers share."""
        return self._open().in_session()

    @property
    def session_time(self) -> Optional[float]:
        """In seconds; None: it is in no session."""
        return self._open().session_time()

    @property
    def member_count(self) -> int:
        """How many other peers are here."""
        return self._open().member_count()

    # -- what there is
    def find(self, path: str) -> Optional[Object]:
        return self._open().find(path)

    def path(self, object: Object) -> Optional[str]:
        return self._open().path(object)

    def owner(self, object: Object) -> int:
        """The peer that runs it; 0: nobody."""
        return self._open().owner(object)

    def owned_objects(self) -> NDArray[np.uint64]:
        """All objects that somebody owns, ascending."""
        return np.array(self._open().owned_objects(), dtype=np.uint64)

    def world(self) -> str:
        """The scene as it is now, as VRML97."""
        return self._open().world()

    # -- where it is, and moving what is this peer's
    def poses(self, objects: ArrayLike, out: Optional[NDArray[np.float64]] = None) -> NDArray[np.float64]:
        """Where they are now, one row each; NaN where there is none. `out` is written to in place."""
        ids = np.ascontiguousarray(objects, dtype=np.uint64).reshape(-1)
        if out is None:
            out = np.empty((len(ids), 7))
        self._open().poses(ids, out)
        return out

    def pose(self, object: Object) -> Optional[NDArray[np.float64]]:
        row = self.poses([object])[0]
        return None if np.isnan(row[0]) else row

    def take(self, object: Object) -> None:
        """Asks for an object: OBJECT_GIVEN says that it is this peer's. From then on move() moves it."""
        self._open().take(object)

    def release(self, object: Object) -> None:
        self._open().release(object)

    def move(self, objects: Union[Object, ArrayLike], poses: ArrayLike, velocities: Optional[ArrayLike] = None,
             jumps: bool = False) -> int:
        """Where own objects are now, one row each, and their velocities, which are found from their poses without. Returns how
        many were taken: others are not this program's to move."""
        ids = np.ascontiguousarray(objects, dtype=np.uint64).reshape(-1)
        rows = np.ascontiguousarray(poses, dtype=np.float64).reshape(len(ids), -1)
        speeds = None if velocities is None else np.ascontiguousarray(velocities, dtype=np.float64).reshape(len(ids), -1)
        return self._open().move(ids, rows, speeds, jumps)

    # -- changing the world
    def add(self, vrml: str, under: Object = NO_OBJECT) -> Operation:
        """Adds the nodes of a VRML text. As all edits it takes effect at all peers at one instant, some 100 ms later."""
        return self._open().add(vrml, under)

    def remove(self, object: Object) -> Operation:
        return self._open().remove(object)

    def reparent(self, object: Object, under: Object) -> Operation:
        return self._open().reparent(object, under)

    def set(self, path: str, field: str, value: Union[str, Sequence[float], float]) -> Operation:
        """A field of a node, in the notation of VRML, or as numbers."""
        text = value if isinstance(value, str) else " ".join(repr(float(each)) for each in np.ravel(value))
        return self._open().set(path, field, text)

    def set_data(self, path: str, key: str, value: Optional[str]) -> Operation:
        """Data of an application at a node; None: the key is removed."""
        return self._open().set_data(path, key, value)

    def data(self, path: str, key: str) -> Optional[str]:
        return self._open().data(path, key)

    def send(self, topic: str, message: str) -> Operation:
        """A message to all."""
        return self._open().send(topic, message)

    def undo(self) -> Operation:
        return self._open().undo()

    def redo(self) -> Operation:
        return self._open().redo()

    def ask(self, **request: Any) -> dict[str, Any]:
        """A request of the control protocol, such as ask(do="status"), and its reply."""
        reply = json.loads(self._open().ask(json.dumps(request)))
        if not reply.get("ok", False):
            raise Error(reply.get("error", "the peer does not say why"))
        return reply

    # -- events
    def events(self) -> Iterator[Event]:
        """The events that wait."""
        while (event := self._open().next_event()) is not None:
            yield event

    async def stream(self) -> AsyncIterator[Event]:
        """Events as they come, for `async for`, of a peer that runs in its own thread."""
        while self._peer is not None:
            for event in self.events():
                yield event
            await asyncio.sleep(_EVENT_PERIOD_S)
