// SPDX-License-Identifier: Apache-2.0
#include "fake/delivery_log.h"

#include <nlohmann/json.hpp>

namespace condyle::host::fake {

std::string delivery_log_json(const DeliveryLog& delivery_log) {
  using Json = nlohmann::ordered_json;
  const Deliveries& d = delivery_log.deliveries;
  Json done = Json::object(), not_done = Json::object();
  for (std::size_t i = 0; i < kFaultKinds; ++i) {
    const std::string name(fault_type(static_cast<FaultKind>(i)).name);
    if (delivery_log.done[i] > 0) done[name] = delivery_log.done[i];
    if (delivery_log.not_done[i] > 0) not_done[name] = delivery_log.not_done[i];
  }
  const Json json = {
      {"transport", delivery_log.transport},
      {"ended", delivery_log.ended},
      {"made", delivery_log.made},
      {"delivered_intact", d.intact},
      {"delivered_altered", d.altered},
      {"lost_in_queue", d.lost_in_queue},
      {"lost_unread", d.lost_unread},
      {"lost_unplugged", d.lost_unplugged},
      {"lost_failed", d.lost_failed},
      {"balances", delivery_log.balances()},
      {"first_counter", delivery_log.first_counter},
      {"last_counter", delivery_log.last_counter},
      {"counter_jumped", delivery_log.counter_jumped},
      {"plugged_in", delivery_log.plugged_in},
      {"faults", done},
      {"faults_not_done", not_done},
  };
  return json.dump();
}

}  // namespace condyle::host::fake
