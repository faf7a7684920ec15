// SPDX-License-Identifier: Apache-2.0
// From what the joint identification holds to what may be said of the point.
//
//   theta     lambda, eta, kappa, tau, c, gamma (joint_identification.h), of covariance A
//   k         kv = lambda / eta, m = 1 / eta, ks = kappa / eta, b = c / eta, Fc = gamma / eta and
//             the drive's delay
//   C         their covariance, by the delta method: C = G A G', G = dk / dtheta
//   s0        their standard deviations before any measurement: the prior's, and the random walk's
//
// Information share:  1 - C_ii / s0_i^2 (provenance.h)
// Observability:      1 - largest eigenvalue of C_ij / (s0_i s0_j): the smallest information share
//                     of any combination of what is fitted
// Standard deviation: that of the filter, C_ii^1/2, which is the posterior Cramer-Rao bound at the
//                     estimate, and of what it takes for granted, which no number of samples
//                     averages out:
//   gain       relative sigma_g of u is one of m, kv, ks, b, Fc
//   delay      tau late, where it is not fitted: kv_bias = (m w^2 - ks) tau with
//              w^2 = mean a^2 / mean v^2, taken as m w^2 tau at least; and w^2 tau^2 / 2 of the
//              drive's curvature, like a gain
//   missing    a force of at most the share s of the total, in phase with v or with a:
//              s rms(F) / rms(v) for kv, s rms(F) / rms(a) for m; likewise for ks (p about its
//              mean), b and Fc (1)
//   reversal   a force of 6 % of Fc, likewise: what the linearised reversal of a fitted Coulomb
//              friction was seen to leave in simulated chewing
// Limit:       a value is measured where its information share and its standard deviation say so,
//              and the innovations do not say that the model fails: that a force which nobody
//              measured acts, or the noise is not as stated. Nor may kv or Fc lie 3 standard
//              deviations below 0: what drives the motion is then not all in the drive. Where the
//              interval would be narrow enough were one other value known (C_ii - C_ij^2 / C_jj),
//              the pair is named: friction and delay act through v and the jerk, mass and stiffness
//              through a and p, which a pure sinusoid makes proportional.
#pragma once

#include "condyle/estimator/eigen_solvers.h"
#include "condyle/estimator/innovation_monitor.h"
#include "condyle/estimator/joint_estimate.h"
#include "condyle/estimator/joint_parameters.h"

namespace condyle {

/// theta, in the order of the state.
struct JointUnknown {
  enum Index { kLambda, kEta, kKappa, kTau, kOffset, kCoulomb, kCount };
};

/// What the filter holds.
template <class Scalar>
struct JointBelief {
  Eigen::Matrix<Scalar, JointUnknown::kCount, 1> theta;
  Eigen::Matrix<Scalar, JointUnknown::kCount, JointUnknown::kCount> A;
  bool has_failed = false;  ///< the filter lost the point before, and started anew
  Scalar time_s = 0;        ///< driven since, over which the means below are
  Scalar mean_p_m = 0, mean_p2 = 0, mean_u2 = 0, mean_v2 = 0, mean_a2 = 0;  ///< SI units
};

/// What a position did to the filter.
enum class JointOutcome : std::uint8_t {
  waits,     ///< no drive was measured since the last interruption
  started,   ///< the first one, or the first after an interruption
  updated,   ///< it was taken
  held,      ///< it was taken for the point's place alone, which moves too little to tell more
  paused,    ///< it lies where teeth or food may touch: not taken
  rejected,  ///< it lies beyond the gate; after three in a row the point's place starts anew
  refused,   ///< a state was not usable, or the place was lost for long and nothing had been
             ///< proved by then: the filter starts anew
};

/// What the filter knows after a sample.
template <class Scalar>
struct JointFilterEstimate : JointEstimate<Scalar> {
  Scalar friction_mass_covariance = 0;  ///< of the filter (Ns/m kg)
  Scalar position_m = 0, velocity_m_s = 0;
  Scalar nis = std::numeric_limits<Scalar>::quiet_NaN();  ///< of the position; NaN: not taken
  Scalar mean_nis = 0;                ///< of all that were taken; 1 where the model holds
  Scalar innovation_correlation = 0;  ///< of neighbours among them; 0 where the model holds
  /// Smallest information share of any combination of what is fitted: 0 where some combination is
  /// not observed at all, 1 where all are known.
  Scalar observability = 0;
  JointOutcome outcome = JointOutcome::waits;
};

/// Draws the conclusion. Fixed size, no allocation.
template <class Scalar>
class JointConclusion {
 public:
  /// Fewest innovations that the model is judged by, and highest mean NIS: it makes intervals 14 %
  /// too narrow.
  static constexpr Scalar kFewestInnovations = 200, kHighestNis = Scalar(1.3);

  /// `parameters` must be valid; both are only used while this lives.
  JointConclusion(const JointParameters& parameters, const InnovationMoments<Scalar>& innovations)
      : parameters_(parameters), innovations_(innovations) {}

