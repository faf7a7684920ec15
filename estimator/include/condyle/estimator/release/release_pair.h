// SPDX-License-Identifier: Apache-2.0
// Friction, stiffness and mass from two passive releases of one jaw, the second with a known load.
//
//   1, 2           the releases; each gives lambda, kappa and r with their covariance
//                  (passive_release.h)
//   dm, dk, W      what the second has more: mass (kg), stiffness (N/m), constant force along the
//                  axis (N); each has a standard deviation s
//   eta            1 / m (1/kg); kv = lambda / eta, ks = kappa / eta of the first
//
// Model:     lambda2 = lambda / (1 + eta dm),  kappa2 = (kappa + eta dk) / (1 + eta dm),
//            r2 = r1 + eta W / kappa
//            A hanging load adds a mass and a weight. The rests are used only if W is given and
//            there is no spring, whose own rest is unknown.
// Estimate:  weighted least squares, Gauss-Newton, over (dm, dk, W) / s, r1, lambda, kappa, eta.
//            Each uncertainty of the load is one more measurement and widens the results.
// Intervals: of the ratios 1 / eta, lambda / eta, kappa / eta by E. C. Fieller (J. R. Stat. Soc. B
//            16 (1954) 175-185), unbounded if eta may be zero
// Agreement: the sum of squares, from the noise alone, is chi-square with one degree of freedom,
// two
//            with rests. Beyond a chance of 1 in 1000 the recordings do not have one (kv, ks, m),
//            and there is no value.
#pragma once

#include <array>

#include "condyle/estimator/impedance/impedance_parameters.h"
#include "condyle/estimator/release/passive_release.h"

namespace condyle {

/// A known quantity and its standard deviation.
struct KnownLoad {
  double value = 0;
  double standard_deviation = 0;
};

/// What the second release has in addition to the first.
struct ReleaseLoad {
  KnownLoad mass_kg, stiffness_N_m;
  KnownLoad weight_N;  ///< in the direction in which the position grows
};

/// How a pair is judged.
struct ReleasePairSettings {
  ReleaseLoad load;
  /// The smallest differences that matter to the user.
  double friction_resolution_Ns_m = ImpedanceParameters{}.friction_resolution_Ns_m;
  double mass_resolution_fraction = ImpedanceParameters{}.mass_resolution_fraction;
  double stiffness_resolution_fraction = 0.1;
  /// Spread between subjects, before any measurement.
  double friction_spread_Ns_m = 5, stiffness_spread_N_m = 100, mass_spread_kg = 0.1;
};

/// Outcome of a pair.
enum class ReleasePairOutcome : std::uint8_t {
  combined,
  release_not_known,  ///< one of the releases has no trusted fit, or too wide intervals
  unusable_load,      ///< none, not finite, or a weight and a spring together
  disagree,           ///< no single (kv, ks, m) explains both
  not_converged,
};

/// The results of two releases.
template <class Scalar>
struct ReleasePair {
  ReleasePairOutcome outcome = ReleasePairOutcome::release_not_known;
  ReleaseValue<Scalar> friction_Ns_m, stiffness_N_m, mass_kg;
  Scalar chi_square = 0;  ///< of the agreement
  int degrees_of_freedom = 0;
};

namespace internal {

/// The weighted least squares of a pair.
template <class Scalar>
class PairEquations {
 public:
  enum { kMass, kStiffness, kWeight, kRest, kLambda, kKappa, kEta, kUnknowns };
  using State = Eigen::Matrix<Scalar, kUnknowns, 1>;
  using Covariance = Eigen::Matrix<Scalar, kUnknowns, kUnknowns>;
  using Weights = ReleaseCovariance<Scalar> PassiveRelease<Scalar>::*;

  /// `weights`: which covariance of the releases is used.
  PairEquations(const std::array<const PassiveRelease<Scalar>*, 2>& releases,
                const ReleaseLoad& load, Weights weights)
      : releases_(releases),
        load_(load),
        weights_(weights),
        uses_rests_(load.weight_N.value != 0) {}

  bool uses_rests() const { return uses_rests_; }

