// SPDX-License-Identifier: Apache-2.0
#include "box/box_log.h"

#include <fmt/format.h>

namespace condyle::box {

void BoxLog::say(Level level, std::string_view kind, const std::string& text) {
  if (reader_ == Reader::person && level == Level::info) return;
  const std::lock_guard lock(mutex_);
  const TimeNs now_ns = clock_.now_ns();
  const auto [place, is_new] = kinds_.try_emplace(std::string(kind));
  Kind& counted = place->second;
  if (is_new || now_ns - counted.begin_ns >= kMinute_ns) {
    counted.begin_ns = now_ns;
    counted.said = 0;
  }
  if (counted.said == kMost) {
    ++counted.withheld;
    return;
  }
  ++counted.said;
  std::string line = fmt::format("{}: {}", kind, text);
  if (reader_ == Reader::journal) {
    line.insert(0, fmt::format("<{}>", static_cast<int>(level)));
  }
  for (char& letter : line) {
    if (static_cast<unsigned char>(letter) < 0x20) letter = ' ';
  }
  if (counted.withheld > 0) {
    line += fmt::format(" ({} similar lines were suppressed)", counted.withheld);
    counted.withheld = 0;
  }
  std::fputs((line + "\n").c_str(), out_);
  std::fflush(out_);
}

}  // namespace condyle::box
