// SPDX-License-Identifier: Apache-2.0
// Velocities of about the last second, to look up by time.
//
// Velocities closer than kStep_ns to the last stored one are left out; between two stored ones the
// history is a straight line.
#pragma once

#include <algorithm>

#include "condyle/estimator/math/arithmetic.h"
#include "condyle/estimator/sample.h"

namespace condyle {

/// See above.
template <class Scalar>
class VelocityHistory {
 public:
  /// Forgets everything.
  void clear() { count_ = 0; }

  /// Adds the velocity (m/s) at `time_ns`, later than those before.
  void add(TimeNs time_ns, Scalar velocity_m_s) {
    if (count_ > 0 && age_ns(time_ns, entry(0)) < kStep_ns) return;
    newest_ = (newest_ + 1) % kEntries;
    count_ = std::min(count_ + 1, kEntries);
    entries_[newest_] = {time_ns, velocity_m_s};
  }

  /// The velocity `before_ns` before `now_ns`: the newest known one if it is later than all, 0 if
  /// it is earlier than all.
  Scalar at(TimeNs now_ns, TimeNs before_ns) const {
    if (count_ == 0) return 0;
    const auto before = static_cast<std::uint64_t>(before_ns);
    if (age_ns(now_ns, entry(0)) >= before) return entry(0).velocity_m_s;
    if (age_ns(now_ns, entry(count_ - 1)) < before) return 0;
    int later = 0, earlier = count_ - 1;  // entries back, around that instant
    while (earlier - later > 1) {
      const int middle = (earlier + later) / 2;
      (age_ns(now_ns, entry(middle)) < before ? later : earlier) = middle;
    }
    const Entry &from = entry(earlier), &to = entry(later);
    const auto waits_ns = static_cast<Scalar>(age_ns(now_ns, from) - before);
    const Scalar part = waits_ns / static_cast<Scalar>(age_ns(to.time_ns, from));
    return from.velocity_m_s + part * (to.velocity_m_s - from.velocity_m_s);
  }

 private:
  static constexpr std::uint64_t kStep_ns = 7'900'000;
  static constexpr int kEntries = 128;

  struct Entry {
    TimeNs time_ns = 0;
    Scalar velocity_m_s = 0;
  };

  static std::uint64_t age_ns(TimeNs now_ns, const Entry& entry) {
    return static_cast<std::uint64_t>(now_ns) - static_cast<std::uint64_t>(entry.time_ns);
  }
  const Entry& entry(int back) const { return entries_[(newest_ + kEntries - back) % kEntries]; }

  int newest_ = 0, count_ = 0;
  Array<Entry, kEntries> entries_ = {};
};

}  // namespace condyle
