// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/mock_names.h"

namespace condyle::hil {

/// A hidraw node (linux/hidraw.h, Documentation/hid/hidraw.rst) for one reader that waits with
/// poll. Harsher than kernels, short reports arrive as they are: kernels drop or pad them. A client
/// that only looks at the device is no reader: at first poll says that there is a report, and who
/// asks for it gets EAGAIN.
class MockHidraw final : public MockNode {
 public:
  MockHidraw(host::fake::ReportQueue& queue, unsigned plug, const std::string& serial)
      : MockNode(queue), names_(hidraw_names(plug, serial)), serial_(serial) {}

  const MockNames& names() const override { return names_; }
  void forget() override;
  gboolean ioctl(UMockdevIoctlClient* client) override;
  gboolean read(UMockdevIoctlClient* client) override;
  void send(const host::fake::Packet& packet) override;
  bool is_read() const override { return has_reader_ && !is_gone_; }
  bool is_taken() const override { return queue_.empty(); }
  void unplug() override;

 protected:
  void greet() override;

 private:
  MockNames names_;
  std::string serial_;
  bool is_asking_ = false;   // whether a client reads: poll says so
  bool has_reader_ = false;  // one did
  bool is_gone_ = false;
};

}  // namespace condyle::hil
