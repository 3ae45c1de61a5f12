#!/usr/bin/env bash
# Builds the core on a bare Linux machine with a GPU and checks and measures gl beside native there.
#
#   tests/gl_bare_machine.sh [FOLDER]     writes report.txt and a JSON file for each measurement to FOLDER [out/gl]
#
# Needs a C++20 compiler, CMake 3.25, make or Ninja, pkg-config, EGL and libepoxy; GoogleTest and Python 3 for the tests.
# Installs nothing. Libraries in a prefix of their own are found by PKG_CONFIG_PATH, CMAKE_PREFIX_PATH, LD_LIBRARY_PATH.
#   SPOOR_BUILD_DIR   where to build [build/gl_bare_machine]
#   SPOOR_GL_DEVICE   spoor-bench --gl-device [auto]
#   SPOOR_TICKS       ticks of each run [60; on a software renderer 8]
# Exits 1 if a test fails, a hash differs, a ledger is off or a measurement cannot be made.
set -uo pipefail
caller_directory=$PWD
cd "$(dirname "$0")/.." || exit 1

case ${1:-} in
  --help) sed -n '2,/^[^#]/s/^# \{0,1\}//p' "tests/$(basename "$0")"; exit 0 ;;
  -*) echo "gl_bare_machine.sh: unknown option $1 (see --help)" >&2; exit 2 ;;
  "") out=$PWD/out/gl ;;
  /*) out=$1 ;;
  *) out=$caller_directory/$1 ;;
esac
build=${SPOOR_BUILD_DIR:-$PWD/build/gl_bare_machine}
device=${SPOOR_GL_DEVICE:-auto}
bench=$build/bin/spoor-bench
jobs=$(nproc 2>/dev/null || echo 2)
failures=()

mkdir -p "$out" || exit 1
rm -f "$out"/report.txt "$out"/{bandwidth,relax,areas}.json "$out"/{car491,slab491}_{plain,fused}.json
exec > >(tee "$out/report.txt") 2>&1
tee_id=$!

finish() {
  exec >&- 2>&-  # so that the report is whole when the script ends
  wait "$tee_id"
  exit "$1"
}

fail() {
  echo "gl_bare_machine.sh: $*"
  finish 1
}

# step NAME COMMAND...: what fails is remembered, and the rest goes on
step() {
  local name=$1
  shift
  echo
  echo "== $name"
  "$@" || { failures+=("$name"); echo "FAILED: $name"; }
}

configure() {
  local generator=()
  command -v ninja >/dev/null && generator=(-G Ninja)
  command -v cmake >/dev/null || { echo "cmake is missing"; return 1; }
  cmake -S . -B "$build" "${generator[@]}" -DCMAKE_BUILD_TYPE=Release -DSPOOR_CORE_ONLY=ON
}

# build_targets [OPTION...]
build_targets() {
  cmake --build "$build" --parallel "$jobs" "$@" >"$build/build.log" 2>&1 || { tail -n 60 "$build/build.log"; return 1; }
}

run_tests() {
  local which='Gl|Backend|Determinism|Golden'
  build_targets || return
  if ctest --test-dir "$build" -N -R "$which" | grep -q 'Total Tests: 0'; then
    echo "no tests: this machine lacks GoogleTest or Python 3"
    return
  fi
  ctest --test-dir "$build" -R "$which" --output-on-failure -j "$jobs"
}

# A line for each run: scene, label, median of a tick in ms, hash. JSON has a key on each line.
runs_of() {
  awk -F'"' '
    { number = $3; gsub(/[: ,]/, "", number) }
    $2 == "scene" { scene = $4 }
    $2 == "label" { label = $4 }
    $2 == "tick_ms_median" { ms = number }
    $2 == "hash" { print scene "|" label "|" ms "|" $4 }' "$1"
}

tick_row() {
  local scene=$1 schedule=$2 file=$out/$1_$2.json label ms hash equal=no
  local native_ms=- native_hash=- gl_ms=- gl_hash=-
  if [ -f "$file" ]; then
    while IFS='|' read -r _ label ms hash; do
      case $label in
        native) native_ms=$ms native_hash=$hash ;;
        gl) gl_ms=$ms gl_hash=$hash ;;
      esac
    done < <(runs_of "$file")
  fi
  [ "$gl_hash" != - ] && [ "$gl_hash" = "$native_hash" ] && equal=yes
  [ $equal = yes ] || failures+=("$scene, $schedule: the hashes differ, or there are none")
  printf '%-10s %-9s %-17s %-17s %-6s %10s %10s\n' "$scene" "$schedule" "$gl_hash" "$native_hash" "$equal" "$gl_ms" "$native_ms"
}

echo "== machine"
uname -srm
grep -m 1 'model name' /proc/cpuinfo
echo "$jobs processors"

echo
echo "== build"
configure || fail "the core cannot be configured here"
build_targets --target spoor-bench || fail "spoor-bench does not build here"
"$bench" --list-devices >/dev/null || fail "spoor-bench does not run"
if grep -q 'gl backend is not in this build' <("$bench" --list-devices); then
  fail "built without gl: pkg-config does not find epoxy and egl (PKG_CONFIG_PATH=${PKG_CONFIG_PATH:-})"
fi

step "tests" run_tests
step "devices" "$bench" --list-devices
step "bandwidth" "$bench" bandwidth --gl-device="$device" --json="$out/bandwidth.json"

# A run of two ticks tells what will be used.
renderer=$("$bench" tick --scene=car --backend=gl --gl-device="$device" --ticks=2 2>/dev/null | sed -n 's/, [a-z]* sweeps)/)/; s/^ *gl: //p')
echo
echo "renderer: ${renderer:-none}"
ticks=${SPOOR_TICKS:-60}
if [[ $renderer =~ llvmpipe|softpipe|swrast|lavapipe|SwiftShader ]]; then
  echo "this is a software renderer: the hashes count, the times do not"
  ticks=${SPOOR_TICKS:-8}
fi

for scene in car491 slab491; do
  for schedule in plain fused; do
    step "tick, $scene, $schedule" "$bench" tick --backend=gl --gl-device="$device" --scene=$scene --schedule=$schedule \
      --ticks="$ticks" --json="$out/${scene}_$schedule.json"
  done
done
step "relax" "$bench" relax --backend=gl --gl-device="$device" --ticks="$ticks" --json="$out/relax.json"
step "areas" "$bench" areas --backend=gl --gl-device="$device" --ticks="$ticks" --json="$out/areas.json"

echo
echo "== result: ${renderer:-no renderer}"
printf '%-10s %-9s %-17s %-17s %-6s %10s %10s\n' scene schedule "gl's hash" "native's hash" equal "gl, ms" "native, ms"
for scene in car491 slab491; do
  for schedule in plain fused; do tick_row $scene $schedule; done
done
if [ ${#failures[@]} -gt 0 ]; then
  printf 'failed: %s\n' "${failures[@]}"
  finish 1
fi
echo "all hashes equal; the figures are in $out"
finish 0
