// SPDX-License-Identifier: Apache-2.0
// Searches the sum of squares of a release (release_motion.h) over its two rates.
//
//   x = (lambda, w), w = log omega     so that kappa = e^(2 w) stays above 0
//   e, J                               residual; its slope by x: d/dw = 2 kappa d/dkappa
//
// Descent: s = (J'J + mu D)^-1 J' e, D the diagonal of J'J, mu ten times larger until e'e falls
//          (D. W. Marquardt, J. SIAM 11 (1963) 431-441); if lambda, w or zeta is held, along the
//          one direction that holds it: (0, 1), (1, 0), (lambda, 1).
// Profile: least sum of squares with a value held. Its 95 % interval ends where that has grown
//          by q^2 noise variances; it needs no symmetry, as the delta method does, and is the same
//          for a value and for any function of it (S. S. Wilks, Ann. Math. Stat. 9 (1938) 60-62).
#pragma once

#include <algorithm>

#include "condyle/estimator/release/release_motion.h"

namespace condyle::internal {

/// What a descent holds fixed.
enum class ReleaseHeld { nothing, lambda, omega, zeta };

/// Positions of a release, and the search over them.
template <class Scalar>
class ReleaseSearch {
 public:
  using Rates = ReleaseRates<Scalar>;
  using Equations = ReleaseEquations<Scalar>;

  /// As for release_equations; the spans must outlive this.
  ReleaseSearch(std::span<const Scalar> time_s, std::span<const Scalar> position_m,
                bool starts_at_rest)
      : time_s_(time_s), position_m_(position_m), starts_at_rest_(starts_at_rest) {}

  /// End of a descent.
  struct End {
    Rates rates;
    Equations equations;
    bool has_converged = false;
  };

  /// The lowest point of a grid over damping ratios, and over natural frequencies from a tenth of a
  /// turn in the recording to one turn in four samples.
  End best_of_grid() const {
    constexpr int kFrequencies = 14;
    constexpr double kRatios[] = {0.03, 0.2, 0.5, 1, 2};
    const Scalar lowest = Scalar(0.6) / duration_s();
    const Scalar turns = Scalar(2.6) * Scalar(time_s_.size() - 1);
    const Scalar factor = elementary::exp(elementary::log(turns) / Scalar(kFrequencies - 1));
    End best;
    best.rates.lambda = std::numeric_limits<Scalar>::quiet_NaN();
    Scalar omega = lowest;
    for (int i = 0; i < kFrequencies; ++i, omega *= factor) {
      for (const double ratio : kRatios) {
        const Rates rates{Scalar(2) * Scalar(ratio) * omega, omega * omega};
        const Equations equations = at(rates);
        const Scalar sum = equations.square_sum();
        if (!is_finite(sum)) continue;
        if (best.rates.lambda == best.rates.lambda && sum >= best.equations.square_sum()) continue;
        best.rates = rates;
        best.equations = equations;
      }
    }
    return best;
  }

  /// Possible starts of a search.
  End from(const Rates& rates) const {
    End end;
    end.rates = rates;
    end.equations = at(rates);
    return end;
  }

  /// Descends from `end` until at most `smallest_gain_m2` can be gained.
  End descend(End end, ReleaseHeld held, Scalar smallest_gain_m2) const {
    constexpr int kMostSteps = 80;
    Scalar mu = Scalar(1e-3);
    end.has_converged = false;
    for (int i = 0; i < kMostSteps; ++i) {
      const Step step = step_from(end, held, mu);
      if (!is_finite(step.gain_m2)) return end;
      if (step.gain_m2 <= smallest_gain_m2) {
        end.has_converged = true;
        return end;
      }
      const Rates rates = moved(end.rates, held, step.s);
      const Equations equations = at(rates);
      if (is_allowed(rates) && equations.square_sum() < end.equations.square_sum()) {
        end.rates = rates;
        end.equations = equations;
        mu = std::max(mu / Scalar(10), Scalar(1e-9));
        continue;
      }
      mu *= Scalar(10);
      if (mu > Scalar(1e9)) {  // converged to rounding, or at the edge
        end.has_converged = is_allowed(rates);
        return end;
      }
    }
    return end;
  }

