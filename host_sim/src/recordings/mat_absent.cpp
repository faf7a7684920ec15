// SPDX-License-Identifier: Apache-2.0
// MAT files where condyle is built without libmatio.
#include "hosted/files/input_error.h"
#include "recordings/mat_recording.h"

namespace condyle::host {

std::unique_ptr<NamedPointsRecording> open_mat(const std::string& path, const RecordingOptions&,
                                               bool) {
  throw InputError(path, "is a MAT file, and this condyle was built without libmatio",
                   "save the positions as CSV, in MATLAB with writetable, or build condyle where "
                   "the package libmatio-dev is installed");
}

}  // namespace condyle::host
