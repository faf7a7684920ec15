// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

namespace condyle::box {

/// An answer that is made piece by piece on a thread of its own, which may wait for the disk; the
/// server's thread takes the pieces as they come, and never waits.
class Document : public std::enable_shared_from_this<Document> {
 public:
  /// What stands before the pieces.
  struct Head {
    int status = 200;
    std::string type;  ///< its Content-Type
    std::string file;  ///< name under which a browser saves it, or none
    static constexpr std::uint64_t kUnknown = static_cast<std::uint64_t>(-1);
    std::uint64_t size = kUnknown;
  };
  /// Calls `begin` once, then `give`; throws for an answer with status 500.
  using Make = std::function<void(Document&)>;

  /// Makes it on a new thread. `wake` is called, on that thread, when `take` has something new.
  void start(Make make, std::function<void()> wake);

  // For the making thread.
  void begin(const Head& head);
  /// Waits while the reader is behind. False: the reader has gone.
  bool give(std::string bytes);

  // For the reading thread.
  /// False: it has not begun.
  bool has_begun(Head& head) const;
  enum class Taken { some, none_yet, all, broken };
  /// The next bytes, at most `size`.
  Taken take(char* buffer, std::size_t size, std::size_t& taken);
  /// The reader has gone.
  void abandon();

 private:
  void run(const Make& make);

  mutable std::mutex mutex_;
  std::condition_variable room_;
  std::function<void()> wake_;  // empty once abandoned
  Head head_;
  bool has_begun_ = false, has_ended_ = false, is_broken_ = false, is_abandoned_ = false;
  std::deque<std::string> pieces_;
  std::size_t taken_of_first_ = 0;
};

}  // namespace condyle::box
