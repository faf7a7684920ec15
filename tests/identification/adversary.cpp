// SPDX-License-Identifier: Apache-2.0
#include "identification/adversary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace condyle::adversary {
namespace {

constexpr double kTau = 2 * std::numbers::pi;

// A function of time with its first two derivatives.
struct Jet {
  double value = 0, rate = 0, curvature = 0;
};

Jet operator+(const Jet& a, const Jet& b) {
  return {a.value + b.value, a.rate + b.rate, a.curvature + b.curvature};
}
Jet operator*(const Jet& a, const Jet& b) {
  return {a.value * b.value, a.rate * b.value + a.value * b.rate,
          a.curvature * b.value + 2 * a.rate * b.rate + a.value * b.curvature};
}
Jet operator*(double factor, const Jet& a) {
  return {factor * a.value, factor * a.rate, factor * a.curvature};
}
Jet sine(const Jet& angle) {
  const double s = std::sin(angle.value), c = std::cos(angle.value);
  return {s, c * angle.rate, c * angle.curvature - s * angle.rate * angle.rate};
}
Jet time_jet(double t) {
  return {t, 1, 0};
}
Jet constant(double value) {
  return {value, 0, 0};
}

// Slow sines about zero, of unit variance, which vary rhythm and height.
class Wander {
 public:
  explicit Wander(Random& random) {
    for (std::size_t k = 0; k < kSines; ++k) {
      frequencies_[k] = kTau * random.uniform(0.05, 0.4);
      phases_[k] = kTau * random.uniform();
    }
  }
  Jet at(double t) const {
    Jet sum;
    for (std::size_t k = 0; k < kSines; ++k) {
      sum = sum + sine(frequencies_[k] * time_jet(t) + constant(phases_[k]));
    }
    return std::sqrt(2.0 / kSines) * sum;
  }
  // Its integral over time, without a constant.
  Jet integral_at(double t) const {
    Jet sum;
    for (std::size_t k = 0; k < kSines; ++k) {
      const Jet angle = frequencies_[k] * time_jet(t) + constant(phases_[k] - kTau / 4);
      sum = sum + (1 / frequencies_[k]) * sine(angle);
    }
    return std::sqrt(2.0 / kSines) * sum;
  }

 private:
  static constexpr std::size_t kSines = 4;
  std::array<double, kSines> frequencies_{}, phases_{};
};

class MovingPoint {
 public:
  MovingPoint(const Regime& regime, Random& random)
      : motion_(regime.motion),
        point_(regime.point),
        duration_s_(regime.duration_s),
        rhythm_(random),
        height_(random),
        phase_(kTau * random.uniform()),
        tremor_phase_(kTau * random.uniform()) {}

  Jet position_m(double t) const {
    const Jet time = time_jet(t);
    const double f = kTau * motion_.frequency_Hz;
    const Jet theta = constant(phase_) + f * time +
                      (kTau * motion_.sweep_Hz_per_s / 2) * (time * time) +
                      (f * motion_.rhythm_spread) * rhythm_.integral_at(t);
    const Jet height = motion_.amplitude_m * (constant(1) + motion_.height_spread * height_.at(t));
    const Jet shape = sine(theta) + motion_.second * sine(2 * theta + constant(1)) +
                      motion_.third * sine(3 * theta + constant(2));
    const Jet tremor =
        motion_.tremor_m * sine(kTau * motion_.tremor_Hz * time + constant(tremor_phase_));
    return height * shape + tremor;
  }

  // All but what has a memory.
  double force_N(double t) const {
    const Jet x = position_m(t);
    const double share = 1 + (point_.friction_end_share - 1) * t / duration_s_;
    const double mass_kg = point_.mass_kg * (1 + point_.mass_slope_per_m * x.value);
    double force_N = mass_kg * x.curvature + point_.friction_Ns_m * share * x.rate +
                     point_.stiffness_N_m * x.value + point_.offset_N;
    force_N += point_.mass_kg * point_.mass_slope_per_m / 2 * x.rate * x.rate;
    force_N += point_.coulomb_N * (x.rate > 0 ? 1 : -1);
    force_N += point_.square_N_m2 * x.value * x.value;
    force_N += point_.cube_N_m3 * x.value * x.value * x.value;
    force_N += point_.contact_N_m * std::max(0.0, x.value - point_.contact_at_m);
    force_N += point_.drag_Ns2_m2 * x.rate * std::abs(x.rate);
    return force_N - point_.missing_Ns_m * x.rate;
  }

