// SPDX-License-Identifier: Apache-2.0
// The summary of a replay. Constant memory.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "condyle/estimator/pose/point_follower.h"
#include "condyle/estimator/sensors/learned_sensor.h"
#include "estimation/estimate_row.h"
#include "quality/axis_ranges.h"
#include "quality/noise_watch.h"
#include "quality/step_watch.h"

namespace condyle::host {

/// Collects rows; each estimator has its own text.
class ReplaySummary {
 public:
  /// `followed`: the axis whose values come first, if there are three.
  explicit ReplaySummary(Axis followed) : followed_(followed) {}
  virtual ~ReplaySummary() = default;

  virtual void add(const EstimateRow& row);
  /// The summary in words, with units, uncertainties and provenance.
  virtual std::string text() const = 0;
  /// The same as data.
  virtual nlohmann::ordered_json json() const;
  /// The result of the drive, called when the text is made.
  void set_conclusion(std::function<ImpedanceEstimate<double>()> conclusion) {
    conclusion_ = std::move(conclusion);
  }
  /// Notes on the drive for the user, called when the text is made.
  void set_drive(std::function<std::vector<std::string>()> notes) { drive_ = std::move(notes); }
  /// What was learned along an axis, called when the text is made, if anything is learned.
  void set_learning(std::function<LearningCounts(int)> learning) {
    learning_ = std::move(learning);
  }
  std::vector<std::string> drive_notes() const {
    return drive_ ? drive_() : std::vector<std::string>();
  }
  /// Warnings in addition to the summary.
  virtual std::vector<std::string> warnings() const;

  /// Why the recording gives no usable result; empty if it does.
  std::string unusable() const;
  /// "value +- half of the interval of `level`, unit, provenance".
  static std::string with_interval(const Quantity<double>& quantity, double shown_per_si,
                                   const char* unit, const char* level);
  // The standard deviation of the mean NIS of this many innovations is 14 %, of fewer larger.
  static constexpr std::uint64_t kFewestInnovations = 100;
  /// Whether a mean NIS, per axis, is consistent with the stated noise.
  static bool is_trusted(double mean_nis);
  /// Adds a line of a summary.
  static void add_line(std::string& text, const char* label, const std::string& words);

 protected:
  /// Duration, rate (with `steps_note` on its line), gaps, events, and faults of the samples that
  /// the motion reveals.
  std::string times_text(const std::string& steps_note) const;
  /// "last values, at ..." with position, velocity and force; `level` is that of their intervals,
  /// unless there are too few innovations to check it.
  std::string last_values_text(const char* level) const;
  static constexpr const char* kTrusted = "95 %";
  static constexpr const char* kDistrusted = "95 % if the intervals were right";
  /// Whether there are enough innovations to check the intervals; and the line for the case that
  /// there are not.
  bool has_enough() const { return judged_ >= kFewestInnovations; }
  std::string too_few_text() const;
  /// The line for the case that a mean NIS is not consistent with the stated noise.
  static std::string distrust_text(double mean_nis);
  /// The line with the text of `unusable`.
  std::string unusable_text() const;
  /// Why no sample had a position.
  std::string no_position_text() const;
  Axis followed() const { return followed_; }
  /// Whether frames were dropped or held under even time stamps.
  bool has_uneven_frames() const { return step_watch_.has_dropped() || step_watch_.has_held(); }

  std::uint64_t steps_ = 0;
  TimeNs shortest_step_ns_ = 0, longest_step_ns_ = 0;
  std::optional<TimeNs> last_step_ns_;  // step added by the last row, if any
  double innovation_rms_m() const;
  double mean_step_s() const;
  ImpedanceEstimate<double> conclusion() const {
    return conclusion_ ? conclusion_() : last_.impedance;
  }
  // The last row with values.
  EstimateRow last_;
  std::function<LearningCounts(int)> learning_;

 private:
  std::string motion_text() const;
  std::vector<std::string> unit_warnings() const;

  Axis followed_;
  int point_axes_ = 1;
  AxisRanges ranges_;
  StepWatch step_watch_;
  std::function<std::vector<std::string>()> drive_;
  std::function<ImpedanceEstimate<double>()> conclusion_;
  std::uint64_t samples_ = 0, innovations_ = 0, judged_ = 0;  // judged: not of rejected samples
  std::uint64_t positions_ = 0;
  std::array<double, 3> first_m_{};
  bool has_moved_ = false;
  std::optional<TimeNs> previous_time_ns_;  // of the last accepted sample
  TimeNs duration_ns_ = 0;
  double innovation_square_sum_m2_ = 0;
  EventCounts events_;
};

/// The published cascade's.
class PublishedSummary final : public ReplaySummary {
 public:
  PublishedSummary(const PublishedParameters& parameters, Axis followed)
      : ReplaySummary(followed), parameters_(parameters) {}
  void add(const EstimateRow& row) override;
  std::string text() const override;
  nlohmann::ordered_json json() const override;
  /// Also counts steps that differ from the sample time, because the published cascade treats all
  /// as equal.
  std::vector<std::string> warnings() const override;

 private:
  struct Mean {
    double sum = 0;
    std::uint64_t count = 0;
    void add(double value) {
      if (!std::isfinite(value)) return;
      sum += value;
      ++count;
    }
    double value() const { return count > 0 ? sum / static_cast<double>(count) : 0; }
  };

  PublishedParameters parameters_;
  std::uint64_t uneven_steps_ = 0;
  Mean motion_nis_, friction_nis_, mass_nis_;
};

/// The recommended estimator's.
class RecommendedSummary final : public ReplaySummary {
 public:
  /// `fits`: those of the sensor, read when the text is made.
  RecommendedSummary(const RecommendedParameters& parameters, int lag, Axis followed,
                     const BodyFits& fits)
      : ReplaySummary(followed), parameters_(parameters), lag_(lag), fits_(fits) {}
  void add(const EstimateRow& row) override;
  std::string text() const override;
  nlohmann::ordered_json json() const override;
  /// Also warns if positions were, or may have been, smoothed before recording.
  std::vector<std::string> warnings() const override;

 private:
  std::string per_axis(const char* format, double (*value)(const RecommendedSummary&, int)) const;
  std::string filtered_text() const;
  // How well the points keep their distances; why there is no estimate.
  std::string body_text() const;
  std::string nothing_text() const;
  // Innovations, and their evidence and that of the positions on the intervals.
  std::string consistency_text() const;
  // Names of the axes whose watch satisfies a condition.
  std::string axes_where(bool (NoiseWatch::*is)() const) const;
  std::string rounding_steps_text() const;
  // How much of the motion is corrected by learning, and what that gained.
  std::string learning_text() const;
  int axis_count() const { return last_.axis_count; }
  int followed_index() const { return axis_count() == 3 ? static_cast<int>(followed()) : 0; }

  RecommendedParameters parameters_;
  int lag_;
  const BodyFits& fits_;
  NoiseWatch watches_[3];
};

}  // namespace condyle::host
