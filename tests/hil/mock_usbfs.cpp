// SPDX-License-Identifier: Apache-2.0
#include "hil/mock_usbfs.h"

#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>
#include <utility>

namespace condyle::hil {

using namespace host::fake;

namespace {

constexpr std::size_t kSetupSize = 8;

usbdevfs_urb& urb_of(UMockdevIoctlData* transfer) {
  return *reinterpret_cast<usbdevfs_urb*>(transfer->data);
}

std::span<std::uint8_t> buffer_of(UMockdevIoctlData* transfer) {
  const usbdevfs_urb& urb = urb_of(transfer);
  return {static_cast<std::uint8_t*>(urb.buffer), static_cast<std::size_t>(urb.buffer_length)};
}

}  // namespace

MockUsbfs::MockUsbfs(ReportQueue& queue, unsigned plug)
    : MockNode(queue), names_(usbfs_names(plug)) {
  gate_.allow_output(false);  // nothing to reap
}

MockUsbfs::~MockUsbfs() {
  forget();
}

// Transfers that nobody will reap any more.
void MockUsbfs::forget() {
  for (UMockdevIoctlData* const transfer : std::exchange(waiting_, {})) g_object_unref(transfer);
  for (const Done& done : std::exchange(done_, {})) {
    if (done.packet && is_gone_) queue_.count_unplugged(*done.packet);
    if (done.packet && !is_gone_) queue_.count_unread();
    g_object_unref(done.transfer);
  }
  gate_.allow_output(false);
}

gboolean MockUsbfs::read(UMockdevIoctlClient* client) {
  return complete(client, -1, EINVAL);
}

gboolean MockUsbfs::ioctl(UMockdevIoctlClient* client) {
  const gulong request = umockdev_ioctl_client_get_request(client);
  // What has finished may be reaped also after the device has gone.
  if (request == USBDEVFS_REAPURB || request == USBDEVFS_REAPURBNDELAY) return reap(client);
  if (is_gone_) return complete(client, -1, ENODEV);
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES: {
      auto* const bits = resolve<guint32>(umockdev_ioctl_client_get_arg(client), 0);
      if (bits == nullptr) return complete(client, -1, EFAULT);
      *bits = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
              USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
      return complete(client, 0);
    }
    case USBDEVFS_CLAIMINTERFACE:
    case USBDEVFS_DISCONNECT_CLAIM:
    case USBDEVFS_RELEASEINTERFACE:
    case USBDEVFS_SETCONFIGURATION:
    case USBDEVFS_SETINTERFACE:
      return complete(client, 0);
    case USBDEVFS_CLEAR_HALT:
    case USBDEVFS_RESET:
      is_halted_ = false;
      deliver();
      return complete(client, 0);
    case USBDEVFS_GETDRIVER:
    case USBDEVFS_IOCTL:
      return complete(client, -1, ENODATA);  // no kernel driver has the interface
    case USBDEVFS_SUBMITURB:
      return submit(client);
    case USBDEVFS_DISCARDURB:
      return discard(client);
    default:
      return complete(client, -1, ENOTTY);
  }
}

gboolean MockUsbfs::submit(UMockdevIoctlClient* client) {
  UMockdevIoctlData* const transfer = umockdev_ioctl_data_resolve(
      umockdev_ioctl_client_get_arg(client), 0, sizeof(usbdevfs_urb), nullptr);
  if (transfer == nullptr) return complete(client, -1, EFAULT);
  const usbdevfs_urb& urb = urb_of(transfer);
  if (urb.buffer_length > 0) {
    umockdev_ioctl_data_resolve(transfer, G_STRUCT_OFFSET(usbdevfs_urb, buffer),
                                static_cast<gsize>(urb.buffer_length), nullptr);
  }
  const bool is_control = urb.type == USBDEVFS_URB_TYPE_CONTROL && urb.endpoint == 0 &&
                          urb.buffer_length >= static_cast<int>(kSetupSize);
  const bool is_report = urb.type == USBDEVFS_URB_TYPE_INTERRUPT && urb.endpoint == kEndpoint &&
                         urb.buffer_length >= static_cast<int>(kLargestPacket);
  if (!is_control && !is_report) return complete(client, -1, EINVAL);
  g_object_ref(transfer);
  if (is_control) {
    answer_endpoint_0(transfer);
  } else {
    waiting_.push_back(transfer);
    deliver();
  }
  return complete(client, 0);
}

