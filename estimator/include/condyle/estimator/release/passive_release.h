// SPDX-License-Identifier: Apache-2.0
// Damping and stiffness per mass of a relaxed jaw from its positions after it is let go. No force
// needs to be known, because support and damping alone move the jaw.
//
//   z        measured position (m): p of release_motion.h plus white noise of sd sigma
//   theta    lambda = kv / m (1/s), kappa = ks / m (1/s^2), r, p0, v0 (v0 may be known to be 0)
//   SSE      sum of (z - p)^2; n samples, k unknowns
//
// Estimate:   the theta of the least SSE, of maximum likelihood: grid, then damped Gauss-Newton
//             with exact sensitivities (release_search.h)
// Covariance: the Cramer-Rao bound at the estimate (release_motion.h)
// Noise:      sigma^2 times max(1, SSE / (sigma^2 (n - k))) times (1 + rho) / (1 - rho), rho the
//             correlation of neighbouring residuals and a standard deviation of it, 1 / sqrt n,
//             more: what is slightly coloured or larger than stated passes the checks, yet widens
// Later start: what fits without the first samples change (release_later_start.h) is part of every
//             interval and of the covariance
// Intervals:  95 %, by profile likelihood: near overdamping lambda is far from normal, and has no
//             upper end if the fast mode dies within a sample. The standard deviation that
//             counts is the wider half of the interval / q, q = 1.96 (sigma not known: Student's t)
// Overdamped: a hand that lets go over a time adds a real pole to the motion, which looks the same
//             as those of an overdamped jaw: if the interval of the damping ratio reaches 1,
//             no value is given, unless the support is known to be gone at the first sample
// Checks:     SSE / sigma^2 is chi-square with n - k degrees of freedom (limits left by chance
//             once in 2000 times each, E. B. Wilson, M. M. Hilferty, PNAS 17 (1931) 684-688);
//             correlation of neighbouring residuals at most 3.29 / sqrt n (once in 2000). Where
//             either fails, or lambda's interval lies below 0 (a muscle, a contact, another law of
//             friction, smoothed positions) no value is given.
//
// Measured: information share at least kMeasuredInformationShare against the spread between
// subjects, standard deviation at most half the smallest difference that matters, checks passed.
#pragma once

#include "condyle/estimator/release/release_later_start.h"

