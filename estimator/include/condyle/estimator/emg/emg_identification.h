// SPDX-License-Identifier: Apache-2.0
// Friction of a point that muscles drive, from its position and the muscles' forces of unknown
// gains: the values that the filter of emg_filter.h supports, with its symbols.
//
//   m         mass, assumed
//
// Values:      kv = lambda m and the like, with the standard deviation of the assumed mass: K_n, kv
//              and m are known up to one scale (g u = m a + kv v), which the assumed mass sets.
//              They are derived, never measured.
//
// What no number of samples averages out is added to P, by correlated_model_error.h with y = (v, p,
// 1, F_n):
//   E^2 = (error_share rms F)^2 + (sigma_lag rms F')^2
// F' is taken for what the motion needs: rms F' = (w^2 + |kappa|) rms v + |lambda| rms a,
// w^2 = mean a^2 / mean v^2. The same error draws gains and friction towards 0 (errors in
// variables), at most by themselves, which is covered if error_share is right. It also shifts
// stiffness and offset, beyond their own intervals: they are shown only if a gain is.
#pragma once

#include "condyle/estimator/emg/emg_filter.h"

namespace condyle {

/// The identification. Fixed size, no allocation; see above.
template <class Scalar>
class EmgIdentification : public EmgFilter<Scalar> {
 public:
  using EmgFilter<Scalar>::EmgFilter;

  /// The present results.
  EmgEstimate<Scalar> estimate() const {
    using std::sqrt;
    EmgEstimate<Scalar> estimate;
    const Scalar m = Scalar(parameters().mass_kg.mean);
    estimate.outcome = outcome();
    estimate.nis = Filter::nis();
    estimate.mean_nis = monitor().mean_nis();
    estimate.innovation_correlation = monitor().correlation();
    estimate.found_error_share = found_error_share();
    estimate.noise_share = noise_share();
    estimate.rejected_share = rejected_share();
    estimate.restarts = restarts();
    estimate.position_m = x()[p];
    estimate.velocity_m_s = x()[v];
    estimate.force_error_N = m * x()[d];
    estimate.force_rms_N = m * sqrt(powers().F2);
    estimate.mass_kg = {m, Scalar(parameters().mass_kg.sd), Provenance::assumed};
    const SystematicVariance systematic = systematic_variance();
    estimate.friction_Ns_m = value(lambda, parameters().friction_Ns_m,
                                   Scalar(parameters().friction_resolution_Ns_m), systematic);
    bool is_scale_known = false;
    for (int n = 0; n < muscles(); ++n) {
      EmgValue<Scalar>& gain = estimate.gain[static_cast<std::size_t>(n)];
      gain = value(g + n, parameters().gain, Scalar(parameters().gain_resolution), systematic);
      is_scale_known = is_scale_known || gain.limit == EmgLimit::none;
    }
    const auto scaled = [&](int i, const EmgPrior& prior) {
      EmgValue<Scalar> of = value(i, prior, half_known(prior), systematic);
      if (of.limit == EmgLimit::none && !is_scale_known) {
        of.limit = EmgLimit::scale;
        of.quantity = {Scalar(prior.mean), Scalar(prior.sd), Provenance::assumed};
      }
      return of;
    };
    estimate.stiffness_N_m = scaled(kappa, parameters().stiffness_N_m);
    estimate.offset_N = scaled(c, parameters().offset_N);
    return estimate;
  }

 private:
  using Filter = EmgFilter<Scalar>;
  using Filter::correlated_error, Filter::found_error_share, Filter::monitor, Filter::muscles;
  using Filter::kValues;
  using Filter::noise_share, Filter::outcome, Filter::P, Filter::parameters, Filter::powers;
  using Filter::p, Filter::v, Filter::d, Filter::lambda, Filter::kappa, Filter::c, Filter::g;
  using Filter::prior_of, Filter::rejected_share, Filter::restarts, Filter::square, Filter::x;
  using typename Filter::Values;

  static constexpr Scalar kFewestInnovations = 200, kHighestNis = Scalar(1.5);
  static constexpr Scalar kLowestCorrelation = Scalar(-0.3);
  static constexpr Scalar kMostRejectedShare = Scalar(0.05);

  static Scalar half_known(const EmgPrior& prior) {
    using std::sqrt;
    return sqrt(Scalar(2)) * Scalar(prior.sd);
  }

  // Variances of errors that no number of samples averages out, and the two parts of E^2.
  struct SystematicVariance {
    Values variance = Values::Zero();
    Scalar force = 0, lag = 0;
  };

  SystematicVariance systematic_variance() const {
    using std::abs;
    using std::sqrt;
    SystematicVariance systematic;
    if (!(powers().v2 > Scalar(0))) return systematic;
    systematic.force = square(Scalar(parameters().error_share)) * powers().F2;
    const Scalar slope = (powers().a2 / powers().v2 + abs(x()[kappa])) * sqrt(powers().v2) +
                         abs(x()[lambda]) * sqrt(powers().a2);
    systematic.lag = square(Scalar(parameters().lag_sd_s) * slope);
    Values D;
    for (int i = 0; i < kValues; ++i) {
      D[i] = Scalar(prior_of(lambda + i).sd / parameters().mass_kg.mean);
    }
    systematic.variance = correlated_error().variances(systematic.force + systematic.lag, D);
    return systematic;
  }

  EmgValue<Scalar> value(int i, const EmgPrior& prior, Scalar resolution,
                         const SystematicVariance& systematic) const {
    using std::sqrt;
    const Scalar m = Scalar(parameters().mass_kg.mean);
    const Scalar of_filter = m * m * P()(i, i),
                 of_systematic = m * m * systematic.variance[i - lambda];
    EmgValue<Scalar> value;
    value.quantity = {Scalar(prior.mean), Scalar(prior.sd), Provenance::assumed};
    value.fitted = m * x()[i];
    value.sampling_sd = sqrt(of_filter > Scalar(0) ? of_filter : Scalar(0));
    const Scalar of_mass = square(x()[i] * Scalar(parameters().mass_kg.sd));
    value.fitted_sd = sqrt(square(value.sampling_sd) + of_systematic + of_mass);
    value.information = information_share(of_filter + of_systematic, square(Scalar(prior.sd)));
    if (!(monitor().count() >= kFewestInnovations)) {
      value.limit = powers().time_s > Scalar(0) ? EmgLimit::too_early : EmgLimit::no_emg;
    } else if (!model_holds()) {
      value.limit = EmgLimit::model;
    } else if (!(value.information >= Scalar(kMeasuredInformationShare))) {
      value.limit = EmgLimit::information;
    } else if (value.fitted_sd <= resolution / Scalar(2)) {
      value.limit = EmgLimit::none;
      value.quantity = {value.fitted, value.fitted_sd, Provenance::derived};
    } else if (of_mass > of_systematic && of_mass > of_filter) {
      value.limit = EmgLimit::mass;
    } else if (of_filter > of_systematic) {
      value.limit = EmgLimit::resolution;
    } else {
      value.limit = systematic.lag > systematic.force ? EmgLimit::lag : EmgLimit::force;
    }
    return value;
  }

  // The error of the muscles' force may be smaller than stated, but not larger.
  bool model_holds() const {
    const Scalar stated = Scalar(parameters().error_share);
    return found_error_share() <= stated && noise_share() <= stated &&
           monitor().mean_nis() < kHighestNis && !monitor().is_correlated() &&
           monitor().correlation() > kLowestCorrelation && rejected_share() < kMostRejectedShare;
  }
};

}  // namespace condyle
