"""A peer of a shared 3D world inside a Python program.

    import peerd

    with peerd.Peer(world="town.wrl", name="ada", own=["CAR"]) as peer:
        car = peer.find("CAR")
        peer.take(car)
        while peer.poll(0.01):
            peer.move(car, [0, 1, 0, 0, 0, 0, 1])
            for event in peer.events():
                print(event.kind, event.time)

In asyncio, the peer has a thread of its own, and the loop sleeps until there is an event:

    async with peerd.Peer(join="town", name="bob") as peer:
        async for event in peer.stream():
            print(event.kind, event.time)

Metres, seconds and radians; places and velocities are in the world's frame, right-handed with y up. A pose is seven
numbers: x, y, z, and the unit quaternion x, y, z, w that turns the object's axes into the world's. An object is a number
that is the same at all peers. What can't be done raises peerd.Error.

Without a thread (start()) all of a peer's functions are called in one thread at a time; with one, in any. A peer belongs to the
process that opened it: in a child of os.fork() its functions raise Error, and close() does nothing to it.
"""
from __future__ import annotations

import asyncio
import contextlib
import json
import os
import time
from typing import Any, AsyncIterator, Callable, Iterator, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _peerd
from ._peerd import NO_OBJECT, Error, Event, EventKind, Operation, Pose

__all__ = ["Error", "Event", "EventKind", "NO_OBJECT", "Object", "Operation", "Peer", "Pose"]
__version__ = _peerd.version()

Object = int
Log = Callable[[int, str], None]
_LOOK_AGAIN_S = 0.005


def _options(log: Optional[Log], values: dict[str, Any]) -> _peerd.Options:
    options = _peerd.Options()
    for name, value in values.items():
        name = name.rstrip("_").replace("_", "-")
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


def _ids(objects: ArrayLike) -> NDArray[np.uint64]:
    return np.ascontiguousarray(objects, dtype=np.uint64).reshape(-1)


def _rows(numbers: ArrayLike, count: int) -> NDArray[np.float64]:
    return np.ascontiguousarray(numbers, dtype=np.float64).reshape(count, -1)


