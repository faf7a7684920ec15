// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/sensors/pose_sensor.h"

namespace condyle {

template class PoseSensor<double>;
template class PoseSensor<float>;

}  // namespace condyle
