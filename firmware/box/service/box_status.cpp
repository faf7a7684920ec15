// SPDX-License-Identifier: Apache-2.0
#include "box/service/box_status.h"

#include <nlohmann/json.hpp>

#include "condyle/hal/status.h"
#include "hosted/files/clean_text.h"

namespace condyle::box {
namespace {

using Json = nlohmann::ordered_json;

// Names come from files: they are shown by pages and on terminals.
Json device_json(const BoxStatus& status) {
  const EngineCounts& counts = status.counts;
  Json json;
  json["source"] = host::clean_line(status.source);
  json["name"] = host::clean_line(status.device);
  json["found"] = status.is_found;
  json["connected"] = status.is_open;
  json["ended"] = status.has_ended;
  json["last_status"] = hal::status_name(status.last_status);
  json["problem"] = host::clean_line(status.problem);
  json["connections"] = status.connections;
  json["disconnections"] = counts.disconnections;
  json["rate_Hz"] = status.rate_Hz;
  json["nominal_rate_Hz"] = status.nominal_rate_Hz > 0 ? Json(status.nominal_rate_Hz) : Json();
  json["reports_received"] = counts.received;
  json["reports_lost"] = counts.lost;
  json["reports_bad"] = counts.bad;
  json["reports_duplicated"] = counts.duplicated;
  json["counter_restarts"] = counts.sequence_restarts;
  json["gaps_of_unknown_length"] = counts.unknown_losses;
  json["stalls"] = counts.stalls;
  json["transfer_errors"] = counts.transfer_errors;
  json["oversized"] = counts.oversized;
  return json;
}

// Null if it is not known.
Json jaw_json(const BoxStatus& status) {
  if (!status.jaw) return {};
  Json json;
  json["condyle_left_mm"] = status.jaw->condyle_left_mm;
  json["condyle_right_mm"] = status.jaw->condyle_right_mm;
  json["incisor_mm"] = status.jaw->incisor_mm;
  json["head_axes"] = status.jaw->axes;
  return json;
}

Json estimator_json(const BoxStatus& status) {
  const EstimatorHealth& health = status.health;
  Json json;
  json["run"] = status.run;
  const bool node_gives = status.node_state.is_connected && !status.node_state.is_silent;
  json["estimating"] =
      health.is_ready && status.is_open && !status.has_ended && (status.node.empty() || node_gives);
  json["samples"] = status.counts.samples;
  json["estimates"] = status.counts.estimates;
  json["assumed_mass_kg"] = status.assumed_mass_kg ? Json(*status.assumed_mass_kg) : Json();
  json["noise_sd_m"] = health.is_ready ? Json(health.noise_sd_m) : Json();
  json["mean_nis_per_axis"] = health.is_ready ? Json(health.mean_nis) : Json();
  json["outliers_rejected"] = health.rejected;
  json["unusable_states"] = health.not_finite;
  return json;
}

// For a microcontroller that estimates; null if there is none.
Json node_json(const BoxStatus& status) {
  if (status.node.empty()) return {};
  const NodeState& node = status.node_state;
  Json json;
  json["line"] = status.node;
  json["connected"] = node.is_connected;
  json["silent"] = node.is_silent;
  json["is"] = node.words;
  json["problem"] = node.problem;
  json["connections"] = node.connections;
  json["losses"] = node.losses;
  json["silences"] = node.silences;
  json["estimates_late"] = node.late;
  json["reports_not_sent"] = node.not_sent;
  json["reports_lost"] = node.lost;
  json["reports_without_estimate"] = node.without_estimate;
  json["frames_refused"] = node.frames_refused;
  json["frames_lost"] = node.frames_lost;
  Json health;
  if (node.health) {
    health["samples"] = node.health->samples;
    health["frames_refused"] = node.health->frames.refused();
    health["frames_lost"] = node.health->frames.lost;
    health["bytes_overrun"] = node.health->uart_overruns;
    health["bytes_without_room"] = node.health->dropped_bytes;
    health["stack_used_bytes"] = node.health->stack_used_bytes;
    health["stack_size_bytes"] = node.health->stack_size_bytes;
    health["uptime_s"] = seconds(node.health->uptime_ns);
  }
  json["its_side"] = health;
  return json;
}

Json real_time_json(const BoxStatus& status) {
  Json json;
  json["scheduling"] = status.scheduling;
  json["memory"] = status.memory;
  Json latency;
  if (status.latency != nullptr && status.latency->count() > 0) {
    latency["reports"] = status.latency->count();
    latency["p50_s"] = seconds(status.latency->quantile_ns(0.5));
    latency["p99_s"] = seconds(status.latency->quantile_ns(0.99));
    latency["p999_s"] = seconds(status.latency->quantile_ns(0.999));
    latency["max_s"] = seconds(status.latency->largest_ns());
  }
  json["report_to_estimate"] = latency;
  return json;
}

Json session_json(const BoxStatus& status) {
  constexpr const char* phases[] = {"idle", "recording", "paused"};
  const SessionState& session = status.session;
  Json json;
  json["possible"] = status.records;
  json["phase"] = phases[static_cast<int>(session.phase)];
  json["subject"] = session.subject;
  json["file"] = session.file;
  json["part"] = session.part;
  json["problem"] = session.problem;
  json["markers"] = session.markers;
  json["pauses"] = session.pauses;
  json["paused_s"] = seconds(session.paused_ns);
  json["reports_received"] = session.reports_received;
  json["reports_in_pauses"] = session.reports_in_pauses;
  json["reports_written"] = session.reports_written;
  json["reports_lost"] = session.reports_lost;
  json["events_written"] = session.events_written;
  json["events_lost"] = session.events_lost;
  json["bytes_written"] = session.log.bytes_written;
  json["bytes_synchronised"] = session.log.bytes_synchronised;
  json["companions"] = Json::array();
  for (const SessionState::Beside& companion : session.companions) {
    json["companions"].push_back({{"name", companion.name}, {"connected", companion.is_connected}});
  }
  json["disk_free_bytes"] = status.records ? Json(session.free_bytes) : Json();
  return json;
}

Json outlets_json(const BoxStatus& status) {
  Json json;
  json["published"] = status.publisher.published;
  json["dropped"] = status.estimates_dropped;
  json["datagrams"] = status.publisher.datagrams;
  json["datagrams_failed"] = status.publisher.datagrams_failed;
  json["http_requests"] = status.http.requests;
  json["http_refused"] = status.http.refused;
  json["http_listeners"] = status.http.listeners;
  json["http_missed"] = status.http.missed;
  if (status.lsl.empty()) return json;
  json["lsl"] = status.lsl;
  json["lsl_samples"] = status.lsl_counts.samples;
  json["lsl_readers"] = status.lsl_counts.readers;
  json["lsl_dropped"] = status.lsl_counts.dropped;
  json["lsl_refused"] = status.lsl_counts.refused;
  return json;
}

}  // namespace

std::string status_json(const BoxStatus& status) {
  Json json;
  json["format"] = "condyle-box-status-1";
  json["software"] = "condyle " CONDYLE_VERSION;
  json["note"] = "research use only; not a diagnosis";
  json["running_s"] = seconds(status.running_ns);
  json["device"] = device_json(status);
  json["jaw"] = jaw_json(status);
  json["estimator"] = estimator_json(status);
  json["node"] = node_json(status);
  json["real_time"] = real_time_json(status);
  json["session"] = session_json(status);
  json["outlets"] = outlets_json(status);
  json["wall_clock"] = {{"steps", status.clock_steps}, {"last_step_s", status.last_clock_step_s}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace condyle::box
