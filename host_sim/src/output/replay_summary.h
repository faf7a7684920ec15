// SPDX-License-Identifier: Apache-2.0
// What is said at the end of a replay. Constant memory.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "condyle/estimator/pose/point_follower.h"
#include "estimation/estimate_row.h"
#include "quality/axis_ranges.h"
#include "quality/noise_watch.h"
#include "quality/step_watch.h"

namespace condyle::host {

/// Collects rows; each estimator has its own words.
class ReplaySummary {
 public:
  /// `followed`: the axis whose values lead, where there are three.
  explicit ReplaySummary(Axis followed) : followed_(followed) {}
  virtual ~ReplaySummary() = default;

  virtual void add(const EstimateRow& row);
  /// The summary in words, with units, uncertainties and provenance.
  virtual std::string text() const = 0;
  /// The same as data.
  virtual nlohmann::ordered_json json() const;
  /// What the drive tells at the end, asked for when the text is made.
  void set_conclusion(std::function<JointEstimate<double>()> conclusion) {
    conclusion_ = std::move(conclusion);
  }
  /// What the user should know of the drive, asked for when the text is made.
  void set_drive(std::function<std::vector<std::string>()> notes) { drive_ = std::move(notes); }
  std::vector<std::string> drive_notes() const {
    return drive_ ? drive_() : std::vector<std::string>();
  }
  /// What to warn about beside the summary.
  virtual std::vector<std::string> warnings() const;

  /// Why nothing can be said of the recording, however many numbers come out; empty if it can.
  std::string unusable() const;
  /// "value +- half of the interval of `level`, unit, provenance".
  static std::string with_interval(const Quantity<double>& quantity, double shown_per_si,
                                   const char* unit, const char* level);
  /// Adds a line of a summary.
  static void add_line(std::string& text, const char* label, const std::string& words);

 protected:
  /// Duration, rate (with `steps_note` on its line), gaps, events, and what the motion says of the
  /// samples.
  std::string times_text(const std::string& steps_note) const;
  /// "last values, at ..." with position, velocity and force; `level` is that of their intervals,
  /// unless there are too few innovations to check it.
  std::string last_values_text(const char* level) const;
  static constexpr const char* kTrusted = "95 %";
  static constexpr const char* kDistrusted = "95 % if the intervals were right";
  /// Whether there are innovations enough to judge the intervals by; and the line that says so
  /// where there are not.
  bool has_enough() const { return judged_ >= kFewestInnovations; }
  std::string too_few_text() const;
  /// Whether a mean NIS speaks for the stated noise; and the line that says so where it does not.
  static bool is_trusted(double mean_nis);
  static std::string distrust_text(double mean_nis);
  /// The line that says what `unusable` does.
  std::string unusable_text() const;
  /// Why no sample had a position.
  std::string no_position_text() const;
  Axis followed() const { return followed_; }
  /// Whether frames were dropped or held under even time stamps.
  bool has_uneven_frames() const { return step_watch_.has_dropped() || step_watch_.has_held(); }

  std::uint64_t steps_ = 0;
  TimeNs shortest_step_ns_ = 0, longest_step_ns_ = 0;
  std::optional<TimeNs> last_step_ns_;  // step that the last row added, if any
  double innovation_rms_m() const;
  double mean_step_s() const;
  JointEstimate<double> conclusion() const { return conclusion_ ? conclusion_() : last_.joint; }
  // The last row with values.
  EstimateRow last_;

 private:
  std::string motion_text() const;
  std::vector<std::string> unit_warnings() const;

  Axis followed_;
  int point_axes_ = 1;
  AxisRanges ranges_;
  StepWatch step_watch_;
  std::function<std::vector<std::string>()> drive_;
  std::function<JointEstimate<double>()> conclusion_;
  // The mean NIS of so many strays by 14 % (standard deviation), of fewer by more.
  static constexpr std::uint64_t kFewestInnovations = 100;

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
  /// Also steps that differ from the sample time, which the published cascade takes all as equal.
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
  /// `fits`: those of the sensor, looked at when the text is made.
  RecommendedSummary(const RecommendedParameters& parameters, int lag, Axis followed,
                     const BodyFits& fits)
      : ReplaySummary(followed), parameters_(parameters), lag_(lag), fits_(fits) {}
  void add(const EstimateRow& row) override;
  std::string text() const override;
  nlohmann::ordered_json json() const override;
  /// Also positions that were smoothed before they came, or may have been.
  std::vector<std::string> warnings() const override;

 private:
  std::string per_axis(const char* format, double (*value)(const RecommendedSummary&, int)) const;
  std::string filtered_text() const;
  // How well the points kept their distances; why there is no estimate.
  std::string body_text() const;
  std::string nothing_text() const;
  // Innovations, and what they and the positions say of the intervals.
  std::string consistency_text() const;
  // Names of the axes whose watch says so.
  std::string axes_where(bool (NoiseWatch::*is)() const) const;
  std::string rounding_steps_text() const;
  int axis_count() const { return last_.axis_count; }
  int followed_index() const { return axis_count() == 3 ? static_cast<int>(followed()) : 0; }

  RecommendedParameters parameters_;
  int lag_;
  const BodyFits& fits_;
  NoiseWatch watches_[3];
};

}  // namespace condyle::host
