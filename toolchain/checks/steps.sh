# SPDX-License-Identifier: Apache-2.0
# The commands of toolchain/checks/steps, run in the project's folder. CONDYLE_TIER is check, full or
# release. Exit status 77: skipped, because a tool is missing.

in_tier() { [[ " $* " = *" $CONDYLE_TIER "* ]]; }

check_format() {
  find estimator hal firmware host_sim tests \( -name '*.h' -o -name '*.cpp' \) -print0 |
    xargs -0 -n 40 -P "$(nproc)" clang-format-14 --dry-run --Werror
}

build() {  # PRESET [TARGET...]
  local options=()
  if [ "$1" = release ]; then
    case $CONDYLE_TIER in
      check) options=(-D CONDYLE_VM_TESTS=OFF -D CONDYLE_BENCHMARKS=OFF) ;;
      full) options=(-D CONDYLE_VM_TESTS=ON -D CONDYLE_BENCHMARKS=ON -D CONDYLE_BOX_REPORTS=4000) ;;
      release) options=(-D CONDYLE_VM_TESTS=ON -D CONDYLE_BENCHMARKS=ON -D CONDYLE_BOX_REPORTS=100000) ;;
    esac
  fi
  if in_tier release; then
    case $1 in
      asan-ubsan) options=(-D CONDYLE_TESTS=most_memory) ;;
      tsan) options=(-D CONDYLE_TESTS=most_threads) ;;
    esac
  fi
  cmake --preset "$1" "${options[@]}" >/dev/null
  cmake --build --preset "$1" --parallel "$(nproc)" ${2:+--target "${@:2}"}
}

# For cores whose images run but are not measured: only what runs.
build_bare_metal() {
  build cortex-m4f
  build cortex-m7
  if in_tier release; then build cortex-m7 day_of_estimates; fi
  build cortex-m33 estimate_bytes board_behaviour_mps2_an505
  build cortex-m55 estimate_bytes board_behaviour_mps3_an547
}

build_asan_ubsan() {
  local targets=(tested_programs fuzzers)
  if in_tier release; then targets+=(condyle); fi
  build asan-ubsan "${targets[@]}"
}

build_tsan() {
  local targets=(tested_programs)
  if in_tier release; then targets+=(condyle); fi
  build tsan "${targets[@]}"
}

build_rtsan() {
  command -v clang++-22 >/dev/null || { echo "skipped: clang++-22 is not installed (Debian 12 has none)"; exit 77; }
  build rtsan
}

# One more job than cores: some tests wait for a device. A box's session ends once it is on the disk,
# behind what a build has not written yet.
run_ctest() {  # PRESET NAME_OF_RESULTS [OPTION...]
  local results=$PWD/build/$1/$2.junit.xml
  sync
  ctest --preset "$1" --parallel $(($(nproc) + 1)) --output-junit "$results" "${@:3}" || return
  tell_skips "$results"
}
# Tells the runner how many tests were skipped. A step whose tests were all skipped is skipped. What
# fetches or builds for virtual machines counts as no test.
tell_skips() {  # JUNIT_FILE
  local tests skipped
  tests=$(grep '<testcase ' "$1" | grep -cvE 'name="vm\.(guest|programs)\.') ||
    { echo "no test ran: $1" >&2; return 1; }
  skipped=$(sed -nE 's/.*<testcase name="([^"]*)".*status="notrun".*/\1/p' "$1" |
    grep -cvE '^vm\.(guest|programs)\.') ||
    return 0
  echo "$skipped of $tests tests skipped" | tee -a "${CONDYLE_SKIPS:-/dev/null}"
  [ "$skipped" -lt "$tests" ] || exit 77
}
# The patterns of left_to_full or real_time, as one.
patterns() { sed -E '/^(#|$)/d' "toolchain/checks/$1" | paste -sd '|'; }
long_statistics='^(consistency|identification|readings)_tests\.'
# In the release tier, run_statistics runs the long tests.
run_tests() {  # PRESET
  local left_out=() status=0
  if in_tier check; then left_out=(--exclude-regex "^($(patterns left_to_full))"); fi
  if in_tier release; then left_out=(--exclude-regex "$long_statistics|^($(patterns real_time))"); fi
  run_ctest "$1" tests --label-exclude '^vm$' "${left_out[@]}" || status=$?
  if in_tier release; then run_ctest "$1" real_time --tests-regex "^($(patterns real_time))" --parallel 1 || status=$?; fi
  return $status
}
# Four steps, because a step that is interrupted starts again from its beginning.
run_statistics() {  # consistency, identification, reading-coverage or readings
  local coverage='^readings_tests\.Cells/ReadingCoverage\.'
  case $1 in
    reading-coverage) run_ctest release "$1" --tests-regex "$coverage" ;;
    readings) run_ctest release "$1" --tests-regex '^readings_tests\.' --exclude-regex "$coverage" ;;
    *) run_ctest release "$1" --tests-regex "^$1_tests\\." ;;
  esac
}
# Short tests use memory and threads in the same way.
run_short_tests() { CONDYLE_TIER=check run_ctest "$1" tests --label-exclude '^vm$'; }  # PRESET
# The tests of the command are those of the optimised build: only the command is to be watched.
run_memory_tests() {
  if ! in_tier release; then export CONDYLE_COMMAND=$PWD/build/release/bin/condyle; fi
  run_short_tests asan-ubsan
  in_tier release || return 0
  CONDYLE_COMMAND=$PWD/build/asan-ubsan/bin/condyle CONDYLE_TIER=check \
    run_ctest release memory --tests-regex '^replay_tests\.'
}
run_thread_tests() {
  if ! in_tier release; then export CONDYLE_COMMAND=$PWD/build/release/bin/condyle; fi
  run_short_tests tsan
}

