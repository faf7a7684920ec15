// SPDX-License-Identifier: Apache-2.0
#include "fake/account.h"

#include <nlohmann/json.hpp>

namespace condyle::host::fake {

std::string account_json(const Account& account) {
  using Json = nlohmann::ordered_json;
  const Deliveries& d = account.deliveries;
  Json done = Json::object(), not_done = Json::object();
  for (std::size_t i = 0; i < kFaultKinds; ++i) {
    const std::string name(fault_type(static_cast<FaultKind>(i)).name);
    if (account.done[i] > 0) done[name] = account.done[i];
    if (account.not_done[i] > 0) not_done[name] = account.not_done[i];
  }
  const Json json = {
      {"transport", account.transport},
      {"ended", account.ended},
      {"made", account.made},
      {"delivered_intact", d.intact},
      {"delivered_altered", d.altered},
      {"lost_in_queue", d.lost_in_queue},
      {"lost_unread", d.lost_unread},
      {"lost_unplugged", d.lost_unplugged},
      {"lost_failed", d.lost_failed},
      {"balances", account.balances()},
      {"first_counter", account.first_counter},
      {"last_counter", account.last_counter},
      {"counter_jumped", account.counter_jumped},
      {"plugged_in", account.plugged_in},
      {"faults", done},
      {"faults_not_done", not_done},
  };
  return json.dump();
}

}  // namespace condyle::host::fake
