// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "fake/file_handle.h"

namespace condyle::hil {

/// A pseudo-terminal that stands for a device node, because umockdev answers ioctl and read but not
/// poll: the client's poll sees this terminal, and we decide what it sees.
class PtyGate {
 public:
  /// InputError where there is no terminal to be had.
  PtyGate();

  /// Path of the side that the client opens.
  const std::string& path() const { return path_; }

  /// One byte waits: POLLIN.
  void ring();
  /// Takes one byte back.
  void unring();
  /// Takes all bytes back.
  void silence();
  /// POLLOUT, by flow control.
  void allow_output(bool allowed);
  /// POLLERR and POLLHUP, for good, as after unplugging.
  void hang_up();

 private:
  host::fake::FileHandle ours_, clients_;
  std::string path_;
};

}  // namespace condyle::hil
