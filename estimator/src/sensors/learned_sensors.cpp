// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/sensors/learned_sensor.h"

namespace condyle {

template class LearnedSensor<RecommendedSensor<double, 1>, double, 1, 16, kMostKernels>;
template class LearnedSensor<RecommendedSensor<double, 3>, double, 3, 16, kMostKernels>;
template class LearnedSensor<DrivenSensor<double, 1>, double, 1, 16, kMostKernels>;
template class LearnedSensor<DrivenSensor<double, 3>, double, 3, 16, kMostKernels>;
template class LearnedSensor<RecommendedSensor<float, 1>, float, 1, 16, kMostKernels>;
template class LearnedSensor<RecommendedSensor<float, 3>, float, 3, 16, kMostKernels>;
template class LearnedSensor<DrivenSensor<float, 1>, float, 1, 16, kMostKernels>;
template class LearnedSensor<DrivenSensor<float, 3>, float, 3, 16, kMostKernels>;

}  // namespace condyle
