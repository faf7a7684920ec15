// SPDX-License-Identifier: Apache-2.0
#include "box/outlets/estimate_text.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "condyle/estimator/events.h"

namespace condyle::box {
namespace {

using Json = nlohmann::ordered_json;

void add_quantity(Json& json, const std::string& name, const std::string& unit,
                  const Quantity<double>& quantity) {
  json[name + "_" + unit] = quantity.value;
  json[name + "_sd_" + unit] = quantity.standard_deviation;
  json[name + "_provenance"] = provenance_name(quantity.provenance);
}

Json axis_json(const AxisEstimate<double>& axis) {
  Json json;
  json["measured_position_m"] = axis.measured_position_m;
  add_quantity(json, "position", "m", axis.position_m);
  add_quantity(json, "velocity", "m_s", axis.velocity_m_s);
  add_quantity(json, "acceleration", "m_s2", axis.acceleration_m_s2);
  add_quantity(json, "force", "N", axis.force_N);
  json["innovation_m"] = axis.innovation_m;
  json["noise_sd_m"] = axis.noise_sd_m;
  return json;
}

void add_identified(Json& json, const std::string& name, const std::string& unit,
                    const IdentifiedValue<double>& value) {
  add_quantity(json, name, unit, value.quantity);
  json[name + "_limit"] = limit_name(value.limit);
}

}  // namespace

std::string estimate_line(const BoxEstimate& box) {
  const RecommendedEstimate<double>& estimate = box.estimate;
  Json json;
  json["run"] = box.run;
  if (box.node.state == NodeMark::State::away) {
    json["node"] = {{"away", true}};
    return json.dump();
  }
  json["number"] = box.number;
  if (estimate.time_valid) {
    json["time_s"] = seconds(estimate.time_ns);
    json["time_ns"] = estimate.time_ns;
  } else {
    json["time_s"] = nullptr;
    json["time_ns"] = nullptr;
  }
  if (estimate.axis_count == 3) {
    for (int i = 0; i < 3; ++i) json[std::string(1, "xyz"[i])] = axis_json(estimate.axes[i]);
  } else {
    json["axis"] = axis_json(estimate.axes[0]);
  }
  json["nis"] = estimate.nis;
  if (box.node.state != NodeMark::State::none) {
    json["node"] = {{"connection", box.node.connection},
                    {"delay_s", seconds(box.node.delay_ns)},
                    {"late", box.node.state == NodeMark::State::late}};
  }
  if (box.has_joint) {
    Json joint;
    add_identified(joint, "friction", "Ns_m", box.estimate.joint.friction_Ns_m);
    add_identified(joint, "mass", "kg", box.estimate.joint.mass_kg);
    json["joint"] = joint;
  }
  Json events = Json::array();
  for (std::size_t i = 0; i < kEventCount; ++i) {
    if (estimate.events.has(static_cast<Event>(i)))
      events.push_back(event_name(static_cast<Event>(i)));
  }
  json["events"] = events;
  return json.dump();
}

}  // namespace condyle::box
