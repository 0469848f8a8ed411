#!/usr/bin/env bash
# Installs what is missing, builds, starts a server with a real scene (SPD balls_3.nff), and flies a
# camera along a path through it with clients in processes of their own: one that finds the cache
# empty, one that finds what the first has left, and one that has every ray traced for comparison.
# Leaves pictures and the hit rates of every frame in demo-output/.
set -euo pipefail
cd "$(dirname "$0")"

epsilon=0.25
size=512
out=demo-output
scene=scenes/spd/balls_3.nff
path=scenes/paths/balls_orbit.textproto

usage() {
  cat <<TEXT
usage: ./demo.sh [--help]
Flies along $path through $scene ($size x $size, epsilon $epsilon) and leaves in $out/:
  frame_N.png      the frames of the first flight, from an empty cache
  source_N.png     where the answer to each pixel came from (colours: linetree render --help)
  classical_N.png  the same frames with every ray traced
  hit_rates.txt    hit rates and costs of every frame, also as hit_rates.json
  *.exr, *.json    what these were made from, with all layers and counters
TEXT
}
case "${1-}" in
  "") ;;
  --help | -h) usage; exit 0 ;;
  *) echo "unknown option '$1'" >&2; usage >&2; exit 2 ;;
esac

.ci/install
.ci/build Release linetree linetreed
bin=build/release/bin
rm -rf "$out"
mkdir -p "$out"

# Port 0: the system picks a free one, and the server says which once it listens.
coproc SERVER { exec "$bin/linetreed" --scene "balls=$scene" --no-store --listen 127.0.0.1:0 2>"$out/server.log"; }
server_pid=$SERVER_PID
exec {server_out}<&"${SERVER[0]}"
stop_server() {
  kill "$server_pid" 2>/dev/null || return 0
  wait "$server_pid" 2>/dev/null || true
}
trap stop_server EXIT
address=
while IFS= read -r -t 60 line <&"$server_out"; do
  case "$line" in "listening on "*) address=${line#listening on }; break ;; esac
done
if [ -z "$address" ]; then
  echo "The server did not start:" >&2
  cat "$out/server.log" >&2
  exit 1
fi
echo "Server (process $server_pid) listens on $address"

fly() {
  echo
  echo "$1"
  shift
  "$bin/linetree" fly --server "$address" --scene balls --path "$path" \
    --width "$size" --height "$size" --epsilon "$epsilon" "$@"
}
fly "First client, empty cache:" -o "$out/frame_%d.png" --stats "$out/cold.json"
fly "Second client, the first one's cache:" --layer source -o "$out/source_%d.png" \
  -o "$out/warm_%d.exr" --stats "$out/warm.json"
fly "Third client, classical (every ray traced):" --mode classical -o "$out/classical_%d.png" \
  -o "$out/classical_%d.exr" --stats "$out/classical.json"

echo
echo "Last frame of the second flight against classical:"
# Status 1 says that pixels lie beyond epsilon, which the table of differences shows.
"$bin/linetree" compare "$out/warm_12.exr" "$out/classical_12.exr" --epsilon "$epsilon" || [ $? -eq 1 ]

echo
python3 .ci/hit_rates.py "$out/cold.json" "$out/warm.json" "$out/classical.json" "$out"
echo
echo "Pictures: $PWD/$out/frame_*.png, source_*.png, classical_*.png"
echo "Table:    $PWD/$out/hit_rates.txt and hit_rates.json"
