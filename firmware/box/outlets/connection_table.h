// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <list>
#include <string>
#include <vector>

#include "condyle/estimator/sample.h"

namespace condyle::box {

/// Who is connected over HTTP, so that none can keep the others out: an address has so many
/// connections, the oldest idle one makes room for another; and a request has so long, from the
/// connection or the request before on, however slowly it comes. One thread at a time.
class ConnectionTable {
 public:
  /// A connection of the table.
  struct Connection {
    std::string address;
    int descriptor = -1;
    TimeNs since_ns = 0;     ///< that a request is waited for
    bool is_idle = true;     ///< it is; else it is being answered
    bool is_ending = false;  ///< it was told to end
  };

  ConnectionTable(std::size_t most_of_an_address, TimeNs deadline_ns)
      : most_of_an_address_(most_of_an_address), deadline_ns_(deadline_ns) {}

  /// A new one, which stays where it is until it is `closed`. Where its address has too many, the
  /// oldest that is idle is added to `ending`; where none is, the new one.
  Connection* opened(std::string address, int descriptor, TimeNs now_ns, std::vector<int>& ending);
  void closed(const Connection* connection);

  /// Those that have waited for a request for too long; each is told once.
  void collect_late(TimeNs now_ns, std::vector<int>& ending);

  std::size_t size() const { return connections_.size(); }

 private:
  std::size_t most_of_an_address_;
  TimeNs deadline_ns_;
  std::list<Connection> connections_;  // in the order of their opening
};

}  // namespace condyle::box
