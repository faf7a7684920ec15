# SPDX-License-Identifier: Apache-2.0
# What the kernel makes of every fifth report descriptor in /files/descriptors.tar.gz.
load uhid
load hid-generic
mkdir descriptors
tar -x -z -f /files/descriptors.tar.gz -C descriptors
kernel_report_sizes $(find descriptors -type f -size +0 ! -name COPYING | sort | awk 'NR % 5 == 0') >/results/sizes.txt
