// SPDX-License-Identifier: Apache-2.0
#include "fake/uhid_transport.h"

#include <fcntl.h>
#include <linux/input.h>
#include <linux/uhid.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "fake/facebow_usb.h"
#include "hosted/files/input_error.h"

namespace condyle::host::fake {
namespace {

constexpr const char* kNode = "/dev/uhid";

template <std::size_t size>
void put_text(__u8 (&field)[size], std::string_view text) {
  static_assert(size > 0);
  std::copy_n(text.data(), std::min(text.size(), size - 1), field);
}

[[noreturn]] void fail_open(int error) {
  if (error == EACCES || error == EPERM) {
    throw InputError(kNode, "permission denied", "run as root");
  }
  throw InputError(kNode, std::string("cannot be opened: ") + std::strerror(error),
                   "as root: modprobe uhid (Debian's \"cloud\" kernels lack this module)");
}

}  // namespace

void UhidTransport::write_event(const uhid_event& event) const {
  if (write(file_.get(), &event, sizeof event) < 0) {
    throw InputError(kNode, std::string("the kernel refuses the device: ") + std::strerror(errno),
                     "see the kernel's log for the reason");
  }
}

void UhidTransport::plug() {
  file_ = FileHandle(open(kNode, O_RDWR | O_CLOEXEC));
  if (!file_.is_open()) fail_open(errno);
  uhid_event event{};
  event.type = UHID_CREATE2;
  uhid_create2_req& device = event.u.create2;
  put_text(device.name, std::string(kManufacturer) + " " + std::string(kProduct));
  put_text(device.phys, "condyle-fake/input0");
  put_text(device.uniq, kSerial);
  const auto descriptor = report_descriptor();
  device.rd_size = static_cast<__u16>(descriptor.size());
  std::memcpy(device.rd_data, descriptor.data(), descriptor.size());
  device.bus = BUS_USB;
  device.vendor = kVendorId;
  device.product = product_id_;
  device.version = kDeviceVersion;
  write_event(event);
}

void UhidTransport::unplug() {
  if (!file_.is_open()) return;
  uhid_event event{};
  event.type = UHID_DESTROY;
  write_event(event);
  file_.reset();
  is_open_ = false;
}

void UhidTransport::send(const Packet& packet) {
  while (wait_readable(file_.get(), 0)) serve(0);  // a reader may have opened or closed the device
  if (!is_open_) {
    ++deliveries_.lost_unread;
    return;
  }
  uhid_event event{};
  event.type = UHID_INPUT2;
  event.u.input2.size = static_cast<__u16>(packet.size);
  std::memcpy(event.u.input2.data, packet.bytes.data(), packet.size);
  write_event(event);
  ++(packet.intact ? deliveries_.intact : deliveries_.altered);
}

// Reads one event: kernels give one at a time.
void UhidTransport::serve(TimeNs deadline_ns) {
  if (!file_.is_open()) {
    hal::SteadyClock().sleep_until(deadline_ns);
    return;
  }
  if (!wait_readable(file_.get(), deadline_ns)) return;
  uhid_event event{};
  if (read(file_.get(), &event, sizeof event) <= 0) return;
  uhid_event reply{};
  switch (event.type) {
    case UHID_OPEN:
      is_open_ = true;
      break;
    case UHID_CLOSE:
      is_open_ = false;
      break;
    case UHID_GET_REPORT:  // the device has no such report
      reply.type = UHID_GET_REPORT_REPLY;
      reply.u.get_report_reply.id = event.u.get_report.id;
      reply.u.get_report_reply.err = EIO;
      write_event(reply);
      break;
    case UHID_SET_REPORT:
      reply.type = UHID_SET_REPORT_REPLY;
      reply.u.set_report_reply.id = event.u.set_report.id;
      reply.u.set_report_reply.err = EIO;
      write_event(reply);
      break;
    default:  // start, stop, output: nothing to do
      break;
  }
}

}  // namespace condyle::host::fake
