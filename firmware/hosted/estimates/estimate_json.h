// SPDX-License-Identifier: Apache-2.0
// Estimates as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "hosted/estimates/estimate_fields.h"
#include "hosted/estimates/followed_cycles.h"

namespace condyle::host {

/// Adds value, standard deviation and provenance of `quantity`.
inline void add_quantity(nlohmann::ordered_json& json, QuantityName name,
                         const Quantity<double>& quantity) {
  json[name.value()] = quantity.value;
  json[name.standard_deviation()] = quantity.standard_deviation;
  json[name.provenance()] = provenance_name(quantity.provenance);
}

/// A chewing cycle. Numbers that are not known are null in the text.
inline nlohmann::ordered_json cycle_json(const FoundCycle& found) {
  using Json = nlohmann::ordered_json;
  const MotionCycle<double>& cycle = found.cycle;
  Json json;
  json["sequence"] = found.sequence;
  json["cycle"] = found.number > 0 ? Json(found.number) : Json();
  json["begin_s"] = seconds(cycle.begin_ns);
  json["turn_s"] = seconds(cycle.turn_ns);
  json["end_s"] = seconds(cycle.end_ns);
  json["begins_after_pause"] = cycle.begins_after_pause;
  json["ends_with_pause"] = cycle.ends_with_pause;
  visit_cycle(cycle, [&json](QuantityName name, const Quantity<double>& quantity) {
    add_quantity(json, name, quantity);
  });
  json["rejected"] = rejection_text(cycle);
  return json;
}

}  // namespace condyle::host