namespace condyle {

/// The smallest differences that matter to the user.
struct ReleaseResolution {
  double damping_rate_per_s = 0.4;  ///< 0.1 Ns/m at 0.25 kg
  double stiffness_fraction = 0.1;
  double damping_ratio = 0.05;
  double natural_frequency_fraction = 0.05;
};

/// Spread between subjects, before any measurement; it does not bias the estimates.
struct ReleaseSpread {
  double damping_rate_per_s = 40;  ///< jaw models: 2 to 20 Ns/m at 0.25 kg
  double stiffness_per_mass_per_s2 = 400;
  double damping_ratio = 1;
  double natural_frequency_rad_s = 20;
};

/// Knowledge about a release before the fit.
struct ReleaseSettings {
  double noise_sd_m = 0;        ///< sigma (m); 0: taken from the residuals
  bool starts_at_rest = false;  ///< v0 is known to be 0
  bool is_sudden = false;       ///< the support is known to be gone at the first sample
  ReleaseResolution resolution;
  ReleaseSpread spread;
};

/// Outcome of a fit.
enum class ReleaseOutcome : std::uint8_t {
  converged,
  too_few_samples,  ///< fewer than kFewestReleaseSamples
  unusable_input,   ///< not finite, or sizes that differ
  times_unordered,  ///< not strictly increasing
  no_motion,        ///< a constant fits as well
  not_converged,    ///< no minimum that fits a release
};

/// Result of the checks of model and noise by the residuals.
enum class ReleaseResiduals : std::uint8_t {
  as_stated,   ///< white, and of the stated size (of any size if none was stated)
  smaller,     ///< white and smaller: intervals are too wide
  larger,      ///< the motion is not a release, or the noise is larger than stated
  coloured,    ///< neighbours are correlated: not a release, or smoothed positions
  driven,      ///< white, but kv is below zero with 95 % confidence: a force drives the jaw
  overdamped,  ///< white, but perhaps overdamped: a hand that lets go over a time looks the same
};

/// One value of a release.
template <class Scalar>
struct ReleaseValue {
  Quantity<Scalar> quantity;  ///< not_computed, NaN: not bounded on both sides, or checks failed
  Scalar low95 = -std::numeric_limits<Scalar>::infinity();  ///< of the 95 % interval
  Scalar high95 = std::numeric_limits<Scalar>::infinity();
  Scalar information = 0;  ///< its information share (provenance.h)
};

/// The results of a release.
template <class Scalar>
struct PassiveRelease {
  ReleaseOutcome outcome = ReleaseOutcome::too_few_samples;
  ReleaseResiduals residuals = ReleaseResiduals::as_stated;
  ReleaseValue<Scalar> damping_rate_per_s, stiffness_per_mass_per_s2, damping_ratio,
      natural_frequency_rad_s, natural_frequency_Hz;
  ReleaseRates<Scalar> rates;  ///< at the least SSE, even if a value is withheld
  Scalar rest_m = 0, start_m = 0, start_velocity_m_s = 0;
  ReleaseCovariance<Scalar> covariance = ReleaseCovariance<Scalar>::Zero();
  ReleaseCovariance<Scalar> bound = covariance;  ///< from the noise alone: Cramer-Rao bound
  Scalar noise_sd_m = 0;     ///< used for the intervals: as stated, or from the residuals
  Scalar quantile = 0;       ///< q
  Scalar later_start_s = 0;  ///< begin of the fit with the latest start
  Scalar residual_rms_m = 0, chi_square = 0, residual_correlation = 0;
  int degrees_of_freedom = 0;
};

/// Position `t` s after the first sample of a fitted release (m).
template <class Scalar>
Scalar release_position(const PassiveRelease<Scalar>& release, Scalar t) {
  const auto at = release_response(release.rates, t);
  return release.rest_m + (release.start_m - release.rest_m) * at.C +
         release.start_velocity_m_s * at.S;
}

/// True if model and noise pass the checks.
template <class Scalar>
bool has_trusted_residuals(const PassiveRelease<Scalar>& release) {
  return release.residuals == ReleaseResiduals::as_stated ||
         release.residuals == ReleaseResiduals::smaller;
}

namespace internal {

/// Deviation of a chi-square number from its mean, converted to that of a normal one.
template <class Scalar>
Scalar normal_of_chi_square(Scalar chi_square, Scalar degrees) {
  const Scalar spread = Scalar(2) / (Scalar(9) * degrees);
  const Scalar root =
      elementary::pow(std::max(chi_square / degrees, Scalar(1e-30)), Scalar(1) / Scalar(3));
  using std::sqrt;
  return (root - Scalar(1) + spread) / sqrt(spread);
}

/// Half-width of the central 95 % of Student's t, by its expansion about the normal quantile (four
/// digits from 5 degrees of freedom on).
template <class Scalar>
Scalar student_half_width(Scalar degrees) {
  const Scalar z = Scalar(kNormalQuantile95), z2 = z * z;
  return z + z * (z2 + Scalar(1)) / (Scalar(4) * degrees) +
         z * ((Scalar(5) * z2 + Scalar(16)) * z2 + Scalar(3)) / (Scalar(96) * degrees * degrees) +
         z * (((Scalar(3) * z2 + Scalar(19)) * z2 + Scalar(17)) * z2 - Scalar(15)) /
             (Scalar(384) * degrees * degrees * degrees);
}

inline constexpr double kChanceLimit = 3.29;  // normal deviations; once in 2000 times, one side

template <class Scalar>
ReleaseOutcome check_release_input(std::span<const Scalar> time_s,
                                   std::span<const Scalar> position_m,
                                   const ReleaseSettings& settings) {
  const auto is_finite = [](auto value) { return value - value == 0; };
  if (time_s.size() != position_m.size() || !is_finite(settings.noise_sd_m) ||
      settings.noise_sd_m < 0) {
    return ReleaseOutcome::unusable_input;
  }
  if (time_s.size() < std::size_t{kFewestReleaseSamples}) return ReleaseOutcome::too_few_samples;
  Scalar mean = 0;
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    if (!is_finite(time_s[i]) || !is_finite(position_m[i])) return ReleaseOutcome::unusable_input;
    if (i > 0 && !(time_s[i] > time_s[i - 1])) return ReleaseOutcome::times_unordered;
    mean += (position_m[i] - position_m[0]) / Scalar(time_s.size());
  }
  Scalar about_mean = 0, between = 0;
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    const Scalar d = position_m[i] - position_m[0] - mean;
    about_mean += d * d;
    if (i > 0) between += (position_m[i] - position_m[i - 1]) * (position_m[i] - position_m[i - 1]);
  }
  // Neighbours differ by twice the variance of white noise.
  const Scalar degrees = Scalar(time_s.size() - 1), sigma = Scalar(settings.noise_sd_m);
  const bool moves = sigma > Scalar(0) ? normal_of_chi_square(about_mean / (sigma * sigma),
                                                              degrees) > Scalar(kChanceLimit)
                                       : about_mean > Scalar(1.5) * between;
  return moves ? ReleaseOutcome::converged : ReleaseOutcome::no_motion;
}

