// SPDX-License-Identifier: Apache-2.0
// Motion-BIDS: measurements in the data set, estimates in its derivatives. The first column of each
// table is the time since the first sample, which is exact where the steps are not.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "exports/bids_dataset.h"
#include "exports/even_times.h"
#include "exports/export_estimates.h"
#include "exports/export_text.h"
#include "hosted/estimates/estimate_fields.h"
#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"
#include "output/event_text.h"
#include "statistics/quantile.h"

namespace condyle::host {
namespace {

constexpr const char* kMissing = "n/a";
const BidsChannel kLatency{.name = "latency", .type = "LATENCY", .unit = "s"};

// The rate that the recording states, or that its times follow.
double rate_of(const ExportData& data) {
  if (data.info.stated.rate_Hz) return *data.info.stated.rate_Hz;
  if (data.samples() < 2) {
    throw InputError(data.source, "has one sample and states no rate, which Motion-BIDS requires",
                     "export to CSV");
  }
  try {
    return even_times(data).rate_Hz;
  } catch (const InputError&) {  // uneven: the middle step
  }
  std::vector<TimeNs> steps;
  for (std::size_t k = 1; k < data.samples(); ++k) {
    steps.push_back(data.time_ns[k] - data.time_ns[k - 1]);
  }
  return 1 / seconds(upper_median(std::move(steps)));
}

class Writer {
 public:
  Writer(const ExportData& data, const TableForm& form, const std::string& out, Exported& exported)
      : data_(data),
        per_metre_(form.lengths_per_m(1000)),
        rate_Hz_(rate_of(data)),
        exported_(exported),
        dataset_(out, data.labels, data.source, exported) {}

  void write_measured() {
    std::vector<BidsChannel> channels{kLatency};
    struct Column {
      const ExportSeries* series;
      std::size_t component;
      double per_SI_unit;
    };
    std::vector<Column> columns;
    for (const ExportSeries& series : data_.series) {
      const WrittenUnit unit = written_unit(series.unit, per_metre_);
      const bool is_turn = series.quantity == "orientation";
      for (std::size_t i = 0; i < series.components.size(); ++i) {
        BidsChannel channel{.name = series.name, .type = "MISC", .unit = unit.name};
        if (series.is_point() || is_turn) {
          channel.type = is_turn ? "ORNT" : "POS";
          channel.component = (is_turn ? "quat_" : "") + series.components[i];
          channel.point = series.name;
          channel.name += "_" + channel.component;
        }
        channels.push_back(channel);
        columns.push_back({&series, i, unit.per_SI_unit});
      }
    }
    OutputFile& table = dataset_.measured_file("_motion.tsv");
    std::string row;
    for (std::size_t k = 0; k < data_.samples(); ++k) {
      row.clear();
      append_time_s(row, latency_ns(data_.time_ns[k]));
      for (const Column& column : columns) {
        append_value(row, column.series->at(k)[column.component], column.per_SI_unit);
      }
      table.write(row += '\n');
    }
    table.close();
    BidsDataset::write_json(dataset_.measured_file("_motion.json"), describe(channels));
    BidsDataset::write_channels(dataset_.measured_file("_channels.tsv"), channels, rate_Hz_);
    BidsDataset::write_json(dataset_.measured_file("_channels.json"), frames());
    std::vector<NamedInstant> events = data_.events;
    std::stable_sort(
        events.begin(), events.end(),
        [](const NamedInstant& a, const NamedInstant& b) { return a.time_s < b.time_s; });
    if (events.empty()) return;
    OutputFile& file = dataset_.measured_file("_events.tsv");
    file.write(kEventHeader);
    for (const NamedInstant& event : events) {
      file.write(event_row(nanoseconds(event.time_s), event.name));
    }
    file.close();
  }

  void write_estimates() {
    ExportEstimates& estimates = *data_.estimates;
    OutputFile& table = dataset_.estimated_file("_motion.tsv");
    std::vector<BidsChannel> channels{kLatency};
    std::string row, event_rows;
    TimeNs last_ns = std::numeric_limits<TimeNs>::min();
    std::uint64_t left_out = 0;
    visit(EstimateRow(),
          [&](const BidsChannel& channel, double, double) { channels.push_back(channel); });
    estimates.run([&](const EstimateRow& estimate) {
      const bool is_in_order = estimate.time_ns && *estimate.time_ns > last_ns &&
                               !estimate.events.has(Event::time_reversed);
      if (!is_in_order) {
        ++left_out;
        return;
      }
      last_ns = *estimate.time_ns;
      row.clear();
      append_time_s(row, latency_ns(last_ns));
      visit(estimate, [&](const BidsChannel&, double value, double per_SI_unit) {
        append_value(row, value, per_SI_unit);
      });
      table.write(row += '\n');
      if (estimate.events.empty()) return;
      std::string names;
      append_events(names, estimate.events);
      event_rows += event_row(last_ns, names);
    });
    table.close();
    if (left_out > 0) {
      exported_.notes.push_back(fmt::format(
          "{} estimates without a time, or not later than the one before, are left out", left_out));
    }
    BidsJson description = describe(channels);
    description["Estimator"] = "recommended, no lag";
    description["Estimated"] = estimates.followed();
    description["AssumedMass"] = estimates.assumed_mass_kg();
    description["AssumedMassUnits"] = "kg";
    BidsDataset::write_json(dataset_.estimated_file("_motion.json"), description);
    BidsDataset::write_channels(dataset_.estimated_file("_channels.tsv"), channels, rate_Hz_);
    BidsDataset::write_json(dataset_.estimated_file("_channels.json"), frames());
    if (event_rows.empty()) return;
    OutputFile& file = dataset_.estimated_file("_events.tsv");
    file.write(kEventHeader + event_rows);
    file.close();
  }

