// SPDX-License-Identifier: Apache-2.0
#include "output/pose_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hosted/estimates/pose_fields.h"
#include "hosted/files/number_text.h"
#include "output/event_text.h"
#include "output/replay_summary.h"

namespace condyle::host {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr int kDegreesOfFreedom = 6;

}  // namespace

PoseFile::PoseFile(const std::string& path, const PoseChoice& choice)
    : file_(path), choice_(choice) {
  std::string header = "time_s";
  const auto add = [&header](const std::string& name) { (header += ',') += name; };
  visit_pose(
      PoseEstimate<double>(), choice_,
      [&](const PoseName& name, const auto&) {
        for (const char axis : {'x', 'y', 'z'}) add(name.value(axis));
        for (const char axis : {'x', 'y', 'z'}) add(name.standard_deviation(axis));
        for (const auto& pair : kAxisPairs) {
          if (!name.squared_unit.empty()) add(name.covariance("xyz"[pair[0]], "xyz"[pair[1]]));
        }
        add(name.provenance());
      },
      [&](const PoseName& name, const auto&) {
        add(name.value());
        add(name.standard_deviation());
        add(name.provenance());
      });
  file_.write(header + ",pose_nis,events\n");
}

void PoseFile::write_row(const Row& row) {
  row_.clear();
  if (row.time_valid) append_time_s(row_, row.time_ns);
  const auto number = [this](double value) { append_number(row_ += ',', value); };
  const auto provenance = [this](Provenance value) { (row_ += ',') += provenance_name(value); };
  visit_pose(
      row, choice_,
      [&](const PoseName& name, const VectorEstimate<double>& vector) {
        for (const double value : vector.value) number(value);
        for (const double value : vector.standard_deviation()) number(value);
        for (const auto& pair : kAxisPairs) {
          if (!name.squared_unit.empty()) number(vector.covariance(pair[0], pair[1]));
        }
        provenance(vector.provenance);
      },
      [&](const PoseName&, const Quantity<double>& quantity) {
        number(quantity.value);
        number(quantity.standard_deviation);
        provenance(quantity.provenance);
      });
  number(row.nis);
  row_ += ',';
  append_events(row_, row.events);
  row_ += '\n';
  file_.write(row_);
}

void PoseSummary::add(const PoseEstimate<double>& estimate) {
  ++samples_;
  if (estimate.provenance() == Provenance::not_computed) return;
  ++known_;
  largest_turn_rad_ = std::max(largest_turn_rad_, estimate.rotation_vector_rad.value.norm());
  if (!std::isfinite(estimate.nis) || is_unexpected(estimate.events)) return;
  nis_sum_ += estimate.nis;
  ++judged_;
}

std::string PoseSummary::text() const {
  std::string text = fmt::format("{} of {} samples have a pose", known_, samples_);
  if (known_ == 0) return text;
  text += fmt::format("; largest turn {:.3g} deg", largest_turn_rad_ * kDegrees);
  if (judged_ >= ReplaySummary::kFewestInnovations) {
    text += fmt::format("; mean NIS {:.3g} (6 if noise and model are right)", mean_nis());
  }
  return text;
}

std::vector<std::string> PoseSummary::warnings() const {
  if (known_ == 0) return {"no sample gave a pose: the events of its rows say why"};
  const double per_axis = mean_nis() / kDegreesOfFreedom;
  if (judged_ < ReplaySummary::kFewestInnovations || ReplaySummary::is_trusted(per_axis)) return {};
  const double factor = std::sqrt(per_axis);
  return {
      fmt::format("the intervals of the pose are too {} by a factor of about {:.2g}: the "
                  "stated noise does not fit this recording",
                  factor > 1 ? "narrow" : "wide", factor > 1 ? factor : 1 / factor)};
}

}  // namespace condyle::host
