// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "comparison/session_comparison.h"
#include "output/output_file.h"

namespace condyle::host {

/// The comparison of sessions in words; `estimator` is what the user calls it.
std::string session_text(const std::string& estimator, const std::vector<Session>& sessions,
                         const SessionComparison& comparison);

/// A row per quantity that is compared and pair of sessions, with all digits.
std::string session_csv(const std::vector<Session>& sessions, const SessionComparison& comparison);

/// Draws "sessions", a panel a quantity, into the folder `directory`. None if nothing is
/// compared.
std::vector<std::unique_ptr<OutputFile>> draw_sessions(const std::string& directory,
                                                       const std::string& estimator,
                                                       const std::vector<Session>& sessions,
                                                       const SessionComparison& comparison);

}  // namespace condyle::host
