// SPDX-License-Identifier: Apache-2.0
// Compiled with -fno-exceptions -fno-rtti: everything a target without an operating system uses.
#include "condyle/estimator/observability.h"
#include "condyle/estimator/published_cascade.h"
#include "condyle/estimator/recommended_estimator.h"
#include "condyle/firmware/run_loop.h"

template class condyle::PublishedCascade<float>;
template class condyle::PublishedCascade<double>;
template class condyle::RecommendedEstimator<float, 1>;
template class condyle::RecommendedEstimator<double, 1>;
template class condyle::RecommendedEstimator<float, 3>;
template class condyle::RecommendedEstimator<double, 3>;
template class condyle::RecommendedEstimator<float, 1, 0>;  // where memory is short

namespace condyle {
Observability<float> judge(const OperatingPoint<float>& point);
Observability<float> judge(const OperatingPoint<float>& point) {
  return judge_observability(observability_matrix<FullSystem>(point));
}
void run_through(hal::Facebow& facebow, hal::Clock& clock, PublishedCascade<float>& cascade);
void run_through(hal::Facebow& facebow, hal::Clock& clock, PublishedCascade<float>& cascade) {
  firmware::RunCounts counts;
  static_cast<void>(firmware::run(
      facebow, clock, cascade, {}, counts, [](const Sample&, const PublishedEstimate<float>&) {},
      [] { return false; }));
}
}  // namespace condyle
