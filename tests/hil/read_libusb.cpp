// SPDX-License-Identifier: Apache-2.0
// The plainest reader of the fake facebow through libusb, independent of condyle's own: several
// interrupt transfers under way, halts cleared, the device opened again after it went.
// usage: read_libusb LAST_COUNTER LIMIT_S
#include <libusb-1.0/libusb.h>
#include <unistd.h>

#include <cstdlib>

#include "support/received_reports.h"

using namespace condyle::hil;

namespace {

constexpr useconds_t kRetry_us = 2000;
constexpr unsigned char kEndpoint = 0x81;
constexpr int kTransfers = 4;

struct Reader {
  Tally tally;
  int under_way = 0;
  bool is_halted = false, is_gone = false, is_closing = false;
};

void on_transfer(libusb_transfer* transfer) {
  Reader& reader = *static_cast<Reader*>(transfer->user_data);
  --reader.under_way;
  switch (transfer->status) {
    case LIBUSB_TRANSFER_COMPLETED:
      reader.tally.take(transfer->buffer, static_cast<std::size_t>(transfer->actual_length));
      break;
    case LIBUSB_TRANSFER_STALL:
      reader.is_halted = true;
      return;
    case LIBUSB_TRANSFER_NO_DEVICE:
      reader.is_gone = true;
      return;
    case LIBUSB_TRANSFER_CANCELLED:
      return;
    default:
      ++reader.tally.failed_transfers;
  }
  if (reader.is_closing || reader.is_halted || reader.is_gone) return;
  if (libusb_submit_transfer(transfer) == 0) {
    ++reader.under_way;
  } else {
    reader.is_gone = true;
  }
}

void wait_for_events(libusb_context* context) {
  timeval limit = {0, 20000};
  libusb_handle_events_timeout_completed(context, &limit, nullptr);
}

void submit(Reader& reader, libusb_transfer* const (&transfers)[kTransfers]) {
  for (libusb_transfer* const transfer : transfers) {
    if (libusb_submit_transfer(transfer) == 0) {
      ++reader.under_way;
    } else {
      reader.is_gone = true;
    }
  }
}

void drain(Reader& reader, libusb_context* context,
           libusb_transfer* const (&transfers)[kTransfers]) {
  for (libusb_transfer* const transfer : transfers) libusb_cancel_transfer(transfer);
  while (reader.under_way > 0) wait_for_events(context);
}

void read_device(Reader& reader, libusb_context* context, libusb_device_handle* device,
                 const Goal& goal) {
  libusb_transfer* transfers[kTransfers];
  static unsigned char buffers[kTransfers][64];
  reader.is_halted = reader.is_gone = reader.is_closing = false;
  for (int i = 0; i < kTransfers; ++i) {
    transfers[i] = libusb_alloc_transfer(0);
    libusb_fill_interrupt_transfer(transfers[i], device, kEndpoint, buffers[i], sizeof buffers[i],
                                   on_transfer, &reader, 0);
  }
  submit(reader, transfers);
  while (!reader.is_gone && !goal.is_reached(reader.tally)) {
    wait_for_events(context);
    if (reader.is_halted && !reader.is_gone) {
      ++reader.tally.stalls;
      drain(reader, context, transfers);
      if (libusb_clear_halt(device, kEndpoint) != 0) break;
      reader.is_halted = false;
      submit(reader, transfers);
    }
  }
  reader.is_closing = true;
  drain(reader, context, transfers);
  for (libusb_transfer* const transfer : transfers) libusb_free_transfer(transfer);
}

}  // namespace

int main(int argc, char** argv) {
  libusb_context* context = nullptr;
  if (argc < 3 || libusb_init(&context) != 0) return 2;
  const Goal goal(static_cast<std::uint32_t>(std::strtoul(argv[1], nullptr, 10)),
                  std::strtod(argv[2], nullptr));
  Reader reader;
  while (!goal.is_reached(reader.tally)) {
    libusb_device_handle* const device = libusb_open_device_with_vid_pid(context, 0x1209, 0x0001);
    if (device == nullptr) {
      wait_for_events(context);
      usleep(kRetry_us);
      continue;
    }
    libusb_set_auto_detach_kernel_driver(device, 1);
    if (libusb_claim_interface(device, 0) == 0) {
      ++reader.tally.opened;
      read_device(reader, context, device, goal);
      if (reader.is_gone) ++reader.tally.disconnections;
      libusb_release_interface(device, 0);
    }
    libusb_close(device);
  }
  libusb_exit(context);
  reader.tally.print("libusb");
  return goal.exit_code(reader.tally);
}
