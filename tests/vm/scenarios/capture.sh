# SPDX-License-Identifier: Apache-2.0
# What the kernel's usbmon saw of a recording, as tcpdump writes it down: replayed, it gives the
# numbers that were recorded.
load vhci-hcd
load usbmon
load usbhid
load hid-generic
start_udev

fail() { echo "$1"; shift; cat "$@"; exit 1; }
echo root:x:0:0::/:/bin/sh >/etc/passwd  # tcpdump asks who it is
tcpdump -Z root -i usbmon0 -s 0 -U -w capture.pcap 2>tcpdump.txt &
tcpdump=$!
sleep 1
grep -q 'listening on' tcpdump.txt || fail "tcpdump does not listen" tcpdump.txt
condyle fake --transport vhci --count 2000 --rate-Hz 500 --settle-s 3 --linger-s 2 >bow.json 2>&1 &
bow=$!
condyle record --profile /files/condyle_facebow.toml --backend libusb --out log.mcap --idle-s 5 \
  >record.txt 2>&1 || fail "not recorded" record.txt tcpdump.txt
wait $bow
kill -INT $tcpdump
wait $tcpdump || fail "not captured" tcpdump.txt
cat record.txt tcpdump.txt
grep -q '^reports  *2000 reports received, 0 lost' record.txt || fail "facebow" bow.json

# The profile, with two of the three points as values that can be compared.
sed 's/"three_points"/"one_point"/' /files/condyle_facebow.toml >bow.toml
for offset in 15 17 19 21 23 25; do
  printf '[auxiliary.at_%s]\noffset_bytes = %s\nwidth_bits = 16\ntype = "signed"\nunit = "um"\n' \
    $offset $offset >>bow.toml
done
condyle replay log.mcap --profile bow.toml --out log.csv --values log >log.txt 2>&1 || fail "log" log.txt
condyle replay capture.pcap --profile bow.toml --out capture.csv --values capture \
  >capture.txt 2>&1 || fail "capture" capture.txt
cat capture.txt
for run in log capture; do cut -d , -f 2- $run/facebow.csv >$run.numbers; done
[ "$(wc -l <log.numbers)" -eq 2001 ] || fail "too few" log.txt
cmp log.numbers capture.numbers