 private:
  Motion motion_;
  Point point_;
  double duration_s_;
  Wander rhythm_, height_;
  double phase_, tremor_phase_;
};

constexpr double kStep_s = 2.5e-4;  // of what has a memory

// Dahl's friction: a bristle that bends before it slips.
class Bristle {
 public:
  explicit Bristle(const Point& point) : point_(point) {}
  double advance_N(double way_m) {
    if (point_.bristle_N <= 0) return 0;
    const double turn = force_N_ / point_.bristle_N * (way_m > 0 ? 1 : -1);
    force_N_ += point_.bristle_N / point_.bristle_m * (1 - turn) * way_m;
    return force_N_;
  }

 private:
  const Point& point_;
  double force_N_ = 0;
};

std::vector<double> force_with_memory(const Regime& regime, const MovingPoint& point) {
  std::vector<double> forces_N;
  Bristle bristle(regime.point);
  double smooth_N = 0;
  bool is_first = true;
  const double blend =
      regime.drive.low_pass_Hz > 0 ? 1 - std::exp(-kTau * regime.drive.low_pass_Hz * kStep_s) : 1;
  double before_m = point.position_m(-0.5).value;
  for (double t = -0.5; t < regime.duration_s + 0.5; t += kStep_s) {
    const double x_m = point.position_m(t).value, way_m = x_m - before_m;
    before_m = x_m;
    const double force_N = point.force_N(t) + bristle.advance_N(way_m);
    smooth_N += (is_first ? 1 : blend) * (force_N - smooth_N);
    is_first = false;
    forces_N.push_back(smooth_N);
  }
  return forces_N;
}

class Noise {
 public:
  Noise(const Tracker& tracker, Random& random) : tracker_(tracker), random_(random) {}
  double next() {
    double white = random_.normal();
    if (tracker_.heavy_tails) {
      double square = 0;
      for (int k = 0; k < 3; ++k) square += std::pow(random_.normal(), 2);
      white /= std::sqrt(square);  // of variance 1: 3 / (3 - 2) over 3
    }
    const double r = tracker_.correlation;
    last_ = r * last_ + std::sqrt(1 - r * r) * white;
    return tracker_.noise_m * last_;
  }

