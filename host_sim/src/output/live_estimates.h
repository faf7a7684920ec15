// SPDX-License-Identifier: Apache-2.0
// Writes estimates live, without blocking the estimator.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "output/cycles_file.h"
#include "output/estimates_file.h"
#include "output/pose_file.h"

namespace condyle::host {

/// A thread writes. Rows are dropped and counted if a slow reader leaves no room. An error of the
/// file ends the writing, not the recording. `File`: EstimatesFile, PoseFile
/// or CyclesFile.
template <class File>
class LiveFile {
 public:
  using Row = typename File::Row;

  /// The arguments make the file. Throws InputError if it cannot be made.
  template <class... Arguments>
  explicit LiveFile(Arguments&&... arguments)
      : file_(std::forward<Arguments>(arguments)...), thread_([this] { run(); }) {}
  ~LiveFile();
  LiveFile(const LiveFile&) = delete;
  LiveFile& operator=(const LiveFile&) = delete;

  /// Never waits for the file.
  void add(const Row& row);
  /// Writes the remaining rows and renames the file; abandons a reader that stalls for two seconds.
  /// A regular file has none: a slow disk is waited for.
  void finish();

  /// After finish: number of dropped rows.
  std::uint64_t dropped() const { return dropped_; }
  /// Why the file is not complete; empty if it is.
  std::string problem() const;

 private:
  static constexpr std::size_t kRoom = 8192;  // rows: 16 s at 500 Hz

  void run();
  void interrupt_writer();

  File file_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Row> rows_;
  bool ends_ = false, has_ended_ = false, is_finished_ = false;
  std::uint64_t dropped_ = 0, written_ = 0;
  std::string problem_;
  std::thread thread_;
};

extern template class LiveFile<EstimatesFile>;
extern template class LiveFile<PoseFile>;
extern template class LiveFile<CyclesFile>;

using LiveEstimates = LiveFile<EstimatesFile>;
using LivePoses = LiveFile<PoseFile>;
using LiveCycles = LiveFile<CyclesFile>;

}  // namespace condyle::host
