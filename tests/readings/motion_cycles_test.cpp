// SPDX-License-Identifier: Apache-2.0
// Cycles that are found while the jaw moves, against the truth of the kinematic jaw.
#include <gtest/gtest.h>

#include <cmath>

#include "condyle/estimator/motion/motion_cycles.h"
#include "condyle/estimator/sensors/pose_sensor.h"
#include "readings/simulated_readings.h"
#include "support/tier.h"

namespace condyle::host {
namespace {

using testing_support::runs;

// Random chewing: sequences with pauses, swallows and speech.
JawScenario chewing(double rate_Hz, bool is_coarse, std::uint64_t seed) {
  JawScenario scenario;
  scenario.motion_seed = seed;
  scenario.facebow.rate_Hz = rate_Hz;
  scenario.facebow.noise_m = is_coarse ? kCoarseNoise_m : kFineNoise_m;
  scenario.facebow.noise_rad = is_coarse ? kCoarseNoise_rad : kFineNoise_rad;
  JawTask task = default_task(JawTaskKind::chewing);
  task.duration_s = 60;
  task.chewing.alternates = seed % 2 == 0;
  task.chewing.cycle_s = 0.6 + 0.1 * static_cast<double>(seed % 5);
  scenario.tasks.push_back(task);
  return scenario;
}

// The taken cycles of the incisor, as they end.
template <class Scalar>
class Chewed {
 public:
  explicit Chewed(const KinematicSimulation& simulation) {
    const Landmarks landmarks = stated_landmarks(simulation, {});
    const Eigen::Matrix<Scalar, 3, 1> up =
        head_frame(landmarks).linear().col(2).template cast<Scalar>();
    const Eigen::Matrix<Scalar, 3, 1> incisor =
        landmarks.point_m[Landmarks::incisor_lower].template cast<Scalar>();
    PoseSensor<Scalar> sensor{MotionEstimatorParameters{}};
    EventSet events;
    Eigen::Matrix<Scalar, 3, 1> in_jaw;
    bool has_point = false;
    for (const Sample& sample : simulation.samples()) {
      const PoseEstimate<Scalar> pose = sensor.process(sample, events);
      if (pose.provenance() == Provenance::not_computed || seconds(pose.time_ns) < 0.8) continue;
      if (!has_point) {  // the jaw rests in the reference position
        in_jaw = pose.rotation.transpose() * (incisor - pose.centre_m.value) + pose.body_centre_m;
        has_point = true;
      }
      if (!sample.position_valid) continue;
      add(pose.time_ns, pose.point(in_jaw), up);
    }
    MotionCycle<Scalar> cycle;
    if (cycles_.finish(cycle)) keep(cycle);
  }

  std::vector<MotionCycle<Scalar>> taken, rejected;

 private:
  void add(TimeNs time_ns, const PointEstimate<Scalar>& point,
           const Eigen::Matrix<Scalar, 3, 1>& up) {
    const auto& v = point.velocity_m_s;
    const auto sd = [](Scalar variance) { return std::sqrt(std::max(variance, Scalar(0))); };
    CycleSample<Scalar> sample;
    sample.time_ns = time_ns;
    sample.height_m = up.dot(point.position_m.value);
    sample.height_sd_m = sd(up.dot(point.position_m.covariance * up));
    sample.rate_m_s = up.dot(v.value);
    sample.rate_sd_m_s = sd(up.dot(v.covariance * up));
    sample.speed_m_s = v.value.norm();
    sample.speed_sd_m_s = sd(v.value.dot(v.covariance * v.value)) / sample.speed_m_s;
    MotionCycle<Scalar> cycle;
    if (cycles_.add(sample, cycle)) keep(cycle);
  }
  void keep(const MotionCycle<Scalar>& cycle) {
    (cycle.verdict == CycleVerdict::taken ? taken : rejected).push_back(cycle);
  }

  MotionCycles<Scalar> cycles_;
};

// Which does not depend on the instrument.
struct Truth {
  explicit Truth(const JawScenario& scenario)
      : jaw(std::make_shared<const KinematicJaw>(scenario)), cycles(true_cycles(*jaw)) {
    for (const TrueReading& reading : true_readings(*jaw)) {
      if (reading.stroke > 0) {
        values[std::to_string(reading.stroke) + reading.reading] = reading.value;
      }
    }
  }
  std::shared_ptr<const KinematicJaw> jaw;
  std::vector<JawCycle> cycles;
  std::map<std::string, double> values;
};

struct Score {
  double truth = 0, found = 0, right = 0;
  double squares[3] = {}, over_sd[4] = {}, largest_delay_s = 0;

