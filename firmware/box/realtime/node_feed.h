// SPDX-License-Identifier: Apache-2.0
// The facebow's reports on their way to a microcontroller that estimates: from the real-time
// thread, which never waits for it, to the thread that does.
#pragma once

#include <atomic>
#include <cstdint>

#include "box/sources/watched_source.h"
#include "condyle/firmware/nonblocking.h"
#include "condyle/firmware/ring.h"

namespace condyle::box {

/// A report, as it arrived.
struct FedReport {
  std::uint64_t run = 0;
  std::uint64_t connection = 0;  ///< of the facebow; another one: it was away in between
  hal::RawReport report;
};

/// Reports of run after run.
class NodeFeed {
 public:
  // The real-time thread's:
  void begin_run(std::uint64_t run) { run_.store(run, std::memory_order_release); }
  void end_run() { run_.store(0, std::memory_order_release); }
  void put(const hal::RawReport& report, std::uint64_t connection) CONDYLE_NONBLOCKING {
    next_.run = run_.load(std::memory_order_relaxed);
    next_.connection = connection;
    next_.report = report;
    (void)ring_.push(next_);
  }

  // The node's thread's:
  /// The run of the reports that are to come, 0: none will; those before it are in the feed
  /// already.
  std::uint64_t run() const { return run_.load(std::memory_order_acquire); }
  bool take(FedReport& report) { return ring_.pop(report); }

  /// Reports that had no room; any thread may ask.
  std::uint64_t dropped() const { return ring_.dropped(); }

 private:
  firmware::Ring<FedReport, 2048> ring_;  // 4 s at 500 Hz
  std::atomic<std::uint64_t> run_ = 0;
  FedReport next_;
};

/// Passes the reports of `source` on, all of them, and feeds the node with them.
class FedSource final : public hal::ReportSource {
 public:
  /// `connections` says how often the facebow was connected.
  FedSource(hal::ReportSource& source, const WatchedSource& connections, NodeFeed& feed)
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
  const WatchedSource& connections_;
  NodeFeed& feed_;
};

}  // namespace condyle::box