template <class Scalar>
void check_residuals(std::span<const Scalar> time_s, std::span<const Scalar> position_m,
                     Scalar stated_sd_m, PassiveRelease<Scalar>& release) {
  using std::sqrt;
  Scalar squares = 0, products = 0, before = 0;
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    const Scalar e = position_m[i] - release_position(release, time_s[i] - time_s[0]);
    squares += e * e;
    products += e * before;
    before = e;
  }
  const Scalar samples = Scalar(time_s.size()), degrees = Scalar(release.degrees_of_freedom);
  release.residual_rms_m = sqrt(squares / samples);
  release.residual_correlation = squares > Scalar(0) ? products / squares : Scalar(0);
  release.noise_sd_m = stated_sd_m > Scalar(0) ? stated_sd_m : sqrt(squares / degrees);
  release.chi_square = squares / (release.noise_sd_m * release.noise_sd_m);
  const Scalar deviation =
      stated_sd_m > Scalar(0) ? normal_of_chi_square(release.chi_square, degrees) : Scalar(0);
  const bool is_coloured = release.residual_correlation * sqrt(samples) > Scalar(kChanceLimit);
  release.residuals = deviation > Scalar(kChanceLimit)    ? ReleaseResiduals::larger
                      : is_coloured                       ? ReleaseResiduals::coloured
                      : deviation < -Scalar(kChanceLimit) ? ReleaseResiduals::smaller
                                                          : ReleaseResiduals::as_stated;
}

/// Factor on sigma^2 for the intervals; see above.
template <class Scalar>
Scalar noise_factor(const PassiveRelease<Scalar>& release, Scalar samples) {
  using std::sqrt;
  const Scalar excess = release.chi_square / Scalar(release.degrees_of_freedom);
  const Scalar rho =
      std::clamp(release.residual_correlation + Scalar(1) / sqrt(samples), Scalar(0), Scalar(0.95));
  return std::max(excess, Scalar(1)) * (Scalar(1) + rho) / (Scalar(1) - rho);
}

/// The ends of an interval around `value`, with `apart` added on either side.
template <class Scalar>
std::pair<Scalar, Scalar> to_double(Scalar value, std::pair<Scalar, Scalar> ends, Scalar apart) {
  using std::sqrt;
  const auto half = [apart](Scalar own) { return sqrt(own * own + apart * apart); };
  return {value - half(value - ends.first), value + half(ends.second - value)};
}

/// Gives a value its interval, standard deviation and provenance.
template <class Scalar>
ReleaseValue<Scalar> release_value(Scalar value, Scalar low, Scalar high, Scalar q, double spread,
                                   double resolution) {
  ReleaseValue<Scalar> result;
  result.low95 = low;
  result.high95 = high;
  const Scalar deviation = std::max(value - low, high - value) / q;
  if (!(deviation - deviation == Scalar(0))) return result;
  result.information = information_share(deviation * deviation, Scalar(spread * spread));
  const bool is_known = result.information >= Scalar(kMeasuredInformationShare) &&
                        deviation <= Scalar(resolution) / Scalar(2);
  result.quantity = {value, deviation, is_known ? Provenance::measured : Provenance::assumed};
  return result;
}

}  // namespace internal