  /// Each load alone would give eta; takes the best of these. Weights by the size of the effect
  /// suffice for a start.
  State start() const {
    const auto& [first, second] = releases_;
    const Scalar dm = Scalar(load_.mass_kg.value), dk = Scalar(load_.stiffness_N_m.value);
    const Scalar W = Scalar(load_.weight_N.value);
    // numerator = eta denominator; of lambda, kappa and the rests
    const Scalar numerators[] = {first->rates.lambda - second->rates.lambda,
                                 second->rates.kappa - first->rates.kappa,
                                 first->rates.kappa * (second->rest_m - first->rest_m)};
    const Scalar denominators[] = {second->rates.lambda * dm, dk - second->rates.kappa * dm, W};
    const Scalar variances[] = {variance(kReleaseLambda), variance(kReleaseKappa),
                                first->rates.kappa * first->rates.kappa * variance(kReleaseRest)};
    Scalar sum = 0, weights = 0;
    for (int i = 0; i < (uses_rests_ ? 3 : 2); ++i) {
      sum += numerators[i] * denominators[i] / variances[i];
      weights += denominators[i] * denominators[i] / variances[i];
    }
    State x = State::Zero();
    x[kRest] = first->rest_m;
    x[kLambda] = first->rates.lambda;
    x[kKappa] = first->rates.kappa;
    x[kEta] = std::max(sum / weights, Scalar(1e-3));
    return x;
  }

  /// The triangle of the linearised equations at `x`; the last column is measured minus modelled.
  Eigen::Matrix<Scalar, kUnknowns + 1, kUnknowns + 1> triangle(const State& x) const {
    RowTriangle<Scalar, kUnknowns + 1> rows;
    for (int i = kMass; i <= kWeight; ++i) rows.add(row_of(i, x[i]));
    if (!uses_rests_) rows.add(row_of(kRest, x[kRest]));  // not used: held
    const Scalar s_m = Scalar(load_.mass_kg.standard_deviation);
    const Scalar s_k = Scalar(load_.stiffness_N_m.standard_deviation);
    const Scalar s_W = Scalar(load_.weight_N.standard_deviation);
    const Scalar dm = Scalar(load_.mass_kg.value) + s_m * x[kMass];
    const Scalar dk = Scalar(load_.stiffness_N_m.value) + s_k * x[kStiffness];
    const Scalar W = Scalar(load_.weight_N.value) + s_W * x[kWeight];
    const Scalar lambda = x[kLambda], kappa = x[kKappa], eta = x[kEta];
    const Scalar g = Scalar(1) / (Scalar(1) + eta * dm);
    using Data = Eigen::Matrix<Scalar, 3, kUnknowns + 1>;
    Data first = Data::Zero(), second = Data::Zero();
    first(0, kLambda) = first(1, kKappa) = first(2, kRest) = Scalar(1);
    second(0, kLambda) = g;
    second(0, kEta) = -lambda * g * g * dm;
    second(0, kMass) = -lambda * g * g * eta * s_m;
    const Scalar kappa2 = (kappa + eta * dk) * g;
    second(1, kKappa) = g;
    second(1, kEta) = g * dk - kappa2 * g * dm;
    second(1, kMass) = -kappa2 * g * eta * s_m;
    second(1, kStiffness) = g * eta * s_k;
    second(2, kRest) = Scalar(1);
    second(2, kEta) = W / kappa;
    second(2, kKappa) = -eta * W / (kappa * kappa);
    second(2, kWeight) = eta * s_W / kappa;
    set_differences(*releases_[0], {lambda, kappa, x[kRest]}, first);
    set_differences(*releases_[1], {lambda * g, kappa2, x[kRest] + eta * W / kappa}, second);
    whiten_and_add(*releases_[0], first, rows);
    whiten_and_add(*releases_[1], second, rows);
    return rows.rows();
  }

  /// R^-1 of the unknowns.
  static Covariance inverse(const Eigen::Matrix<Scalar, kUnknowns + 1, kUnknowns + 1>& R) {
    const Covariance U = R.template topLeftCorner<kUnknowns, kUnknowns>();
    return inverse_of_triangle<Scalar, kUnknowns>(U, kUnknowns);
  }

 private:
  static constexpr int kPlaces[] = {kReleaseLambda, kReleaseKappa, kReleaseRest};

