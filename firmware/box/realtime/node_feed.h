// SPDX-License-Identifier: Apache-2.0
// Carries the facebow's reports from the real-time thread, which never waits, to the thread of the
// microcontroller that estimates.
#pragma once

#include <atomic>
#include <cstdint>

#include "box/sources/reconnecting_source.h"
#include "condyle/firmware/nonblocking.h"
#include "condyle/firmware/ring.h"

namespace condyle::box {

/// A report, as it arrived.
struct FedReport {
  std::uint64_t run = 0;
  std::uint64_t connection = 0;  ///< of the facebow; a new number: it was away in between
  hal::RawReport report;
};

/// Reports of run after run.
class NodeFeed {
 public:
  // For the real-time thread:
  void begin_run(std::uint64_t run) { run_.store(run, std::memory_order_release); }
  void end_run() { run_.store(0, std::memory_order_release); }
  void put(const hal::RawReport& report, std::uint64_t connection) CONDYLE_NONBLOCKING {
    next_.run = run_.load(std::memory_order_relaxed);
    next_.connection = connection;
    next_.report = report;
    (void)ring_.push(next_);
  }

  // For the node's thread:
  /// The run of the next reports; 0: none will come. Those of earlier runs are already in the feed.
  std::uint64_t run() const { return run_.load(std::memory_order_acquire); }
  bool take(FedReport& report) { return ring_.pop(report); }

  /// Reports for which there was no room; any thread may ask.
  std::uint64_t dropped() const { return ring_.dropped(); }

 private:
  firmware::Ring<FedReport, 2048> ring_;  // 4 s at 500 Hz
  std::atomic<std::uint64_t> run_ = 0;
  FedReport next_;
};

/// Passes on all reports of `source`, and feeds the node with them.
class TeeSource final : public hal::ReportSource {
 public:
  /// `connections` gives how often the facebow was connected.
  TeeSource(hal::ReportSource& source, const ReconnectingSource& connections, NodeFeed& feed)
      : source_(source), connections_(connections), feed_(feed) {}

  hal::Status open() override { return source_.open(); }
  hal::Status read(TimeNs deadline_ns, hal::RawReport& report) override {
    const hal::Status status = source_.read(deadline_ns, report);
    if (status == hal::Status::ok) feed_.put(report, connections_.connections());
    return status;
  }
  void close() override { source_.close(); }
  hal::TransportCounts counts() const override { return source_.counts(); }

 private:
  hal::ReportSource& source_;
  const ReconnectingSource& connections_;
  NodeFeed& feed_;
};

}  // namespace condyle::box
