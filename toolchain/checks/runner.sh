# SPDX-License-Identifier: Apache-2.0
# Sourced by toolchain/check: reads the table of steps and runs those of a tier, in parallel if
# there are enough cores. Uses the variables tier, force and subjects.
declare -A tier_of=() subject_of=() cores_of=() needs_of=() command_of=()
declare -A state=() seconds_of=() name_of_job=() skips_of=()
names=()
log_folder=build/checks          # what each step printed
stamp_folder=build/release-tier  # which steps of the release tier passed, each with its key of files
times_file=build/times/steps     # RUN TIER STEP RESULT WALL_S CPU_S, a line a step
reads_pages=" tests sanitizers packages windows clean-root "  # subjects whose steps depend on the pages (*.md) too
cores=$(nproc)

rank() { case $1 in check) echo 1 ;; full) echo 2 ;; release) echo 3 ;; *) return 1 ;; esac; }

# read_steps FILE
read_steps() {
  local name tier subject cores_wanted needs command need
  while read -r name tier subject cores_wanted needs command; do
    case $name in "" | "#"*) continue ;; esac
    needs=${needs//,/ }
    [ "$needs" != - ] || needs=
    [ "$cores_wanted" != all ] || cores_wanted=$cores
    rank "$tier" >/dev/null || { echo "$1: step $name: no tier '$tier'; use check, full or release" >&2; exit 2; }
    for need in $needs; do
      [ -n "${tier_of[$need]:-}" ] || { echo "$1: step $name needs '$need', which is not above it" >&2; exit 2; }
    done
    [ -n "$command" ] || { echo "$1: step $name has no command" >&2; exit 2; }
    names+=("$name")
    tier_of[$name]=$tier subject_of[$name]=$subject needs_of[$name]=$needs command_of[$name]=$command
    cores_of[$name]=$((cores_wanted > cores ? cores : cores_wanted))
  done <"$1"
}

is_subject() {
  local name
  for name in "${names[@]}"; do [ "${subject_of[$name]}" != "$1" ] || [ "$1" = - ] || return 0; done
  return 1
}
list_subjects() {
  local name
  echo "Subjects of --release, with their steps:"
  for name in "${names[@]}"; do
    [ "${subject_of[$name]}" = - ] || echo "${subject_of[$name]} $name"
  done | awk '{ if (!($1 in steps)) order[++n] = $1; steps[$1] = steps[$1] " " $2 }
    END { for (i = 1; i <= n; ++i) printf "  %-14s%s\n", order[i], steps[order[i]] }'
}

# Changes with every file on which the step depends, and with the presence of real recordings.
key_of() {  # STEP
  local files=(find . \( -path ./build -o -path ./.git -o -name __pycache__ \) -prune -o -type f)
  [[ $reads_pages = *" ${subject_of[$1]} "* ]] || files+=(! -name '*.md')
  {
    echo "${CONDYLE_REFERENCE_DATA:+with reference data}"
    "${files[@]}" -printf '%m %p\n' | LC_ALL=C sort
    "${files[@]}" -print0 | LC_ALL=C sort -z | xargs -0 sha256sum
  } | sha256sum | cut -d ' ' -f 1
}
find_keys() {
  local name with_pages without_pages
  for name in "${names[@]}"; do
    if [[ $reads_pages = *" ${subject_of[$name]} "* ]]; then
      key_at_start[$name]=${with_pages:=$(key_of "$name")}
    else
      key_at_start[$name]=${without_pages:=$(key_of "$name")}
    fi
  done
}
passed_already() {
  ! $force && [ "$tier" = release ] && [ "$(cat "$stamp_folder/$1" 2>/dev/null)" = "${key_at_start[$1]}" ]
}