  static Eigen::Matrix<Scalar, 1, kUnknowns + 1> row_of(int i, Scalar at) {
    Eigen::Matrix<Scalar, 1, kUnknowns + 1> row = Eigen::Matrix<Scalar, 1, kUnknowns + 1>::Zero();
    row[i] = Scalar(1);
    row[kUnknowns] = i == kRest ? Scalar(0) : -at;
    return row;
  }

  Scalar variance(int i) const {
    return (releases_[0]->*weights_)(i, i) + (releases_[1]->*weights_)(i, i);
  }

  template <class Data>
  static void set_differences(const PassiveRelease<Scalar>& release, const Vector3<Scalar>& model,
                              Data& data) {
    data(0, kUnknowns) = release.rates.lambda - model[0];
    data(1, kUnknowns) = release.rates.kappa - model[1];
    data(2, kUnknowns) = release.rest_m - model[2];
  }

  // Rows L^-1 data, L L' the covariance: forward substitution.
  template <class Data>
  void whiten_and_add(const PassiveRelease<Scalar>& release, Data data,
                      RowTriangle<Scalar, kUnknowns + 1>& rows) const {
    using std::sqrt;
    const int count = uses_rests_ ? 3 : 2;
    Eigen::Matrix<Scalar, 3, 3> L = Eigen::Matrix<Scalar, 3, 3>::Zero();
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j <= i; ++j) {
        Scalar sum = (release.*weights_)(kPlaces[i], kPlaces[j]);
        for (int k = 0; k < j; ++k) sum -= L(i, k) * L(j, k);
        L(i, j) = i == j ? sqrt(sum) : sum / L(j, j);
      }
      for (int j = 0; j < i; ++j) data.row(i) -= L(i, j) * data.row(j);
      data.row(i) /= L(i, i);
      rows.add(data.row(i));
    }
  }

  std::array<const PassiveRelease<Scalar>*, 2> releases_;
  ReleaseLoad load_;
  Weights weights_;
  bool uses_rests_;
};

/// The minimum of the least squares.
template <class Scalar>
struct PairSolution {
  typename PairEquations<Scalar>::State x;
  typename PairEquations<Scalar>::Covariance inverse;
  Scalar chi_square = 0;
  bool has_converged = false;
};

template <class Scalar>
PairSolution<Scalar> solve(const PairEquations<Scalar>& equations) {
  using Equations = PairEquations<Scalar>;
  constexpr int kMostSteps = 30;
  PairSolution<Scalar> solution;
  solution.x = equations.start();
  for (int i = 0; i < kMostSteps && !solution.has_converged; ++i) {
    const auto R = equations.triangle(solution.x);
    solution.inverse = Equations::inverse(R);
    const auto whitened = R.col(Equations::kUnknowns).template head<Equations::kUnknowns>().eval();
    solution.x += solution.inverse * whitened;
    solution.chi_square = R(Equations::kUnknowns, Equations::kUnknowns);
    solution.chi_square *= solution.chi_square;
    // of a standard deviation, squared
    solution.has_converged = whitened.squaredNorm() < Scalar(1e-6);
    if (!solution.x.allFinite()) break;
  }
  solution.has_converged = solution.has_converged && solution.inverse.allFinite();
  return solution;
}

/// Ends of the interval of a / b, by Fieller; infinite if b may be 0.
template <class Scalar>
std::pair<Scalar, Scalar> ratio_interval(Scalar a, Scalar b, Scalar aa, Scalar ab, Scalar bb,
                                         Scalar q) {
  using std::sqrt;
  const Scalar infinity = std::numeric_limits<Scalar>::infinity();
  // (a - x b)^2 <= q^2 (aa - 2 x ab + x^2 bb)
  const Scalar square = b * b - q * q * bb, mixed = a * b - q * q * ab, rest = a * a - q * q * aa;
  const Scalar root = mixed * mixed - square * rest;
  if (!(square > Scalar(0)) || !(b > Scalar(0)) || !(root >= Scalar(0))) {
    return {-infinity, infinity};
  }
  return {(mixed - sqrt(root)) / square, (mixed + sqrt(root)) / square};
}

