# SPDX-License-Identifier: Apache-2.0
# The measurement box on a fake facebow in a real kernel: a session with faults, in which every report
# is received or said to be lost, and whose replay works. Set: transport=uhid|vhci kind=hid|usb
# count=N.
load "$([ "$transport" = uhid ] && echo uhid || echo vhci-hcd)"
load usbhid
load hid-generic
start_udev
ifconfig lo 127.0.0.1 up

cat >box.toml <<END
[facebow]
source = "$kind:/files/condyle_facebow.toml"
[recording]
folder = "."
reserve_MB = 1
[http]
port = 0
END
# Never the last report: nothing after it would tell that it is missing.
faults="unplug/$((count / 25))=0.3 truncated/$(((count - 2) / 9)) wrong_checksum/$(((count - 2) / 11))
  wrong_id/$(((count - 2) / 7)) pause/$((count / 5))=0.1"
set -- --count "$count" --settle-s 1 --linger-s 1 --rate-Hz 500
for fault in $faults; do set -- "$@" --fault "$fault"; done
condyle fake --transport "$transport" "$@" >device.json 2>device.log &
drive_box 6 /programs/condyle-box --config box.toml >status.json 2>box.log ||
  { cat box.log device.log; echo "the box did not do as told"; exit 1; }
wait $! || { cat device.log; exit 1; }
cat device.json box.log
tr ',' '\n' <status.json | grep -E 'reports_|connect|scheduling|memory|p50|p99|max_s|dropped|grown'
field() { sed -n "s/.*\"$2\":\([^,}]*\).*/\1/p" "$1"; }
check() { eval "[ $* ]" || { echo "not so: $*"; exit 1; }; }
check "$(field device.json balances)" = true
check "$(field device.json plugged_in)" -ge 24
check $(($(field status.json reports_received) + $(tr ',' '\n' <status.json | sed -n 's/.*"reports_lost":\([0-9]*\).*/\1/p' | head -n 1))) -eq "$count"
check "$(field status.json gaps_of_unknown_length)" -eq 0
check "$(field status.json dropped)" -eq 0
condyle replay ./*.mcap >replay.txt || { cat replay.txt; exit 1; }
