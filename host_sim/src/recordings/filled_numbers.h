// SPDX-License-Identifier: Apache-2.0
// Numbers that stand for a missing place. Programs write one number, such as -999, on all axes of a
// point that was not seen. The rule, for a point with the same number N on all three axes:
//
//   stated      `--missing N`: it is missing; with any --missing, nothing below applies
//   far         it is more than 0.1 m from the point's last place: missing
//   jump        N is usual (-1, -9, 99, -99, 999, -999, 9999, -9999), more than 10 mm from the last
//               place, and that place has decimals in the file's unit: missing
//   near        N is 0, or usual after a place without decimals, and as near as the point's last
//               step explains: a place
//   zero        N is 0, and none of these: missing
//   unclear     N is usual, and none of these: the recording is refused
//   beginning   N is usual and no place came before: missing
//
// A point that has been at 0 0 0 from the beginning and jumps by more than 10 mm is refused too.
//
// No jaw moves so far from one sample to the next, and the place of a point that is measured to
// less than a whole unit hardly ever is the same whole number on three axes. What is read as a
// place though it stands for a missing one is off by no more than the point moves in a few samples.
// Of one axis, only usual numbers from 99 on are missing, if they are more than 50 mm from the last
// place, or before the first place more than 0.5 m from 0.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "condyle/estimator/sample.h"

namespace condyle::host {

/// Which numbers the user says are missing places.
struct MissingNumbers {
  std::string text;             ///< as stated; empty: the rule above decides
  std::vector<double> numbers;  ///< in the file's unit

  /// Takes "NUMBER,..." or "none". Throws InputError for anything else.
  void state(const std::string& words);
  bool has(double number) const;
};

/// Finds them in a recording, one sample after another.
class FilledNumbers {
 public:
  explicit FilledNumbers(MissingNumbers missing) : missing_(std::move(missing)) {}

  /// Turns missing places among `points_m` (m, one a column) into NaN. `units_per_metre`: of the
  /// file; `place`: of the sample, as text, for messages. True if there were any. Throws InputError
  /// where it is unclear.
  template <class Place>
  bool drop(Eigen::Matrix3Xd& points_m, double units_per_metre, const Place& place) {
    bool has_any = false;
    tracks_.resize(static_cast<std::size_t>(points_m.cols()));
    for (Eigen::Index i = 0; i < points_m.cols(); ++i) {
      Track& track = tracks_[static_cast<std::size_t>(i)];
      const double x = points_m(0, i);
      const bool is_filled = x == points_m(1, i) && x == points_m(2, i) &&
                             is_missing(points_m.col(i), track, units_per_metre, place);
      if (is_filled) {
        points_m.col(i).setConstant(std::numeric_limits<double>::quiet_NaN());
        has_any = true;
      } else if (points_m.col(i).allFinite()) {
        if (leaves_zero(points_m.col(i), track)) refuse_beginning(place());
        track.move_to(points_m.col(i));
      }
    }
    return has_any;
  }

  /// The same for the points of a sample whose coordinates are in metres.
  template <class Place>
  void drop(Sample& sample, double units_per_metre, const Place& place) {
    if (!sample.position_valid) return;
    const Eigen::Index points = sample.kind == SampleKind::three_points ? 3 : 1;
    Eigen::Matrix3Xd points_m = Eigen::Map<const Eigen::Matrix3Xd>(sample.coordinates, 3, points);
    if (drop(points_m, units_per_metre, place)) sample.position_valid = false;
  }

  /// Whether the place `value_m` of one axis is missing.
  bool is_missing(double value_m, double units_per_metre);

  /// Adds what was found, a line a number.
  void add_notes(std::vector<std::string>& notes) const;

 private:
  enum class Verdict { place, missing, unclear };
  // Of a point.
  struct Track {
    Eigen::Vector3d last_m =
        Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());  // NaN: none yet
    double step_m = 0;  // between the last two places
    bool is_at_zero_from_begin = true;

    void move_to(const Eigen::Vector3d& place_m);
  };
  Verdict judge(const Eigen::Vector3d& place_m, const Track& track, double units_per_metre) const;
  bool leaves_zero(const Eigen::Vector3d& place_m, const Track& track) const;
  [[noreturn]] static void refuse(double number, const std::string& place);
  [[noreturn]] static void refuse_beginning(const std::string& place);
  void count(double number) { ++counts_[number]; }

  template <class Place>
  bool is_missing(const Eigen::Vector3d& place_m, const Track& track, double units_per_metre,
                  const Place& place) {
    const Verdict verdict = judge(place_m, track, units_per_metre);
    if (verdict == Verdict::place) return false;
    const double number = in_unit(place_m[0], units_per_metre);
    if (verdict == Verdict::unclear) refuse(number, place());
    count(number);
    return true;
  }
  static double in_unit(double value_m, double units_per_metre);

  MissingNumbers missing_;
  std::vector<Track> tracks_;
  double last_of_axis_m_ = std::numeric_limits<double>::quiet_NaN();
  std::map<double, std::uint64_t> counts_;  // of missing places, by number
};

/// The same for values of the first rows, in any unit: NaN where the three `columns` of a point are
/// equal, so that they do not decide on its unit.
void drop_equal(std::vector<std::vector<double>>& columns);

}  // namespace condyle::host
