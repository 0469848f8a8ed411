#!/usr/bin/env bash
# Installs what is missing, builds, and runs all tests: everything in Release, everything but the
# long picture comparisons again under address and undefined-behaviour sanitizers, and what of the
# core runs on several threads again under the thread sanitizer. Ends with one line as ctest writes
# it; the status is 0 only when everything was built and every test passed.
set -uo pipefail
cd "$(dirname "$0")" || exit 1

usage() {
  cat <<'TEXT'
usage: ./test.sh [--quick] [--stage Release|Asan|Tsan|Fuzz]... [--stress-long]
                 [--fuzz-long [SECONDS]] [--help]
  --quick       Release only (the same as --stage Release)
  --stage TYPE  only these build types, in the order given
  --stress-long the stress tests in their long form, some twenty times as much
  --fuzz-long   after the other stages, or alone with --stage Fuzz: libFuzzer looks for inputs that
                end a reader of what comes from outside, so many seconds for each of them (60);
                needs the packages clang and libclang-rt-14-dev, which nothing else here does.
                What it has learnt stays in build/fuzz, where the next run goes on
  --help        this text
Environment:
  LINETREE_TEST_JOBS    tests that run at the same time (default: one a core)
  LINETREE_STRESS_SEED  a number that the stress tests' scenes and rays are drawn from
  LINETREE_STRESS_LONG  1: the same as --stress-long
  LINETREE_FUZZ_SECONDS the seconds of --fuzz-long
Builds go to build/release, build/asan, build/tsan and build/fuzz.
TEXT
}

stages=()
fuzz_long=false
while [ $# -gt 0 ]; do
  case "$1" in
    --quick) stages+=(Release) ;;
    --stress-long) export LINETREE_STRESS_LONG=1 ;;
    --fuzz-long)
      fuzz_long=true
      if [[ ${2-} =~ ^[0-9]+$ ]]; then
        export LINETREE_FUZZ_SECONDS=$2
        shift
      fi ;;
    --stage)
      case "${2-}" in
        Release | Asan | Tsan | Fuzz) stages+=("$2"); shift ;;
        *) echo "--stage: expected Release, Asan, Tsan or Fuzz, got '${2-}'" >&2; exit 2 ;;
      esac ;;
    --help | -h) usage; exit 0 ;;
    *) echo "unknown option '$1'" >&2; usage >&2; exit 2 ;;
  esac
  shift
done
[ "${#stages[@]}" -eq 0 ] && stages=(Release Asan Tsan)
if $fuzz_long && [[ " ${stages[*]} " != *" Fuzz "* ]]; then stages+=(Fuzz); fi

.ci/install || exit 1

log=$(mktemp)
trap 'rm -f "$log"' EXIT
total=0
failed=0
broken=()
summary=()

# Tests that a sanitizer build would only repeat: pictures against other programs and the long audit,
# where the code under test is the same as in the unit tests, and the checks of the source text.
excluded_of() {
  case "$1" in
    Release) echo '^$' ;;
    Asan | Tsan) echo '^(oracle|house|audit)$' ;;
    Fuzz) echo '^(unit|system|stress|oracle|house|audit)$' ;;
  esac
}

# Debian's kernel may place memory where the thread sanitizer cannot map its shadow; a fixed layout
# is what it was built for.
launcher_of() {
  [ "$1" = Tsan ] && command -v setarch >/dev/null && setarch -R true 2>/dev/null &&
    echo "setarch -R"
}

run_stage() {
  local type=$1 counts launcher
  local targets=() jobs="${LINETREE_TEST_JOBS:-$(nproc)}"
  echo "== $type"
  if [ "$type" = Fuzz ]; then
    targets=(fuzzers)
    export LINETREE_FUZZ_SECONDS="${LINETREE_FUZZ_SECONDS:-60}"
  fi
  if ! .ci/build "$type" "${targets[@]}"; then
    broken+=("$type did not build")
    return
  fi
  launcher=$(launcher_of "$type")
  # shellcheck disable=SC2086  # the launcher is a command with its option, or nothing
  $launcher ctest --test-dir "build/${type,,}" --output-on-failure \
    --parallel "$jobs" --label-exclude "$(excluded_of "$type")" |
    tee "$log"
  local status=${PIPESTATUS[0]}
  counts=$(sed -nE 's/^.*tests passed, ([0-9]+) tests? failed out of ([0-9]+).*$/\1 \2/p' "$log")
  if [ -z "$counts" ]; then
    broken+=("$type ran no tests")
    return
  fi
  read -r stage_failed stage_total <<<"$counts"
  failed=$((failed + stage_failed))
  total=$((total + stage_total))
  summary+=("$type $((stage_total - stage_failed))/$stage_total")
  if [ "$status" -ne 0 ] && [ "$stage_failed" -eq 0 ]; then
    broken+=("$type: ctest ended with status $status")
  fi
}

for stage in "${stages[@]}"; do
  run_stage "$stage"
done

# A stage that broke counts as one test that failed, so that the last line never looks better than
# the run was.
echo
for problem in "${broken[@]}"; do
  echo "FAILED: $problem"
done
failed=$((failed + ${#broken[@]}))
total=$((total + ${#broken[@]}))
[ "${#summary[@]}" -gt 0 ] && printf 'Passed: %s\n' "${summary[@]}"
echo "$(((total - failed) * 100 / total))% tests passed, $failed tests failed out of $total"
[ "$failed" -eq 0 ]