class Peer:
    """A peer. Its options are those of `peerd run` and, with `join`, of `peerd join`, with _ for -.

        Peer(world="town.wrl", name="ada", own=["CAR"])   founds a session of that file, or takes part in it
        Peer(join="town", name="bob")                     gets the world from the peers that are in it; join="": the only one
        Peer(config="town.toml", peer="a")                one of a configuration's peers

    `own` and `set` take lists; `open`, `fresh`, `take_over` and `verbose` take True or False. `from_` stands for from,
    which Python keeps for itself. `log` gets lines of the peer's log: a level from 0 (debug) to 3 (error), and the text.
    It must not call the peer; what it raises goes to sys.unraisablehook, and the peer goes on.

    Opening a peer reads the world, or gets it from others, which takes a second or more: in asyncio,
    `await asyncio.to_thread(peerd.Peer, join="town")`. Raises Error where an option, the world or the network is wrong.
    """

    def __init__(self, *, log: Optional[Log] = None, **options: Any) -> None:
        self._peer: Optional[_peerd.Peer] = _peerd.Peer(_options(log, options))
        self._has_thread = False

    def _open(self) -> _peerd.Peer:
        if self._peer is None:
            raise Error("the peer is closed")
        return self._peer

    def __enter__(self) -> "Peer":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    async def __aenter__(self) -> "Peer":
        """Starts the peer's thread, unless it has been started."""
        return self if self._has_thread else self.start()

    async def __aexit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Says goodbye to the others, and ends the peer. It may be closed twice; all other functions then raise Error."""
        self._peer = None

    @property
    def handle(self) -> int:
        """The address of the peer for functions of the C interface, peerd.h, such as by ctypes. It is this object's to close."""
        return self._open().handle()

    # -- driving
    def poll(self, at_most_s: float = 0.0) -> bool:
        """Does what is due, and waits for it at most so many seconds. Call it some sixty times a second or more.

        False: the peer has left, or it has a thread, which does that.
        """
        return self._open().poll(at_most_s)

    def start(self) -> "Peer":
        """From now on the peer runs in a thread of its own, and nobody polls it. Returns the peer.

        Raises Error where it has a thread already.
        """
        self._open().start()
        self._has_thread = True
        return self

    @contextlib.contextmanager
    def hold(self) -> Iterator["Peer"]:
        """Keeps the peer's thread waiting, so that several calls see one moment, and cost one wait in place of one each.

            with peer.hold():
                poses = peer.poses(cars), peer.session_time

        Holds of one thread nest. Not to be kept over an `await`. A peer without a thread waits for nobody.
        """
        peer = self._open()
        peer.hold()
        try:
            yield self
        finally:
            peer.end_hold()

    def wait_until(self, holds: Callable[[], bool], at_most_s: float = 10.0) -> None:
        """Polls the peer, or sleeps where it has a thread, until that is so.

        Raises TimeoutError where it is not so after that many seconds, and Error where the peer has left. In asyncio,
        `await asyncio.to_thread(peer.wait_until, lambda: peer.in_session)`.
        """
        give_up = time.monotonic() + at_most_s
        while not holds():
            if self.has_left:
                raise Error("the peer has left")
            if time.monotonic() > give_up:
                raise TimeoutError(f"not within {at_most_s} s")
            if self._has_thread:
                time.sleep(_LOOK_AGAIN_S)
            else:
                self.poll(_LOOK_AGAIN_S)

    def leave(self) -> None:
        """Leaves the session. What the peer has may still be read."""
        self._open().leave()

    @property
    def has_left(self) -> bool:
        """Whether it has left, by itself too, as where another peer of its number is running."""
        return self._open().has_left()

    # -- the session
    @property
    def id(self) -> int:
        """The number of this peer, from 1."""
        return self._open().id()

    @property
    def in_session(self) -> bool:
        """Whether it has the time that all of the session's peers share."""
        return self._open().in_session()

    @property
    def session_time(self) -> Optional[float]:
        """The time that all of the session's peers share, in seconds; None: it is in no session."""
        return self._open().session_time()

    @property
    def member_count(self) -> int:
        """How many other peers are here."""
        return self._open().member_count()

    # -- what there is
    def find(self, path: str) -> Optional[Object]:
        """The object at a path, such as "CAR" or "TOWN/CAR/WHEEL"; None: there is none."""
        return self._open().find(path)

    def path(self, object: Object) -> Optional[str]:
        """The path of an object; None: there is no such object."""
        return self._open().path(object)

    def owner(self, object: Object) -> int:
        """The number of the peer that runs it; 0: nobody."""
        return self._open().owner(object)

    def owned_objects(self) -> NDArray[np.uint64]:
        """All objects that somebody owns, ascending: shape (n,)."""
        return self._open().owned_objects()

    def world(self) -> str:
        """The scene as it is now, as VRML97. Raises Error where it has more than 4 MiB, or can't be written."""
        return self._open().world()

    # -- where it is, and moving what is this peer's
    def poses(self, objects: ArrayLike, out: Optional[NDArray[np.float64]] = None) -> NDArray[np.float64]:
        """Where objects are now, as a viewer of this peer shows them: shape (n, 7), a row for each of the n objects.

        A row is x, y, z [m] and the quaternion x, y, z, w, in the world's frame; NaN where there is no such object, and
        everywhere before there is a session. `out`, a C-contiguous array of float64 of that shape, is written to in
        place and returned; where it is of another type, TypeError; of another shape, ValueError. Where `objects` is an
        array of uint64 nothing is copied.
        """
        ids = _ids(objects)
        if out is None:
            out = np.empty((len(ids), 7))
        self._open().poses(ids, out)
        return out

    def pose(self, object: Object) -> Optional[NDArray[np.float64]]:
        """Where one object is now: shape (7,). None: there is no such object, or no session. For many, poses()."""
        row = self.poses([object])[0]
        return None if np.isnan(row[0]) else row

    def take(self, object: Object) -> None:
        """Asks for an object: OBJECT_GIVEN says that it is this peer's. From then on move() moves it.

        Raises Error where there is no such object, or it can't be had.
        """
        self._open().take(object)

    def release(self, object: Object) -> None:
        """The object is nobody's from then on, and stays where it is. Raises Error where it is not this peer's."""
        self._open().release(object)

    def move(self, objects: Union[Object, ArrayLike], poses: ArrayLike, velocities: Optional[ArrayLike] = None,
             jumps: bool = False) -> int:
        """Where own objects are now: one object and seven numbers, or n objects and an array of shape (n, 7), as poses() has it.

        `velocities`, shape (n, 3) [m/s], in the world's frame; without them they are found from the poses, which is less
        exact. A row of NaN: of that object it is found. `jumps`: they were placed, and have not moved there. Returns how
        many were taken: others this program may not move, now. Raises ValueError where shapes do not fit.
        """
        ids = _ids(objects)
        speeds = None if velocities is None else _rows(velocities, len(ids))
        return self._open().move(ids, _rows(poses, len(ids)), speeds, jumps)

    # -- changing the world
    def add(self, vrml: str, under: Object = NO_OBJECT) -> Operation:
        """Adds the nodes of a VRML text below an object, or at the top level.

        As all edits it takes effect at all peers at one instant, some 100 ms later; the event EDIT says so. Edits raise
        Error where they are refused at once: wrong VRML, no such object, something locked.
        """
        return self._open().add(vrml, under)

    def remove(self, object: Object) -> Operation:
        """Removes an object with all that is below it."""
        return self._open().remove(object)

    def reparent(self, object: Object, under: Object = NO_OBJECT) -> Operation:
        """Moves an object below another one, or to the top level. Its fields stay what they are, in the new parent's frame."""
        return self._open().reparent(object, under)

    def set(self, path: str, field: str, value: Union[str, Sequence[float], float]) -> Operation:
        """A field of the node at the path: a text in the notation of VRML, or numbers."""
        text = value if isinstance(value, str) else " ".join(repr(float(each)) for each in np.ravel(value))
        return self._open().set(path, field, text)

    def set_data(self, path: str, key: str, value: Optional[str]) -> Operation:
        """Data of an application at the node at the path, which all peers keep; None: the key is removed."""
        return self._open().set_data(path, key, value)

    def data(self, path: str, key: str) -> Optional[str]:
        """Data of an application at the node at the path; None: there is none."""
        return self._open().data(path, key)

    def send(self, topic: str, message: str) -> Operation:
        """A message to all peers, this one too: the event MESSAGE."""
        return self._open().send(topic, message)

    def undo(self) -> Operation:
        """Undoes this peer's last edit. Raises Error where there is none."""
        return self._open().undo()

    def redo(self) -> Operation:
        """Takes back this peer's last undo. Raises Error where there is none."""
        return self._open().redo()

    def ask(self, **request: Any) -> dict[str, Any]:
        """A request of the control protocol, such as ask(do="status"), and its reply. Raises Error where it is refused."""
        reply: dict[str, Any] = json.loads(self._open().ask(json.dumps(request)))
        if not reply.get("ok", False):
            raise Error(reply.get("error", "the peer does not say why"))
        return reply

    # -- events
    def events(self) -> Iterator[Event]:
        """Takes the events that wait. Of more than 65,536 the oldest are lost, and EVENTS_LOST says how many."""
        while (event := self._open().next_event()) is not None:
            yield event

    async def stream(self) -> AsyncIterator[Event]:
        """Takes events as they come, for `async for`, until the peer leaves or is closed.

        The loop sleeps until there is one. The peer has a thread (start(), or `async with`), or something else polls it.
        An event goes to one stream only.
        """
        # A descriptor of this stream's own: an event loop knows one reader of each, and the peer's ends with the peer.
        descriptor = os.dup(self._open().event_descriptor())
        loop, woken = asyncio.get_running_loop(), asyncio.Event()
        loop.add_reader(descriptor, woken.set)
        try:
            while self._peer is not None:
                woken.clear()
                for event in self.events():
                    yield event
                    if self._peer is None:
                        return
                if self.has_left:
                    return
                await woken.wait()
        finally:
            loop.remove_reader(descriptor)
            os.close(descriptor)
