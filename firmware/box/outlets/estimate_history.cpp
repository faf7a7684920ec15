// SPDX-License-Identifier: Apache-2.0
#include "box/outlets/estimate_history.h"

#include <algorithm>
#include <utility>

namespace condyle::box {

void EstimateHistory::add(std::string line) {
  auto text = std::make_shared<const std::string>(std::move(line));
  const std::lock_guard lock(mutex_);
  lines_.push_back(std::move(text));
  if (lines_.size() > most_lines_) lines_.pop_front();
  ++newest_;
}

std::uint64_t EstimateHistory::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

EstimateHistory::Line EstimateHistory::after(std::uint64_t place) const {
  const std::lock_guard lock(mutex_);
  if (place >= newest_) return {};
  const std::uint64_t oldest = newest_ - lines_.size() + 1;
  const std::uint64_t number = std::max(place + 1, oldest);
  return {number, number - place - 1, lines_[static_cast<std::size_t>(number - oldest)]};
}

}  // namespace condyle::box
