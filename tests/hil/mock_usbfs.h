// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/usbdevice_fs.h>

#include <deque>
#include <optional>

#include "hil/mock_names.h"

namespace condyle::hil {

/// A usbfs node (linux/usbdevice_fs.h) as libusb uses it: asynchronous transfers of endpoint 0 and
/// of the reports.
class MockUsbfs final : public MockNode {
 public:
  MockUsbfs(host::fake::ReportQueue& queue, unsigned plug);
  ~MockUsbfs() override;

  const MockNames& names() const override { return names_; }
  void forget() override;
  gboolean ioctl(UMockdevIoctlClient* client) override;
  gboolean read(UMockdevIoctlClient* client) override;
  void send(const host::fake::Packet& packet) override;
  bool is_read() const override { return !waiting_.empty() && !is_gone_; }
  bool is_taken() const override { return queue_.empty() && done_.empty(); }
  void unplug() override;

 private:
  // A finished transfer that the client has not yet reaped, and the report in it.
  struct Done {
    UMockdevIoctlData* transfer = nullptr;
    std::optional<host::fake::Packet> packet;
  };

  gboolean submit(UMockdevIoctlClient* client);
  gboolean discard(UMockdevIoctlClient* client);
  gboolean reap(UMockdevIoctlClient* client);
  void finish(UMockdevIoctlData* transfer, int status, const host::fake::Packet* packet = nullptr);
  void answer_endpoint_0(UMockdevIoctlData* transfer);
  void deliver();

  MockNames names_;
  std::deque<UMockdevIoctlData*> waiting_;  // transfers of the reports' endpoint; references held
  std::deque<Done> done_;
  bool is_halted_ = false, is_gone_ = false;
};

}  // namespace condyle::hil
