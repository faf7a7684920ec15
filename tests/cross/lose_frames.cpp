// SPDX-License-Identifier: Apache-2.0
// A line that loses whole frames: between a socket that condyle bridge connects to and a node's.
// usage: lose_frames SOCKET PORT REPORT ESTIMATE     (PORT as of condyle bridge)
//   loses the report and the estimate with these numbers, counted from 1, of whoever connects
//   first.
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <vector>

#include "condyle/hal/link/link_messages.h"
#include "condyle/hal/link/serial_port.h"

namespace {

using namespace condyle;

constexpr TimeNs kPatience_ns = kNanosecondsPerSecond;

// Frames on their way in one direction, but for the `lost`-th of those of `type`.
class Direction {
 public:
  Direction(hal::ByteStream& from, hal::ByteStream& to, hal::MessageType type, int lost)
      : from_(from), to_(to), type_(type), lost_(lost) {}

  // Until either end is closed.
  void carry(hal::Clock& clock) {
    std::array<std::uint8_t, 256> bytes{};
    for (;;) {
      std::size_t count = 0;
      const hal::Status status = from_.read(clock.now_ns() + kPatience_ns, bytes, count);
      if (status == hal::Status::timeout) continue;
      if (status != hal::Status::ok) return;
      for (std::size_t i = 0; i < count; ++i) {
        if (!take(bytes[i])) return;
      }
    }
  }

 private:
  // A frame ends with the 0 that follows something else.
  bool take(std::uint8_t byte) {
    frame_.push_back(byte);
    if (byte != 0 || frame_.size() == 1) return true;
    if (frame_.size() == 2) {  // the 0s between two frames
      frame_.pop_back();
      return true;
    }
    // Behind 0 and code the type, which is never 0.
    const bool is_counted = frame_[2] == static_cast<std::uint8_t>(type_);
    const bool is_lost = is_counted && ++number_ == lost_;
    const bool is_well = is_lost || to_.write(frame_) == hal::Status::ok;
    frame_.clear();
    return is_well;
  }

  hal::ByteStream &from_, &to_;
  hal::MessageType type_;
  int lost_, number_ = 0;
  std::vector<std::uint8_t> frame_;
};

// Of the first who connects to the socket `path`; -1 where there can be none.
int first_connection(const char* path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (std::strlen(path) >= sizeof address.sun_path) return -1;
  std::strcpy(address.sun_path, path);
  const int listening = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (bind(listening, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      listen(listening, 1) != 0) {
    return -1;
  }
  const int connection = accept4(listening, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  close(listening);
  return connection;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: lose_frames SOCKET PORT REPORT ESTIMATE\n");
    return 2;
  }
  hal::SteadyClock clock;
  hal::SerialPort node(clock), bridge(clock);
  if (node.open(argv[2], 1'000'000) != hal::Status::ok) {
    std::fprintf(stderr, "lose_frames: %s: %s\n", argv[2], node.problem().c_str());
    return 2;
  }
  const int connection = first_connection(argv[1]);
  if (connection < 0) {
    std::perror("lose_frames");
    return 2;
  }
  bridge.adopt(connection);
  Direction there(bridge, node, hal::MessageType::report, std::atoi(argv[3]));
  Direction back(node, bridge, hal::MessageType::recommended_estimate, std::atoi(argv[4]));
  std::thread answers([&] { back.carry(clock); });
  there.carry(clock);
  std::_Exit(0);  // whoever still waits for the node
}
