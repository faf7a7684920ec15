// SPDX-License-Identifier: Apache-2.0
// Reads a stream of the Lab Streaming Layer as a source of reports.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "condyle/hal/clock.h"
#include "condyle/hal/report/raw_report.h"
#include "hosted/lsl/clock_offset.h"
#include "hosted/lsl/feed.h"
#include "hosted/lsl/socket.h"
#include "hosted/lsl/stream_layout.h"
#include "hosted/lsl/stream_search.h"

namespace condyle::host::lsl {

/// How an inlet waits.
struct InletSettings {
  SearchSettings search;
  TimeNs reopen_ns = 300'000'000;      ///< for the first answer, when looking for a lost stream
  TimeNs probe_ns = 128'000'000;       ///< longest wait for the answer to a probe
  TimeNs probe_gap_ns = 64'000'000;    ///< between the probes of a later wave
  TimeNs wave_gap_ns = 2'000'000'000;  ///< from the start of a wave to the next
  TimeNs silence_ns = 15'000'000'000;  ///< neither samples nor answers for so long: it has gone
};

/// What happened to an inlet beside its TransportCounts.
struct InletCounts {
  std::uint64_t untimed = 0;  ///< samples dropped, because their stamp is not known or not a time
  std::uint64_t waves = 0;    ///< measured offsets of the clocks
  std::uint64_t failed_waves = 0;  ///< too few probes were answered
};

/// See ReportSource and stream_layout.h. One thread does all its work; reading allocates nothing. A
/// stream that went away is looked for by name, and by its source id if it has one; it must have
/// the same format and channels as before. A report's time is the sender's stamp plus the measured
/// offset of the clocks, so it is the instant for which the sender stamped the sample.
class Inlet final : public hal::ReportSource {
 public:
  /// `stream`: with its full description. `clock`: the machine's monotonic clock.
  Inlet(StreamPlace place, FoundStream stream, std::vector<std::size_t> stored, hal::Clock& clock,
        const InletSettings& settings = {});

  /// ok; not_found if it does not answer, also not to probes; bad_report if a stream of the name
  /// has other channels now. May take as long as the settings say.
  hal::Status open() override;
  hal::Status read(TimeNs deadline_ns, hal::RawReport& report) override;
  void close() override;
  hal::TransportCounts counts() const override { return counts_; }

  const InletCounts& inlet_counts() const { return inlet_counts_; }
  const ClockOffset& clock_offset() const { return offset_; }
  /// Why the last open failed; empty if it did not.
  const std::string& problem() const { return problem_; }

 private:
  std::optional<hal::Status> find_again();
  bool begin_feed();
  bool measure_first_offset();
  bool more(std::size_t& begin, TimeNs end_ns);
  void service_clock(TimeNs now_ns);
  void send_probe(TimeNs now_ns);
  void take_answers();
  void receive(TimeNs now_ns);
  bool fill(const FeedSample& sample, hal::RawReport& report);
  hal::Status lose();

  StreamPlace place_;
  FoundStream stream_;
  std::vector<std::size_t> stored_;
  hal::Clock& clock_;
  InletSettings settings_;

  Socket feed_, probes_;
  bool has_ended_ = false;  // the sender has closed the connection
  bool is_big_endian_ = false;
  Bytes buffer_;
  std::size_t begin_ = 0, end_ = 0;  // of the bytes not yet read
  TimeNs arrival_ns_ = 0, last_sign_ns_ = 0;
  std::uint32_t count_ = 0;
  std::optional<double> last_stamp_s_;

  ClockOffset offset_;
  std::uint32_t wave_ = 0;
  int probes_sent_ = 0;
  bool is_wave_open_ = false;
  TimeNs wave_begin_ns_ = 0, next_probe_ns_ = 0;

  hal::TransportCounts counts_;
  InletCounts inlet_counts_;
  std::string problem_;
};

/// How the sender's clock relates to this machine's, for a summary.
std::string clock_text(const Inlet& inlet);

}  // namespace condyle::host::lsl
