// SPDX-License-Identifier: Apache-2.0
#include "fake/fault_script.h"

#include <algorithm>

#include "statistics/random.h"

namespace condyle::host::fake {

const FaultType& fault_type(FaultKind kind) {
  static constexpr Range jump = {-4294967295.0, 4294967295.0};
  static constexpr std::array<FaultType, kFaultKinds> types = {{
      {"unplug", "off_s", "s", {0, 3600}, 0.2},
      {"pause", "duration_s", "s", {0, 3600}, 0.15},
      {"counter_jump", "step", "counts", jump, 1000, true},
      {"clock_jump", "step_s", "s", {-4294, 4294}, 1},
      {"burst", "count", "reports", {2, 1000}, 8, true},
      {"stall", "", ""},
      {"transfer_error", "", ""},
      {"truncated", "size_bytes", "bytes", {1, 28}, 11, true},
      {"garbage", "", ""},
      {"wrong_checksum", "", ""},
      {"wrong_id", "", ""},
  }};
  return types[static_cast<std::size_t>(kind)];
}

FaultScript::FaultScript(std::vector<FaultRule> rules, std::uint64_t seed)
    : rules_(std::move(rules)), is_over_(rules_.size(), false), seed_(seed) {
  std::stable_sort(rules_.begin(), rules_.end(),
                   [](const FaultRule& a, const FaultRule& b) { return a.kind < b.kind; });
}

// Each report and kind has its own random stream, so that rules do not affect each other.
bool FaultScript::hits(std::size_t index, std::uint64_t number, TimeNs time_ns,
                       bool spares_chance) {
  const FaultRule& rule = rules_[index];
  if (rule.at_report) return number == *rule.at_report;
  if (rule.every_reports) return number > 0 && number % *rule.every_reports == 0;
  if (rule.at_time_ns) {
    const bool is_due = !is_over_[index] && *rule.at_time_ns <= time_ns;
    if (is_due) is_over_[index] = true;
    return is_due;
  }
  if (!rule.probability || spares_chance) return false;
  RandomGenerator random(seed_, number * kFaultKinds + static_cast<std::uint64_t>(rule.kind));
  return random.uniform() < *rule.probability;
}

std::vector<Fault> FaultScript::faults_of(std::uint64_t number, TimeNs time_ns,
                                          bool spares_chance) {
  std::vector<Fault> faults;
  for (std::size_t i = 0; i < rules_.size(); ++i) {
    if (!faults.empty() && faults.back().kind == rules_[i].kind) continue;
    if (hits(i, number, time_ns, spares_chance)) {
      faults.push_back({rules_[i].kind, rules_[i].amount, rules_[i].at_time_ns.value_or(time_ns)});
    }
  }
  return faults;
}

}  // namespace condyle::host::fake
