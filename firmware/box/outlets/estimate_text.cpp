// SPDX-License-Identifier: Apache-2.0
#include "box/outlets/estimate_text.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "condyle/estimator/events.h"
#include "hosted/estimates/estimate_json.h"
#include "hosted/estimates/pose_fields.h"

namespace condyle::box {
namespace {

using Json = nlohmann::ordered_json;

Json axis_json(const AxisEstimate<double>& axis) {
  Json json;
  json[host::kMeasuredPositionName] = axis.measured_position_m;
  host::visit_motion(axis, [&](host::QuantityName name, const Quantity<double>& quantity) {
    host::add_quantity(json, name, quantity);
  });
  host::add_quantity(json, host::kForceName, axis.force_N);
  json[host::kInnovationName] = axis.innovation_m;
  json[host::kNoiseName] = axis.noise_sd_m;
  return json;
}

template <class Vector>
Json array_of(const Vector& vector) {
  Json json = Json::array();
  for (const double value : vector) json.push_back(value);
  return json;
}

Json events_json(EventSet events) {
  Json json = Json::array();
  for (std::size_t i = 0; i < kEventCount; ++i) {
    if (events.has(static_cast<Event>(i))) json.push_back(event_name(static_cast<Event>(i)));
  }
  return json;
}

// Vectors as arrays x, y, z; covariances as arrays xy, xz, yz.
Json pose_json(const PoseEstimate<double>& pose, const host::PoseChoice& choice) {
  Json json;
  json["time_ns"] = pose.time_valid ? Json(pose.time_ns) : Json();
  host::visit_pose(
      pose, choice,
      [&](const host::PoseName& name, const VectorEstimate<double>& vector) {
        json[name.value()] = array_of(vector.value);
        json[name.standard_deviation()] = array_of(vector.standard_deviation());
        if (!name.squared_unit.empty()) {
          Json& covariances = json[name.covariances()] = Json::array();
          for (const auto& pair : host::kAxisPairs) {
            covariances.push_back(vector.covariance(pair[0], pair[1]));
          }
        }
        json[name.provenance()] = provenance_name(vector.provenance);
      },
      [&](const host::PoseName& name, const Quantity<double>& quantity) {
        json[name.value()] = quantity.value;
        json[name.standard_deviation()] = quantity.standard_deviation;
        json[name.provenance()] = provenance_name(quantity.provenance);
      });
  json["nis"] = pose.nis;
  json["events"] = events_json(pose.events);
  return json;
}

}  // namespace

std::string estimate_line(const BoxEstimate& box, const host::PoseChoice& pose,
                          const std::optional<host::FoundCycle>& cycle) {
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
  if (box.has_impedance) {
    Json impedance;
    host::visit_friction_and_mass(
        box.estimate.impedance.friction_Ns_m, box.estimate.impedance.mass_kg,
        [&](host::QuantityName name, const IdentifiedValue<double>& value) {
          host::add_quantity(impedance, name, value.quantity);
          impedance[name.limit()] = limit_name(value.limit);
        });
    json["impedance"] = impedance;
  }
  if (box.has_pose) json["pose"] = pose_json(box.pose, pose);
  if (cycle) json["cycle"] = host::cycle_json(*cycle);
  json["events"] = events_json(estimate.events);
  return json.dump();
}

}  // namespace condyle::box