run_vm_tests() {  # ARCHITECTURE
  local left_out=()
  # In full only what runs in virtual time, and not the sweep of the clock.
  if in_tier full; then left_out=(--exclude-regex '\.(icount[023]|real)$'); fi
  run_ctest release "vm_$1" --label-regex '^vm$' --tests-regex "\.$1" "${left_out[@]}"
}

# The library needs objects of its own.
check_library() {
  cmake --preset release -B build/library -D CONDYLE_BUILD_LIBRARY=ON -D CONDYLE_BENCHMARKS=OFF >/dev/null
  cmake --build build/library --parallel "$(nproc)" --target condyle condyle_api
  ctest --test-dir build/library --output-on-failure --output-junit "$PWD/build/library/tests.junit.xml" \
    --tests-regex '^(c_interface|python_package|mex_file)$'
  tell_skips build/library/tests.junit.xml
}

compare_builds() {  # PRESET...
  local preset estimator
  for preset in "$@"; do
    for estimator in published recommended; do
      "build/$preset/bin/condyle" replay host_sim/recordings/chewing_60hz.csv \
        --estimator $estimator --out "build/$preset/$estimator.csv" >/dev/null
      cmp "build/$1/$estimator.csv" "build/$preset/$estimator.csv"
      echo "$preset, $estimator: $(sha256sum <"build/$preset/$estimator.csv")"
    done
  done
}

# The short form tries a fixed number of inputs of each target: the same tree passes or fails each time.
run_fuzzers() {
  local length=short
  if in_tier release; then length=600; fi
  find tests/fuzz -name 'fuzz_*.cpp' | sed -E 's,.*/fuzz_(.*)\.cpp,\1,' | sort |
    xargs -n 1 -P "$(nproc)" tests/fuzz/fuzz_for "$length" build/asan-ubsan
}

# prove SCRIPT: runs it in a new folder, which is deleted on success.
prove() {
  local folder=build/prove_${1##*/}
  [ "$(id -u)" -eq 0 ] || { echo "skipped: $1 needs root (chroot)"; exit 77; }
  umount "$folder/proc" "$folder/dev/pts" 2>/dev/null || true  # left by a run that was killed
  rm -rf --one-file-system "$folder"
  "$1" "$folder"
  rm -rf --one-file-system "$folder"
}

# The preset puts counters into our sources only: with those of Eigen the tests take many times as
# long. It excludes early inlining: lines that GCC inlines before it inserts counters count as never run.
# Left out: tests that measure the program of another build, and tests that link outside this one.
measure_coverage() {
  local status=0 folder results=build/coverage/coverage.json
  find build/coverage -name '*.gcda' -delete
  CONDYLE_TIER=check run_ctest coverage tests --exclude-regex '^(instruction_counts|installed_package)$' || status=$?
  gcovr --root . --object-directory build/coverage --exclude-throw-branches --exclude-unreachable-branches \
    --filter '(estimator|hal|firmware|host_sim)/' -j "$(nproc)" --json $results build/coverage
  echo "Coverage, lines and branches, of what this machine compiles; by file in build/coverage/FOLDER.txt"
  for folder in estimator hal firmware host_sim; do
    # A regular file, because gcovr deletes its output file first, even /dev/null.
    gcovr --root . --add-tracefile $results --filter "$folder/" --print-summary --txt "build/coverage/$folder.txt" |
      sed -nE "s/^(lines|branches): (.*)/  $folder: \1 \2/p"
  done
  return $status
}
