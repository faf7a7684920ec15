// SPDX-License-Identifier: Apache-2.0
// Offers streams of the Lab Streaming Layer: answers searches, and serves their samples.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <list>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "condyle/hal/clock.h"
#include "hosted/lsl/feed.h"
#include "hosted/lsl/socket.h"
#include "hosted/lsl/stream_info.h"

namespace condyle::host::lsl {

/// What happened to an outlet.
struct OutletCounts {
  std::uint64_t samples = 0;      ///< given to it, in all streams
  std::uint64_t connections = 0;  ///< that asked for samples
  std::uint64_t readers = 0;      ///< connected now
  std::uint64_t dropped = 0;      ///< samples that readers were too slow to take, in all
  std::uint64_t refused = 0;      ///< requests and searches that could not be understood
};

/// Serves streams on a thread of its own. Whoever gives samples never waits for a reader. A slow
/// reader loses the oldest samples, which are counted. Values are doubles or texts.
class Outlet {
 public:
  /// Samples kept for slow readers.
  static constexpr std::size_t kMostKept = 8192;

  /// Offers `streams`, whose format is double64 or string, at `address` of this computer. Their
  /// uid, ports and host are filled in. Throws an InputError if no port can be opened.
  Outlet(in_addr address, std::vector<StreamInfo> streams, hal::Clock& clock);
  ~Outlet();
  Outlet(const Outlet&) = delete;
  Outlet& operator=(const Outlet&) = delete;

  /// Gives a sample of numbers, one for each channel, or a text; any thread may.
  void push(std::size_t stream, double stamp_s, std::span<const double> values);
  void push(std::size_t stream, double stamp_s, std::string_view text);
  /// Serves the samples that readers have not taken yet, at most for `patience_ns`, and ends.
  void finish(TimeNs patience_ns);

  OutletCounts counts() const;
  /// As offered.
  StreamInfo info(std::size_t stream) const { return streams_[stream].info; }

 private:
  struct Stream {
    StreamInfo info;
    std::string short_xml, full_xml;
    Socket listener, service;
    std::deque<Bytes> kept;   // guarded by mutex_
    std::uint64_t first = 0;  // number of the first kept one; guarded by mutex_
  };
  struct Client {
    Socket socket;
    std::size_t stream = 0;
    std::string request;
    Bytes out;
    std::size_t sent = 0;
    bool has_feed = false, ends = false;  // ends: once `out` is sent
    std::uint64_t next = 0;               // number of its next sample
    std::size_t most_behind = 0, chunk = 1;
    TimeNs begin_ns = 0;
  };

  void open(Stream& stream, in_addr address);
  void run();
  void answer_datagrams(const Socket& socket, const Stream* only);
  void answer_search(const Socket& socket, std::string_view text, const sockaddr_in& from,
                     const Stream* only);
  void accept_all(std::size_t stream);
  /// False: the client has gone.
  bool serve(Client& client, bool is_readable);
  bool take_request(Client& client);
  void answer_request(Client& client);
  void begin_feed(Client& client);
  void take_samples(Client& client);
  void add(std::size_t stream, Bytes sample);
  void wake();

  hal::Clock& clock_;
  std::vector<Stream> streams_;
  Socket discovery_, wake_;
  std::list<Client> clients_;

  mutable std::mutex mutex_;
  std::atomic<bool> stops_ = false, finishes_ = false, is_drained_ = false;
  std::atomic<std::uint64_t> samples_ = 0, connections_ = 0, readers_ = 0, dropped_ = 0,
                             refused_ = 0;
  std::thread thread_;
};

}  // namespace condyle::host::lsl