 private:
  static inline const std::string kEventHeader = "onset\tduration\ttrial_type\n";

  TimeNs latency_ns(TimeNs time_ns) const { return time_ns - data_.time_ns.front(); }

  std::string followed_point() const {
    const FollowedPoint followed = data_.estimates->point();
    if (followed.body_point_m) return "point of the jaw";
    return data_.points().at(static_cast<std::size_t>(followed.point - 1))->name;
  }

  static void append_value(std::string& row, double value, double per_SI_unit) {
    row += '\t';
    if (std::isfinite(value)) {
      append_scaled(row, value, per_SI_unit);
    } else {
      row += kMissing;
    }
  }

  std::string event_row(TimeNs time_ns, const std::string& name) const {
    std::string row;
    append_time_s(row, latency_ns(time_ns));
    return row + "\t0\t" + bids_cell(name) + "\n";
  }

  // Passes each channel of an estimate with its value and the number of its units in the SI unit.
  template <class Take>
  void visit(const EstimateRow& row, Take&& take) const {
    const auto pass = [&](const std::string& prefix, BidsChannel channel, QuantityName name,
                          const Quantity<double>& quantity) {
      const WrittenUnit unit = written_unit(bids_unit(name.unit), per_metre_);
      const std::string base = prefix + name.name;
      channel.name = base;
      channel.unit = unit.name;
      take(channel, quantity.value, unit.per_SI_unit);
      const std::string of = "of " + base;
      take(BidsChannel{.name = base + "_sd",
                       .type = "MISC",
                       .unit = unit.name,
                       .description = "standard deviation " + of},
           quantity.standard_deviation, unit.per_SI_unit);
      take(BidsChannel{.name = base + "_provenance",
                       .type = "MISC",
                       .description = "provenance " + of +
                                      ": 0 not computed, 1 assumed, 2 derived, 3 measured"},
           static_cast<int>(quantity.provenance), 1);
    };
    const std::string point = followed_point();
    for (int axis = 0; axis < 3; ++axis) {
      const char letter = "xyz"[axis];
      visit_motion(row.axes[axis], [&](QuantityName name, const Quantity<double>& quantity) {
        const std::string_view what = name.name;
        BidsChannel channel{.type = what == "position"   ? "POS"
                                    : what == "velocity" ? "VEL"
                                                         : "ACCEL",
                            .point = point};
        channel.component = letter;
        pass({letter, '_'}, channel, name, quantity);
      });
    }
    pass("", BidsChannel{.type = "MISC"}, kForceName, row.force_N);
    if (!data_.estimates->has_impedance()) return;
    visit_friction_and_mass(row.friction_Ns_m, row.mass_kg,
                            [&](QuantityName name, const Quantity<double>& quantity) {
                              pass("", BidsChannel{.type = "MISC"}, name, quantity);
                            });
  }

  BidsJson describe(const std::vector<BidsChannel>& channels) const {
    const double duration_s = seconds(latency_ns(data_.time_ns.back()));
    BidsJson content = {{"TaskName", dataset_.task()},     {"SamplingFrequency", rate_Hz_},
                        {"TrackingSystemName", "facebow"}, {"RecordingDuration", duration_s},
                        {"MissingValues", kMissing},       {"MotionChannelCount", channels.size()}};
    if (duration_s > 0) {
      content["SamplingFrequencyEffective"] = static_cast<double>(data_.samples() - 1) / duration_s;
    }
    std::vector<std::string> points;
    for (const char* type : {"POS", "ORNT", "VEL", "ACCEL", "LATENCY", "MISC"}) {
      std::size_t count = 0;
      for (const BidsChannel& channel : channels) {
        if (channel.type != type) continue;
        ++count;
        if (channel.component != kMissing) points.push_back(channel.point);
      }
      if (count > 0) content[std::string(type) + "ChannelCount"] = count;
    }
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    content["TrackedPointsCount"] = points.size();
    return content;
  }

  // The directions of the instrument's axes in the body are not known.
  static BidsJson frames() {
    BidsJson content;
    content["reference_frame"]["Levels"]["instrument"]["Description"] =
        "Frame of the instrument, as recorded. The recording does not state the anatomical "
        "directions of its axes. Quaternions turn the body's frame into it.";
    return content;
  }

  const ExportData& data_;
  double per_metre_, rate_Hz_;
  Exported& exported_;
  BidsDataset dataset_;
};

}  // namespace

Exported export_bids(const ExportData& data, const TableForm& form, const std::string& out) {
  if (form.resample_Hz) {
    throw InputError("--resample-Hz", "is given, and Motion-BIDS holds what was measured",
                     "leave it out; a column holds the time of each sample");
  }
  if (data.points().empty()) {
    throw InputError(data.source, "has no points in space, which Motion-BIDS holds",
                     "export to CSV or MAT");
  }
  Exported result;
  Writer writer(data, form, out, result);
  writer.write_measured();
  if (data.estimates) writer.write_estimates();
  if (data.time_ns.front() != 0) {
    std::string start;
    append_time_s(start, data.time_ns.front());
    result.notes.push_back(fmt::format("times begin at 0, which is {} s of the recording", start));
  }
  const std::string left_out =
      note_on_left_out(data, false, true, [](const ExportSeries&) { return true; });
  if (!left_out.empty()) result.notes.push_back(left_out);
  return result;
}

}  // namespace condyle::host
