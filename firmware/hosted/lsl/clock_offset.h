// SPDX-License-Identifier: Apache-2.0
// How the clock of a stream's sender lies to this machine's, measured as liblsl does it.
//
// A wave is 8 probes over UDP. Probe and answer give four times: t0 sent here, t1 received there,
// t2 answered there, t3 received here.
//
//   rtt     (t3 - t0) - (t2 - t1)             time on the way, both ways
//   offset  -((t1 - t0) + (t2 - t3)) / 2      this clock minus the sender's; wrong by rtt/2 at most
//
// The offset of the probe with the least rtt counts, if at least 6 were answered. The offset in use
// goes to a new one no faster than kSlew per second of the sender's time, so that velocities are
// not distorted by more; a change of more than kStep_s is taken at once, and counted.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

namespace condyle::host::lsl {

/// Probes of a wave, and how many must be answered.
inline constexpr int kProbes = 8, kFewestAnswers = 6;

/// A probe's text.
std::string probe_text(std::uint32_t wave, double now_s);

/// The four times of an answered probe.
struct ProbeTimes {
  double t0 = 0, t1 = 0, t2 = 0, t3 = 0;
};
/// Reads the answer to a probe of `wave`, which arrived at `now_s`; false if it is none. Does not
/// allocate.
bool parse_probe_answer(std::string_view text, std::uint32_t wave, double now_s, ProbeTimes& times);

/// Answers a probe that was received at `received_s`; empty if `text` is none.
std::string probe_answer(std::string_view text, double received_s, double now_s);

/// See above.
class ClockOffset {
 public:
  static constexpr double kSlew = 1e-3, kStep_s = 0.1;

  /// Begins a wave.
  void begin_wave() { answers_ = 0; }
  void add(const ProbeTimes& times);
  /// Ends the wave; false if too few probes were answered, and the offset stays as it was.
  bool end_wave();
  /// The sender's clock is unrelated to what it was.
  void restart() { is_known_ = has_stamp_ = false; }

  bool is_known() const { return is_known_; }
  int answers() const { return answers_; }
  /// The offset to add to `stamp_s` of the sender's clock; call it for each sample in order.
  double at(double stamp_s);
  /// The one that was used last.
  double in_use_s() const { return in_use_s_; }
  /// Half the round trip of the best probe: the offset is wrong by this at most (s).
  double uncertainty_s() const { return uncertainty_s_; }
  /// Changes that were taken at once.
  std::uint64_t steps() const { return steps_; }

 private:
  int answers_ = 0;
  double best_rtt_s_ = 0, best_offset_s_ = 0;
  bool is_known_ = false, has_stamp_ = false;
  double wanted_s_ = 0, in_use_s_ = 0, last_stamp_s_ = 0;
  double uncertainty_s_ = std::numeric_limits<double>::infinity();
  std::uint64_t steps_ = 0;
};

}  // namespace condyle::host::lsl