  /// End of the interval of the `held` value above (`side` 1) or below (-1) that of `minimum`, with
  /// `deviation` its standard deviation by the delta method (that of w for omega, which gives log
  /// omega); infinite if there is no end.
  Scalar interval_end(const End& minimum, ReleaseHeld held, Scalar side, Scalar deviation,
                      Scalar noise_variance_m2, Scalar q) const {
    using std::sqrt;
    constexpr int kMostTries = 24;
    const Scalar nothing = side * std::numeric_limits<Scalar>::infinity();
    const Scalar best = value_of(minimum.rates, held);
    if (!is_finite(deviation) || !(deviation > Scalar(0))) return nothing;
    Scalar distance = q * deviation, inside = 0, outside = -1;
    End end = minimum;
    for (int i = 0; i < kMostTries; ++i) {
      End start = outside < Scalar(0) ? end : minimum;
      start.rates = with_value(start.rates, held, best + side * distance);
      if (!is_allowed(start.rates)) return nothing;
      start.equations = at(start.rates);
      end = descend(start, held, Scalar(1e-4) * noise_variance_m2);
      const Scalar growth = end.equations.square_sum() - minimum.equations.square_sum();
      const Scalar reached = sqrt(std::max(growth, Scalar(0)) / noise_variance_m2);
      if (!is_finite(reached)) return nothing;
      if (reached > Scalar(0.99) * q && reached < Scalar(1.01) * q) return best + side * distance;
      (reached < q ? inside : outside) = distance;
      const Scalar ratio = reached > Scalar(0) ? q / reached : Scalar(3);
      distance *= std::clamp(ratio, Scalar(0.3), Scalar(3));
      if (outside > Scalar(0) && !(distance > inside && distance < outside)) {
        distance = (inside + outside) / Scalar(2);
      }
    }
    return nothing;
  }

  /// The equations at `rates`.
  Equations at(const Rates& rates) const {
    return release_equations(time_s_, position_m_, rates, starts_at_rest_);
  }
  /// From the first sample to the last.
  Scalar duration_s() const { return time_s_.back() - time_s_.front(); }

 private:
  using Pair = Eigen::Matrix<Scalar, 2, 1>;
  struct Step {
    Pair s;
    Scalar gain_m2;  ///< expected
  };

  static bool is_finite(Scalar value) { return value - value == Scalar(0); }

  // Faster than visible between samples, or slower than in a hundred recordings: not a release.
  bool is_allowed(const Rates& rates) const {
    const Scalar fastest = Scalar(40) * Scalar(time_s_.size() - 1) / duration_s();
    const Scalar slowest = Scalar(0.01) / duration_s();
    const bool is_in_range = fastest > rates.lambda && -fastest / Scalar(40) < rates.lambda;
    return is_in_range && rates.kappa < fastest * fastest && rates.kappa > slowest * slowest;
  }

  static Step step_from(const End& end, ReleaseHeld held, Scalar mu) {
    const auto& e = end.equations.residual;
    const auto of_lambda = end.equations.slope.col(0);
    const auto of_w = (Scalar(2) * end.rates.kappa * end.equations.slope.col(1)).eval();
    if (held != ReleaseHeld::nothing) {
      const Pair direction(held == ReleaseHeld::lambda  ? Scalar(0)
                           : held == ReleaseHeld::omega ? Scalar(1)
                                                        : end.rates.lambda,
                           held == ReleaseHeld::omega ? Scalar(0) : Scalar(1));
      const auto slope = (of_lambda * direction[0] + of_w * direction[1]).eval();
      const Scalar g = slope.dot(e), h = slope.squaredNorm();
      return {Pair(direction * (g / (h * (Scalar(1) + mu)))), g * g / h};
    }
    const Scalar a = of_lambda.squaredNorm(), b = of_lambda.dot(of_w), c = of_w.squaredNorm();
    const Scalar g0 = of_lambda.dot(e), g1 = of_w.dot(e);
    const Scalar a_damped = a * (Scalar(1) + mu), c_damped = c * (Scalar(1) + mu);
    const Scalar determinant = a_damped * c_damped - b * b;
    const Pair s((c_damped * g0 - b * g1) / determinant, (a_damped * g1 - b * g0) / determinant);
    return {s, s[0] * g0 + s[1] * g1};
  }

  // Held values stay exactly where they are.
  static Rates moved(const Rates& rates, ReleaseHeld held, Pair s) {
    const Scalar w = std::clamp(s[1], Scalar(-1), Scalar(1));
    const Scalar growth = elementary::exp(w);
    if (held == ReleaseHeld::zeta) {
      return {rates.lambda * growth, rates.kappa * growth * growth};
    }
    return {rates.lambda + s[0], rates.kappa * growth * growth};
  }

  static Scalar value_of(const Rates& rates, ReleaseHeld held) {
    using std::sqrt;
    if (held == ReleaseHeld::lambda) return rates.lambda;
    if (held == ReleaseHeld::omega) return elementary::log(rates.kappa) / Scalar(2);
    return rates.lambda / (Scalar(2) * sqrt(rates.kappa));
  }
  static Rates with_value(const Rates& rates, ReleaseHeld held, Scalar value) {
    using std::sqrt;
    if (held == ReleaseHeld::lambda) return {value, rates.kappa};
    if (held == ReleaseHeld::omega) return {rates.lambda, elementary::exp(Scalar(2) * value)};
    return {Scalar(2) * value * sqrt(rates.kappa), rates.kappa};
  }

  std::span<const Scalar> time_s_, position_m_;
  bool starts_at_rest_;
};

}  // namespace condyle::internal
