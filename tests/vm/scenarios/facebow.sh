# SPDX-License-Identifier: Apache-2.0
# The fake facebow in a real kernel, with faults, unplugged and plugged in again, and a reader of it.
# Set: transport=uhid|vhci reader=PROGRAM [library=hidapi|libusb] [repeats=N]. The reader is called as
# PROGRAM [LIBRARY] LAST_COUNTER LIMIT_S and prints its tally as JSON.
count=600
load "$([ "$transport" = uhid ] && echo uhid || echo vhci-hcd)"
load usbhid
load hid-generic
start_udev

faults="truncated@100=11 garbage@150 pause@200=0.15 unplug@300=0.2 wrong_checksum@400"
case "$reader ${library:-}" in *libusb*) faults="$faults stall@450 transfer_error@500" ;; esac
set -- --count $count --settle-s 0.2  # the kernel's usbhid drops what comes in the first 50 ms
for fault in $faults; do set -- "$@" --fault "$fault"; done
field() { sed -n "s/.*\"$2\":\([^,}]*\).*/\1/p" "$1.json"; }
check() { eval "[ $* ]" || { echo "not so: $*"; exit 1; }; }

for round in $(seq "${repeats:-1}"); do
  "$reader" ${library:-} $((count - 1)) 80 >reader.json &
  condyle fake --transport "$transport" "$@" >device.json 2>device.log ||
    { echo "condyle fake failed"; cat device.log; exit 1; }
  wait $! || { cat device.json reader.json; echo "the reader did not reach the last report"; exit 1; }
  echo "round $round"
  cat device.json reader.json

  check "$(field device balances)" = true
  check "$(field device plugged_in)" -eq 2
  check "$(field reader disconnections)" -ge 1
  check "$(field reader repeated)" -eq 0
  check "$(field reader intact)" -le "$(field device delivered_intact)"
  # None is unaccounted for: each was read intact or is missing in the counter.
  check $(($(field reader intact) + $(field reader lost))) -eq $count
done