 private:
  const Tracker& tracker_;
  Random& random_;
  double last_ = 0;
};

std::vector<Reading> positions_of(const Regime& regime, const MovingPoint& point, Random& random) {
  const Tracker& tracker = regime.tracker;
  Noise noise(tracker, random);
  std::vector<Reading> positions;
  std::vector<double> recent;
  const double phase_s = random.uniform() / tracker.rate_Hz;
  for (int k = 0;; ++k) {
    double t = phase_s + k / tracker.rate_Hz;
    if (tracker.jitter_s > 0) t += tracker.jitter_s * random.uniform(-1, 1);
    if (t > regime.duration_s) break;
    double z_m = tracker.scale * point.position_m(t).value + noise.next();
    recent.push_back(z_m);
    if (recent.size() > static_cast<std::size_t>(tracker.mean_of)) recent.erase(recent.begin());
    z_m = 0;
    for (const double value : recent) z_m += value / static_cast<double>(recent.size());
    if (random.uniform() < tracker.outlier_share) z_m += tracker.outlier_m * random.normal();
    if (tracker.rounding_m > 0) z_m = tracker.rounding_m * std::round(z_m / tracker.rounding_m);
    if (random.uniform() < tracker.drop_share) continue;
    const double late_s = tracker.is_centred ? (tracker.mean_of - 1) / 2.0 / tracker.rate_Hz : 0;
    positions.push_back({t - late_s + tracker.stamp_error_s * random.uniform(-1, 1), z_m});
  }
  return positions;
}

std::vector<Reading> drive_of(const Regime& regime, const MovingPoint& point, Random& random) {
  const DriveSensor& sensor = regime.drive;
  const bool has_memory = regime.point.bristle_N > 0 || sensor.low_pass_Hz > 0;
  const std::vector<double> forces_N =
      has_memory ? force_with_memory(regime, point) : std::vector<double>();
  const auto force_N = [&](double t) {
    if (!has_memory) return point.force_N(t);
    const double place = (t + 0.5) / kStep_s;
    const auto k = static_cast<std::size_t>(place);
    const double share = place - static_cast<double>(k);
    return forces_N[k] + share * (forces_N[k + 1] - forces_N[k]);
  };
  std::vector<Reading> drive;
  const double phase_s = random.uniform() / sensor.rate_Hz;
  const double keep = std::exp(-kTau * sensor.slow_noise_Hz / sensor.rate_Hz);
  double slow = random.normal();
  for (int k = 0;; ++k) {
    const double t = phase_s + k / sensor.rate_Hz;
    if (t > regime.duration_s) break;
    slow = keep * slow + std::sqrt(1 - keep * keep) * random.normal();
    const double u_N = sensor.gain * force_N(t - sensor.delay_s) +
                       sensor.noise_N * random.normal() + sensor.slow_noise_N * slow +
                       sensor.drift_N * t / regime.duration_s;
    drive.push_back({t * (1 + sensor.clock_ppm * 1e-6), u_N});
  }
  return drive;
}

}  // namespace

namespace {

// splitmix64 (G. Steele, D. Lea, C. Flood, OOPSLA 2014)
std::uint64_t mixed(std::uint64_t z) {
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31U);
}
constexpr std::uint64_t kStep = 0x9E3779B97F4A7C15U;

}  // namespace

// Mixed, or the numbers of one seed would be those of the next one, shifted.
Random::Random(std::uint64_t seed) : state_(mixed(mixed(seed + kStep) + kStep)) {}

double Random::uniform() {
  state_ += kStep;
  return (static_cast<double>(mixed(state_) >> 11U) + 0.5) * 0x1p-53;
}

double Random::log_uniform(double low, double high) {
  return std::exp(uniform(std::log(low), std::log(high)));
}

double Random::normal() {
  const double radius = std::sqrt(-2 * std::log(uniform()));
  return radius * std::cos(kTau * uniform());
}

Recording simulate(const Regime& regime, std::uint64_t seed) {
  Random random(seed);
  const MovingPoint point(regime, random);
  Recording recording;
  recording.positions = positions_of(regime, point, random);
  recording.drive = drive_of(regime, point, random);
  return recording;
}

std::vector<TruePoint> motion_of(const Regime& regime, std::uint64_t seed, double step_s) {
  Random random(seed);
  const MovingPoint moving(regime, random);
  std::vector<TruePoint> points;
  for (double t = 0; t < regime.duration_s; t += step_s) {
    const Jet x = moving.position_m(t);
    points.push_back({t, x.value, x.rate, x.curvature});
  }
  return points;
}

double effective_friction_Ns_m(const Regime& regime, std::uint64_t seed) {
  Random random(seed);
  const MovingPoint moving(regime, random);
  const Point& point = regime.point;
  Bristle bristle(point);
  double before_m = moving.position_m(-0.5).value, work = 0, square = 0;
  for (double t = -0.5; t < regime.duration_s; t += kStep_s) {
    const Jet x = moving.position_m(t);
    const double bristle_N = bristle.advance_N(x.value - before_m), v = x.rate;
    before_m = x.value;
    if (t < 0) continue;
    work += (bristle_N + point.coulomb_N * (v > 0 ? 1 : -1) + point.drag_Ns2_m2 * v * std::abs(v)) *
            v * kStep_s;
    square += v * v * kStep_s;
  }
  return point.friction_Ns_m * point.friction_end_share + work / square;
}

}  // namespace condyle::adversary
