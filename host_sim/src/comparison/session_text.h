// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "comparison/session_comparison.h"
#include "output/output_file.h"

namespace condyle::host {

/// The comparison of sessions in words; `estimator` is the user's name for it.
std::string session_text(const std::string& estimator, const std::vector<Session>& sessions,
                         const SessionComparison& comparison);

/// One row for each compared quantity and pair of sessions, with all digits.
std::string session_csv(const std::vector<Session>& sessions, const SessionComparison& comparison);

/// Draws "sessions", with one panel for each quantity, into the folder `directory`. None if no
/// quantity is compared.
std::vector<std::unique_ptr<OutputFile>> draw_sessions(const std::string& directory,
                                                       const std::string& estimator,
                                                       const std::vector<Session>& sessions,
                                                       const SessionComparison& comparison);

}  // namespace condyle::host
