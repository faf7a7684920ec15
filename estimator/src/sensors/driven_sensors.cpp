// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/sensors/cycle_sensor.h"
#include "condyle/estimator/sensors/driven_sensor.h"

// Of the cycle sensor in float there is only a test, which compiles its own instance.
namespace condyle {

template class DrivenSensor<double, 1>;
template class DrivenSensor<double, 3>;
template class DrivenSensor<float, 1>;
template class DrivenSensor<float, 3>;
template class CycleSensor<double, 1>;
template class CycleSensor<double, 3>;

}  // namespace condyle
