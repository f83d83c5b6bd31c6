# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# Sourced by scripts/test after common.sh, for --sanitize: a build of its own with sanitizers, and what they report.

# Chooses the build folder and the flags for a list such as "address,undefined" or "thread".
sanitize_with() {
  local list=$1 suppressions=$root/test/sanitizers
  if [[ ! $list =~ ^((address|undefined)(,(address|undefined))?|thread)$ ]]; then
    echo "test: --sanitize takes address, undefined, both with a comma between, or thread; not '$list'" >&2
    exit 2
  fi
  # The sanitizers of Debian 12 find no room in an address space that is shuffled more than this.
  if [ "$(sysctl -n vm.mmap_rnd_bits 2>/dev/null || echo 0)" -gt 28 ]; then
    echo "test: sanitizers need 'sysctl vm.mmap_rnd_bits=28' here, by root" >&2
    exit 2
  fi
  build=$root/build/sanitize_${list/,/_}
  sanitizer_reports=$build/sanitizer_reports
  # Assertions stay on, of Eigen and of the standard library too; the first finding ends the program.
  cmake_arguments=(-DCMAKE_BUILD_TYPE=None
    -DCMAKE_CXX_FLAGS="-O2 -g1 -fno-omit-frame-pointer -fsanitize=$list -fno-sanitize-recover=all -D_GLIBCXX_ASSERTIONS")

  # Every process writes what it finds into a file of its own, which outlives it: a node that ends with an error fails no
  # rostest by itself.
  rm -rf "$sanitizer_reports"
  mkdir -p "$sanitizer_reports"
  export ASAN_OPTIONS=log_path=$sanitizer_reports/address:detect_stack_use_after_return=1:strict_string_checks=1
  export LSAN_OPTIONS=suppressions=$suppressions/leaks.txt:print_suppressions=0
  export UBSAN_OPTIONS=log_path=$sanitizer_reports/undefined:print_stacktrace=1
  export TSAN_OPTIONS=log_path=$sanitizer_reports/thread:suppressions=$suppressions/threads.txt:ignore_noninstrumented_modules=1

  left_out='nosetests_docs|nosetests_package|nosetests_python'
  echo "left out: effects_cost_nothing, which counts the instructions of a build without sanitizers; benchmarks"
  echo "left out: the tests of pages and package, which try the usual build and make builds of their own"
  echo "left out: the tests of the physics for Python, since Python itself has no sanitizer"
  echo "left out: seven of eight hard cases, which take ten times as long"
  if [ "$list" = thread ]; then
    left_out+='|_rviz_'
    echo "left out: the tests of RViz, a program whose locks and threads this sanitizer has not seen"
  else
    # RViz itself has no sanitizer, which must then be there before its plugin.
    RBS_RVIZ_PRELOAD=$(g++ -print-file-name=libasan.so)
    export RBS_RVIZ_PRELOAD
  fi
}

# Prints what the sanitizers have found; fails when there is something.
sanitizer_findings() {
  local report found=0
  for report in "$sanitizer_reports"/*; do
    [ -s "$report" ] || continue
    found=1
    echo "=== $report"
    head -n 60 "$report"
  done
  if [ $found = 0 ]; then echo "no finding of the sanitizers"; fi
  return $found
}
