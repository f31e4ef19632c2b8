# Sourced by run.sh and test.sh: the distribution's packages that are missing, and a configured
# build folder. Debian 12 and Ubuntu 24.04.

DUET_ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

duet_packages=(
  g++ cmake ninja-build git ca-certificates
  libceres-dev libeigen3-dev libsuitesparse-dev
  libopencv-core-dev libopencv-imgproc-dev libopencv-imgcodecs-dev libopencv-features2d-dev
  libopencv-video-dev libopencv-calib3d-dev
  libgflags-dev libgoogle-glog-dev libyaml-cpp-dev nlohmann-json3-dev libssl-dev libboost-dev
  gnuplot-nox fonts-liberation
)
duet_test_packages=(libgtest-dev libgmock-dev libbenchmark-dev)
# Compiles the LaTeX tables in a test, which is skipped without it, and says so.
duet_tex_packages=(texlive-latex-base texlive-latex-recommended)
# What some tests need besides; without it they are skipped, and say so.
duet_browser_packages=(chromium)
command -v node >/dev/null || duet_browser_packages+=(nodejs)
command -v npm >/dev/null || duet_browser_packages+=(npm)

# Installs what is missing of the packages named; says so, and how, where it may not.
duet_install_packages() {
  command -v dpkg-query >/dev/null || {
    echo "duet: this set-up knows Debian 12 and Ubuntu 24.04; elsewhere install the packages of docs/dependencies.md" >&2
    return 2
  }
  local missing=() package
  for package in "$@"; do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  echo "duet: installing ${#missing[@]} packages: ${missing[*]}" >&2
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || {
      echo "duet: run as root: apt-get install --no-install-recommends ${missing[*]}" >&2
      return 2
    }
    as_root=(sudo)
  fi
  "${as_root[@]}" apt-get update -qq &&
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq \
      --no-install-recommends "${missing[@]}" >/dev/null
}

# duet_configure FOLDER [-D...]: configures build/FOLDER (further arguments from the environment's
# DUET_CMAKE_ARGUMENTS), output only where it fails. Sources are compiled in batches: from nothing that
# is half the time, because Eigen's templates are instantiated once a batch. Skipped where
# the folder was configured with the same arguments (the build itself notices changed files).
duet_configure() {
  local folder="$DUET_ROOT/build/$1"
  shift
  # shellcheck disable=SC2086  # several arguments in one variable
  set -- -DCMAKE_UNITY_BUILD=ON -DDUET_WERROR=OFF "$@" ${DUET_CMAKE_ARGUMENTS:-}
  local stamp="$folder/.configured-with"
  [ -f "$folder/build.ninja" ] && [ "$(cat "$stamp" 2>/dev/null)" = "$*" ] && return 0
  mkdir -p "$folder"
  cmake -S "$DUET_ROOT" -B "$folder" -G Ninja "$@" >"$folder/configure.log" 2>&1 || {
    cat "$folder/configure.log" >&2
    return 2
  }
  echo "$*" >"$stamp"
}

# duet_build FOLDER TARGET...: the compiler's words only where it fails.
duet_build() {
  local folder="$DUET_ROOT/build/$1"
  shift
  if [ -t 2 ]; then
    ninja -C "$folder" "$@" >&2
  else
    ninja --quiet -C "$folder" "$@" >"$folder/build.log" 2>&1 || {
      cat "$folder/build.log" >&2
      return 2
    }
  fi
}
