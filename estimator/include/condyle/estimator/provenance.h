// SPDX-License-Identifier: Apache-2.0
// Where a value comes from. Every value carries its provenance.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "condyle/estimator/math/arithmetic.h"

namespace condyle {

/// Where a value comes from.
enum class Provenance : std::uint8_t {
  not_computed,  ///< there is no value
  assumed,       ///< the prior or the tuning determines it, not the measurements
  derived,       ///< a measured quantity times a named assumption
  measured,      ///< the measurements determine it
};

/// Name of a provenance in files and summaries.
constexpr const char* provenance_name(Provenance provenance) {
  constexpr const char* names[] = {"", "assumed", "derived", "measured"};
  return names[static_cast<int>(provenance)];
}

/// A value with its standard deviation, both in the unit of the name that holds it.
template <class Scalar>
struct Quantity {
  Scalar value = std::numeric_limits<Scalar>::quiet_NaN();
  Scalar standard_deviation = std::numeric_limits<Scalar>::quiet_NaN();  ///< by the model
  Provenance provenance = Provenance::not_computed;
};

/// A fitted value, the value to show, and the limit that withholds it. `kFirst` is the limit before
/// any measurement.
template <class Scalar, class LimitName, LimitName kFirst>
struct LimitedValue {
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::quiet_NaN();
  Quantity<Scalar> quantity;   ///< the value to show: the prior, assumed, while a limit holds
  Scalar fitted = kNone;       ///< even if withheld
  Scalar fitted_sd = kNone;    ///< with systematic errors; infinite if unbounded
  Scalar sampling_sd = kNone;  ///< without systematic errors
  LimitName limit = kFirst;
};

/// Half-width of a normal distribution's central 95 %, in standard deviations.
inline constexpr double kNormalQuantile95 = 1.959963984540054;

/// Share of information from which on a value counts as measured.
inline constexpr double kMeasuredInformationShare = 0.5;

/// Information share: 1 - posterior variance / variance from prior and process noise alone. 0: the
/// measurements contributed nothing; 1: they determined the value. The posterior must include only
/// measurements that do not presuppose the value. 0 if the variances are unusable.
template <class Scalar>
Scalar information_share(Scalar posterior_variance, Scalar prior_only_variance) {
  const Scalar share = Scalar(1) - posterior_variance / prior_only_variance;
  return share > Scalar(0) ? share : Scalar(0);
}

/// `measured` from kMeasuredInformationShare on, else `assumed`.
template <class Scalar>
Provenance provenance_of_share(Scalar share) {
  return share >= Scalar(kMeasuredInformationShare) ? Provenance::measured : Provenance::assumed;
}

/// If the instant's own sample was not used, the motion model carries the others over.
constexpr Provenance carried_over(Provenance provenance, bool is_taken) {
  return provenance == Provenance::measured && !is_taken ? Provenance::derived : provenance;
}

/// A value and its variance as a quantity; empty if one of them is not finite or the variance is
/// negative.
template <class Scalar>
Quantity<Scalar> quantity_of(Scalar value, Scalar variance, Provenance provenance) {
  if (!std::isfinite(value) || !std::isfinite(variance) || variance < Scalar(0)) return {};
  return {value, std::sqrt(variance), provenance};
}

}  // namespace condyle