# Steps without a subject prepare others: they run if another step needs them.
choose_steps() {
  local name need i
  for name in "${names[@]}"; do
    [ "${subject_of[$name]}" != - ] && [ "$(rank "${tier_of[$name]}")" -le "$(rank "$tier")" ] || continue
    [ ${#subjects[@]} -eq 0 ] || [[ " ${subjects[*]} " = *" ${subject_of[$name]} "* ]] || continue
    state[$name]=waiting
    ! passed_already "$name" || state[$name]="passed before"
  done
  for ((i = ${#names[@]} - 1; i >= 0; --i)); do
    [ "${state[${names[i]}]:-}" = waiting ] || continue
    for need in ${needs_of[${names[i]}]}; do
      passed_already "$need" && state[$need]="passed before" || state[$need]=waiting
    done
  done
}

clock() { printf '%d:%02d:%02d' $((SECONDS / 3600)) $((SECONDS / 60 % 60)) $((SECONDS % 60)); }

# A step that takes all cores shows its output at once, other steps at their end.
start_step() {
  local name=$1 log=$log_folder/$1
  printf '\n== %s (%d of %d, after %s)\n' "$name" $((++started)) "$count" "$(clock)"
  # Its own process group, so that everything it started can be ended.
  set -m
  (
    exec 9>&- </dev/null
    export CONDYLE_SKIPS=$PWD/$log.skips
    rm -f "$CONDYLE_SKIPS"
    TIMEFORMAT='%R %U %S'
    run=(bash -euo pipefail -c "source toolchain/checks/steps.sh; ${command_of[$name]}")
    if [ "${cores_of[$name]}" -eq "$cores" ]; then
      { time "${run[@]}" 2>&1 | tee "$log.log"; } 2>"$log.time"
    else
      { time "${run[@]}" >"$log.log" 2>&1; } 2>"$log.time"
    fi
  ) &
  set +m
  name_of_job[$!]=$name
  state[$name]=running
  free=$((free - cores_of[$name]))
}

finish_step() {  # JOB STATUS
  local name=${name_of_job[$1]} wall_s user_s system_s cpu_s
  unset "name_of_job[$1]"
  free=$((free + cores_of[$name]))
  case $2 in 0) state[$name]=passed ;; 77) state[$name]=skipped ;; *) state[$name]=FAILED ;; esac
  if [ "${cores_of[$name]}" -ne "$cores" ]; then
    printf '\n== %s: its output\n' "$name"
    cat "$log_folder/$name.log"
  fi
  # In some locales `time` writes decimal commas.
  read -r wall_s user_s system_s < <(tail -n 1 "$log_folder/$name.time" | tr , .) || wall_s=0 user_s=0 system_s=0
  cpu_s=$(LC_ALL=C awk -v user="$user_s" -v kernel="$system_s" 'BEGIN { printf "%.1f", user + kernel }')
  skips_of[$name]=$(paste -sd, "$log_folder/$name.skips" 2>/dev/null || true)
  seconds_of[$name]=$(LC_ALL=C; printf '%8.1f s %8.1f s CPU' "$wall_s" "$cpu_s")
  printf '== %s: %s, %s\n' "$name" "${state[$name]}${skips_of[$name]:+; ${skips_of[$name]}}" "$(xargs <<<"${seconds_of[$name]}")"
  printf '%s\t%s\t%s\t%s\t%s\t%s\n' "$run" "$tier" "$name" "${state[$name]}" "$wall_s" "$cpu_s" >>"$times_file"
  if [ "$tier" = release ] && [ "${state[$name]}" = passed ] && [ "${subject_of[$name]}" != - ]; then
    if [ "$(key_of "$name")" = "${key_at_start[$name]}" ]; then
      echo "${key_at_start[$name]}" >"$stamp_folder/$name"
    else
      echo "The files have changed meanwhile: $name does not count as passed for them"
    fi
  fi
}

# Starts every step that can start. After a failure no step starts; in the release tier, only those
# that need the failed step do not.
start_steps() {
  local name need
  for name in "${names[@]}"; do
    [ "${state[$name]:-}" = waiting ] || continue
    for need in ${needs_of[$name]}; do
      case "${state[$need]}" in
        waiting | running) continue 2 ;;
        FAILED | "not run"*) state[$name]="not run: it needs $need"; continue 2 ;;
        skipped) state[$name]="skipped: it needs $need"; continue 2 ;;
      esac
    done
    if $failed && [ "$tier" != release ]; then state[$name]="not run"; continue; fi
    [ "${cores_of[$name]}" -gt $free ] || start_step "$name"
  done
}

end_jobs() {
  local job
  trap - EXIT
  for job in "${!name_of_job[@]}"; do kill -- "-$job" 2>/dev/null || true; done
}

run_steps() {
  local name job status started=0 count=0 free=$cores failed=false run
  local -A key_at_start=()
  mkdir -p $log_folder $stamp_folder "$(dirname $times_file)"
  exec 9>$log_folder/lock
  flock -n 9 || { echo "toolchain/check: another run is using this folder; wait for its end" >&2; exit 2; }
  run=$(date +%Y-%m-%dT%H:%M:%S)
  if [ "$tier" = release ]; then find_keys; fi
  choose_steps
  for name in "${names[@]}"; do [ "${state[$name]:-}" != waiting ] || count=$((count + 1)); done
  trap end_jobs EXIT
  trap 'exit 130' INT TERM
  while start_steps; [ ${#name_of_job[@]} -gt 0 ]; do
    status=0
    wait -n -p job || status=$?
    finish_step "$job" $status
    ! [[ " ${state[*]} " = *FAILED* ]] || failed=true
  done
  print_summary
  ! $failed
}

print_summary() {
  local name before=false skipped=()
  printf '\n== %s, the tier %s:\n' "$(clock)" "$tier"
  for name in "${names[@]}"; do
    [ -n "${state[$name]:-}" ] || continue
    printf '%-24s %-24s %s\n' "$name" "${seconds_of[$name]:-}" "${state[$name]}${skips_of[$name]:+; ${skips_of[$name]}}"
    case "${state[$name]}" in "passed before") before=true ;; skipped*) skipped+=("$name") ;; esac
  done
  ! $before || echo "Passed before: with these files already; --force runs them again."
  if $failed; then
    echo "== FAILED; the output of each step is in $log_folder"
  elif [ ${#skipped[@]} -gt 0 ]; then
    echo "== no check failed; skipped: ${skipped[*]}"
  else
    echo "== all checks passed"
  fi
}
