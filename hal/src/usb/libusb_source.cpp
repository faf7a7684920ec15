// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/usb/libusb_source.h"

#include <libusb.h>

#include <algorithm>

#include "condyle/hal/hid/report_descriptor.h"
#include "usb/usb_device.h"

namespace condyle::hal {
namespace {

constexpr TimeNs kLongestWait_ns = 1'000'000'000;

// Bytes of the longest input report; 0 if the descriptor does not give it.
std::size_t longest_input(const std::vector<std::uint8_t>& bytes) {
  const DescriptorResult result = parse_report_descriptor(bytes);
  std::size_t longest = 0;
  if (!result.descriptor) return longest;
  for (const DescribedReport& report : result.descriptor->reports) {
    if (report.direction != ReportDirection::input) continue;
    longest = std::max<std::size_t>(longest, (report.size_bits + 7) / 8);
  }
  return longest;
}

}  // namespace

LibusbSource::LibusbSource(DeviceAddress address, Clock& clock)
    : address_(std::move(address)),
      clock_(clock),
      queue_(std::make_unique<std::array<RawReport, kTransfers>>()) {}

LibusbSource::~LibusbSource() {
  close();
  if (context_ != nullptr) libusb_exit(context_);
}

Status LibusbSource::open() {
  close();
  if (context_ == nullptr && libusb_init(&context_) != 0) return Status::not_found;
  Status status = open_usb_device(context_, address_, handle_);
  if (status != Status::ok) return status;

  UsbInterface interface;
  status = find_usb_interface(handle_, address_.interface_number, interface);
  if (status == Status::ok) status = claim_usb_interface(handle_, interface.number);
  if (status == Status::ok) {
    interface_ = interface.number;
    endpoint_ = interface.endpoint;
    report_descriptor_ = read_usb_report_descriptor(handle_, interface);
    // A report of many packets comes in one transfer. Whole packets: data beyond the buffer would
    // be cut off.
    const std::size_t packet = interface.packet_size_bytes;
    const std::size_t longest = std::min(longest_input(report_descriptor_), kMaxReportSize);
    const std::size_t packets = std::max<std::size_t>(1, (longest + packet - 1) / packet);
    if (!start_transfers(packets * packet)) status = Status::not_found;
  }
  if (status != Status::ok) close();
  return status;
}

bool LibusbSource::start_transfers(std::size_t length) {
  is_gone_ = is_halted_ = is_stopping_ = false;
  errors_in_a_row_ = 0;
  queue_begin_ = queue_count_ = 0;
  for (std::size_t i = 0; i < kTransfers; ++i) {
    buffers_[i].resize(length);
    transfers_[i] = libusb_alloc_transfer(0);
    if (transfers_[i] == nullptr) return false;
    libusb_fill_interrupt_transfer(transfers_[i], handle_, endpoint_, buffers_[i].data(),
                                   static_cast<int>(length), &LibusbSource::completed, this, 0);
  }
  is_in_flight_.fill(false);
  return true;  // the first read requests the first report
}

// Requests reports while there is room for them.
void LibusbSource::submit_idle() {
  for (std::size_t i = 0; i < kTransfers && !is_gone_; ++i) {
    if (is_in_flight_[i]) continue;
    if (static_cast<std::size_t>(in_flight_) + queue_count_ >= kTransfers) break;
    const int failure = libusb_submit_transfer(transfers_[i]);
    is_in_flight_[i] = failure == 0;
    in_flight_ += failure == 0 ? 1 : 0;
    counts_.transfer_errors += failure == 0 || failure == LIBUSB_ERROR_NO_DEVICE ? 0 : 1;
    is_gone_ = failure != 0;
  }
}

void LibusbSource::completed(libusb_transfer* transfer) {
  static_cast<LibusbSource*>(transfer->user_data)->complete(*transfer);
}

void LibusbSource::complete(libusb_transfer& transfer) {
  --in_flight_;
  const auto index = std::find(transfers_.begin(), transfers_.end(), &transfer);
  is_in_flight_[static_cast<std::size_t>(index - transfers_.begin())] = false;
  switch (transfer.status) {
    case LIBUSB_TRANSFER_COMPLETED:
      errors_in_a_row_ = 0;
      store(transfer);
      break;
    case LIBUSB_TRANSFER_STALL:
      is_halted_ = true;  // cleared outside the callback, when all transfers are back
      break;
    case LIBUSB_TRANSFER_NO_DEVICE:
      is_gone_ = true;
      break;
    case LIBUSB_TRANSFER_CANCELLED:
      break;
    default:
      ++counts_.transfer_errors;
      is_gone_ = is_gone_ || ++errors_in_a_row_ > kMostErrors;
  }
}

void LibusbSource::store(const libusb_transfer& transfer) {
  const auto size = static_cast<std::size_t>(transfer.actual_length);
  if (size > kMaxReportSize) {
    ++counts_.oversized;
  } else if (size > 0) {
    RawReport& report = (*queue_)[(queue_begin_ + queue_count_++) % kTransfers];
    report.host_time_ns = clock_.now_ns();
    report.size = static_cast<std::uint16_t>(size);
    std::copy_n(transfer.buffer, size, report.bytes.begin());
  }
}

Status LibusbSource::read(TimeNs deadline_ns, RawReport& report) {
  if (handle_ == nullptr) return Status::not_open;
  TimeNs longest_ns = 0;  // first takes whatever has arrived, so that nothing grows old
  for (;;) {
    submit_idle();
    const bool is_undisturbed = wait(longest_ns);
    if (is_halted_ && !is_gone_) clear_halt();
    // Reports under way when the device went are still delivered.
    if (is_gone_ && !is_stopping_) stop_transfers();
    if (pop(report)) return Status::ok;
    if (is_gone_) {
      ++counts_.disconnections;
      close();
      return Status::disconnected;
    }
    const TimeNs now_ns = clock_.now_ns();
    if (!is_undisturbed || now_ns >= deadline_ns) return Status::timeout;
    longest_ns = std::min(deadline_ns - now_ns, kLongestWait_ns);
  }
}

// Handles the library's events until some came, for at most this time. False if a signal
// interrupted.
bool LibusbSource::wait(TimeNs longest_ns) {
  // Rounded up, so that a wait of less than a microsecond is still a wait.
  const TimeNs longest_us = (longest_ns + 999) / 1000;
  timeval time{};
  time.tv_sec = static_cast<time_t>(longest_us / 1'000'000);
  time.tv_usec = static_cast<suseconds_t>(longest_us % 1'000'000);
  const int failure = libusb_handle_events_timeout_completed(context_, &time, nullptr);
  if (failure == LIBUSB_ERROR_INTERRUPTED) return false;
  if (failure != 0) {  // no further event will come
    ++counts_.transfer_errors;
    is_gone_ = true;
  }
  return true;
}

bool LibusbSource::pop(RawReport& report) {
  if (queue_count_ == 0) return false;
  const RawReport& first = (*queue_)[queue_begin_];
  report.host_time_ns = first.host_time_ns;
  report.size = first.size;
  std::copy_n(first.bytes.begin(), first.size, report.bytes.begin());
  queue_begin_ = (queue_begin_ + 1) % kTransfers;
  --queue_count_;
  return true;
}

void LibusbSource::clear_halt() {
  ++counts_.stalls;
  const bool is_hopeless = ++errors_in_a_row_ > kMostErrors;
  if (!stop_transfers() || is_hopeless || libusb_clear_halt(handle_, endpoint_) != 0) {
    is_gone_ = true;
    return;
  }
  is_halted_ = is_stopping_ = false;
}

// Cancels the transfers in flight and waits about a second for their end. False if some never came
// back. The waits are counted, because a clock other than the machine's may stand still.
bool LibusbSource::stop_transfers() {
  constexpr int kMostWaits = 100 + 2 * static_cast<int>(kTransfers);
  constexpr TimeNs kWait_ns = 10'000'000;
  is_stopping_ = true;
  for (libusb_transfer* transfer : transfers_) {
    if (transfer != nullptr) libusb_cancel_transfer(transfer);
  }
  for (int i = 0; in_flight_ > 0 && i < kMostWaits; ++i) wait(kWait_ns);
  return in_flight_ == 0;
}

void LibusbSource::close() {
  if (handle_ == nullptr) return;
  if (stop_transfers()) {
    for (libusb_transfer*& transfer : transfers_) libusb_free_transfer(transfer);
  } else {
    // Left to the library, which may still write to them.
    for (libusb_transfer* transfer : transfers_) {
      if (transfer != nullptr) transfer->callback = [](libusb_transfer*) {};
    }
    new std::array<std::vector<std::uint8_t>, kTransfers>(std::move(buffers_));
  }
  transfers_.fill(nullptr);
  in_flight_ = 0;
  if (interface_ >= 0) libusb_release_interface(handle_, interface_);
  libusb_close(handle_);
  handle_ = nullptr;
  interface_ = -1;
}

}  // namespace condyle::hal