  /// True where there are enough innovations.
  bool is_judged() const { return innovations_.count() >= kFewestInnovations; }
  /// True where they are as they would be if the model held.
  bool model_holds() const {
    return innovations_.mean_nis() < kHighestNis && !innovations_.is_correlated();
  }

  /// What `belief` says of the values; the rest of the estimate is the filter's.
  JointFilterEstimate<Scalar> draw(const JointBelief<Scalar>& belief) {
    using std::sqrt;
    const Scalar e = belief.theta[JointUnknown::kEta], m = Scalar(1) / e;
    Values k, prior_sd;
    Table G = Table::Zero();
    constexpr int unknown_of[kValues] = {JointUnknown::kLambda,  JointUnknown::kEta,
                                         JointUnknown::kKappa,   JointUnknown::kOffset,
                                         JointUnknown::kCoulomb, JointUnknown::kTau};
    for (int i = 0; i < kValues; ++i) {
      k[i] = belief.theta[unknown_of[i]] * m;
      G(i, unknown_of[i]) = m;
      G(i, JointUnknown::kEta) = -k[i] * m;
    }
    k[kMass] = m;
    G(kMass, JointUnknown::kEta) = -m * m;
    k[kDelay] = belief.theta[JointUnknown::kTau];
    G.row(kDelay).setZero();
    G(kDelay, JointUnknown::kTau) = Scalar(1);
    const Table GA = G * belief.A;
    C_ = GA * G.transpose();
    const DriveParameters& drive = parameters_.drive;
    const JointPrior of_delay{drive.delay_s, drive.delay_sd_s, 0};
    const JointPrior* const priors[kValues] = {&parameters_.friction_Ns_m, &parameters_.mass_kg,
                                               &parameters_.stiffness_N_m, &parameters_.offset_N,
                                               &parameters_.coulomb_N,     &of_delay};
    for (int i = 0; i < kValues; ++i) {
      prior_variance_[i] = square(Scalar(priors[i]->sd)) +
                           belief.time_s * square(Scalar(priors[i]->walk_per_root_s));
    }
    time_s_ = belief.time_s;
    has_failed_ = belief.has_failed;

    JointFilterEstimate<Scalar> estimate;
    estimate.mean_nis = innovations_.mean_nis();
    estimate.innovation_correlation = innovations_.correlation();
    estimate.friction_mass_covariance = C_(kFriction, kMass);
    estimate.observability = observability();
    const auto granted = grant(belief, k);
    is_passive_ = true;
    for (const int i : {+kFriction, +kSliding}) {
      const Scalar variance = C_(i, i) + granted[static_cast<std::size_t>(i)].variance();
      const bool takes_energy = k[i] >= Scalar(0) || square(k[i]) <= kSpread2 * variance;
      is_passive_ = is_passive_ && takes_energy;
    }
    k[kDelay] += Scalar(drive.delay_s);
    IdentifiedValue<Scalar>* const values[kValues] = {&estimate.friction_Ns_m, &estimate.mass_kg,
                                                      &estimate.stiffness_N_m, &estimate.offset_N,
                                                      &estimate.coulomb_N,     &estimate.delay_s};
    for (int i = 0; i < kValues; ++i) {
      const Scalar resolution = i == kFriction ? Scalar(parameters_.friction_resolution_Ns_m)
                                : i == kMass   ? Scalar(parameters_.mass_resolution_fraction) * m
                                               : sqrt(Scalar(2) * prior_variance_[i]);
      conclude(i, k[i], Scalar(priors[i]->mean), granted[static_cast<std::size_t>(i)], resolution,
               *values[i]);
    }
    return estimate;
  }

 private:
  enum { kFriction, kMass, kStiffness, kConstant, kSliding, kDelay, kValues };
  static_assert(static_cast<int>(kValues) == static_cast<int>(JointUnknown::kCount));
  using Values = Eigen::Matrix<Scalar, kValues, 1>;
  using Table = Eigen::Matrix<Scalar, kValues, kValues>;

  // What is taken for granted, in the value's unit.
  struct Granted {
    Scalar gain = 0, delay = 0, missing = 0, reversal = 0;
    Scalar variance() const {
      return square(gain) + square(delay) + square(missing) + square(reversal);
    }
  };

  static constexpr Scalar kReversalShare = Scalar(0.06);
  static constexpr Scalar kSpread2 = Scalar(3 * 3);

  static Scalar square(Scalar value) { return value * value; }

