// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <umockdev.h>

#include <string>

#include "fake/report_queue.h"
#include "fake/transport.h"
#include "hil/pty_gate.h"

namespace condyle::hil {

/// What umockdev is to be told of a plugged-in device.
struct MockNames {
  std::string node;                  ///< "/dev/..."
  std::vector<std::string> devices;  ///< umockdev's descriptions, the outermost first
  std::vector<std::string> paths;    ///< their paths below /sys, in the same order
  std::string identity;  ///< hidraw's: file below /sys with serial number, for who lists devices
};

/// Completes a client's call: with a result, or -1 and an errno.
inline gboolean complete(UMockdevIoctlClient* client, glong result, int error = 0) {
  umockdev_ioctl_client_complete(client, result, error);
  return TRUE;
}

/// The client's memory that the pointer at `offset` of `data` points to, as local memory; nullptr
/// where it points to none.
template <typename Type>
Type* resolve(UMockdevIoctlData* data, gsize offset, gsize size = sizeof(Type)) {
  UMockdevIoctlData* const inner = umockdev_ioctl_data_resolve(data, offset, size, nullptr);
  return inner != nullptr ? reinterpret_cast<Type*>(inner->data) : nullptr;
}

/// A device node from plugging in to unplugging, and what its last reader still does with it. The
/// transport calls it under its lock.
class MockNode {
 public:
  explicit MockNode(host::fake::ReportQueue& queue) : queue_(queue) {}
  virtual ~MockNode() = default;
  MockNode(const MockNode&) = delete;
  MockNode& operator=(const MockNode&) = delete;

  virtual const MockNames& names() const = 0;
  /// A client opened it.
  void open() {
    ++clients_;
    greet();
  }
  /// A client closed it.
  void close() {
    if (--clients_ == 0) forget();
  }
  /// Counts as lost what no client will read any more.
  virtual void forget() = 0;
  /// A client's calls; they must be completed.
  virtual gboolean ioctl(UMockdevIoctlClient* client) = 0;
  virtual gboolean read(UMockdevIoctlClient* client) = 0;
  /// See Transport.
  virtual void send(const host::fake::Packet& packet) = 0;
  virtual bool is_read() const = 0;
  virtual bool is_taken() const = 0;
  /// The device has gone: calls fail, what was on its way is lost. Its node cannot be opened any
  /// more.
  virtual void unplug() = 0;
  /// Whoever waits for the device learns it, too.
  void hang_up() { gate_.hang_up(); }

  const PtyGate& gate() const { return gate_; }
  bool is_open() const { return clients_ > 0; }

 protected:
  /// After each opening.
  virtual void greet() {}

  host::fake::ReportQueue& queue_;
  PtyGate gate_;

 private:
  int clients_ = 0;
};

}  // namespace condyle::hil
