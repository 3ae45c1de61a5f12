# Sourced by ./run and ./test: installs what is missing from Debian and builds.

# Everything Spoor needs on a fresh Debian 12 with git and a shell.
spoor_packages=(
  g++ cmake ninja-build pkg-config python3
  libenet-dev libflatbuffers-dev flatbuffers-compiler libzstd-dev
  libglfw3-dev libglm-dev libepoxy-dev libegl-dev libegl-mesa0 libgl1-mesa-dri
  libgdal-dev libassimp-dev libtomlplusplus-dev libspdlog-dev libfmt-dev libpng-dev
  libgtest-dev glslang-tools
)

fail() {
  echo "$(basename "$0"): $*" >&2
  exit 1
}

install_packages() {
  command -v dpkg-query >/dev/null && command -v apt-get >/dev/null || fail "needs Debian (dpkg and apt-get)"
  local missing=() package
  for package in "${spoor_packages[@]}"; do
    dpkg-query -W -f='${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || fail "lacks the packages ${missing[*]}, and neither root nor sudo is at hand to install them"
    as_root=(sudo)
  fi
  echo "installing ${missing[*]}"
  "${as_root[@]}" apt-get update -qq || fail "apt-get update failed"
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null ||
    fail "apt-get could not install ${missing[*]}"
}

# build PRESET [TARGET ...]: into build/PRESET
build() {
  local preset=$1
  shift
  echo "building ($preset)"
  local log=build/$preset.log
  mkdir -p build
  cmake --preset "$preset" >"$log" 2>&1 || { tail -n 40 "$log" >&2; fail "cmake failed; all of it is in $log"; }
  cmake --build --preset "$preset" ${1:+--target "$@"} >>"$log" 2>&1 || { tail -n 60 "$log" >&2; fail "the build failed; all of it is in $log"; }
}