  std::array<Granted, kValues> grant(const JointBelief<Scalar>& belief, const Values& k) const {
    using std::sqrt;
    const DriveParameters& drive = parameters_.drive;
    std::array<Granted, kValues> granted;
    for (std::size_t i = 0; i < kDelay; ++i)
      granted[i].gain = Scalar(drive.gain_sd) * k[static_cast<int>(i)];
    if (!(belief.mean_v2 > Scalar(0) && belief.mean_a2 > Scalar(0))) return granted;
    const Scalar w2 = belief.mean_a2 / belief.mean_v2;
    const Scalar late2 = parameters_.delay == DelayModel::fitted ? C_(kDelay, kDelay)
                                                                 : square(Scalar(drive.delay_sd_s));
    for (std::size_t i = 0; i < kDelay; ++i) {
      granted[i].delay = w2 * late2 / Scalar(2) * k[static_cast<int>(i)];
    }
    if (parameters_.delay == DelayModel::known) {
      const Scalar inertial = k[kMass] * w2, elastic = k[kStiffness] - inertial;
      granted[kFriction].delay +=
          (inertial > elastic ? inertial : elastic) * Scalar(drive.delay_sd_s);
    }
    const Scalar missing = Scalar(drive.missing_share) * sqrt(belief.mean_u2);
    const Scalar reversal = kReversalShare * k[kSliding];
    const Scalar spread_m = sqrt(belief.mean_p2 - square(belief.mean_p_m));
    const Scalar per_N[kDelay] = {Scalar(1) / sqrt(belief.mean_v2),
                                  Scalar(1) / sqrt(belief.mean_a2), Scalar(1) / spread_m, Scalar(1),
                                  Scalar(1)};
    for (std::size_t i = 0; i < kDelay; ++i) {
      granted[i].missing = missing * per_N[i];
      granted[i].reversal = reversal * per_N[i];
    }
    return granted;
  }

  Scalar share_of(int i, Scalar variance) const {
    return information_share(variance, prior_variance_[i]);
  }

  // The interval is widened; the value is shown where it is narrow enough and the model holds.
  void conclude(int i, Scalar fitted, Scalar prior_mean, const Granted& granted, Scalar resolution,
                IdentifiedValue<Scalar>& value) const {
    using std::sqrt;
    const Scalar variance = C_(i, i) > Scalar(0) ? C_(i, i) : Scalar(0);
    value.quantity = {prior_mean, sqrt(prior_variance_[i]), Provenance::assumed};
    value.fitted = fitted;
    value.sampling_sd = sqrt(variance);
    value.information = share_of(i, variance);
    const Scalar squares[] = {variance, square(granted.gain), square(granted.delay),
                              square(granted.missing), square(granted.reversal)};
    constexpr JointLimit limits[] = {JointLimit::resolution, JointLimit::gain, JointLimit::delay,
                                     JointLimit::missing, JointLimit::viscous_or_coulomb};
    int largest = 0;
    for (int j = 1; j < 5; ++j) {
      if (!(squares[j] <= squares[largest])) largest = j;
    }
    const Scalar sum = variance + granted.variance();
    value.fitted_sd = sqrt(sum);
    const auto suffices = [&](Scalar filter_variance) {
      const Scalar all = sum - variance + filter_variance;
      return share_of(i, filter_variance) >= Scalar(kMeasuredInformationShare) &&
             all <= square(resolution / Scalar(2));
    };
    if (!is_judged()) {
      value.limit = has_failed_           ? JointLimit::model
                    : time_s_ > Scalar(0) ? JointLimit::too_early
                                          : JointLimit::no_drive;
    } else if (!model_holds() || !is_passive_) {
      value.limit = JointLimit::model;
    } else if (suffices(variance)) {
      value.limit = JointLimit::none;
      value.quantity = {fitted, value.fitted_sd, Provenance::measured};
    } else {
      value.limit = pair_of(i, suffices);
      if (value.limit != JointLimit::none) return;
      value.limit = value.information >= Scalar(kMeasuredInformationShare)
                        ? limits[largest]
                        : JointLimit::information;
    }
  }

  // The pair that value i belongs to, where it would suffice to know the other one.
  template <class Suffices>
  JointLimit pair_of(int i, const Suffices& suffices) const {
    struct Pair {
      int one, other;
      JointLimit limit;
    };
    constexpr Pair pairs[] = {{kFriction, kDelay, JointLimit::friction_or_delay},
                              {kMass, kStiffness, JointLimit::mass_or_stiffness},
                              {kFriction, kSliding, JointLimit::viscous_or_coulomb}};
    for (const Pair& pair : pairs) {
      if (i != pair.one && i != pair.other) continue;
      const int j = i == pair.one ? pair.other : pair.one;
      if (C_(j, j) > Scalar(0) && suffices(C_(i, i) - square(C_(i, j)) / C_(j, j))) {
        return pair.limit;
      }
    }
    return JointLimit::none;
  }

  Scalar observability() const {
    using std::sqrt;
    Table scaled = Table::Zero();
    for (int i = 0; i < kValues; ++i) {
      for (int j = 0; j < kValues; ++j) {
        const Scalar scale = sqrt(prior_variance_[i] * prior_variance_[j]);
        if (scale > Scalar(0)) scaled(i, j) = C_(i, j) / scale;
      }
    }
    return information_share(largest_eigenvalue(scaled), Scalar(1));
  }

  const JointParameters& parameters_;
  const InnovationMoments<Scalar>& innovations_;
  Table C_;
  Values prior_variance_;
  Scalar time_s_ = 0;
  bool has_failed_ = false;
  bool is_passive_ = true;
};

}  // namespace condyle
