// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/link/serial_port.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace condyle::hal {
namespace {

constexpr TimeNs kWritePatience_ns = 2'000'000'000;
constexpr TimeNs kLongestPoll_ns = 60'000'000'000;

struct Rate {
  unsigned baud;
  speed_t code;
};
constexpr Rate kRates[] = {
    {9600, B9600},       {19200, B19200},     {38400, B38400},     {57600, B57600},
    {115200, B115200},   {230400, B230400},   {460800, B460800},   {500000, B500000},
    {921600, B921600},   {1000000, B1000000}, {1500000, B1500000}, {2000000, B2000000},
    {3000000, B3000000}, {4000000, B4000000},
};

}  // namespace

Status SerialPort::fail(const char* what, int error) {
  problem_ = std::string(what) + ": " + std::strerror(error);
  close();
  if (error == ENOENT || error == ENODEV || error == ENXIO) return Status::not_found;
  return error == EACCES || error == EPERM ? Status::not_permitted : Status::bad_report;
}

Status SerialPort::open(const std::string& name, unsigned baud) {
  constexpr const char kSocket[] = "unix:";
  close();
  problem_.clear();
  return name.starts_with(kSocket) ? open_socket(name.substr(sizeof kSocket - 1))
                                   : open_device(name, baud);
}

Status SerialPort::open_socket(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return fail("socket", ENAMETOOLONG);
  std::copy(path.begin(), path.end(), address.sun_path);
  file_ = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  is_socket_ = true;
  if (file_ < 0 ||
      connect(file_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return fail("socket", errno);
  }
  return Status::ok;
}

Status SerialPort::open_device(const std::string& path, unsigned baud) {
  const auto* const rate =
      std::find_if(std::begin(kRates), std::end(kRates), [&](Rate r) { return r.baud == baud; });
  if (rate == std::end(kRates)) {
    problem_ = "serial ports do not support " + std::to_string(baud) + " baud";
    return Status::bad_report;
  }
  file_ = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  is_socket_ = false;
  if (file_ < 0) return fail("open", errno);
  termios settings{};
  if (tcgetattr(file_, &settings) != 0) return fail("serial port", errno);
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  // HUPCL would drop DTR on close, which resets many boards.
  settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS | HUPCL);
  cfsetispeed(&settings, rate->code);
  cfsetospeed(&settings, rate->code);
  if (tcsetattr(file_, TCSANOW, &settings) != 0) return fail("serial port", errno);
  tcflush(file_, TCIOFLUSH);
  return Status::ok;
}

std::vector<unsigned> SerialPort::rates() {
  std::vector<unsigned> rates;
  for (const Rate& rate : kRates) rates.push_back(rate.baud);
  return rates;
}

void SerialPort::adopt(int file) {
  close();
  file_ = file;
  is_socket_ = true;
}

void SerialPort::close() {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
}

Status SerialPort::wait(short events, TimeNs deadline_ns) {
  for (;;) {
    const TimeNs left_ns = std::clamp<TimeNs>(deadline_ns - clock_.now_ns(), 0, kLongestPoll_ns);
    // Rounded up, so that it does not spin in the last millisecond.
    const auto left_ms = static_cast<int>((left_ns + 999'999) / 1'000'000);
    pollfd entry{file_, events, 0};
    const int ready = poll(&entry, 1, left_ms);
    if (ready < 0 && errno != EINTR) return Status::disconnected;
    if (ready > 0) return Status::ok;
    if (clock_.now_ns() >= deadline_ns || ready < 0) return Status::timeout;
  }
}

Status SerialPort::read(TimeNs deadline_ns, std::span<std::uint8_t> bytes, std::size_t& count) {
  count = 0;
  for (;;) {
    const ssize_t got = ::read(file_, bytes.data(), bytes.size());
    if (got > 0) {
      count = static_cast<std::size_t>(got);
      return Status::ok;
    }
    if (got == 0 || (errno != EAGAIN && errno != EINTR)) return Status::disconnected;
    const Status status = wait(POLLIN, deadline_ns);
    if (status != Status::ok) return status;
  }
}

Status SerialPort::write(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    // A cut line is reported as a result, not by a signal.
    const ssize_t sent = is_socket_ ? send(file_, bytes.data(), bytes.size(), MSG_NOSIGNAL)
                                    : ::write(file_, bytes.data(), bytes.size());
    if (sent > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
      continue;
    }
    if (sent < 0 && errno != EAGAIN && errno != EINTR) return Status::disconnected;
    // A signal does not interrupt it: a frame is sent whole.
    const TimeNs deadline_ns = clock_.now_ns() + kWritePatience_ns;
    Status status = Status::timeout;
    while (status == Status::timeout && clock_.now_ns() < deadline_ns) {
      status = wait(POLLOUT, deadline_ns);
    }
    if (status != Status::ok) return Status::disconnected;
  }
  return Status::ok;
}

}  // namespace condyle::hal
