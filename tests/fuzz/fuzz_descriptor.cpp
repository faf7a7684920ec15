// SPDX-License-Identifier: Apache-2.0
// Any bytes as a report descriptor: its fields fill its reports, or it is refused with a reason.
#include <algorithm>
#include <cstdlib>

#include "condyle/hal/hid/report_descriptor.h"
#include "inspect/descriptor_text.h"

namespace {

// Whether the usage of the field's last value is one of those declared. Zero may be declared too.
bool lists_last_usage(const condyle::hal::DescriptorField& field) {
  const std::uint32_t usage = field.usage_of(field.count - 1);
  return std::any_of(field.usages.begin(), field.usages.end(), [&](const auto& range) {
    return range.first <= usage && usage <= range.last;
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto result = condyle::hal::parse_report_descriptor({data, size});
  if (!result.descriptor) {
    if (result.error.reason.empty() || result.error.byte_offset > size) std::abort();
    return 0;
  }
  for (const auto& report : result.descriptor->reports) {
    std::uint32_t next = report.id ? 8 : 0;
    for (const auto& field : report.fields) {
      if (field.offset_bits != next) std::abort();
      next += field.width_bits * field.count;
      if (field.count > 0 && !field.usages.empty() && !lists_last_usage(field)) std::abort();
    }
    if (report.size_bits != next) std::abort();
  }
  condyle::host::descriptor_text(*result.descriptor);
  condyle::host::descriptor_json(*result.descriptor);
  return 0;
}
