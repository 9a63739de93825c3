# The set-up that pipeline/demo.sh, tests/run.sh and .ci/run share: sourced, not run. Leaves the shell in the root.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

packages=(g++ cmake ninja-build ccache pkg-config
  libeigen3-dev libassimp-dev libtomlplusplus-dev libcli11-dev libtbb-dev libnanoflann-dev
  libepoxy-dev libegl-dev libglvnd-core-dev libegl-mesa0 libgl1-mesa-dri libpng-dev libcairo2-dev fonts-dejavu-core
  libavcodec-dev libavformat-dev libavutil-dev libswscale-dev
  nlohmann-json3-dev libfmt-dev libgtest-dev libgmock-dev libbenchmark-dev)

# Installs those of the named packages that are missing; asks for nothing when all are there.
install_missing() {
  local missing=() package
  for package in "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return
  echo "Installing ${missing[*]}"
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "Packages are missing: run this as root, or install sudo." >&2; exit 1; }
    as_root=(sudo)
  fi
  local install=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}")
  # A fresh system has no package lists, an old one may have stale ones: fetched only when installing fails without.
  "${install[@]}" || { "${as_root[@]}" apt-get update && "${install[@]}"; }
}

# Configures and builds a preset.
build() {
  cmake --preset "$1"
  cmake --build --preset "$1"
}

install_missing "${packages[@]}"
