"""Which folder may include which: data and dependencies flow one way.

    core/  math -> policy -> jet -> scene -> trace -> packet -> tree -> certify -> cache -> store
           -> frame -> render -> audit; io may include all of them
    peers (other ray tracers, for comparison) includes core; peers/embree nothing else of peers
    client, server include core; the server may share code with client/library, the programs in client
    include peers; nothing else crosses

Protobuf messages are known in core/io only (of core), gRPC nowhere in core.
"""

import re

from trees import sources

LAYERS = ["math", "policy", "jet", "scene", "trace", "packet", "tree", "certify", "cache", "store", "frame", "render", "audit"]
_INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)
_GRPC = re.compile(r"^grpc|\.grpc\.pb\.h$")
_PROTOBUF = re.compile(r"^google/protobuf/|\.pb\.h$")


def complaints(root):
    """One line for every include that runs against the arrows."""
    found = []
    for path in sources(root, ["core", "peers", "server", "client"], {".h", ".cpp"}):
        text = (root / path).read_text()
        for bracket, target in _INCLUDE.findall(text):
            reason = _refusal(path.parts, target, bracket == '"')
            if reason:
                found.append(f"{path}: includes {target}: {reason}")
    return found


def _refusal(parts, target, quoted):
    if parts[0] == "core" and _GRPC.search(target):
        return "core knows no gRPC"
    if parts[0] == "core" and parts[1] != "io" and _PROTOBUF.search(target):
        return "only core/io knows Protobuf"
    head = target.split("/")
    if head[0] == "core":
        return _core_refusal(parts, head[1])
    if head[0] == "server" and parts[0] != "server":
        return "only the server includes the server"
    if head[0] == "peers":
        return _peers_refusal(parts, head[1])
    if head[0] == "client":
        return _client_refusal(parts, head[1])
    if quoted and "/" not in target:
        return "project headers are included by their path from the root"
    return None


def _core_refusal(parts, wanted):
    if parts[0] != "core" or parts[1] in ("io", wanted):
        return None
    if wanted not in LAYERS:
        return f"core/{parts[1]} may not include core/{wanted}"
    if parts[1] not in LAYERS:
        return f"core/{parts[1]} is not one of the layers"
    if LAYERS.index(wanted) > LAYERS.index(parts[1]):
        return f"{wanted} stands above {parts[1]}"
    return None


def _peers_refusal(parts, wanted):
    if parts[0] == "peers":
        return "embree is one tracer among the peers" if parts[1] == "embree" != wanted else None
    if parts[0] == "client" and parts[1] != "library":
        return None
    return "only the client's programs compare with peers"


def _client_refusal(parts, wanted):
    if parts[0] in ("core", "peers"):
        return f"{parts[0]} knows no client"
    if wanted == "library":
        return None
    if parts[0] == "server":
        return "the server shares client/library only"
    if parts[1] == "library":
        return "the library does not know the programs that use it"
    return None
