"""Many clients, one server: who asks for much gets no more of it than who asks for little. What was
done for whom is told by the server's counters, never by a clock."""

import queue
import threading
import unittest

import grpc

import served
from served import PATIENCE_S, service_pb2, small_frame

WIDTH, HEIGHT = 240, 160
# What a snapshot of counters may be off by, in frames: those that end while it is taken.
SLACK_FRAMES = 5


class Session:
    """Keeps some frames in flight until it is stopped, each asked for when another has come."""

    def __init__(self, server, name, in_flight, flights=False, **fields):
        self.server = server
        self.metadata = [("x-session-id", name)]
        self.request = small_frame(codec=service_pb2.CODEC_JPEG, **fields)
        self.request.options.mode = service_pb2.CLASSICAL
        self.pixels = self.request.width * self.request.height
        self.frames = 0
        self.stopped = threading.Event()
        self.changed = threading.Condition()
        ask = self._fly if flights else self._ask
        self.threads = [threading.Thread(target=ask) for _ in range(in_flight)]

    def _ask(self):
        while not self.stopped.is_set():
            for _ in self.server.stub.RenderFrame(self.request, timeout=PATIENCE_S,
                                                  metadata=self.metadata):
                pass
            self._count()

    def _fly(self):
        viewpoints = queue.SimpleQueue()
        request = service_pb2.FlyRequest(frame=self.request)
        viewpoints.put(request)
        for reply in self.server.stub.Fly(iter(viewpoints.get, None), timeout=PATIENCE_S,
                                          metadata=self.metadata):
            if reply.chunk.HasField("end"):
                self._count()
                viewpoints.put(None if self.stopped.is_set() else request)

    def _count(self):
        with self.changed:
            self.frames += 1
            self.changed.notify_all()

    def wait_for(self, frames):
        with self.changed:
            if not self.changed.wait_for(lambda: self.frames >= frames, PATIENCE_S):
                raise AssertionError("waited in vain")

    def __enter__(self):
        for thread in self.threads:
            thread.start()
        return self

    def __exit__(self, *unused):
        self.stopped.set()
        for thread in self.threads:
            thread.join()


class Fairness(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = cls.enterClassContext(served.Served("--render-slots", "1", "--no-prefetch"))
        cls.server.load_ball()

    def pixels(self):
        """Rendered so far, for everybody."""
        stats = self.server.stub.GetStats(service_pb2.GetStatsRequest(), timeout=PATIENCE_S)
        return stats.scenes[0].totals.pixels

    def shares(self, greedy, modest, frames):
        """Pixels that both have got while the modest one got so many frames, both waiting all the
        time."""
        with greedy, modest:
            greedy.wait_for(2)
            modest.wait_for(3)
            pixels, before = self.pixels(), modest.frames
            modest.wait_for(before + frames)
            pixels, after = self.pixels() - pixels, modest.frames
        of_modest = (after - before) * modest.pixels
        return pixels - of_modest, of_modest

    def test_sessions_have_equal_parts_whatever_they_ask_for(self):
        for in_flight, width in [(24, WIDTH), (24, 3 * WIDTH)]:
            with self.subTest(in_flight=in_flight, width=width):
                greedy = Session(self.server, "greedy", in_flight, width=width, height=HEIGHT)
                modest = Session(self.server, "modest", 4, width=WIDTH, height=HEIGHT)
                of_greedy, of_modest = self.shares(greedy, modest, frames=30)
                slack = SLACK_FRAMES * WIDTH * HEIGHT + greedy.pixels
                self.assertLess(abs(of_greedy - of_modest), slack, (of_greedy, of_modest))

    def test_many_flights_of_a_session_have_one_part(self):
        greedy = Session(self.server, "greedy", 12, flights=True, width=WIDTH, height=HEIGHT)
        modest = Session(self.server, "modest", 4, width=WIDTH, height=HEIGHT)
        of_greedy, of_modest = self.shares(greedy, modest, frames=30)
        self.assertLess(abs(of_greedy - of_modest), (SLACK_FRAMES + 1) * greedy.pixels,
                        (of_greedy, of_modest))

    def test_a_lower_class_has_its_smaller_part(self):
        greedy = Session(self.server, "greedy", 24, width=WIDTH, height=HEIGHT,
                         priority=service_pb2.PRIORITY_BATCH)
        modest = Session(self.server, "modest", 4, width=WIDTH, height=HEIGHT)
        of_greedy, of_modest = self.shares(greedy, modest, frames=48)
        self.assertLess(abs(of_greedy - of_modest / 8), SLACK_FRAMES * WIDTH * HEIGHT,
                        (of_greedy, of_modest))
        self.assertGreater(of_greedy, 0, "nobody waits for ever")

    def test_who_finds_no_room_is_told_when_to_come_back(self):
        """A crowd of one session gives way to another's first frame."""
        with served.Served("--render-slots", "1", "--no-prefetch") as server:
            server.load_ball()
            endless = small_frame(width=4000, height=4000)
            endless.options.mode = service_pb2.CLASSICAL
            crowd = [server.stub.RenderFrame(endless, timeout=PATIENCE_S,
                                             metadata=[("x-session-id", "crowd")])
                     for _ in range(70)]
            refused = []
            for call in crowd:
                call.add_callback(lambda call=call: refused.append(call))
            # Of 65 in work or waiting some have gone, or the other's would have found no room.
            served.wait_until(lambda: len(refused) >= 5)
            other = server.stub.RenderFrame(small_frame(), timeout=PATIENCE_S,
                                            metadata=[("x-session-id", "other")])
            served.wait_until(lambda: len(refused) >= 6)
            for call in refused:
                self.assertEqual(call.code(), grpc.StatusCode.RESOURCE_EXHAUSTED)
                trailers = dict(call.trailing_metadata())
                self.assertGreater(int(trailers["grpc-retry-pushback-ms"]), 0)
            for call in crowd:
                call.cancel()
            self.assertTrue(list(other)[-1].HasField("end"))


if __name__ == "__main__":
    unittest.main()
