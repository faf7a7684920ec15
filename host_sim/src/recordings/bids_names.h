// SPDX-License-Identifier: Apache-2.0
// Names of BIDS: "sub-01_ses-pre_task-chewing_run-2_motion.tsv".
#pragma once

#include <string>

namespace condyle::host {

/// What the names of a recording's files say; empty: not said.
struct BidsLabels {
  std::string subject, session, task, run;
};

/// The labels in `name`, which may begin with a path and end with an extension. None if it does not
/// begin with "sub-".
BidsLabels bids_labels_in(const std::string& name);

/// Throws an InputError that names `place` if `label`, of a `what`, has other characters than
/// letters and digits.
void check_bids_label(const std::string& place, const char* what, const std::string& label);

}  // namespace condyle::host
