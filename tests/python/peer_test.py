"""Peers in this program, by the Python package, over multicast on lo."""
import asyncio
import ctypes
import fcntl
import os
import random
import signal
import sys
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np

import peerd

WORLD = """#VRML V2.0 utf8
DEF CAR Transform { children Shape { geometry Box { } } }
DEF CUBE Transform { translation 8 0 0 children Shape { geometry Box { } } }
CollisionInterest { objectPath "CAR" interests "CUBE" collisionType 1 }
"""
GIVES_UP_S = 20.0


class PeerTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        os.environ["XDG_CONFIG_HOME"] = self.folder.name
        self.world = Path(self.folder.name, "w.wrl")
        self.world.write_text(WORLD)
        self.port = random.SystemRandom().randrange(20_000, 30_000)

    def tearDown(self):
        self.folder.cleanup()

    def open(self, name, own, **more):
        return peerd.Peer(world=self.world, name=name, own=[own], interface="lo", port=self.port, take_over=True, **more)

    def run_until(self, peers, holds):
        give_up = time.monotonic() + GIVES_UP_S
        while not holds():
            self.assertLess(time.monotonic(), give_up)
            for peer in peers:
                self.assertTrue(peer.poll(0.002))

    def test_two_peers_move_meet_and_edit(self):
        with self.open("a", "CAR") as a, self.open("b", "CUBE") as b:
            self.run_until([a, b], lambda: a.in_session and b.in_session and a.member_count == b.member_count == 1)
            car, cube = a.find("CAR"), a.find("CUBE")
            self.run_until([a, b], lambda: b.owner(car) == a.id and a.owner(cube) == b.id)
            np.testing.assert_array_equal(b.owned_objects(), [car, cube])
            a.take(car)
            began, contacts = a.session_time, {}

            def meet():
                x = 4.0 * (a.session_time - began)
                self.assertIn(a.move(car, [x, 0, 0, 0, 0, 0, 1], [4, 0, 0]), (0, 1))
                for peer in (a, b):
                    for event in peer.events():
                        if event.kind == peerd.EventKind.CONTACT:
                            contacts[peer.id] = event
                return len(contacts) == 2

            self.run_until([a, b], meet)
            at_a, at_b = contacts[a.id], contacts[b.id]
            self.assertEqual((at_a.time, at_a.peer), (at_b.time, at_b.peer))
            self.assertEqual({at_a.object, at_a.other}, {car, cube})

            out = np.empty((2, 7))
            self.assertIs(b.poses([car, cube], out), out)
            self.assertGreater(out[0, 0], 3.0)
            self.assertEqual(out[1, 0], 8.0)
            self.assertTrue(np.isnan(b.poses([peerd.NO_OBJECT])).all())
            self.assertIsNone(b.find("HORSE"))

            b.add("DEF BALL Transform { children Shape { geometry Sphere { } } }")
            self.run_until([a, b], lambda: a.find("BALL") is not None)
            a.set("BALL", "translation", [1, 2, 3])
            self.run_until([a, b], lambda: list(b.pose(b.find("BALL"))[:3]) == [1, 2, 3])
            a.set_data("BALL", "colour", "red")
            self.run_until([a, b], lambda: b.data("BALL", "colour") == "red")
            self.assertEqual(a.ask(do="status")["peer"]["name"], "a")

    def meet(self, a, b):
        """Both have threads, and see each other."""
        for peer in (a, b):
            peer.wait_until(lambda: peer.in_session and peer.member_count == 1, GIVES_UP_S)

    def test_a_peer_joins_a_world_without_its_file(self):
        name = f"joined-{self.port}"  # other tests of this computer are not joined
        with self.open("a", "CAR", world_name=name).start() as a:
            a.wait_until(lambda: a.in_session, GIVES_UP_S)
            a.add("DEF BALL Transform { translation 1 2 3 children Shape { geometry Sphere { } } }")
            a.wait_until(lambda: a.find("BALL") is not None, GIVES_UP_S)
            with peerd.Peer(join=name, name="b", interface="lo").start() as b:
                self.meet(a, b)
                self.assertEqual(b.find("CAR"), a.find("CAR"))
                b.wait_until(lambda: b.find("BALL") is not None, GIVES_UP_S)
                self.assertEqual(list(b.pose(b.find("BALL"))[:3]), [1, 2, 3])

    def test_a_loop_sleeps_until_there_is_an_event(self):
        async def talk():
            async with self.open("a", "CAR") as a, self.open("b", "CUBE") as b:
                await asyncio.to_thread(self.meet, a, b)
                messages = asyncio.create_task(self.messages(b))
                await asyncio.sleep(0.1)
                self.assertFalse(messages.done())
                began = time.monotonic()
                a.send("chat", "hello")
                a.send("chat", "goodbye")
                while len(messages_of_b) < 2:
                    await asyncio.wait_for(heard.wait(), GIVES_UP_S)
                    heard.clear()
                self.assertEqual([(e.name, e.text, e.peer) for e in messages_of_b], [("chat", "hello", a.id), ("chat", "goodbye", a.id)])
                self.assertLess(time.monotonic() - began, GIVES_UP_S)
                b.leave()
                self.assertEqual(await asyncio.wait_for(messages, GIVES_UP_S), 2)  # the stream has ended
                self.assertTrue(b.has_left)
                with self.assertRaisesRegex(peerd.Error, "has left"):
                    b.wait_until(lambda: False)

        messages_of_b, heard = [], asyncio.Event()
        self.note = lambda event: (messages_of_b.append(event), heard.set())
        asyncio.run(talk())

    async def messages(self, peer):
        count = 0
        async for event in peer.stream():
            if event.kind == peerd.EventKind.MESSAGE:
                count += 1
                self.note(event)
        return count

    def test_a_stream_ends_when_the_peer_is_closed_in_it(self):
        async def first(peer):
            async for event in peer.stream():
                peer.close()

        async def run():
            peer = self.open("a", "CAR").start()
            await asyncio.to_thread(peer.wait_until, lambda: peer.in_session, GIVES_UP_S)
            peer.send("chat", "to myself")
            await asyncio.wait_for(first(peer), GIVES_UP_S)

        asyncio.run(run())

    def test_a_hold_is_one_moment(self):
        with self.open("a", "CAR").start() as a:
            a.wait_until(lambda: a.in_session, GIVES_UP_S)
            ticks = lambda: a.ask(do="status")["counters"]["ticks"]
            a.wait_until(lambda: ticks() > 0, GIVES_UP_S)
            with a.hold(), a.hold():
                before = ticks()
                time.sleep(0.2)
                self.assertEqual(ticks(), before)
            a.wait_until(lambda: ticks() > before, GIVES_UP_S)
        with self.assertRaises(TimeoutError), self.open("a", "CAR") as a:
            a.wait_until(lambda: False, 0.05)

    def test_poses_are_written_and_read_where_they_are(self):
        with self.open("a", "CAR") as a:
            self.run_until([a], lambda: a.in_session and len(a.owned_objects()) == 1)
            car = a.owned_objects()
            self.assertEqual((car.dtype, car.shape), (np.uint64, (1,)))
            a.take(int(car[0]))
            frames = np.full((3, 1, 7), 5.0)
            self.run_until([a], lambda: a.move(car, [[1, 2, 3, 0, 0, 0, 1]], [[0, 0, 0]], jumps=True) == 1)
            self.assertIs(a.poses(car, out=frames[1]).base, frames)
            np.testing.assert_allclose(frames[1, 0], [1, 2, 3, 0, 0, 0, 1], atol=1e-9)
            self.assertTrue((frames[[0, 2]] == 5.0).all())
            with self.assertRaises(TypeError):
                a.poses(car, out=np.empty((1, 14))[:, ::2])  # not contiguous
            with self.assertRaises(ValueError):
                a.poses(car, out=np.empty((2, 7)))
            with self.assertRaises(ValueError):
                a.move(car, np.zeros((2, 7)))

    def test_the_handle_is_that_of_the_c_interface(self):
        with self.open("a", "CAR") as a, open("/proc/self/maps") as maps:
            library = ctypes.CDLL(next(line.split()[-1] for line in maps if "/libpeerd.so" in line))
            library.peerd_id.argtypes, library.peerd_id.restype = [ctypes.c_void_p], ctypes.c_uint32
            self.assertEqual(library.peerd_id(a.handle), a.id)

    def test_a_stream_of_a_peer_with_a_thread(self):
        async def heard(peer):
            async for event in peer.stream():
                if event.kind == peerd.EventKind.MESSAGE:
                    return event

        lines = []
        with self.open("a", "CAR", log=lambda level, text: lines.append(text)).start() as a, \
                self.open("b", "CUBE").start() as b:
            give_up = time.monotonic() + GIVES_UP_S
            while not (a.in_session and b.in_session and a.member_count == b.member_count == 1):
                self.assertLess(time.monotonic(), give_up)
                time.sleep(0.01)
            a.send("chat", "hello")
            event = asyncio.run(asyncio.wait_for(heard(b), GIVES_UP_S))
            self.assertEqual((event.name, event.text, event.peer), ("chat", "hello", a.id))
        self.assertTrue(any("peer a" in line for line in lines))

    def in_a_child(self, work):
        """What `work` returns or raises in a forked child, as text; the test fails where the child does not end."""
        out, into = os.pipe()
        child = os.fork()
        if child == 0:
            try:
                said = repr(work())
            except BaseException as raised:
                said = f"{type(raised).__name__}: {raised}"
            os.write(into, said.encode())
            os._exit(0)
        os.close(into)
        give_up = time.monotonic() + GIVES_UP_S
        while os.waitpid(child, os.WNOHANG) == (0, 0):
            if time.monotonic() > give_up:
                os.kill(child, signal.SIGKILL)
                os.waitpid(child, 0)
                self.fail("the child hangs")
            time.sleep(0.01)
        with os.fdopen(out) as reader:
            return reader.read()

    def test_a_forked_child_has_no_part_in_the_peer(self):
        calls = [
            lambda peer: peer.poll(), lambda peer: peer.start(), lambda peer: peer.leave(), lambda peer: peer.id,
            lambda peer: peer.has_left, lambda peer: peer.session_time, lambda peer: peer.find("CAR"),
            lambda peer: peer.world(), lambda peer: peer.poses([0]), lambda peer: peer.move(0, [0] * 7),
            lambda peer: peer.send("chat", "child"), lambda peer: peer.add("Group { }"),
            lambda peer: peer.set_data("CAR", "a", "child"), lambda peer: peer.data("CAR", "a"),
            lambda peer: peer.ask(do="status"), lambda peer: list(peer.events()), lambda peer: peer.handle,
            lambda peer: peer.hold().__enter__(),
        ]
        for has_thread in (False, True):
            with self.open("a", "CAR") as a, self.open("b", "CUBE") as b:
                self.run_until([a, b], lambda: a.in_session and b.in_session and a.member_count == b.member_count == 1)
                polled = [a, b]
                if has_thread:
                    a.start()
                    polled = [b]

                def closes():
                    for call in calls:
                        with self.assertRaisesRegex(peerd.Error, "another process"):
                            call(a)
                    with a:
                        pass
                    return "closed"

                self.assertEqual(self.in_a_child(closes), "'closed'")
                self.run_until(polled, lambda: True)
                a.send("chat", "parent")
                heard = []

                def hear():
                    heard.extend(event for event in b.events() if event.kind in (peerd.EventKind.MESSAGE, peerd.EventKind.PEER_LEFT))
                    return heard

                self.run_until(polled, hear)
                self.assertEqual([(event.kind, event.text) for event in heard], [(peerd.EventKind.MESSAGE, "parent")])
                self.assertFalse(a.has_left)
                self.assertEqual(b.member_count, 1)

    def test_a_child_may_have_a_peer_of_its_own(self):
        with self.open("a", "CAR") as a:
            def child():
                with self.open("b", "CUBE") as b:
                    b.wait_until(lambda: b.in_session and b.member_count == 1)
                    return "met"

            a.start()
            self.assertEqual(self.in_a_child(child), "'met'")

    def test_other_programs_do_not_get_its_descriptors(self):
        before = set(os.listdir("/proc/self/fd"))
        with self.open("a", "CAR", store=Path(self.folder.name, "store"), control=Path(self.folder.name, "s"), view="127.0.0.1:0") as a:
            self.run_until([a], lambda: a.in_session)
            inherited = {}
            for name in set(os.listdir("/proc/self/fd")) - before:
                try:
                    if not fcntl.fcntl(int(name), fcntl.F_GETFD) & fcntl.FD_CLOEXEC:
                        inherited[name] = os.readlink(f"/proc/self/fd/{name}")
                except OSError:  # that of the listing
                    pass
            self.assertEqual(inherited, {})

    def test_a_log_that_raises_is_no_end(self):
        raised = []
        old_hook, sys.unraisablehook = sys.unraisablehook, lambda what: raised.append(str(what.exc_value))
        try:
            def log(level, text):
                raise ValueError("no log")

            with self.open("a", "CAR", log=log) as a:
                self.run_until([a], lambda: a.in_session)
            with self.open("a", "CAR", log=log).start() as a:
                a.wait_until(lambda: a.in_session)
        finally:
            sys.unraisablehook = old_hook
        self.assertEqual(set(raised), {"no log"})

    def test_data_may_have_any_character(self):
        with self.open("a", "CAR") as a:
            self.run_until([a], lambda: a.in_session)
            for value in ("a\0b", "\0", "", "\n\u00e4\U0001f600"):
                a.set_data("CAR", "text", value)
                self.run_until([a], lambda: a.data("CAR", "text") == value)
            for call in (lambda: a.send("chat", "a\0b"), lambda: a.find("CAR\0X"), lambda: a.set_data("CAR", "a\0b", "c")):
                with self.assertRaisesRegex(peerd.Error, "zero byte"):
                    call()

    def test_says_why_not(self):
        with self.assertRaisesRegex(peerd.Error, "no option colour"):
            peerd.Peer(colour="red")
        with self.assertRaisesRegex(peerd.Error, "nowhere"):
            peerd.Peer(world="/nowhere.wrl")
        peer = self.open("a", "CAR")
        with self.assertRaisesRegex(peerd.Error, "no such object"):
            peer.remove(peerd.NO_OBJECT)
        with self.assertRaisesRegex(peerd.Error, "must be one of"):
            peer.ask(do="dance")
        with self.assertRaisesRegex(ValueError, "7 numbers"):
            peer.move(peer.find("CAR"), [1, 2, 3])
        with self.assertRaises(TypeError):
            peer.poses([peer.find("CAR")], np.empty((1, 7), dtype=np.float32))
        peer.close()
        peer.close()
        with self.assertRaisesRegex(peerd.Error, "closed"):
            peer.poll()


if __name__ == "__main__":
    unittest.main()
