// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <list>
#include <string>
#include <vector>

#include "condyle/estimator/sample.h"

namespace condyle::box {

/// Limits HTTP connections, so that no client can lock out the others. The number of connections of
/// one address is limited; a new one replaces the oldest idle one. A request must be complete
/// within a limited time, counted from the connection or the previous request. One thread at a
/// time.
class ConnectionTable {
 public:
  /// A connection of the table.
  struct Connection {
    std::string address;
    int descriptor = -1;
    TimeNs since_ns = 0;     ///< the request has been awaited since then
    bool is_idle = true;     ///< it waits for a request; false: it is being answered
    bool is_ending = false;  ///< it has been asked to end
  };

  ConnectionTable(std::size_t most_of_an_address, TimeNs deadline_ns)
      : most_of_an_address_(most_of_an_address), deadline_ns_(deadline_ns) {}

  /// Adds a connection; the pointer stays valid until it is `closed`. If the client's address has
  /// too many, adds the oldest idle one to `ending`, or the new one if none is idle.
  Connection* opened(std::string address, int descriptor, TimeNs now_ns, std::vector<int>& ending);
  void closed(const Connection* connection);

  /// Connections that have waited too long for a request; each is returned once.
  void collect_late(TimeNs now_ns, std::vector<int>& ending);

  std::size_t size() const { return connections_.size(); }

 private:
  std::size_t most_of_an_address_;
  TimeNs deadline_ns_;
  std::list<Connection> connections_;  // in order of opening
};

}  // namespace condyle::box