/// A fit that can be trusted, with intervals close to those of the covariance.
template <class Scalar>
bool is_fit_for_a_pair(const PassiveRelease<Scalar>& release) {
  using std::sqrt;
  if (release.outcome != ReleaseOutcome::converged || !has_trusted_residuals(release)) return false;
  const auto is_normal = [&release](const ReleaseValue<Scalar>& value, int i) {
    return value.quantity.standard_deviation < Scalar(1.5) * sqrt(release.covariance(i, i));
  };
  return is_normal(release.damping_rate_per_s, kReleaseLambda) &&
         is_normal(release.stiffness_per_mass_per_s2, kReleaseKappa);
}

inline bool is_usable(const ReleaseLoad& load) {
  bool is_finite = true;
  for (const KnownLoad* known : {&load.mass_kg, &load.stiffness_N_m, &load.weight_N}) {
    is_finite = is_finite && known->value - known->value == 0 && known->standard_deviation >= 0 &&
                known->standard_deviation - known->standard_deviation == 0;
  }
  const bool has_weight = load.weight_N.value != 0, has_spring = load.stiffness_N_m.value != 0;
  return is_finite && (load.mass_kg.value != 0 || has_spring || has_weight) &&
         !(has_weight && has_spring);
}

}  // namespace internal

/// Combines the release `first` with `second`, which has the load of the settings in addition.
/// Gives values only if the outcome is combined; kv, ks and m are those of the first.
template <class Scalar>
ReleasePair<Scalar> combine_releases(const PassiveRelease<Scalar>& first,
                                     const PassiveRelease<Scalar>& second,
                                     const ReleasePairSettings& settings) {
  using Equations = internal::PairEquations<Scalar>;
  ReleasePair<Scalar> pair;
  if (!internal::is_usable(settings.load)) {
    pair.outcome = ReleasePairOutcome::unusable_load;
    return pair;
  }
  if (!internal::is_fit_for_a_pair(first) || !internal::is_fit_for_a_pair(second)) return pair;

  const Equations by_noise({&first, &second}, settings.load, &PassiveRelease<Scalar>::bound),
      equations({&first, &second}, settings.load, &PassiveRelease<Scalar>::covariance);
  const auto agreement = internal::solve(by_noise), solution = internal::solve(equations);
  if (!agreement.has_converged || !solution.has_converged) {
    pair.outcome = ReleasePairOutcome::not_converged;
    return pair;
  }
  const Scalar chi_square = agreement.chi_square;
  pair.chi_square = chi_square;
  pair.degrees_of_freedom = equations.uses_rests() ? 2 : 1;
  const Scalar limit = equations.uses_rests() ? Scalar(13.82) : Scalar(10.83);
  if (chi_square > limit) {
    pair.outcome = ReleasePairOutcome::disagree;
    return pair;
  }
  pair.outcome = ReleasePairOutcome::combined;

  const auto& x = solution.x;
  const auto P = (solution.inverse * solution.inverse.transpose()).eval();
  constexpr int eta = Equations::kEta;
  const Scalar e = x[eta], q = std::max(first.quantile, second.quantile);
  const auto ratio = [&](Scalar a, Scalar aa, Scalar ab, double spread, double resolution) {
    const auto [low, high] = internal::ratio_interval(a, e, aa, ab, P(eta, eta), q);
    return internal::release_value(a / e, low, high, q, spread, resolution);
  };
  const auto of_unknown = [&](int i, double spread, double resolution) {
    return ratio(x[i], P(i, i), P(i, eta), spread, resolution);
  };
  pair.mass_kg = ratio(Scalar(1), Scalar(0), Scalar(0), settings.mass_spread_kg,
                       settings.mass_resolution_fraction / static_cast<double>(e));
  pair.friction_Ns_m = of_unknown(Equations::kLambda, settings.friction_spread_Ns_m,
                                  settings.friction_resolution_Ns_m);
  pair.stiffness_N_m = of_unknown(
      Equations::kKappa, settings.stiffness_spread_N_m,
      settings.stiffness_resolution_fraction * static_cast<double>(x[Equations::kKappa] / e));
  return pair;
}

}  // namespace condyle
