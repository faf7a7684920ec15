// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/math/eigen_solvers.h"

namespace condyle {

template double largest_eigenvalue(const Eigen::Matrix<double, 6, 6>&);
template Eigen::Matrix4d closest_rigid_motion(const Eigen::Matrix3d&, const Eigen::Matrix3d&);
template Eigen::Matrix<double, 6, 1> internal::singular_values_of_6_by_6(
    const Eigen::Matrix<double, 6, 6>&);

}  // namespace condyle
