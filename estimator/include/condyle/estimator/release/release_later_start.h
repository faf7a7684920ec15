// SPDX-License-Identifier: Apache-2.0
// Effect of the first samples of a release on its fit.
//
// Fits:       without the first samples, as many as leave 1.25, 1.75 and three times the standard
//             deviation of lambda
// Difference: a hand or muscle that still acts at the begin, smoothing over the release, a spring
//             that hardens and dry friction make these fits differ from that of all; of a spring
//             and a damper they are the same within their noise. The largest difference is taken.
// Energy:     that of the last counts over 1 - E, E the energy left there as a share of that at the
//             first: an error that grows with the energy, as hardening, is then covered
#pragma once

#include "condyle/estimator/release/release_search.h"

namespace condyle {

inline constexpr int kFewestReleaseSamples = 10;

namespace internal {

/// A fitted release, and the noise of its positions.
template <class Scalar>
struct FittedMotion {
  ReleaseRates<Scalar> rates;
  Scalar rest_m, start_m, start_velocity_m_s, noise_sd_m;
};

/// Change through later starts; infinite if one of them has no fit.
template <class Scalar>
struct LaterStart {
  Scalar start_s = 0, lambda = 0, kappa = 0, rest_m = 0, zeta = 0, log_omega = 0;

  void take_larger(const LaterStart& other) {
    start_s = std::max(start_s, other.start_s);
    for (Scalar LaterStart::*of : {&LaterStart::lambda, &LaterStart::kappa, &LaterStart::rest_m,
                                   &LaterStart::zeta, &LaterStart::log_omega}) {
      using std::abs;
      if (abs(other.*of) > abs(this->*of)) this->*of = other.*of;
    }
  }
};

template <class Scalar>
LaterStart<Scalar> change_from(std::span<const Scalar> time_s, std::span<const Scalar> position_m,
                               std::size_t begin, Scalar more, const FittedMotion<Scalar>& release,
                               Scalar negligible_m2) {
  using std::sqrt;
  constexpr Scalar kUnknown = std::numeric_limits<Scalar>::infinity();
  const ReleaseSearch<Scalar> search(time_s.subspan(begin), position_m.subspan(begin), false);
  const auto minimum =
      search.descend(search.from(release.rates), ReleaseHeld::nothing, negligible_m2);
  const Scalar start_s = time_s[begin] - time_s[0];
  if (!minimum.has_converged) return {start_s, kUnknown, kUnknown, kUnknown, kUnknown, kUnknown};
  const auto zeta = [](const ReleaseRates<Scalar>& rates) {
    return rates.lambda / (Scalar(2) * sqrt(rates.kappa));
  };
  return {start_s,
          more * (minimum.rates.lambda - release.rates.lambda),
          more * (minimum.rates.kappa - release.rates.kappa),
          more * (minimum.equations.linear[0] - release.rest_m),
          more * (zeta(minimum.rates) - zeta(release.rates)),
          more * elementary::log(minimum.rates.kappa / release.rates.kappa) / Scalar(2)};
}

template <class Scalar>
LaterStart<Scalar> start_later(std::span<const Scalar> time_s, std::span<const Scalar> position_m,
                               const FittedMotion<Scalar>& release, Scalar negligible_m2) {
  constexpr Scalar kTimes[] = {Scalar(1.25), Scalar(1.75), Scalar(3)};
  constexpr std::size_t kSteps = 24;
  const std::size_t most = time_s.size() - std::size_t{kFewestReleaseSamples};
  std::size_t begins[std::size(kTimes)] = {};
  Scalar least = 0;  // variance of lambda of the whole
  Scalar energy_m2 = 1, later_energy_m2 = 1;
  for (std::size_t i = 0; i <= kSteps; ++i) {
    const std::size_t k = i * most / kSteps;
    const auto at = release_response(release.rates, time_s[k] - time_s[0]);
    const Scalar off_m = release.start_m - release.rest_m;
    const Scalar p_m = off_m * at.C + release.start_velocity_m_s * at.S;
    // C' = -kappa S, S' = C - lambda S
    const Scalar v_m_s = -off_m * release.rates.kappa * at.S +
                         release.start_velocity_m_s * (at.C - release.rates.lambda * at.S);
    const auto bound =
        release_bound(time_s.subspan(k), release.rates, p_m, v_m_s, release.noise_sd_m, false);
    const Scalar variance = bound(kReleaseLambda, kReleaseLambda);
    const Scalar now_m2 = p_m * p_m + v_m_s * v_m_s / release.rates.kappa;
    if (i == 0) {
      least = variance;
      energy_m2 = now_m2;
    }
    const auto is_within = [&](Scalar times) { return variance <= times * times * least; };
    for (std::size_t j = 0; j < std::size(kTimes); ++j) {
      if (is_within(kTimes[j])) begins[j] = k;
    }
    if (!is_within(kTimes[std::size(kTimes) - 1])) break;
    later_energy_m2 = now_m2;
  }
  const Scalar share = std::clamp(later_energy_m2 / energy_m2, Scalar(0), Scalar(0.99));
  LaterStart<Scalar> apart;
  for (std::size_t j = 0; j < std::size(kTimes); ++j) {
    const bool is_last = j + 1 == std::size(kTimes);
    apart.take_larger(change_from(time_s, position_m, begins[j],
                                  is_last ? Scalar(1) / (Scalar(1) - share) : Scalar(1), release,
                                  negligible_m2));
  }
  return apart;
}

}  // namespace internal
}  // namespace condyle
