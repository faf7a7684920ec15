// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "fake/file_handle.h"
#include "fake/transport.h"

struct uhid_event;

namespace condyle::host::fake {

/// The fake facebow as a HID device of the running kernel, through /dev/uhid (linux/uhid.h,
/// Documentation/hid/uhid.rst). It is not on USB: only hidraw sees it, and transfers cannot fail.
/// Delivered means passed to the kernel, which drops reports that are not read in time.
class UhidTransport final : public Transport {
 public:
  explicit UhidTransport(std::uint16_t product_id) : product_id_(product_id) {}
  std::string name() const override { return "uhid"; }
  void plug() override;
  void unplug() override;
  void send(const Packet& packet) override;
  bool can_fail() const override { return false; }
  bool knows_taken() const override { return false; }
  void serve(TimeNs deadline_ns) override;
  bool is_read() override { return is_open_; }
  bool is_taken() override { return true; }
  Deliveries deliveries() override { return deliveries_; }

 private:
  void write_event(const uhid_event& event) const;

  std::uint16_t product_id_;
  FileHandle file_;
  bool is_open_ = false;  // by a reader
  Deliveries deliveries_;
};

}  // namespace condyle::host::fake
