// SPDX-License-Identifier: Apache-2.0
#include "fake/vhci_transport.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "hosted/files/input_error.h"

namespace condyle::host::fake {
namespace {

const std::string kController = "/sys/devices/platform/vhci_hcd.0";
constexpr TimeNs kPortWait_ns = 5 * kNanosecondsPerSecond;
constexpr unsigned kFullSpeed = 2;  // enum usb_device_speed

// A message is a header of twelve words, big endian, and data. Words 0 to 4 are command, sequence
// number, device, direction and endpoint; the others depend on the command.
enum Code : std::uint32_t { kSubmit = 1, kUnlink = 2, kSubmitted = 3, kUnlinked = 4 };
constexpr std::size_t kWords = 12, kHeaderSize = 4 * kWords, kSetupOffset = 40;
using Words = std::array<std::uint32_t, kWords>;

constexpr std::uint32_t kLargestData = 65536;

[[noreturn]] void fail(const std::string& where, int error) {
  const bool is_permission = error == EACCES || error == EPERM;
  throw InputError(
      where, std::strerror(error),
      is_permission ? "run as root"
                    : "as root: modprobe vhci-hcd (Debian's \"cloud\" kernels lack this module)");
}

// First high-speed port in state VDEV_ST_NULL (4: nothing attached); -1 if all are taken.
int free_port() {
  const std::string path = kController + "/status";
  std::ifstream file(path);
  if (!file) fail(path, errno);
  std::string line, hub;
  int port = 0, state = 0;
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    if (fields >> hub >> port >> state && hub == "hs" && state == 4) return port;
  }
  return -1;
}

void attach(int port, int socket, std::uint32_t device) {
  const std::string path = kController + "/attach";
  const FileHandle file(open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (!file.is_open()) fail(path, errno);
  const std::string text = fmt::format("{} {} {} {}", port, socket, device, kFullSpeed);
  if (write(file.get(), text.data(), text.size()) < 0) fail(path, errno);
}

void send_all(int socket, const std::vector<std::uint8_t>& message) {
  std::size_t sent = 0;
  while (sent < message.size()) {
    const ssize_t count =
        ::send(socket, message.data() + sent, message.size() - sent, MSG_NOSIGNAL);
    if (count > 0) {
      sent += static_cast<std::size_t>(count);
    } else if (errno != EINTR) {
      throw InputError(kController, "the kernel let go of the device", "start the fake again");
    }
  }
}

void receive_all(int socket, void* data, std::size_t size) {
  auto* const bytes = static_cast<std::uint8_t*>(data);
  std::size_t received = 0;
  while (received < size) {
    const ssize_t count = recv(socket, bytes + received, size - received, MSG_WAITALL);
    if (count > 0) {
      received += static_cast<std::size_t>(count);
    } else if (count == 0 || errno != EINTR) {
      throw InputError(kController, "the kernel let go of the device", "start the fake again");
    }
  }
}

std::vector<std::uint8_t> message_of(const Words& words) {
  std::vector<std::uint8_t> message(kHeaderSize);
  for (std::size_t i = 0; i < kWords; ++i) {
    const std::uint32_t word = htonl(words[i]);
    std::memcpy(message.data() + 4 * i, &word, 4);
  }
  return message;
}

}  // namespace

struct VhciTransport::Command {
  Words words{};
  std::array<std::uint8_t, 8> setup{};

  std::uint32_t code() const { return words[0]; }
  std::uint32_t sequence() const { return words[1]; }
  bool is_read() const { return words[3] == 1; }
  std::uint32_t endpoint() const { return words[4]; }
  std::uint32_t unlinked_sequence() const { return words[5]; }
  std::uint32_t length() const { return words[6]; }  // words[5] are flags
};

void VhciTransport::plug() {
  hal::SteadyClock clock;
  const TimeNs give_up_ns = clock.now_ns() + kPortWait_ns;
  int port = free_port();
  while (port < 0) {  // the kernel frees ports some time after the unplugging
    if (clock.now_ns() > give_up_ns) {
      throw InputError(kController, "all its ports are in use", "detach other USB/IP devices");
    }
    clock.sleep_until(clock.now_ns() + kNanosecondsPerSecond / 20);
    port = free_port();
  }
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) fail("socket pair", errno);
  FileHandle ours(ends[0]);
  const FileHandle kernels(ends[1]);
  ++device_number_;
  attach(port, kernels.get(), 1U << 16U | (device_number_ & 0xffffU));  // bus 1, device
  socket_ = std::move(ours);
  transfers_.clear();
  is_halted_ = false;
}

