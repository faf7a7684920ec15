// SPDX-License-Identifier: Apache-2.0
#include "box/outlets/document.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <thread>
#include <utility>

#include "box/outlets/http_answer.h"

namespace condyle::box {
namespace {

constexpr std::size_t kMostWaiting = 4;  // pieces

}  // namespace

// Detached, so that no thread waits for a disk that hangs. It owns what it uses.
void Document::start(Make make, std::function<void()> wake) {
  wake_ = std::move(wake);
  std::thread([self = shared_from_this(), make = std::move(make)] { self->run(make); }).detach();
}

void Document::run(const Make& make) {
  std::string problem;
  try {
    make(*this);
  } catch (const std::exception& error) {
    problem = error.what();
  }
  std::unique_lock lock(mutex_);
  if (!has_begun_) {
    pieces_.push_back(answer_json({500, problem}));
    head_ = {500, "application/json", "", pieces_.back().size()};
    has_begun_ = true;
  } else if (!problem.empty()) {
    is_broken_ = true;
  }
  has_ended_ = true;
  if (wake_) wake_();
}

void Document::begin(const Head& head) {
  const std::lock_guard lock(mutex_);
  head_ = head;
  has_begun_ = true;
  if (wake_) wake_();
}

bool Document::give(std::string bytes) {
  std::unique_lock lock(mutex_);
  room_.wait(lock, [this] { return is_abandoned_ || pieces_.size() < kMostWaiting; });
  if (is_abandoned_) return false;
  if (!bytes.empty()) pieces_.push_back(std::move(bytes));
  if (wake_) wake_();
  return true;
}

bool Document::has_begun(Head& head) const {
  const std::lock_guard lock(mutex_);
  if (has_begun_) head = head_;
  return has_begun_;
}

Document::Taken Document::take(char* buffer, std::size_t size, std::size_t& taken) {
  const std::lock_guard lock(mutex_);
  taken = 0;
  while (taken < size && !pieces_.empty()) {
    const std::string& first = pieces_.front();
    const std::size_t part = std::min(size - taken, first.size() - taken_of_first_);
    std::memcpy(buffer + taken, first.data() + taken_of_first_, part);
    taken += part;
    taken_of_first_ += part;
    if (taken_of_first_ < first.size()) break;
    pieces_.pop_front();
    taken_of_first_ = 0;
    room_.notify_one();
  }
  if (taken > 0) return Taken::some;
  if (is_broken_) return Taken::broken;
  return has_ended_ ? Taken::all : Taken::none_yet;
}

void Document::abandon() {
  const std::lock_guard lock(mutex_);
  is_abandoned_ = true;
  wake_ = nullptr;
  pieces_.clear();
  room_.notify_one();
}

}  // namespace condyle::box
