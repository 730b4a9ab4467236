# Shared by the scripts of this folder: system packages, the virtual environment, the build, logs.
# Sourced, not run. Everything can be repeated and does nothing when nothing changed.

set -euo pipefail

ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$ROOT"
LOGS=$ROOT/build
VENV=$ROOT/.venv
JOBS=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}
export CMAKE_BUILD_PARALLEL_LEVEL=$JOBS
# Our own builds take warnings for errors, and find in ccache what another folder has compiled. The
# compiler tells ccache what a file includes: asking the preprocessor first costs a fifth of a
# compilation.
export PERILUNE_WERROR=${PERILUNE_WERROR:-ON} CCACHE_BASEDIR=$ROOT CCACHE_NOHASHDIR=1 CCACHE_DEPEND=1
# Tests start Python some hundred times: each module is compiled once, whatever the caller has set, and
# beside the other builds rather than among the sources that stages copy meanwhile.
unset PYTHONDONTWRITEBYTECODE
export PYTHONPYCACHEPREFIX=$LOGS/pycache
STARTED=$SECONDS
mkdir -p "$LOGS"

# The real models and maps, where this checkout has them beside it.
if [[ -z ${PERILUNE_DATA:-} && -d $ROOT/../shared/data ]]; then
  PERILUNE_DATA=$(cd "$ROOT/../shared/data" && pwd)
  export PERILUNE_DATA
fi

BUILD_PACKAGES=(
  gcc g++ cmake ninja-build ccache
  libembree-dev libpng-dev libjpeg-dev libwebp-dev libdeflate-dev libopenexr-dev
  libtinygltf-dev nlohmann-json3-dev libdraco-dev libmeshoptimizer-dev
  python3 python3-dev python3-venv ca-certificates
)
TEST_PACKAGES=(binutils libcmocka-dev valgrind)
FUZZ_PACKAGES=(clang llvm)

say() { printf '==> %s\n' "$*"; }

die() {
  printf 'error: %s\n' "$*" >&2
  exit 1
}

finished() { say "$1 (in $((SECONDS - STARTED)) s)"; }

# quietly NAME COMMAND...: output goes to build/NAME.log and is shown only on failure.
quietly() {
  local log=$LOGS/$1.log
  shift
  if ! "$@" >"$log" 2>&1; then
    tail -n 200 "$log" >&2
    die "failed: $* (whole log: $log)"
  fi
}

is_installed() {
  [[ $(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null) == installed ]]
}

# as_root COMMAND...: with sudo when we are not root.
as_root() {
  if ((EUID == 0)); then
    env DEBIAN_FRONTEND=noninteractive "$@"
  elif command -v sudo >/dev/null; then
    sudo env DEBIAN_FRONTEND=noninteractive "$@"
  else
    die "not root and no sudo; as root, run: $*"
  fi
}

# need_packages NAME...: installs the system packages that are missing.
need_packages() {
  local missing=() package
  command -v dpkg-query >/dev/null || die "needs Debian 12, Ubuntu 24.04 or a relative of theirs"
  for package in "$@"; do
    is_installed "$package" || missing+=("$package")
  done
  ((${#missing[@]} == 0)) && return
  say "Installing system packages: ${missing[*]}"
  quietly apt-update as_root apt-get update
  for package in "${missing[@]}"; do
    apt-cache show "$package" >/dev/null 2>&1 ||
      die "apt knows no package '$package'; on Ubuntu, enable the component 'universe'"
  done
  quietly apt-install as_root apt-get install -y --no-install-recommends "${missing[@]}"
}

# need_venv: the virtual environment, made with the system's Python.
need_venv() {
  local python=${PERILUNE_PYTHON:-/usr/bin/python3}
  "$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' ||
    die "$python is $("$python" -V 2>&1); Python 3.11 or newer is needed (set PERILUNE_PYTHON)"
  if ! "$VENV/bin/python" -c 'import pip' >/dev/null 2>&1; then
    say "Making the virtual environment .venv with $("$python" -V)"
    rm -rf "$VENV"
    quietly venv "$python" -m venv "$VENV"
  fi
  export PATH=$VENV/bin:$PATH
}

# dependencies EXTRA: what pyproject.toml asks for, and the extra's, a line each.
dependencies() {
  "$VENV/bin/python" - "$@" <<'END'
import sys, tomllib
project = tomllib.load(open("pyproject.toml", "rb"))["project"]
extras = [name for names in sys.argv[1:] for name in names.split(",")]
print(*project["dependencies"], *(line for name in extras for line in project["optional-dependencies"][name]), sep="\n")
END
}

# install PYTHON ARGUMENTS: packages for that Python as pip installs them, by uv, which takes 35 s of a
# processor where pip takes 94 for all of the tests'. Where pip was told to look, uv looks. Without uv,
# or where it fails, pip does it.
install() {
  local python=$1 settings
  shift
  if "$VENV/bin/pip" install --no-compile uv &&
    settings=$("$VENV/bin/python" "$ROOT/script/pip_settings.py") &&
    (eval "$settings" && "$VENV/bin/uv" pip install --python "$python" "$@"); then
    return
  fi
  # Bytecode of what is never imported is not made.
  "$VENV/bin/pip" --python "$python" install --no-compile "$@"
}

# need_package [EXTRA]: builds and installs perilune in place, with the dependencies of the extra.
# When dependencies and metadata are as last time only the extension is brought up to date. With the
# lock, builds of the same sources wait for each other, and the second finds them in ccache.
need_package() {
  local extra=${1:-} state stamp lock=(flock "$LOGS/core.lock")
  state=$(cat pyproject.toml setup.py | sha256sum)
  for stamp in "$VENV/.perilune" ${extra:+"$VENV/.perilune-$extra"}; do
    if [[ $(cat "$stamp" 2>/dev/null) != "$state" ]]; then
      say "Installing Python packages and building perilune"
      dependencies ${extra:+"$extra"} >"$LOGS/requirements.txt"
      quietly pip-dependencies install "$VENV/bin/python" "setuptools>=77" wheel -r "$LOGS/requirements.txt"
      quietly pip-install "${lock[@]}" "$VENV/bin/pip" install --no-build-isolation --no-deps -e .
      printf '%s' "$state" >"$VENV/.perilune"
      [[ -z $extra ]] || printf '%s' "$state" >"$VENV/.perilune-$extra"
      return
    fi
  done
  say "Bringing the extension up to date"
  quietly build "${lock[@]}" "$VENV/bin/python" setup.py build_ext --inplace
}
