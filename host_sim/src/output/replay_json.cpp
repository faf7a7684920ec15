// SPDX-License-Identifier: Apache-2.0
// The summary of a replay as data, with the content of replay_summary.cpp and
// recommended_summary.cpp. Values in the SI units of their names; null if there is none.
#include <cmath>
#include <nlohmann/json.hpp>

#include "output/replay_summary.h"

namespace condyle::host {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

Json json_of(const Quantity<double>& quantity) {
  if (quantity.provenance == Provenance::not_computed) return {};
  return {{"value", number(quantity.value)},
          {"standard_deviation", number(quantity.standard_deviation)},
          {"provenance", provenance_name(quantity.provenance)}};
}

Json json_of(const IdentifiedValue<double>& value) {
  Json json = json_of(value.quantity);
  json["limit"] =
      value.limit == ImpedanceLimit::none ? Json() : Json(std::string(limit_name(value.limit)));
  if (std::isfinite(value.needed_s)) json["needed_s"] = value.needed_s;
  return json;
}

}  // namespace

Json ReplaySummary::json() const {
  const double duration_s = seconds(duration_ns_);
  Json json = {{"duration_s", duration_s}, {"samples", samples_}};
  json["rate_Hz"] = duration_s > 0 ? Json(1 / mean_step_s()) : Json();
  json["shortest_step_s"] = steps_ > 0 ? Json(seconds(shortest_step_ns_)) : Json();
  json["longest_step_s"] = steps_ > 0 ? Json(seconds(longest_step_ns_)) : Json();
  Json& events = json["events"] = Json::object();
  for (std::size_t i = 0; i < kEventCount; ++i) {
    const auto event = static_cast<Event>(i);
    if (events_[event] > 0) events[std::string(event_name(event))] = events_[event];
  }
  Json& ranges = json["middle_95_percent_range_m"] = Json::object();
  const auto ranges_m = ranges_.ranges_m();
  for (int axis = 0; axis < point_axes_; ++axis) {
    const char* const name = point_axes_ == 1 ? "position"
                             : axis == 0      ? "x"
                             : axis == 1      ? "y"
                                              : "z";
    ranges[name] = number(ranges_m[static_cast<std::size_t>(axis)]);
  }
  json["dropped_frames"] = step_watch_.has_dropped() ? step_watch_.dropped() : 0;
  json["held_frames"] = step_watch_.has_held() ? step_watch_.held() : 0;
  json["innovation_rms_m"] = number(innovation_rms_m());
  json["last"] = {{"time_s", last_.time_ns ? Json(seconds(*last_.time_ns)) : Json()},
                  {"position_m", json_of(last_.position_m)},
                  {"velocity_m_s", json_of(last_.velocity_m_s)},
                  {"force_N", json_of(last_.force_N)}};
  return json;
}

Json PublishedSummary::json() const {
  Json json = ReplaySummary::json();
  json["mean_nis"] = {{"motion", number(motion_nis_.value())},
                      {"friction", number(friction_nis_.value())},
                      {"mass", number(mass_nis_.value())}};
  json["last"]["friction_Ns_m"] = json_of(last_.friction_Ns_m);
  json["last"]["mass_kg"] = json_of(last_.mass_kg);
  json["verdict"] = verdict_name(last_.verdict);
  return json;
}

Json RecommendedSummary::json() const {
  Json json = ReplaySummary::json();
  json["lag_samples"] = lag_;
  json["last"]["acceleration_m_s2"] = json_of(last_.followed.acceleration_m_s2);
  Json& axes = json["axes"] = Json::array();
  for (int axis = 0; axis < axis_count(); ++axis) {
    const NoiseWatch& watch = watches_[axis];
    axes.push_back({{"axis", axis_count() == 3 ? std::string(1, "xyz"[axis]) : "position"},
                    {"noise_sd_m", number(last_.axes[axis].noise_sd_m)},
                    {"mean_nis", number(watch.monitor().mean_nis())},
                    {"innovation_correlation", number(watch.monitor().innovation_correlation())},
                    {"is_smoothed", watch.is_filtered()},
                    {"rounding_step_m", watch.rounding_step_m()}});
    if (!learning_) continue;
    const LearningCounts counts = learning_(axis);
    axes.back()["learning"] = {{"samples", counts.samples},
                               {"corrected", counts.corrected},
                               {"next_position_error_ratio", number(counts.error_ratio())}};
  }
  if (!last_.has_impedance) return json;
  const ImpedanceEstimate<double> impedance = conclusion();
  Json& identified = json["identified"] = Json::object();
  identified["friction_Ns_m"] = json_of(impedance.friction_Ns_m);
  identified["mass_kg"] = json_of(impedance.mass_kg);
  identified["stiffness_N_m"] = json_of(impedance.stiffness_N_m);
  identified["offset_N"] = json_of(impedance.offset_N);
  if (parameters_.impedance.coulomb_N.sd > 0)
    identified["coulomb_N"] = json_of(impedance.coulomb_N);
  if (parameters_.impedance.delay == DelayModel::fitted) {
    identified["delay_s"] = json_of(impedance.delay_s);
  }
  identified["used_s"] = impedance.used_s;
  identified["residual_ratio"] = number(impedance.residual_ratio);
  identified["drive_noise_sd_N"] = number(impedance.drive_noise_sd_N);
  return json;
}

}  // namespace condyle::host
