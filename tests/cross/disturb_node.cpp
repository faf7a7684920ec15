// SPDX-License-Identifier: Apache-2.0
// Sends a node on a line damaged frames, one after the other: is each refused and counted once, and
// the next good frame answered? usage: disturb_node PORT FRAMES     (PORT as of condyle bridge)
// Damage: a wrong bit, a lost end, two frames run together, a frame that is too long. The checksum
// does not find 1 in 65,536 of lost ends and of merged frames; with this seed it finds all.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <random>
#include <vector>

#include "condyle/hal/link/link_end.h"
#include "condyle/hal/link/serial_port.h"

namespace {

using namespace condyle;
using Bytes = std::vector<std::uint8_t>;
using Random = std::mt19937_64;

constexpr std::size_t kRing = 2048;  // bytes that the node has room for (uart.cpp)

std::size_t below(std::size_t limit, Random& random) {
  return static_cast<std::size_t>(random() % limit);
}

// A report's frame, of random bytes.
Bytes good_frame(Random& random) {
  Bytes payload(1 + below(80, random));
  for (std::uint8_t& byte : payload) byte = static_cast<std::uint8_t>(random());
  hal::FrameEncoder encoder;
  Bytes line(hal::kMaxFrameSize);
  line.resize(encoder.encode(static_cast<std::uint8_t>(hal::MessageType::report), payload, line));
  return line;
}

Bytes damaged_frame(int kind, Random& random) {
  Bytes line = good_frame(random);
  const std::size_t inside = 1 + below(line.size() - 2, random);  // not a 0
  if (kind == 0) {
    std::uint8_t bit = 0;
    do {
      bit = static_cast<std::uint8_t>(1U << below(8, random));
    } while (line[inside] == bit);  // a 0 would make two frames of it
    line[inside] ^= bit;
  } else if (kind == 1) {
    line.resize(inside + 1);
    if (line.size() < 3) line.push_back(7);
    line.back() = 0;
  } else if (kind == 2) {
    line.pop_back();
    const Bytes next = good_frame(random);
    line.insert(line.end(), next.begin() + 1, next.end());
  } else {
    line.assign(hal::kMaxFrameSize + below(500, random), 9);
    line.front() = line.back() = 0;
  }
  return line;
}

// A question that may be lost is asked again soon; any other wait is for a node that hangs.
constexpr TimeNs kWait_ns = 120'000'000'000, kWaitIfLost_ns = 200'000'000;

// The first answer that counts another number of refused frames than `refused`: one that counts the
// same is a late answer to an earlier question.
bool ask_health(hal::LinkEnd& end, hal::Clock& clock, TimeNs wait_ns,
                std::optional<std::uint64_t> refused, hal::HealthMessage& health) {
  if (end.send(hal::AskHealthMessage{}) != hal::Status::ok) return false;
  while (end.receive(clock.now_ns() + wait_ns) == hal::Status::ok) {
    if (end.type() != hal::MessageType::health) continue;
    if (hal::get(end.frame().payload, health).reason != hal::RefusalReason::none) return false;
    if (health.frames.refused() != refused) return true;
  }
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: disturb_node PORT FRAMES\n");
    return 2;
  }
  hal::SteadyClock clock;
  hal::SerialPort port(clock);
  if (port.open(argv[1], 1'000'000) != hal::Status::ok) {
    std::fprintf(stderr, "disturb_node: %s: %s\n", argv[1], port.problem().c_str());
    return 2;
  }
  hal::LinkEnd end(port);
  hal::HealthMessage before, after;
  if (!ask_health(end, clock, kWait_ns, {}, before)) {
    std::fprintf(stderr, "disturb_node: no answer\n");
    return 1;
  }
  Random random(1);
  const int frames = std::atoi(argv[2]);
  for (int i = 0; i < frames; ++i) {
    const Bytes line = damaged_frame(i % 4, random);
    // A frame longer than the node's ring may lose bytes there, where the line has no speed, as an
    // emulator's. If its end is among them, it ends with the next frame; if bytes of the question
    // behind it are, that is refused too, and counted.
    const bool may_lose = line.size() > kRing;
    const bool is_sent = port.write(line) == hal::Status::ok;
    const auto ask = [&](TimeNs wait_ns) {
      return ask_health(end, clock, wait_ns, before.frames.refused(), after);
    };
    if (!is_sent || !((may_lose && ask(kWaitIfLost_ns)) || ask(kWait_ns))) {
      std::fprintf(stderr, "disturb_node: no answer that counts damaged frame %d\n", i);
      return 1;
    }
    const std::uint64_t refused = after.frames.refused() - before.frames.refused();
    const std::uint64_t lost = after.dropped_bytes - before.dropped_bytes;
    const bool is_counted = refused == 1 || (refused == 2 && may_lose && lost > 0);
    if (!is_counted || (lost != 0 && !may_lose) || after.uart_overruns != 0) {
      std::fprintf(stderr,
                   "disturb_node: damaged frame %d of kind %d counted %llu times, %llu bytes lost, "
                   "%llu overrun\n",
                   i, i % 4, static_cast<unsigned long long>(refused),
                   static_cast<unsigned long long>(lost),
                   static_cast<unsigned long long>(after.uart_overruns));
      return 1;
    }
    before = after;
  }
  std::printf("%d damaged frames: each refused and counted, each good one answered\n", frames);
  return 0;
}
