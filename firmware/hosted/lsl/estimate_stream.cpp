// SPDX-License-Identifier: Apache-2.0
#include "hosted/lsl/estimate_stream.h"

#include <fmt/format.h>

#include "hosted/estimates/estimate_fields.h"
#include "hosted/files/input_error.h"
#include "hosted/lsl/stream_search.h"

namespace condyle::host::lsl {
namespace {

constexpr const char* kNotes =
    "Research use only; not for diagnosis. Each value has its standard deviation (sd) and its "
    "provenance: 0 withheld, 1 assumed, 2 derived, 3 measured. A withheld value is NaN.";

std::string unit_text(const QuantityName& name) {
  std::string unit = name.unit;
  if (unit == "m_s" || unit == "m_s2" || unit == "Ns_m") unit[unit.find('_')] = '/';
  return unit == "m/s2" ? "m/s^2" : unit;
}

void add_channels(std::vector<StreamChannel>& channels, const std::string& prefix,
                  const QuantityName& name) {
  const std::string unit = unit_text(name);
  channels.push_back({prefix + name.value(), unit, "Estimate"});
  channels.push_back({prefix + name.standard_deviation(), unit, "StandardDeviation"});
  channels.push_back({prefix + name.provenance(), "code", "Provenance"});
}

void add_values(std::vector<double>& values, const Quantity<double>& quantity) {
  values.push_back(quantity.value);
  values.push_back(quantity.standard_deviation);
  values.push_back(static_cast<double>(quantity.provenance));
}

StreamInfo estimates_info(const EstimateStreamSettings& settings) {
  StreamInfo info;
  info.name = parse_stream_place(settings.place).name;
  info.type = "Estimates";
  info.nominal_rate_Hz = settings.rate_Hz;
  info.notes = kNotes;
  for (int axis = 0; axis < settings.axis_count; ++axis) {
    const std::string prefix = settings.axis_count == 1 ? "" : std::string{"xyz"[axis], '_'};
    info.channels.push_back({prefix + kMeasuredPositionName, "m", "Measurement"});
    visit_motion(AxisEstimate<double>(), [&](const QuantityName& name, const auto&) {
      add_channels(info.channels, prefix, name);
    });
    add_channels(info.channels, prefix, kForceName);
  }
  if (settings.has_impedance) {
    visit_friction_and_mass(
        0, 0, [&](const QuantityName& name, int) { add_channels(info.channels, "", name); });
  }
  info.channel_count = info.channels.size();
  return info;
}

StreamInfo markers_info(const EstimateStreamSettings& settings) {
  StreamInfo info;
  info.name = parse_stream_place(settings.place).name + "-markers";
  info.type = "Markers";
  info.format = ChannelFormat::string;
  info.channel_count = 1;
  info.channels = {{"marker", "", "Marker"}};
  return info;
}

}  // namespace

EstimateStream::EstimateStream(const EstimateStreamSettings& settings, hal::Clock& clock)
    : settings_(settings),
      clock_(clock),
      info_(estimates_info(settings)),
      outlet_(parse_stream_place(settings.place).address, {info_, markers_info(settings)}, clock) {
  values_.reserve(info_.channel_count);
}

void EstimateStream::add_motion(const RecommendedEstimate<double>& estimate) {
  values_.clear();
  for (int axis = 0; axis < settings_.axis_count; ++axis) {
    const AxisEstimate<double>& of = estimate.axes[axis];
    values_.push_back(of.measured_position_m);
    visit_motion(of, [&](const QuantityName&, const Quantity<double>& quantity) {
      add_values(values_, quantity);
    });
    add_values(values_, of.force_N);
  }
}

void EstimateStream::push(const RecommendedEstimate<double>& estimate) {
  values_.resize(info_.channel_count, AxisEstimate<double>::kNone);
  if (!estimate.time_valid) {
    ++untimed_;
    return;
  }
  outlet_.push(0, stamp_of(estimate.time_ns), values_);
  ++estimates_;
}

void EstimateStream::add(const RecommendedEstimate<double>& estimate) {
  add_motion(estimate);
  push(estimate);
}

void EstimateStream::add(const DrivenEstimate<double>& estimate) {
  add_motion(estimate);
  if (settings_.has_impedance) {
    visit_friction_and_mass(estimate.impedance.friction_Ns_m, estimate.impedance.mass_kg,
                            [&](const QuantityName&, const IdentifiedValue<double>& identified) {
                              add_values(values_, identified.quantity);
                            });
  }
  push(estimate);
}

void EstimateStream::mark(std::string_view text) {
  outlet_.push(1, stamp_of(clock_.now_ns()), text);
  ++markers_;
}

std::string EstimateStream::summary() const {
  const OutletCounts counts = outlet_.counts();
  std::string text = fmt::format("{}: {} estimates, {} markers, {} connections", settings_.place,
                                 estimates_.load(), markers_.load(), counts.connections);
  if (counts.dropped > 0) text += fmt::format(", {} dropped for slow readers", counts.dropped);
  if (untimed_ > 0) text += fmt::format(", {} without a time not sent", untimed_.load());
  if (counts.refused > 0) text += fmt::format(", {} requests refused", counts.refused);
  return text;
}

void check_outlet_place(const std::string& place) {
  const StreamPlace parsed = parse_stream_place(place);
  if (is_multicast(parsed.address)) {
    throw InputError(place, "a stream is not offered at a multicast address",
                     "name an IPv4 address of this computer");
  }
}

}  // namespace condyle::host::lsl
