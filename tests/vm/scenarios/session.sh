# SPDX-License-Identifier: Apache-2.0
# A session with a real kernel: condyle inspect and doctor see a fake facebow and a companion of
# another rate and clock; condyle record records both, and a replay is the live run again.
load uhid
load usbhid
load hid-generic
start_udev

cat >force.toml <<'END'
name = "fake force sensor"
vendor_id = 0x1209
product_id = 0x0002
rate_Hz = 200
[report]
id = 1
minimum_size_bytes = 29
[sequence]
offset_bytes = 1
width_bits = 32
[device_time]
offset_bytes = 5
width_bits = 32
unit = "us"
[drive]
offset_bytes = 9
width_bits = 16
type = "signed"
unit = "mN"
[auxiliary.emg_masseter_left]
offset_bytes = 11
width_bits = 16
type = "signed"
unit = "uV"
END

fail() { echo "$1"; shift; cat "$@"; exit 1; }
condyle fake --transport uhid --count 3000 --rate-Hz 500 --settle-s 3 --linger-s 6 >bow.json 2>&1 &
condyle fake --transport uhid --product-id 2 --count 1200 --rate-Hz 200 --clock-drift-ppm 500 \
  --settle-s 3 --linger-s 6 >force.json 2>&1 &
while [ "$(ls /dev/hidraw* 2>/dev/null | wc -l)" -lt 2 ]; do sleep 0.1; done
condyle inspect >inspect.txt
grep -q '^1209:0001 .*fake facebow' inspect.txt || fail "no facebow" inspect.txt
grep -q '^1209:0002 ' inspect.txt || fail "no companion" inspect.txt
condyle doctor --profile /files/condyle_facebow.toml >doctor.txt || fail "the doctor finds" doctor.txt

condyle record --profile /files/condyle_facebow.toml --companion force.toml --out log.mcap \
  --estimates live.csv --idle-s 5 >record.txt 2>&1 || fail "not recorded" record.txt
cat record.txt
wait
grep -q '^reports  *3000 reports received, 0 lost' record.txt || fail "facebow" bow.json
grep -q '^reports  *1200 reports received, 0 lost' record.txt || fail "companion" force.json

# The companion's clock runs 500 ppm fast, as far as the run can tell.
sed -n 's/^clock .* \([0-9.]*\) ppm \([a-z]*\) than .* +-\([0-9.]*\) .*/\1 \2 \3/p' record.txt | tail -n 1 |
  awk '{ drift = $2 == "faster" ? $1 : -$1; off = drift - 500; exit !(off < 1.5 * $3 && -off < 1.5 * $3) }' ||
  fail "drift" record.txt

condyle replay log.mcap --out again.csv --values values >replay.txt 2>&1 || fail "no replay" replay.txt
cmp live.csv again.csv
[ "$(wc -l <values/companion-1.csv)" -eq 1201 ] || fail "values" values/companion-1.csv
[ "$(head -n 1 values/companion-1.csv)" = time_s,drive_N,emg_masseter_left_V ]
# On the same host time: the companion's begins within half a second of the facebow's.
first() { sed -n 2p "$1" | cut -d , -f 1; }
awk -v a="$(first live.csv)" -v b="$(first values/companion-1.csv)" \
  'BEGIN { d = a - b; exit !(d < 0.5 && d > -0.5) }' || fail "apart" values/companion-1.csv
