// SPDX-License-Identifier: Apache-2.0
// Numbers that stand for a missing place. Programs write one number, such as -999, on all axes of a
// point that was not seen. The rule, for a point with the same number N on all three axes:
//
//   stated      `--missing N`: it is missing; with any --missing, nothing below applies
//   far         it is more than 0.1 m from the point's last place: missing
//   jump        N is 0 or usual (-1, -9, 99, -99, 999, -999, 9999, -9999), more than 10 mm from the
//               last place, and that place has decimals in the file's unit: missing
//   unclear     N is usual and nearer to such a place: the recording is refused
//   beginning   N is usual and no place came before: missing
//
// No jaw moves so far from one sample to the next, and the place of a point that is measured to
// less than a whole unit hardly ever is the same whole number on three axes. Of one axis, only
// usual numbers from 99 on are missing, if they are more than 50 mm from the last place, or before
// the first place more than 0.5 m from 0.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

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
    if (last_m_.cols() != points_m.cols()) {
      last_m_.setConstant(3, points_m.cols(), std::numeric_limits<double>::quiet_NaN());
    }
    for (Eigen::Index i = 0; i < points_m.cols(); ++i) {
      const double x = points_m(0, i);
      const bool is_filled = x == points_m(1, i) && x == points_m(2, i) &&
                             is_missing(points_m.col(i), last_m_.col(i), units_per_metre, place);
      if (is_filled) {
        points_m.col(i).setConstant(std::numeric_limits<double>::quiet_NaN());
        has_any = true;
      } else if (points_m.col(i).allFinite()) {
        last_m_.col(i) = points_m.col(i);
      }
    }
    return has_any;
  }

  /// Whether the place `value_m` of one axis is missing.
  bool is_missing(double value_m, double units_per_metre);

  /// What was found, a line a number.
  std::vector<std::string> notes() const;

 private:
  enum class Verdict { place, missing, unclear };
  Verdict judge(const Eigen::Vector3d& place_m, const Eigen::Vector3d& last_m,
                double units_per_metre) const;
  [[noreturn]] static void refuse(double number, const std::string& place);
  void count(double number) { ++counts_[number]; }

  template <class Place>
  bool is_missing(const Eigen::Vector3d& place_m, const Eigen::Vector3d& last_m,
                  double units_per_metre, const Place& place) {
    const Verdict verdict = judge(place_m, last_m, units_per_metre);
    if (verdict == Verdict::place) return false;
    const double number = in_unit(place_m[0], units_per_metre);
    if (verdict == Verdict::unclear) refuse(number, place());
    count(number);
    return true;
  }
  static double in_unit(double value_m, double units_per_metre);

  MissingNumbers missing_;
  Eigen::Matrix3Xd last_m_;  // of each point; NaN: none yet
  double last_of_axis_m_ = std::numeric_limits<double>::quiet_NaN();
  std::map<double, std::uint64_t> counts_;  // of missing places, by number
};

/// The same for values of the first rows, in any unit: NaN where the three `columns` of a point are
/// equal, so that they do not decide on its unit.
void drop_equal(std::vector<std::vector<double>>& columns);

}  // namespace condyle::host
