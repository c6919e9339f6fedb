# What tests of installed parts share: folders, and an environment that finds nothing but what is installed.
build_dir=$(cd -- "$1" && pwd)
source_dir=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset CPATH CPLUS_INCLUDE_PATH C_INCLUDE_PATH CXXFLAGS CPPFLAGS CMAKE_PREFIX_PATH
prefix=$work/prefix

fail() {
  echo "FAILED: $*"
  exit 1
}

# install_component NAME: under $prefix.
install_component() {
  cmake --install "$build_dir" --component "$1" --prefix "$prefix" >"$work/install.log" || fail "install: $(cat "$work/install.log")"
}