void VhciTransport::unplug() {
  socket_.reset();
  transfers_.clear();
  queue_.unplug();
}

void VhciTransport::send(const Packet& packet) {
  while (wait_readable(socket_.get(), 0)) serve(0);
  queue_.push(packet);
  deliver();
}

void VhciTransport::complete(std::uint32_t sequence, int status, const std::uint8_t* data,
                             std::size_t size, std::size_t actual_size) {
  auto message = message_of({kSubmitted, sequence, 0, 0, 0, static_cast<std::uint32_t>(status),
                             static_cast<std::uint32_t>(actual_size)});
  message.insert(message.end(), data, data + size);
  send_all(socket_.get(), message);
}

// Gives waiting reports to waiting transfers.
void VhciTransport::deliver() {
  while (!transfers_.empty() && (is_halted_ || !queue_.empty())) {
    const std::uint32_t sequence = transfers_.front();
    if (!is_halted_) {
      const Packet packet = queue_.pop();
      if (packet.failure == TransferFailure::none) {
        complete(sequence, 0, packet.bytes.data(), packet.size, packet.size);
        queue_.count_delivered(packet);
      } else if (packet.failure == TransferFailure::error) {
        complete(sequence, -EPROTO, nullptr, 0, 0);
      } else {
        is_halted_ = true;
      }
    }
    if (is_halted_) complete(sequence, -EPIPE, nullptr, 0, 0);
    transfers_.pop_front();
  }
}

void VhciTransport::serve(TimeNs deadline_ns) {
  if (!socket_.is_open()) {
    hal::SteadyClock().sleep_until(deadline_ns);
    return;
  }
  if (!wait_readable(socket_.get(), deadline_ns)) return;
  std::array<std::uint8_t, kHeaderSize> header;
  receive_all(socket_.get(), header.data(), header.size());
  Command command;
  std::memcpy(command.words.data(), header.data(), header.size());
  for (std::uint32_t& word : command.words) word = ntohl(word);
  std::copy_n(header.begin() + kSetupOffset, command.setup.size(), command.setup.begin());
  if (command.code() == kUnlink) {
    unlink(command);
  } else if (command.code() == kSubmit) {
    submit(command);
  } else {
    throw InputError(kController, fmt::format("sent the unknown command {}", command.code()),
                     "this kernel's USB/IP is not the one known");
  }
}

void VhciTransport::submit(const Command& command) {
  if (!command.is_read() && command.length() > 0) {
    if (command.length() > kLargestData) {
      throw InputError(kController, fmt::format("sent {} bytes at once", command.length()),
                       "this kernel's USB/IP is not the one known");
    }
    std::vector<std::uint8_t> ignored(command.length());
    receive_all(socket_.get(), ignored.data(), ignored.size());
  }
  if (command.endpoint() == 0) {
    answer_endpoint_0(command);
  } else if (command.is_read() && command.endpoint() == (kEndpoint & 0x0fU)) {
    transfers_.push_back(command.sequence());
  } else {
    complete(command.sequence(), -EPIPE, nullptr, 0, 0);
  }
  deliver();
}

void VhciTransport::answer_endpoint_0(const Command& command) {
  const ControlRequest request(command.setup);
  if (request.clears_halt()) is_halted_ = false;
  const ControlAnswer answer = answer_control(request);
  if (answer.stalled) {
    complete(command.sequence(), -EPIPE, nullptr, 0, 0);
  } else if (request.is_read()) {
    complete(command.sequence(), 0, answer.data.data(), answer.data.size(), answer.data.size());
  } else {
    complete(command.sequence(), 0, nullptr, 0, command.length());
  }
}

// A cancelled transfer is not completed; a completed one cannot be cancelled.
void VhciTransport::unlink(const Command& command) {
  const auto found = std::find(transfers_.begin(), transfers_.end(), command.unlinked_sequence());
  const bool is_waiting = found != transfers_.end();
  if (is_waiting) transfers_.erase(found);
  const int status = is_waiting ? -ECONNRESET : 0;
  send_all(socket_.get(), message_of({kUnlinked, command.sequence(), 0, 0, 0,
                                      static_cast<std::uint32_t>(status)}));
}

}  // namespace condyle::host::fake
