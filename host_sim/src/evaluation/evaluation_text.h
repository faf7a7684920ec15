// SPDX-License-Identifier: Apache-2.0
// The result of an evaluation, as text and table. Quantities that the estimator does not compute
// have no number.
#pragma once

#include <string>

#include "evaluation/estimator_evaluation.h"

namespace condyle::host {

/// Errors, consistency and events for the reader, with units and intervals.
std::string evaluation_text(const Evaluation& evaluation);

/// The errors as CSV: one row for each quantity, with all digits, in the row's unit. An empty field
/// was not computed.
std::string evaluation_csv(const Evaluation& evaluation);

}  // namespace condyle::host
