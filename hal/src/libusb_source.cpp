// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/libusb_source.h"

#include <libusb.h>

#include <algorithm>

#include "condyle/hal/report_descriptor.h"

namespace condyle::hal {
namespace {

constexpr TimeNs kPatience_ns = 1'000'000'000;  // for the end of transfers that were cancelled
constexpr unsigned kControlTimeout_ms = 500;

bool has_serial(libusb_device_handle* handle, std::uint8_t index, const std::string& serial) {
  if (serial.empty()) return true;
  std::array<unsigned char, 256> text{};
  const int size = libusb_get_string_descriptor_ascii(handle, index, text.data(), text.size());
  return size >= 0 && serial == std::string(text.begin(), text.begin() + size);
}

// Bytes of the longest input report; 0 where the descriptor does not tell.
std::size_t longest_input(const std::vector<std::uint8_t>& bytes) {
  const DescriptorResult result = parse_report_descriptor(bytes);
  std::size_t longest = 0;
  if (!result.descriptor) return longest;
  for (const ReportLayout& report : result.descriptor->reports) {
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
  libusb_device** list = nullptr;
  const auto count = libusb_get_device_list(context_, &list);
  Status status = Status::not_found;
  for (ssize_t i = 0; i < count && handle_ == nullptr; ++i) {
    libusb_device_descriptor descriptor{};
    libusb_get_device_descriptor(list[i], &descriptor);
    if (descriptor.idVendor != address_.vendor_id || descriptor.idProduct != address_.product_id) {
      continue;
    }
    const int failure = libusb_open(list[i], &handle_);
    if (failure == LIBUSB_ERROR_ACCESS) status = Status::not_permitted;
    if (failure != 0) {
      handle_ = nullptr;
    } else if (!has_serial(handle_, descriptor.iSerialNumber, address_.serial)) {
      libusb_close(handle_);
      handle_ = nullptr;
    }
  }
  if (list != nullptr) libusb_free_device_list(list, 1);
  if (handle_ == nullptr) return status;

  status = choose_interface();
  if (status == Status::ok) {
    libusb_set_auto_detach_kernel_driver(handle_, 1);
    const int failure = libusb_claim_interface(handle_, interface_);
    if (failure == LIBUSB_ERROR_ACCESS) status = Status::not_permitted;
    // The interface may not be there yet, or be in use: another attempt may find it free.
    else if (failure != 0)
      status = Status::not_found;
    if (failure != 0) interface_ = -1;
  }
  if (status == Status::ok) {
    read_descriptor();
    // A report of many packets comes in one transfer; whole packets, so that none overflows.
    const std::size_t longest = std::min(longest_input(report_descriptor_), kMaxReportSize);
    if (!start_transfers(std::max(longest, packet_size_))) status = Status::not_found;
  }
  if (status != Status::ok) close();
  return status;
}

// The HID interface that is meant, and its interrupt input.
Status LibusbSource::choose_interface() {
  libusb_config_descriptor* configuration = nullptr;
  if (libusb_get_active_config_descriptor(libusb_get_device(handle_), &configuration) != 0) {
    return Status::not_found;
  }
  Status status = Status::not_found;
  for (int i = 0; i < configuration->bNumInterfaces && status != Status::ok; ++i) {
    const libusb_interface& settings = configuration->interface[i];
    if (settings.num_altsetting < 1) continue;
    const libusb_interface_descriptor& interface = settings.altsetting[0];
    const bool is_meant = address_.interface_number < 0
                              ? interface.bInterfaceClass == LIBUSB_CLASS_HID
                              : interface.bInterfaceNumber == address_.interface_number;
    if (!is_meant) continue;
    status = Status::bad_report;
    for (int j = 0; j < interface.bNumEndpoints && status != Status::ok; ++j) {
      const libusb_endpoint_descriptor& endpoint = interface.endpoint[j];
      const bool is_input = (endpoint.bEndpointAddress & LIBUSB_ENDPOINT_IN) != 0;
      const auto type = endpoint.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK;
      if (!is_input || type != LIBUSB_TRANSFER_TYPE_INTERRUPT) continue;
      interface_ = interface.bInterfaceNumber;
      endpoint_ = endpoint.bEndpointAddress;
      packet_size_ = std::max<std::size_t>(endpoint.wMaxPacketSize & 0x7FFU, 8);
      status = Status::ok;
    }
  }
  libusb_free_config_descriptor(configuration);
  return status;
}

void LibusbSource::read_descriptor() {
  constexpr std::uint8_t kStandardIn = 0x81;           // of an interface
  constexpr std::uint16_t kReportDescriptor = 0x2200;  // HID 1.11, section 7.1
  report_descriptor_.resize(kMaxDescriptorSize);
  const int size =
      libusb_control_transfer(handle_, kStandardIn, LIBUSB_REQUEST_GET_DESCRIPTOR,
                              kReportDescriptor, static_cast<std::uint16_t>(interface_),
                              report_descriptor_.data(), kMaxDescriptorSize, kControlTimeout_ms);
  report_descriptor_.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
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
  return true;  // the first read asks for the first report
}

// Asks for reports as long as there is room for them.
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
      is_halted_ = true;  // cleared outside of the callback, when all transfers are back
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
  for (;;) {
    // Whatever has arrived is taken in, so that nothing grows old in the library.
    submit_idle();
    bool is_interrupted = !wait(0);
    if (is_halted_ && !is_gone_) clear_halt();
    // What was on its way when the device went is still handed over.
    if (is_gone_ && !is_stopping_) stop_transfers();
    if (pop(report)) return Status::ok;
    if (is_gone_) {
      ++counts_.disconnections;
      close();
      return Status::disconnected;
    }
    const TimeNs now_ns = clock_.now_ns();
    if (is_interrupted || now_ns >= deadline_ns) return Status::timeout;
    is_interrupted = !wait(std::min(deadline_ns - now_ns, kPatience_ns));
    if (is_interrupted && queue_count_ == 0) return Status::timeout;
  }
}

// Handles the library's events until some came, at most so long. False where a signal interrupted.
bool LibusbSource::wait(TimeNs longest_ns) {
  timeval time{};
  time.tv_sec = longest_ns / kNanosecondsPerSecond;
  time.tv_usec = (longest_ns % kNanosecondsPerSecond) / 1000;
  return libusb_handle_events_timeout_completed(context_, &time, nullptr) !=
         LIBUSB_ERROR_INTERRUPTED;
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
  if (!stop_transfers() || libusb_clear_halt(handle_, endpoint_) != 0) {
    is_gone_ = true;
    return;
  }
  is_halted_ = is_stopping_ = false;
}

// Cancels what is in flight and waits for its end. False where some never came back.
bool LibusbSource::stop_transfers() {
  is_stopping_ = true;
  for (libusb_transfer* transfer : transfers_) {
    if (transfer != nullptr) libusb_cancel_transfer(transfer);
  }
  const TimeNs deadline_ns = clock_.now_ns() + kPatience_ns;
  while (in_flight_ > 0 && clock_.now_ns() < deadline_ns) wait(kPatience_ns / 100);
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
