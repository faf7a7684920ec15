// SPDX-License-Identifier: Apache-2.0
// MAT files where condyle is built without libmatio.
#include "exports/export_format.h"
#include "hosted/files/input_error.h"

namespace condyle::host {

Exported export_mat(const ExportData&, const TableForm&, const std::string& out) {
  throw InputError(out, "would be a MAT file, and this condyle was built without libmatio",
                   "write CSV, which MATLAB reads with readtable: --format wide, or build condyle "
                   "where the package libmatio-dev is installed");
}

}  // namespace condyle::host
