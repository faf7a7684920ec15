// SPDX-License-Identifier: Apache-2.0
#include "box/outlets/connection_table.h"

#include <utility>

namespace condyle::box {

ConnectionTable::Connection* ConnectionTable::opened(std::string address, int descriptor,
                                                     TimeNs now_ns, std::vector<int>& ending) {
  connections_.push_back({std::move(address), descriptor, now_ns});
  Connection& newest = connections_.back();
  std::size_t count = 0;
  Connection* oldest = nullptr;
  for (Connection& other : connections_) {
    if (other.address != newest.address || other.is_ending) continue;
    ++count;
    if (oldest == nullptr && other.is_idle) oldest = &other;
  }
  if (count > most_of_an_address_) {
    oldest->is_ending = true;  // at least the newest is idle
    ending.push_back(oldest->descriptor);
  }
  return &newest;
}

void ConnectionTable::closed(const Connection* connection) {
  connections_.remove_if([connection](const Connection& other) { return &other == connection; });
}

void ConnectionTable::collect_late(TimeNs now_ns, std::vector<int>& ending) {
  for (Connection& connection : connections_) {
    if (!connection.is_idle || connection.is_ending) continue;
    if (now_ns - connection.since_ns < deadline_ns_) continue;
    connection.is_ending = true;
    ending.push_back(connection.descriptor);
  }
}

}  // namespace condyle::box
