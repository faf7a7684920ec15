// SPDX-License-Identifier: Apache-2.0
// Serial ports: pseudo-terminals and sockets in the place of a line.
#include "condyle/hal/link/serial_port.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include "condyle/hal/facebow.h"

namespace condyle::hal {
namespace {

using testing::ElementsAreArray;
using testing::HasSubstr;

// The other end of a serial port: a pseudo-terminal's master.
class Terminal {
 public:
  Terminal() : file_(posix_openpt(O_RDWR | O_NOCTTY)) {
    EXPECT_EQ(grantpt(file_), 0);
    EXPECT_EQ(unlockpt(file_), 0);
    std::array<char, 64> name{};
    EXPECT_EQ(ptsname_r(file_, name.data(), name.size()), 0);
    name_ = name.data();
  }
  ~Terminal() { hang_up(); }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  const std::string& name() const { return name_; }
  int file() const { return file_; }
  void hang_up() {
    if (file_ >= 0) ::close(file_);
    file_ = -1;
  }

 private:
  int file_;
  std::string name_;
};

std::vector<std::uint8_t> every_byte() {
  std::vector<std::uint8_t> bytes(256);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  return bytes;
}

std::vector<std::uint8_t> read_all(ByteStream& stream, std::size_t size) {
  std::vector<std::uint8_t> all;
  std::array<std::uint8_t, 100> bytes{};
  while (all.size() < size) {
    std::size_t count = 0;
    if (stream.read(kNoDeadline, bytes, count) != Status::ok) break;
    all.insert(all.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
  }
  return all;
}

// No byte means anything to the terminal: not end of file, interrupt, flow control, new line.
TEST(SerialPort, CarriesEveryByteBothWays) {
  SteadyClock clock;
  Terminal other;
  SerialPort port(clock);
  ASSERT_EQ(port.open(other.name(), 921600), Status::ok) << port.problem();
  const std::vector<std::uint8_t> bytes = every_byte();
  ASSERT_EQ(write(other.file(), bytes.data(), bytes.size()), 256);
  EXPECT_THAT(read_all(port, 256), ElementsAreArray(bytes));
  ASSERT_EQ(port.write(bytes), Status::ok);
  std::vector<std::uint8_t> back(256);
  std::size_t got = 0;
  while (got < back.size()) {
    const ssize_t count = read(other.file(), back.data() + got, back.size() - got);
    ASSERT_GT(count, 0);
    got += static_cast<std::size_t>(count);
  }
  EXPECT_THAT(back, ElementsAreArray(bytes));
}

TEST(SerialPort, HasTheSpeedAskedFor) {
  const std::map<unsigned, speed_t> speeds = {
      {9600, B9600},       {19200, B19200},     {38400, B38400},     {57600, B57600},
      {115200, B115200},   {230400, B230400},   {460800, B460800},   {500000, B500000},
      {921600, B921600},   {1000000, B1000000}, {1500000, B1500000}, {2000000, B2000000},
      {3000000, B3000000}, {4000000, B4000000}};
  EXPECT_EQ(SerialPort::rates().size(), speeds.size());
  SteadyClock clock;
  Terminal other;
  SerialPort port(clock);
  for (const auto& [baud, speed] : speeds) {
    ASSERT_EQ(port.open(other.name(), baud), Status::ok) << port.problem();
    termios settings{};
    ASSERT_EQ(tcgetattr(other.file(), &settings), 0);
    EXPECT_EQ(cfgetispeed(&settings), speed) << baud;
    EXPECT_EQ(cfgetospeed(&settings), speed) << baud;
  }
  EXPECT_EQ(port.open(other.name(), 9601), Status::bad_report);
  EXPECT_EQ(port.problem(), "serial ports do not support 9601 baud");
}

// Many a board resets when DTR drops.
TEST(SerialPort, DoesNotHangUpWhenItIsClosed) {
  SteadyClock clock;
  Terminal other;
  termios settings{};
  ASSERT_EQ(tcgetattr(other.file(), &settings), 0);
  settings.c_cflag |= HUPCL;
  ASSERT_EQ(tcsetattr(other.file(), TCSANOW, &settings), 0);
  SerialPort port(clock);
  ASSERT_EQ(port.open(other.name(), 115200), Status::ok) << port.problem();
  ASSERT_EQ(tcgetattr(other.file(), &settings), 0);
  EXPECT_EQ(settings.c_cflag & HUPCL, 0U);
}

TEST(SerialPort, WaitsNoLongerThanAsked) {
  SteadyClock clock;
  Terminal other;
  SerialPort port(clock);
  ASSERT_EQ(port.open(other.name(), 115200), Status::ok);
  std::array<std::uint8_t, 8> bytes{};
  std::size_t count = 1;
  const TimeNs begin_ns = clock.now_ns();
  EXPECT_EQ(port.read(begin_ns + 30'000'000, bytes, count), Status::timeout);
  EXPECT_EQ(count, 0U);
  EXPECT_GE(clock.now_ns() - begin_ns, 30'000'000);
  EXPECT_EQ(port.read(begin_ns, bytes, count), Status::timeout);
}

TEST(SerialPort, SaysThatTheOtherEndWent) {
  SteadyClock clock;
  Terminal other;
  SerialPort port(clock);
  ASSERT_EQ(port.open(other.name(), 115200), Status::ok);
  other.hang_up();
  std::array<std::uint8_t, 8> bytes{};
  std::size_t count = 0;
  EXPECT_EQ(port.read(clock.now_ns(), bytes, count), Status::disconnected);
  EXPECT_EQ(port.write(bytes), Status::disconnected);
}

TEST(SerialPort, SaysWhyItDoesNotOpen) {
  SteadyClock clock;
  Terminal other;
  SerialPort port(clock);
  EXPECT_EQ(port.open("/dev/condyle-no-such-port", 115200), Status::not_found);
  EXPECT_EQ(port.open("unix:/tmp/condyle-no-such-socket", 115200), Status::not_found);
  EXPECT_EQ(port.open(other.name(), 12345), Status::bad_report);
  EXPECT_THAT(port.problem(), HasSubstr("12345 baud"));
  EXPECT_EQ(port.open("/dev/null", 115200), Status::bad_report);
  EXPECT_THAT(port.problem(), HasSubstr("serial port"));
  EXPECT_EQ(port.open("unix:" + std::string(200, 'x'), 115200), Status::bad_report);
}

// A socket in a folder of its own that waits for a port.
class ListeningSocket {
 public:
  ListeningSocket() {
    EXPECT_NE(mkdtemp(folder_.data()), nullptr);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path().copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(bind(file_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(listen(file_, 1), 0);
  }
  ~ListeningSocket() {
    ::close(file_);
    std::filesystem::remove_all(folder_);
  }
  ListeningSocket(const ListeningSocket&) = delete;
  ListeningSocket& operator=(const ListeningSocket&) = delete;
  std::string path() const { return folder_ + "/line"; }
  int file() const { return file_; }

 private:
  std::string folder_ = testing::TempDir() + "condyle-serial-XXXXXX";
  int file_ = socket(AF_UNIX, SOCK_STREAM, 0);
};

TEST(SerialPort, TakesASocketInTheLinesPlace) {
  ManualClock clock;  // it stands still: a reader that is slow is waited for
  const ListeningSocket line;
  SerialPort port(clock);
  ASSERT_EQ(port.open("unix:" + line.path(), 0), Status::ok) << port.problem();
  const int other = accept(line.file(), nullptr, nullptr);
  // More than the socket takes at once: the writer waits for the reader.
  const std::size_t size = 4'000'000;
  std::thread writer([&] {
    EXPECT_EQ(port.write(std::vector<std::uint8_t>(size, 7)), Status::ok);
    port.close();
  });
  std::size_t got = 0;
  std::vector<std::uint8_t> bytes(65536);
  for (ssize_t count; (count = read(other, bytes.data(), bytes.size())) > 0;) {
    got += static_cast<std::size_t>(count);
  }
  writer.join();
  EXPECT_EQ(got, size);
  ::close(other);
}

// A service may start with its standard input closed: the first file that it opens has number 0.
TEST(SerialPort, TakesASocketWhoseNumberIsZero) {
  SteadyClock clock;
  const ListeningSocket line;
  const int input = fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3);
  ::close(STDIN_FILENO);
  SerialPort port(clock);
  const Status status = port.open("unix:" + line.path(), 0);
  EXPECT_EQ(status, Status::ok) << port.problem();
  EXPECT_NE(fcntl(STDIN_FILENO, F_GETFD), -1) << "it has number 0";
  port.close();
  EXPECT_EQ(fcntl(STDIN_FILENO, F_GETFD), -1) << "it is closed";
  if (input >= 0) dup2(input, STDIN_FILENO);
  if (input >= 0) ::close(input);
}

}  // namespace
}  // namespace condyle::hal
