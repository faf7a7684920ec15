// SPDX-License-Identifier: Apache-2.0
#include "hil/mock_hidraw.h"

#include <linux/hidraw.h>
#include <linux/input.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>

namespace condyle::hil {

using namespace host::fake;

namespace {

// The ioctls that take a text's length in their number.
gboolean give_text(UMockdevIoctlClient* client, std::string_view text) {
  const gsize size = _IOC_SIZE(umockdev_ioctl_client_get_request(client));
  auto* const buffer = resolve<char>(umockdev_ioctl_client_get_arg(client), 0, size);
  if (buffer == nullptr || size == 0) return complete(client, -1, EFAULT);
  const std::string copy = std::string(text) + '\0';
  const gsize given = std::min(size, copy.size());
  std::memcpy(buffer, copy.data(), given);
  return complete(client, static_cast<glong>(given));
}

}  // namespace

// Kinder than the kernel, a client that opened the node just before the device went still gets the
// descriptor: hidapi 0.13 uses freed memory where it does not (see HidapiSource::open).
gboolean MockHidraw::ioctl(UMockdevIoctlClient* client) {
  UMockdevIoctlData* const argument = umockdev_ioctl_client_get_arg(client);
  const gulong request = umockdev_ioctl_client_get_request(client);
  const auto descriptor = report_descriptor();
  if (request == HIDIOCGRDESCSIZE) {
    auto* const size = resolve<int>(argument, 0);
    if (size == nullptr) return complete(client, -1, EFAULT);
    *size = static_cast<int>(descriptor.size());
    return complete(client, 0);
  }
  if (request == HIDIOCGRDESC) {
    auto* const copy = resolve<hidraw_report_descriptor>(argument, 0);
    if (copy == nullptr) return complete(client, -1, EFAULT);
    std::copy_n(descriptor.begin(), std::min<std::size_t>(copy->size, descriptor.size()),
                copy->value);
    return complete(client, 0);
  }
  if (is_gone_) return complete(client, -1, ENODEV);
  if (request == HIDIOCGRAWINFO) {
    auto* const info = resolve<hidraw_devinfo>(argument, 0);
    if (info == nullptr) return complete(client, -1, EFAULT);
    *info = {BUS_USB, static_cast<__s16>(kVendorId), static_cast<__s16>(kProductId)};
    return complete(client, 0);
  }
  if (_IOC_TYPE(request) == 'H') {
    switch (_IOC_NR(request)) {
      case 0x04:
        return give_text(client, std::string(kManufacturer) + " " + std::string(kProduct));
      case 0x05:
        return give_text(client, "usb-0000:00:14.0-1/input0");
      case 0x08:
        return give_text(client, serial_);
      default:  // no report that could be asked for or set
        return complete(client, -1, EPIPE);
    }
  }
  return complete(client, -1, ENOTTY);
}

gboolean MockHidraw::read(UMockdevIoctlClient* client) {
  if (is_gone_) return complete(client, -1, EIO);
  has_reader_ = true;
  if (queue_.empty()) {
    gate_.silence();
    is_asking_ = false;
    return complete(client, -1, EAGAIN);
  }
  gate_.unring();
  const Packet packet = queue_.pop();
  UMockdevIoctlData* const buffer = umockdev_ioctl_client_get_arg(client);
  const std::size_t size =
      std::min(packet.size, static_cast<std::size_t>(std::max(0, buffer->data_len)));
  std::copy_n(packet.bytes.begin(), size, buffer->data);
  queue_.count_delivered(packet);
  return complete(client, static_cast<glong>(size));
}

void MockHidraw::send(const Packet& packet) {
  if (!is_open()) {
    queue_.count_unread();
  } else if (queue_.push(packet)) {
    gate_.ring();
  }
}

void MockHidraw::greet() {
  if (is_gone_ || has_reader_ || is_asking_) return;
  is_asking_ = true;
  gate_.ring();
}

// As the kernel does, a node that is opened again starts with nothing.
void MockHidraw::forget() {
  if (is_gone_) return;
  gate_.silence();
  is_asking_ = has_reader_ = false;
  while (!queue_.empty()) {
    queue_.pop();
    queue_.count_unread();
  }
}

void MockHidraw::unplug() {
  is_gone_ = true;
  queue_.unplug();
}

}  // namespace condyle::hil
