"""A linetreed process on a free port, and stubs made from proto/."""

import contextlib
import os
import pathlib
import signal
import subprocess
import sys
import tempfile

import grpc

PROJECT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(os.environ["LINETREE_PROGRAMS"]) / "linetreed"
SERVICE = "linetree.v1.RadianceCache"
# Nothing here takes this long; a hang shall end as a failure.
PATIENCE_S = 120

_stubs = tempfile.TemporaryDirectory()
STUBS = _stubs.name
subprocess.run(
    ["protoc", f"-I{PROJECT / 'proto'}", f"--python_out={STUBS}", f"--grpc_out={STUBS}",
     "--plugin=protoc-gen-grpc=/usr/bin/grpc_python_plugin",
     "linetree/v1/scene.proto", "linetree/v1/camera_path.proto", "linetree/v1/service.proto"],
    check=True)
sys.path.insert(0, STUBS)

# pylint: disable=wrong-import-position
from linetree.v1 import scene_pb2, service_pb2, service_pb2_grpc  # noqa: E402

SCENE_TEXT = (pathlib.Path(__file__).parent / "ball.textproto").read_text()


class Served:
    """Use it in a with statement."""

    def __init__(self, *flags):
        # Leaving the block must not depend on what the test did to the process.
        self.process = subprocess.Popen(
            [PROGRAM, "--listen", "127.0.0.1:0", "--threads", "2", *flags],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        prefix = "listening on "
        if not line.startswith(prefix):
            raise AssertionError(f"expected '{prefix}...', got {line!r}: "
                                 + self.process.communicate()[1])
        self.address = line[len(prefix):].strip()
        self.channel = grpc.insecure_channel(
            self.address, [("grpc.max_receive_message_length", -1)])
        self.stub = service_pb2_grpc.RadianceCacheStub(self.channel)

    def __enter__(self):
        return self

    def __exit__(self, *unused):
        self.channel.close()
        self.process.kill()
        self.process.communicate()

    def call_raw(self, method, request):
        """Bytes in, bytes out; `method` is the full name."""
        return self.channel.unary_unary(method)(request, timeout=PATIENCE_S)

    def load_ball(self, name="ball"):
        return self.stub.LoadScene(
            service_pb2.LoadSceneRequest(name=name, text=SCENE_TEXT), timeout=PATIENCE_S)

    def process_cpu_s(self):
        """What the process has computed so far, in seconds of one core."""
        fields = pathlib.Path(f"/proc/{self.process.pid}/stat").read_text().rsplit(")")[-1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def stop(self, signal_number=signal.SIGTERM):
        """Sends the signal; what the process returns."""
        self.process.send_signal(signal_number)
        return self.process.wait(timeout=PATIENCE_S)


def small_frame(**fields):
    """A request that is fine, but for what the caller changes."""
    values = {"scene": "ball", "width": 48, "height": 32, **fields}
    return service_pb2.RenderFrameRequest(**values)


@contextlib.contextmanager
def refused(test, code, field):
    """The calls in the block end with this code and a message that starts with the field."""
    with test.assertRaises(grpc.RpcError) as caught:
        yield
    test.assertEqual(caught.exception.code(), code, caught.exception.details())
    test.assertTrue(caught.exception.details().startswith(field), caught.exception.details())
