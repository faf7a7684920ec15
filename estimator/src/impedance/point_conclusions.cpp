// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/impedance/point_conclusion.h"

namespace condyle {

template class PointConclusion<double>;
template class PointConclusion<float>;

}  // namespace condyle
