// SPDX-License-Identifier: Apache-2.0
// MAT files where condyle is built without libmatio: on Windows.
#include "hosted/files/input_error.h"
#include "recordings/mat_recording.h"

namespace condyle::host {

std::unique_ptr<NamedPointsRecording> open_mat(const std::string& path, const RecordingOptions&,
                                               bool) {
  throw InputError(path, "is a MAT file, which condyle reads on Linux only",
                   "save the positions as CSV, in MATLAB with writetable");
}

}  // namespace condyle::host