  template <class Scalar>
  void add(const Truth& of, const Chewed<Scalar>& chewed) {
    const std::vector<JawCycle>& cycles = of.cycles;
    const std::map<std::string, double>& values = of.values;
    truth += static_cast<double>(cycles.size());
    found += static_cast<double>(chewed.taken.size());
    int number = 0;
    for (const JawCycle& cycle : cycles) {
      ++number;
      for (const auto& one : chewed.taken) {
        const double errors_s[] = {seconds(one.begin_ns) - cycle.begin_s,
                                   seconds(one.turn_ns) - cycle.opening_end_s,
                                   seconds(one.end_ns) - cycle.end_s};
        if (std::abs(errors_s[1]) > 0.1 || std::abs(errors_s[0]) > 0.1 ||
            std::abs(errors_s[2]) > 0.1) {
          continue;
        }
        ++right;
        for (int i = 0; i < 3; ++i) squares[i] += errors_s[i] * errors_s[i];
        const auto z = [&](const Quantity<Scalar>& quantity, double scale, const char* name) {
          const double true_value = values.at(std::to_string(number) + name) / scale;
          const double error = (static_cast<double>(quantity.value) - true_value) /
                               static_cast<double>(quantity.standard_deviation);
          return error * error;
        };
        over_sd[0] += z(one.duration_s, 1, "cycle_duration_s");
        over_sd[1] += z(one.height_m, 1e3, "cycle_height_mm");
        over_sd[2] += z(one.opening_peak_speed_m_s, 1e3, "opening_peak_speed_mm_s");
        over_sd[3] += z(one.closing_peak_speed_m_s, 1e3, "closing_peak_speed_mm_s");
        largest_delay_s = std::max(largest_delay_s, seconds(one.known_ns - one.end_ns));
        break;
      }
    }
  }
  double rms_ms(int i) const { return 1e3 * std::sqrt(squares[i] / right); }
  double rms_sds(int i) const { return std::sqrt(over_sd[i] / right); }
};

template <class Scalar>
class MotionCyclesOfAJaw : public testing::Test {};
using Scalars = testing::Types<double, float>;
TYPED_TEST_SUITE(MotionCyclesOfAJaw, Scalars);

TYPED_TEST(MotionCyclesOfAJaw, AreTheTrueOnes) {
  std::vector<Truth> truths;
  for (std::uint64_t seed = 1; seed <= runs<std::uint64_t>(2, 2, 20); ++seed) {
    truths.emplace_back(chewing(200, false, seed));
  }
  for (const double rate_Hz : {50.0, 55.0, 60.0, 65.0, 80.0, 100.0, 200.0, 500.0}) {
    for (const bool is_coarse : {false, true}) {
      Score score;
      for (std::uint64_t seed = 1; seed <= truths.size(); ++seed) {
        const Truth& truth = truths[seed - 1];
        const KinematicSimulation simulation(truth.jaw, chewing(rate_Hz, is_coarse, seed), seed);
        score.add(truth, Chewed<TypeParam>(simulation));
      }
      std::printf(
          "%3.0f Hz %s: %3.0f cycles, recall %.3f, precision %.3f, rms error of begin %.1f, turn "
          "%.1f, end %.1f ms; rms error in sd: duration %.2f, height %.2f, speeds %.2f and %.2f; "
          "known after %.2f s\n",
          rate_Hz, is_coarse ? "coarse" : "fine", score.truth, score.right / score.truth,
          score.right / score.found, score.rms_ms(0), score.rms_ms(1), score.rms_ms(2),
          score.rms_sds(0), score.rms_sds(1), score.rms_sds(2), score.rms_sds(3),
          score.largest_delay_s);
      EXPECT_GE(score.right, 0.99 * score.truth);
      EXPECT_GE(score.right, 0.99 * score.found);
      // Root mean squares of 80 cycles or more: 1.3 is beyond 1 by four of their standard errors.
      for (int i = 0; i < 4; ++i) EXPECT_LT(score.rms_sds(i), 1.3) << i;
      for (int i = 0; i < 3; ++i) EXPECT_LT(score.rms_ms(i), is_coarse ? 20 : 10) << i;
      EXPECT_LT(score.largest_delay_s, 0.7);
    }
  }
}

}  // namespace
}  // namespace condyle::host
