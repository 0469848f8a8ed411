"""A linetreed process on a free port, and stubs made from proto/."""

import contextlib
import os
import pathlib
import re
import signal
import ssl
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

# An idle client hears of a server that stops, and answers, this often; else every 5 seconds.
os.environ["GRPC_CLIENT_CHANNEL_BACKUP_POLL_INTERVAL_MS"] = "100"
# pylint: disable=wrong-import-position
import grpc  # noqa: E402

PROJECT = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = pathlib.Path(os.environ["LINETREE_PROGRAMS"])
PROGRAM = PROGRAMS / "linetreed"
SANITIZED = b"__asan_init" in PROGRAM.read_bytes()
SERVICE = "linetree.v1.RadianceCache"
# Nothing here takes this long; a hang shall end as a failure.
PATIENCE_S = 120

_stubs = tempfile.TemporaryDirectory()
STUBS = _stubs.name
# Whoever is told no folder keeps what it keeps with the stubs.
os.environ["XDG_STATE_HOME"] = str(STUBS)
subprocess.run(
    ["protoc", f"-I{PROJECT / 'proto'}", f"--python_out={STUBS}", f"--grpc_out={STUBS}",
     "--plugin=protoc-gen-grpc=/usr/bin/grpc_python_plugin",
     "linetree/v1/scene.proto", "linetree/v1/camera_path.proto", "linetree/v1/service.proto"],
    check=True)
sys.path.insert(0, STUBS)

from linetree.v1 import scene_pb2, service_pb2, service_pb2_grpc  # noqa: E402

SCENE_TEXT = (pathlib.Path(__file__).parent / "ball.textproto").read_text()


class Served:
    """Use it in a with statement. `before` is a command that runs the program; `popen` goes to
    subprocess.Popen."""

    def __init__(self, *flags, listen="127.0.0.1:0", credentials=None, before=(),
                 **popen):
        # Leaving the block must not depend on what the test did to the process.
        # Servers of tests know nothing of each other.
        store = [] if "--data-dir" in flags else ["--no-store"]
        self.process = subprocess.Popen(
            [*before, PROGRAM, "--listen", listen, "--threads", "2", *store, *flags],
            **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, **popen})
        self.address = self._line("listening on ")
        self.http = self._line("http on ") if "--http" in flags else None
        options = [("grpc.max_receive_message_length", -1)]
        if credentials is None:
            self.channel = grpc.insecure_channel(self.address, options)
        else:
            self.channel = grpc.secure_channel(self.address, credentials, options)
        self.stub = service_pb2_grpc.RadianceCacheStub(self.channel)

    def _line(self, prefix):
        line = self.process.stdout.readline()
        if not line.startswith(prefix):
            raise AssertionError(f"expected '{prefix}...', got {line!r}: "
                                 + str(self.process.communicate()[1]))
        return line[len(prefix):].strip()

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


def peak_bytes(process):
    """The most memory that the process has had."""
    text = pathlib.Path(f"/proc/{process.pid}/status").read_text()
    return int(re.search(r"VmHWM:\s+(\d+) kB", text)[1]) << 10


def fetch(url, **headers):
    """Status and text of a page; https without looking at the certificate."""
    context = ssl.create_default_context()
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE
    try:
        with urllib.request.urlopen(urllib.request.Request(url, headers=headers),
                                    timeout=PATIENCE_S, context=context) as page:
            return page.status, page.read().decode()
    except urllib.error.HTTPError as error:
        with error:
            return error.code, error.read().decode()


def wait_until(condition):
    """Asks again and again until it holds."""
    end = time.monotonic() + PATIENCE_S
    while not condition():
        if time.monotonic() > end:
            raise AssertionError("waited in vain")
        time.sleep(0.01)


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