void MockUsbfs::answer_endpoint_0(UMockdevIoctlData* transfer) {
  const auto buffer = buffer_of(transfer);
  const ControlRequest request(buffer.first<kSetupSize>());
  if (request.clears_halt()) is_halted_ = false;
  const ControlAnswer answer = answer_control(request);
  urb_of(transfer).actual_length = 0;
  if (answer.stalled) {
    finish(transfer, -EPIPE);
    return;
  }
  const auto data = buffer.subspan(kSetupSize);
  const std::size_t size = std::min(answer.data.size(), data.size());
  std::copy_n(answer.data.begin(), size, data.begin());
  urb_of(transfer).actual_length = static_cast<int>(request.is_read() ? size : request.length);
  finish(transfer, 0);
}

gboolean MockUsbfs::discard(UMockdevIoctlClient* client) {
  const UMockdevIoctlData* const argument = umockdev_ioctl_client_get_arg(client);
  gulong address = 0;
  std::memcpy(&address, argument->data, sizeof address);
  const auto found = std::find_if(waiting_.begin(), waiting_.end(), [&](const auto* transfer) {
    return transfer->client_addr == address;
  });
  if (found == waiting_.end()) return complete(client, -1, EINVAL);
  UMockdevIoctlData* const transfer = *found;
  waiting_.erase(found);
  finish(transfer, -ENOENT);
  return complete(client, 0);
}

gboolean MockUsbfs::reap(UMockdevIoctlClient* client) {
  if (done_.empty()) {
    return complete(client, -1, is_gone_ ? ENODEV : EAGAIN);
  }
  const Done done = done_.front();
  done_.pop_front();
  if (done_.empty()) gate_.allow_output(false);
  UMockdevIoctlData* const place = umockdev_ioctl_data_resolve(
      umockdev_ioctl_client_get_arg(client), 0, sizeof(gpointer), nullptr);
  umockdev_ioctl_data_set_ptr(place, 0, done.transfer);
  g_object_unref(done.transfer);
  if (done.packet) queue_.count_delivered(*done.packet);
  return complete(client, 0);
}

void MockUsbfs::finish(UMockdevIoctlData* transfer, int status, const Packet* packet) {
  usbdevfs_urb& urb = urb_of(transfer);
  urb.status = status;
  Done done{transfer, std::nullopt};
  if (packet != nullptr) {
    std::copy_n(packet->bytes.begin(), packet->size, buffer_of(transfer).begin());
    urb.actual_length = static_cast<int>(packet->size);
    done.packet = *packet;
  } else if (urb.type != USBDEVFS_URB_TYPE_CONTROL) {
    urb.actual_length = 0;
  }
  done_.push_back(done);
  gate_.allow_output(true);
}

void MockUsbfs::send(const Packet& packet) {
  queue_.push(packet);
  deliver();
}

// Gives waiting reports to waiting transfers.
void MockUsbfs::deliver() {
  while (!waiting_.empty() && (is_halted_ || !queue_.empty())) {
    UMockdevIoctlData* const transfer = waiting_.front();
    if (is_halted_) {
      waiting_.pop_front();
      finish(transfer, -EPIPE);
      continue;
    }
    const Packet packet = queue_.pop();
    is_halted_ = packet.failure == TransferFailure::stall;
    if (is_halted_) continue;
    waiting_.pop_front();
    if (packet.failure == TransferFailure::error) {
      finish(transfer, -EPROTO);
    } else {
      finish(transfer, 0, &packet);
    }
  }
}

void MockUsbfs::unplug() {
  is_gone_ = true;
  for (UMockdevIoctlData* const transfer : std::exchange(waiting_, {})) {
    finish(transfer, -ESHUTDOWN);
  }
  queue_.unplug();
}

}  // namespace condyle::hil
