// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/sensors/published_sensor.h"
#include "condyle/estimator/sensors/recommended_sensor.h"

namespace condyle {

template class PublishedSensor<double>;
template class PublishedSensor<float>;
template class RecommendedSensor<double, 1>;
template class RecommendedSensor<double, 3>;
template class RecommendedSensor<float, 1>;
template class RecommendedSensor<float, 3>;

}  // namespace condyle