/// Fits a release to positions `position_m` (m) at `time_s` (s, strictly increasing), the first of
/// them after it began. Gives values only if the outcome is converged; uses no memory beyond the
/// result.
template <class Scalar>
PassiveRelease<Scalar> fit_passive_release(std::span<const Scalar> time_s,
                                           std::span<const Scalar> position_m,
                                           const ReleaseSettings& settings) {
  using internal::ReleaseHeld;
  using std::sqrt;
  PassiveRelease<Scalar> release;
  release.outcome = internal::check_release_input(time_s, position_m, settings);
  if (release.outcome != ReleaseOutcome::converged) return release;

  const internal::ReleaseSearch<Scalar> search(time_s, position_m, settings.starts_at_rest);
  auto minimum = search.best_of_grid();
  const Scalar negligible_m2 =
      std::numeric_limits<Scalar>::epsilon() * minimum.equations.square_sum();
  minimum = search.descend(minimum, ReleaseHeld::nothing, negligible_m2);
  release.rates = minimum.rates;
  release.rest_m = minimum.equations.linear[0];
  release.start_m = minimum.equations.linear[1];
  release.start_velocity_m_s = minimum.equations.linear[2];
  release.degrees_of_freedom =
      static_cast<int>(time_s.size()) - kReleaseUnknowns + (settings.starts_at_rest ? 1 : 0);
  const Scalar stated_sd_m = Scalar(settings.noise_sd_m);
  internal::check_residuals(time_s, position_m, stated_sd_m, release);
  release.bound =
      release_bound(time_s, release.rates, release.start_m - release.rest_m,
                    release.start_velocity_m_s, release.noise_sd_m, settings.starts_at_rest);
  if (!minimum.has_converged || !release.bound.allFinite()) {
    release.outcome = ReleaseOutcome::not_converged;
    return release;
  }

  const Scalar q = stated_sd_m > Scalar(0)
                       ? Scalar(kNormalQuantile95)
                       : internal::student_half_width(Scalar(release.degrees_of_freedom));
  release.quantile = q;
  const Scalar factor = internal::noise_factor(release, Scalar(time_s.size()));
  const Scalar variance = factor * release.noise_sd_m * release.noise_sd_m;
  const auto later = internal::start_later<Scalar>(time_s, position_m,
                                                   {release.rates, release.rest_m, release.start_m,
                                                    release.start_velocity_m_s, release.noise_sd_m},
                                                   negligible_m2);
  release.later_start_s = later.start_s;
  release.covariance = factor * release.bound;
  const Scalar omega = sqrt(release.rates.kappa);
  const auto deviations = release_deviations(release.covariance, release.rates);
  const auto ends = [&](ReleaseHeld held, Scalar deviation) {
    const Scalar value = held == ReleaseHeld::lambda ? release.rates.lambda
                         : held == ReleaseHeld::zeta ? release.rates.lambda / (Scalar(2) * omega)
                                                     : elementary::log(omega);
    const Scalar apart = held == ReleaseHeld::lambda ? later.lambda
                         : held == ReleaseHeld::zeta ? later.zeta
                                                     : later.log_omega;
    const std::pair own(search.interval_end(minimum, held, Scalar(-1), deviation, variance, q),
                        search.interval_end(minimum, held, Scalar(1), deviation, variance, q));
    return internal::to_double(value, own, q * apart);
  };
  const ReleaseSpread& spread = settings.spread;
  const ReleaseResolution& resolution = settings.resolution;
  const auto [slowest, fastest] = ends(ReleaseHeld::lambda, deviations.damping_rate_per_s);
  if (has_trusted_residuals(release) && fastest < Scalar(0)) {
    release.residuals = ReleaseResiduals::driven;
  }
  const auto [least, most] = ends(ReleaseHeld::zeta, deviations.damping_ratio);
  if (has_trusted_residuals(release) && !settings.is_sudden && !(most < Scalar(1))) {
    release.residuals = ReleaseResiduals::overdamped;
  }
  const auto [w_low, w_high] = ends(ReleaseHeld::omega, deviations.natural_frequency_rad_s / omega);
  const Scalar low = elementary::exp(w_low), high = elementary::exp(w_high);
  constexpr double kTurn = 6.283185307179586;
  const double resolution_rad_s =
      resolution.natural_frequency_fraction * static_cast<double>(omega);
  const auto value = [&](Scalar fitted, Scalar lowest, Scalar highest, double of_spread,
                         double of_resolution) {
    if (!has_trusted_residuals(release)) return ReleaseValue<Scalar>();  // intervals would not hold
    return internal::release_value(fitted, lowest, highest, q, of_spread, of_resolution);
  };
  release.damping_rate_per_s = value(release.rates.lambda, slowest, fastest,
                                     spread.damping_rate_per_s, resolution.damping_rate_per_s);
  release.damping_ratio = value(release.rates.lambda / (Scalar(2) * omega), least, most,
                                spread.damping_ratio, resolution.damping_ratio);
  release.natural_frequency_rad_s =
      value(omega, low, high, spread.natural_frequency_rad_s, resolution_rad_s);
  release.natural_frequency_Hz =
      value(omega / Scalar(kTurn), low / Scalar(kTurn), high / Scalar(kTurn),
            spread.natural_frequency_rad_s / kTurn, resolution_rad_s / kTurn);
  release.stiffness_per_mass_per_s2 =
      value(release.rates.kappa, low * low, high * high, spread.stiffness_per_mass_per_s2,
            resolution.stiffness_fraction * static_cast<double>(release.rates.kappa));
  ReleaseCovariance<Scalar> apart = ReleaseCovariance<Scalar>::Zero();
  apart.col(0) << later.lambda, later.kappa, later.rest_m, 0, 0;
  release.covariance += apart * apart.transpose();
  return release;
}

}  // namespace condyle
