# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# Sourced by the scripts beside it: where things are, and how the package is built.

# The ROS packages of Debian belong to the system's own Python, so its folder comes first.
export PATH=/usr/bin:$PATH
# All of ROS runs on this machine, whose own name need not have an address.
export ROS_HOSTNAME=localhost

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build
cmake_arguments=()

# Where help is asked for, prints the comment at the head of the script, and ends it.
help_if_asked() {
  case ${1-} in
    -h | --help) awk 'NR > 2 { if (!/^#/) exit; print substr($0, 3) }' "$0"; exit ;;
  esac
}

# Builds the given targets.
build_targets() {
  "$root/scripts/setup"
  cmake -S "$root" -B "$build" "${cmake_arguments[@]}"
  cmake --build "$build" --parallel "$(nproc)" --target "$@"
}

# Lets Python find the physics and the sweeps of this build.
use_python() {
  export PYTHONPATH=$build/devel/lib/python3/dist-packages${PYTHONPATH:+:$PYTHONPATH}
}
