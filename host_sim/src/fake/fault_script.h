// SPDX-License-Identifier: Apache-2.0
// Faults of the fake facebow, planned or random. A file has a section for each kind:
//
//   seed = 7                   # of the random faults
//   [unplug]                   # or truncated, garbage, wrong_checksum, wrong_id, stall,
//                              # transfer_error, pause, burst, counter_jump, clock_jump
//   reports = [100, 250]       # before or in these reports; the first is 0
//   times_s = [1.25]           # at these times since the device was first read
//   every_reports = 60         # and in every 60th
//   probability = 0.001        # and at random, for each report
//   off_s = 0.2                # amount, for the kinds that have one: see fault_type
//
// The same as text, for a command line: unplug@100, unplug@1.25s, unplug/60, unplug~0.001, each
// with the amount after "=": unplug@100=0.2.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "condyle/estimator/parameter_range.h"
#include "condyle/estimator/sample.h"

namespace condyle::host::fake {

/// In the order of their application, if several hit one report.
enum class FaultKind : std::uint8_t {
  unplug,          ///< before the report; plugged in again after off_s
  pause,           ///< no measurement for duration_s
  counter_jump,    ///< by `step` counts
  clock_jump,      ///< by step_s
  burst,           ///< `count` reports are held back and sent at once
  stall,           ///< the endpoint halts; the report is lost
  transfer_error,  ///< the transfer fails with EPROTO; the report is lost
  truncated,       ///< the report ends after size_bytes
  garbage,         ///< random bytes after the report id
  wrong_checksum,
  wrong_id,  ///< report id 2, with a valid checksum
};

inline constexpr std::size_t kFaultKinds = 11;

/// Properties of a kind.
struct FaultType {
  std::string_view name;
  std::string_view amount_key;  ///< "" if the kind has no amount
  std::string_view unit;
  Range range{};
  double amount = 0;  ///< default
  bool is_whole = false;
};

/// The kind's name, and its amount's.
const FaultType& fault_type(FaultKind kind);

/// When a fault happens. Exactly one of the conditions is set.
struct FaultRule {
  FaultKind kind = FaultKind::garbage;
  double amount = 0;
  std::optional<std::uint64_t> at_report;
  std::optional<TimeNs> at_time_ns;
  std::optional<std::uint64_t> every_reports;
  std::optional<double> probability;
};

/// A fault that is due.
struct Fault {
  FaultKind kind = FaultKind::garbage;
  double amount = 0;
  TimeNs time_ns = 0;  ///< not after the report's
};

/// The faults of one run. The same rules and seed give the same faults.
class FaultScript {
 public:
  /// No faults.
  FaultScript() = default;
  FaultScript(std::vector<FaultRule> rules, std::uint64_t seed);

  /// The faults that hit report `number` (from 0, one call for each, in order), due at `time_ns`
  /// after the device was first read; at most one of a kind. `spares_chance`: no random ones.
  std::vector<Fault> faults_of(std::uint64_t number, TimeNs time_ns, bool spares_chance);

 private:
  bool hits(std::size_t rule, std::uint64_t number, TimeNs time_ns, bool spares_chance);

  std::vector<FaultRule> rules_;
  std::vector<bool> is_over_;  // for each rule at a time
  std::uint64_t seed_ = 0;
};

/// Reads a file; InputErrors name line, column and remedy. `seed` keeps its value if the file has
/// none.
std::vector<FaultRule> load_faults(const std::string& path, std::uint64_t& seed);

/// Reads one rule from text; throws InputError if the text is not a rule.
FaultRule parse_fault(const std::string& text);

}  // namespace condyle::host::fake
