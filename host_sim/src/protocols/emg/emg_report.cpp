// SPDX-License-Identifier: Apache-2.0
#include "protocols/emg/emg_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"

namespace condyle::host {
namespace {

using Json = nlohmann::ordered_json;
using Value = EmgValue<double>;

constexpr const char* kRowHeader =
    "time_s,position_m,velocity_m_s,friction_Ns_m,friction_sd_Ns_m,friction_provenance,"
    "friction_limit,mass_kg,mass_sd_kg,mass_provenance,mean_nis,innovation_correlation\n";

void append_row(std::string& rows, TimeNs time_ns, const EmgEstimate<double>& estimate) {
  const auto& friction = estimate.friction_Ns_m;
  append_time_s(rows, time_ns);
  for (const double value : {estimate.position_m, estimate.velocity_m_s, friction.quantity.value,
                             friction.quantity.standard_deviation}) {
    append_number(rows += ',', value);
  }
  rows += fmt::format(",{},{}", provenance_name(friction.quantity.provenance),
                      limit_name(friction.limit));
  append_number(rows += ',', estimate.mass_kg.value);
  append_number(rows += ',', estimate.mass_kg.standard_deviation);
  rows += fmt::format(",{}", provenance_name(estimate.mass_kg.provenance));
  append_number(rows += ',', estimate.mean_nis);
  append_number(rows += ',', estimate.innovation_correlation);
  rows += '\n';
}

// Why a value is not derived, for the user.
std::string explain(EmgLimit limit) {
  switch (limit) {
    case EmgLimit::none:
      return "";
    case EmgLimit::no_emg:
      return "no EMG accompanies the positions";
    case EmgLimit::too_early:
      return "too few positions to check the model";
    case EmgLimit::model:
      return "muscles and model do not explain the motion: another force acts, or the muscles' "
             "force is wrong by more than error_share";
    case EmgLimit::information:
      return "EMG and motion determine it less than the prior does";
    case EmgLimit::resolution:
      return "too uncertain; a longer recording would help";
    case EmgLimit::mass:
      return "too uncertain; most of the uncertainty comes from the assumed mass";
    case EmgLimit::lag:
      return "too uncertain; most of the uncertainty comes from the lag of the force behind its "
             "EMG";
    case EmgLimit::force:
      return "too uncertain; most of the uncertainty comes from errors of the muscles' force, "
             "which a longer recording does not average out";
    case EmgLimit::scale:
      return "no muscle's gain is known, and errors of the muscles' force draw this value towards "
             "0 "
             "with the gains";
  }
  return "";
}

std::string line(const std::string& name, const char* unit, const Value& value) {
  const auto& [number, deviation, provenance] = value.quantity;
  if (provenance == Provenance::assumed) {
    return fmt::format("{:<30}WITHHELD; assumed {:.4g}{} (sd {:.2g}): {}\n", name, number, unit,
                       deviation, explain(value.limit));
  }
  const double half = kNormalQuantile95 * deviation;
  return fmt::format(
      "{:<30}95 %: {:.4g} to {:.4g}{} ({:.4g}, sd {:.2g}); derived, by the assumed mass\n", name,
      number - half, number + half, unit, number, deviation);
}

Json json_of(const Value& value) {
  return {{"value", value.quantity.value},
          {"standard_deviation", value.quantity.standard_deviation},
          {"provenance", provenance_name(value.quantity.provenance)},
          {"limit", limit_name(value.limit)},
          {"information", value.information}};
}

// The smallest difference of friction that this recording can resolve; none if the model does not
// hold or the prior dominates.
bool has_resolution(EmgLimit limit) {
  return limit != EmgLimit::no_emg && limit != EmgLimit::too_early && limit != EmgLimit::model &&
         limit != EmgLimit::information;
}

std::string count_notes(const EmgResult& result) {
  std::string text;
  const auto note = [&text](std::uint64_t count, const char* what) {
    if (count > 0) text += fmt::format("{:<30}{} {}\n", "note", count, what);
  };
  const EmgRecording& emg = result.emg;
  note(result.positions_missing, "rows of the recording without time or position");
  note(emg.rows_without_time, "rows of EMG without a time");
  note(emg.missing_values, "values of EMG are missing");
  note(emg.envelope.saturated, "raw samples at the amplifier's limit were not used");
  note(emg.envelope.restarts, "restarts of the envelope filters");
  note(emg.above_maximum, "excitations above 1: a maximum was not a maximal contraction");
  note(result.counts.emg_not_finite, "rows of EMG left out: a value is not known");
  note(result.counts.emg_not_in_order, "rows of EMG left out: not in order of time");
  note(result.counts.emg_gaps, "gaps of the EMG");
  note(result.counts.out_of_reach,
       "times out of the jaw's reach; check [jaw] and the followed point and axis");
  note(result.counts.positions_too_early, "positions without EMG");
  note(result.counts.positions_dropped, "positions dropped while they waited for EMG");
  note(result.estimate.restarts, "restarts of the identification");
  return text;
}

}  // namespace

EmgResult identify_from_emg(const EmgSource& source, const MuscleFile& muscles) {
  EmgResult result;
  result.source = source;
  result.muscles = muscles;
  result.emg = read_emg(source.emg, muscles, source.emg_reading);
  const std::vector<EmgRow> rows = std::move(result.emg.rows);
  result.emg_rows = rows.size();
  const auto recording = open_recording(source.recording, source.choice.reading);
  source.choice.check(source.recording, recording->info());
  EmgTimeline<double> timeline(muscles.identification, muscles.set, -result.emg.delay_s);
  if (source.keeps_rows) result.rows = kRowHeader;
  std::size_t next = 0;
  FollowedPositions positions(source.choice);
  Sample sample;
  while (recording->next(sample)) {
    const std::optional<double> position_m = positions.position_m(sample);
    if (!sample.time_valid || !position_m) {
      ++result.positions_missing;
      continue;
    }
    while (next < rows.size() && timeline.force_time_ns(rows[next].time_ns) <= sample.time_ns) {
      timeline.add_emg(rows[next].time_ns, rows[next].excitation);
      ++next;
    }
    timeline.add_position(sample.time_ns, *position_m, source.noise_sd_m);
    ++result.positions;
    if (source.keeps_rows) append_row(result.rows, sample.time_ns, timeline.estimate());
  }
  if (next < rows.size()) timeline.add_emg(rows[next].time_ns, rows[next].excitation);
  result.estimate = timeline.estimate();
  result.counts = timeline.counts();
  if (result.estimate.friction_Ns_m.limit == EmgLimit::no_emg) {
    throw InputError(source.emg, fmt::format("no EMG at the times of {}", source.recording),
                     "both must use the same clock, with an EMG row at least every "
                     "longest_gap_s");
  }
  return result;
}

std::string emg_text(const EmgResult& result) {
  const EmgEstimate<double>& estimate = result.estimate;
  const EmgParameters& parameters = result.muscles.identification;
  std::string text = fmt::format("{:<30}{}, {} positions\n", "recording",
                                 clean_line(result.source.recording), result.positions);
  text += fmt::format("{:<30}{}, {} rows at {:.4g} Hz, {} muscles{}\n", "EMG", result.source.emg,
                      result.emg_rows, result.emg.rate_Hz, result.muscles.set.count,
                      result.source.emg_reading.is_raw ? ", raw" : "");
  text += fmt::format(
      "{:<30}{:.4g} kg (sd {:.2g}), assumed: EMG of unknown gain does not determine it\n", "mass",
      estimate.mass_kg.value, estimate.mass_kg.standard_deviation);
  text += line("friction", " Ns/m", estimate.friction_Ns_m);
  if (has_resolution(estimate.friction_Ns_m.limit)) {
    text += fmt::format("{:<30}smallest difference of friction {:.2g} Ns/m; requested {:.4g}\n",
                        "resolution", 2 * estimate.friction_Ns_m.fitted_sd,
                        parameters.friction_resolution_Ns_m);
  }
  text += line("stiffness", " N/m", estimate.stiffness_N_m);
  text += line("constant force", " N", estimate.offset_N);
  for (std::size_t n = 0; n < result.muscles.set.count; ++n) {
    text += line("gain of " + result.muscles.channels[n].muscle, "", estimate.gain[n]);
  }
  text += fmt::format(
      "{:<30}rms {:.3g} N at the assumed mass; assumed error {:.0f} % of that, assumed delay "
      "{:.0f} ms (sd {:.0f})\n",
      "muscles' force", estimate.force_rms_N, 100 * parameters.error_share, 1e3 * parameters.lag_s,
      1e3 * parameters.lag_sd_s);
  text += fmt::format("{:<30}mean NIS {:.2f}, correlation {:.2f}, {:.1f} % rejected\n",
                      "innovations", estimate.mean_nis, estimate.innovation_correlation,
                      100 * estimate.rejected_share);
  return text + count_notes(result);
}

std::string emg_json(const EmgResult& result) {
  const EmgEstimate<double>& estimate = result.estimate;
  Json gains;
  for (std::size_t n = 0; n < result.muscles.set.count; ++n) {
    gains[result.muscles.channels[n].muscle] = json_of(estimate.gain[n]);
  }
  const Json json = {{"condyle", CONDYLE_VERSION},
                     {"note", "research use only; not a diagnosis"},
                     {"recording", result.source.recording},
                     {"emg", result.source.emg},
                     {"positions", result.positions},
                     {"friction_Ns_m", json_of(estimate.friction_Ns_m)},
                     {"mass_kg",
                      {{"value", estimate.mass_kg.value},
                       {"standard_deviation", estimate.mass_kg.standard_deviation},
                       {"provenance", provenance_name(estimate.mass_kg.provenance)}}},
                     {"stiffness_N_m", json_of(estimate.stiffness_N_m)},
                     {"offset_N", json_of(estimate.offset_N)},
                     {"gains", gains},
                     {"force_rms_N", estimate.force_rms_N},
                     {"error_share", result.muscles.identification.error_share},
                     {"mean_nis", estimate.mean_nis},
                     {"innovation_correlation", estimate.innovation_correlation},
                     {"rejected_share", estimate.rejected_share},
                     {"restarts", estimate.restarts}};
  return json.dump(2) + "\n";
}

}  // namespace condyle::host
