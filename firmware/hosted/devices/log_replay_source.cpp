// SPDX-License-Identifier: Apache-2.0
#include "hosted/devices/log_replay_source.h"

namespace condyle::host {

hal::Status LogReplaySource::read(TimeNs deadline_ns, hal::RawReport& report) {
  if (!has_begun_) {
    recorded_.ahead_ns = device_.reports->header().start_monotonic_ns - clock_.now_ns();
  }
  has_begun_ = true;
  const hal::Status status = device_.reports->read(deadline_ns + recorded_.ahead_ns, report);
  if (status == hal::Status::ok) report.host_time_ns -= recorded_.ahead_ns;
  return status;
}

}  // namespace condyle::host
