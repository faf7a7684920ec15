// SPDX-License-Identifier: Apache-2.0
#include "hosted/devices/companion.h"

namespace condyle::host {

void Companion::start() {
  stops_ = false;
  thread_ = std::thread([this] { run(); });
}

void Companion::stop() {
  stops_ = true;
  if (thread_.joinable()) thread_.join();
}

void Companion::run() {
  constexpr TimeNs kPatience_ns = 20'000'000;
  Sample sample;
  while (!stops_) {
    if (!is_open_) {
      is_open_ = device_.open() == hal::Status::ok;
      if (!is_open_) clock_.sleep_until(clock_.now_ns() + kPatience_ns);
      continue;
    }
    const hal::Status status = device_.read(clock_.now_ns() + kPatience_ns, sample);
    if (status == hal::Status::end) break;
    is_open_ = status == hal::Status::ok || status == hal::Status::timeout ||
               status == hal::Status::bad_report;
  }
  is_open_ = false;
  device_.close();
}

}  // namespace condyle::host
