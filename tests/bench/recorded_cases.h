// SPDX-License-Identifier: Apache-2.0
// On a PC: the cases of filter_cases.h in both precisions, and their samples made beforehand.
#pragma once

#include <string>
#include <vector>

#include "bench/filter_cases.h"
#include "condyle/estimator/pose/pose_estimator.h"

namespace condyle::bench {

/// Positions (m) of a chewing jaw, and the time from the sample before (s).
template <class Scalar>
struct Recording {
  explicit Recording(std::size_t samples) {
    ChewingJaw jaw;
    for (std::size_t i = 0; i < samples; ++i) {
      const auto next = jaw.next<Scalar>();
      positions_m.push_back(next.position_m);
      steps_s.push_back(next.step_s);
    }
  }
  std::vector<Scalar> positions_m, steps_s;
};

/// Three estimators of one axis each, beside which that of the whole pose is judged.
template <class T>
struct ThreeSingleAxes {
  using Scalar = T;
  static constexpr const char* kName = "recommended_three_single_axes";
  RecommendedOneAxis<Scalar> axes[3];
  void step(Scalar z, Scalar step_s) {
    for (auto& axis : axes) axis.step(z, step_s);
  }
};

/// Position and orientation of a jaw that turns as it opens.
template <class T>
struct WholePose {
  using Scalar = T;
  static constexpr const char* kName = "whole_pose";
  PoseEstimator<Scalar> estimator{MotionEstimatorParameters{}};
  PoseEstimate<Scalar> last;
  TimeNs time_ns = 0;
  [[gnu::noinline]] void step(Scalar z, Scalar step_s) {
    time_ns += static_cast<TimeNs>(static_cast<double>(step_s) * 1e9);
    const Scalar turn_rad = Scalar(10) * z;  // 0.15 rad at 15 mm
    TimedPose<Scalar> measurement;
    measurement.time_ns = time_ns;
    measurement.is_measured = true;
    measurement.pose = {rotation_of<Scalar>({turn_rad, Scalar(0.2) * turn_rad, 0}), {z, z, z}};
    last = estimator.step(measurement);
  }
};

/// Calls `visit.operator()<Case>(name)` for each case, `name` with its scalar type.
template <class Visitor>
void for_each_case(Visitor&& visit) {
  const auto in = [&visit]<class Scalar>(const char* scalar) {
    const auto named = [&visit, scalar]<class Case>(const char* name) {
      visit.template operator()<Case>(std::string(name) + "_" + scalar);
    };
    for_each_filter<Scalar>(named);
    for_each_dense_twin<Scalar>(named);
    named.template operator()<ThreeSingleAxes<Scalar>>(ThreeSingleAxes<Scalar>::kName);
    named.template operator()<WholePose<Scalar>>(WholePose<Scalar>::kName);
  };
  in.template operator()<double>("double");
  in.template operator()<float>("float");
}

}  // namespace condyle::bench
