// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/hid/report_descriptor.h"

#include <algorithm>

#include "hid/descriptor_item.h"
#include "hid/descriptor_unit.h"

namespace condyle::hal {
namespace {

using namespace descriptor_items;

// Bounds as in Linux (HID_MAX_USAGES, HID_MAX_BUFFER_SIZE and the check of the report size), so
// that what is decoded here is what the kernel delivers.
constexpr std::uint32_t kMaxWidthBits = 256;
constexpr std::uint32_t kMaxCount = 12288;
constexpr std::uint32_t kMaxReportBits = 16384 * 8;

struct GlobalState {
  std::uint32_t usage_page = 0;
  ItemRange logical, physical;
  std::int32_t unit_exponent = 0;
  std::uint32_t unit = 0;
  std::uint32_t report_size = 0, report_count = 0;
  std::optional<std::uint8_t> report_id;
};

struct LocalUsage {
  UsageRange range;
  bool is_extended = false;  // it contains its own page
};

struct LocalState {
  std::vector<LocalUsage> usages;
  std::optional<Item> usage_minimum, usage_maximum;
  int delimiter_depth = 0, delimiter_branch = 0;
};

class Parser {
 public:
  explicit Parser(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  DescriptorResult parse() {
    if (bytes_.size() > kMaxDescriptorSize) {
      item_offset_ = kMaxDescriptorSize;
      fail("the descriptor is longer than " + std::to_string(kMaxDescriptorSize) + " bytes");
    }
    while (!failed_ && next_ < bytes_.size()) read_item();
    item_offset_ = bytes_.size();
    if (!failed_ && depth_ > 0) {
      fail(std::to_string(depth_) + " collection(s) not closed at its end");
    }
    if (failed_) return {std::nullopt, error_};
    if (descriptor_.reports.empty()) {
      note(bytes_.empty() ? "it is empty" : "it describes no reports");
    }
    return {std::move(descriptor_), {}};
  }

 private:
  void fail(std::string reason) {
    if (failed_) return;
    failed_ = true;
    error_ = {item_offset_, std::move(reason)};
  }

  void note(const std::string& text) {
    descriptor_.notes.push_back("byte " + std::to_string(item_offset_) + ": " + text);
  }

  void read_item() {
    item_offset_ = next_;
    const std::uint8_t prefix = bytes_[next_++];
    if (prefix == kLongItem) return skip_long_item();
    Item item;
    item.size = (prefix & 3U) == 3 ? 4 : prefix & 3U;
    item.type = (prefix >> 2U) & 3U;
    item.tag = prefix >> 4U;
    if (bytes_.size() - next_ < item.size) return fail("its last item is cut off");
    for (std::size_t i = 0; i < item.size; ++i) {
      item.value |= std::uint32_t{bytes_[next_++]} << (8 * i);
    }
    switch (item.type) {
      case main_item:
        read_main(item);
        local_ = {};
        break;
      case global_item:
        read_global(item);
        break;
      case local_item:
        read_local(item);
        break;
      default:
        note("an item of reserved type, not read");
    }
  }

  void skip_long_item() {
    if (bytes_.size() - next_ < 2 || bytes_.size() - next_ - 2 < bytes_[next_]) {
      return fail("its last item (a long one) is cut off");
    }
    next_ += std::size_t{2} + bytes_[next_];
    note("a long item, not read");
  }

  void read_global(const Item& item) {
    switch (item.tag) {
      case usage_page_tag:
        if (item.value > 0xFFFF) return fail("the usage page is above 0xFFFF");
        global_.usage_page = item.value;
        return;
      case logical_minimum_tag:
        global_.logical.minimum = item.signed_value();
        return;
      case logical_maximum_tag:
        global_.logical.maximum_item = item;
        return;
      case physical_minimum_tag:
        global_.physical.minimum = item.signed_value();
        return;
      case physical_maximum_tag:
        global_.physical.maximum_item = item;
        return;
      case unit_exponent_tag: {
        // A nibble in two's complement; some devices write whole signed bytes instead.
        const std::int64_t exponent = item.signed_value();
        const bool is_nibble = exponent >= 8 && exponent <= 15;
        if (exponent < -128 || exponent > 127) return fail("the unit exponent is out of range");
        global_.unit_exponent = static_cast<std::int32_t>(is_nibble ? exponent - 16 : exponent);
        return;
      }
      case unit_tag:
        global_.unit = item.value;
        return;
      case report_size_tag:
        if (item.value > kMaxWidthBits) {
          return fail("a report size of " + std::to_string(item.value) + " bits; at most " +
                      std::to_string(kMaxWidthBits) + " are supported");
        }
        global_.report_size = item.value;
        return;
      case report_id_tag:
        if (item.value == 0 || item.value > 255) {
          return fail("report id " + std::to_string(item.value) + "; ids are 1 to 255");
        }
        global_.report_id = static_cast<std::uint8_t>(item.value);
        return;
      case report_count_tag:
        if (item.value > kMaxCount) {
          return fail("a report count of " + std::to_string(item.value) + "; at most " +
                      std::to_string(kMaxCount) + " are supported");
        }
        global_.report_count = item.value;
        return;
      case push_tag:
        stack_.push_back(global_);
        return;
      case pop_tag:
        if (stack_.empty()) return fail("a pop without a push");
        global_ = stack_.back();
        stack_.pop_back();
        return;
      default:
        return fail("an unknown global item, tag " + std::to_string(item.tag));
    }
  }

  UsageRange with_page(std::uint32_t first, std::uint32_t last) const {
    return {global_.usage_page << 16U | (first & 0xFFFFU),
            global_.usage_page << 16U | (last & 0xFFFFU)};
  }

  void read_local(const Item& item) {
    // The device prefers the first of alternatives (HID 1.11, 6.2.2.8).
    const bool is_alternative = local_.delimiter_depth > 0 && local_.delimiter_branch > 0;
    switch (item.tag) {
      case usage_tag:
        if (local_.delimiter_depth > 0 && local_.delimiter_branch++ > 0) return;
        add_usages(item, item);
        return;
      case usage_minimum_tag:
        if (is_alternative) return;
        local_.usage_minimum = item;
        return join_usage_range();
      case usage_maximum_tag:
        if (is_alternative) return;
        local_.usage_maximum = item;
        return join_usage_range();
      case delimiter_tag:
        if (item.value > 1) return fail("a delimiter that neither opens nor closes a set");
        if (item.value == 1 && local_.delimiter_depth > 0) return fail("nested delimiters");
        if (item.value == 0 && local_.delimiter_depth == 0) {
          return fail("a delimiter that closes no set");
        }
        local_.delimiter_depth = item.value == 1 ? 1 : 0;
        local_.delimiter_branch = 0;
        return;
      case designator_index_tag:
      case designator_minimum_tag:
      case designator_maximum_tag:
      case string_index_tag:
      case string_minimum_tag:
      case string_maximum_tag:
        return;  // names of body parts and strings are not decoded
      default:
        note("an unknown local item, tag " + std::to_string(item.tag) + ", not read");
    }
  }

  void join_usage_range() {
    if (!local_.usage_minimum || !local_.usage_maximum) return;
    add_usages(*local_.usage_minimum, *local_.usage_maximum);
    local_.usage_minimum.reset();
    local_.usage_maximum.reset();
  }

  void add_usages(const Item& first, const Item& last) {
    const bool is_extended = first.size == 4 && last.size == 4;
    UsageRange range = with_page(first.value, last.value);
    if (first.size == 4) range.first = first.value;
    if (last.size == 4) range.last = last.value;
    if (range.first >> 16U != range.last >> 16U) {
      return fail("a range of usages that spans usage pages");
    }
    if (range.last < range.first)
      return note("a range of usages that ends before it starts, not read");
    local_.usages.push_back({range, is_extended});
  }

  // The page declared last holds for the short usages before it (HID 1.11, 6.2.2.8), back to those
  // that were declared under it.
  void complete_usages() {
    for (auto usage = local_.usages.rbegin(); usage != local_.usages.rend(); ++usage) {
      if (usage->is_extended) continue;
      if (usage->range.first >> 16U == global_.usage_page) break;
      usage->range = with_page(usage->range.first, usage->range.last);
    }
  }

  void read_main(const Item& item) {
    if (local_.usage_minimum || local_.usage_maximum) note("half of a range of usages, not read");
    if (local_.delimiter_depth > 0) return fail("a set of usages is not closed by its delimiter");
    complete_usages();
    switch (item.tag) {
      case input_tag:
        return add_field(item, ReportDirection::input);
      case output_tag:
        return add_field(item, ReportDirection::output);
      case feature_tag:
        return add_field(item, ReportDirection::feature);
      case collection_tag: {
        constexpr std::uint32_t kApplication = 1;
        if (item.value == kApplication) {
          descriptor_.applications.push_back(local_.usages.empty() ? UsageRange{}
                                                                   : local_.usages.back().range);
        }
        ++depth_;
        return;
      }
      case end_collection_tag:
        if (depth_ == 0) return fail("an end of a collection that was not begun");
        --depth_;
        return;
      default:
        note("an unknown main item, tag " + std::to_string(item.tag) + ", not read");
    }
  }

  DescribedReport& report_of(ReportDirection direction) {
    const auto found = std::find_if(
        descriptor_.reports.begin(), descriptor_.reports.end(), [&](const DescribedReport& report) {
          return report.direction == direction && report.id == global_.report_id;
        });
    if (found != descriptor_.reports.end()) return *found;
    DescribedReport report;
    report.id = global_.report_id;
    report.direction = direction;
    report.size_bits = global_.report_id ? 8 : 0;
    descriptor_.reports.push_back(std::move(report));
    return descriptor_.reports.back();
  }

  bool mixes_numbered(ReportDirection direction) const {
    return std::any_of(descriptor_.reports.begin(), descriptor_.reports.end(),
                       [&](const DescribedReport& report) {
                         return report.direction == direction &&
                                report.id.has_value() != global_.report_id.has_value();
                       });
  }

  void add_field(const Item& item, ReportDirection direction) {
    DescriptorField field;
    field.logical_minimum = global_.logical.minimum;
    field.logical_maximum = global_.logical.maximum();
    if (field.logical_maximum < field.logical_minimum) {
      return fail("the logical range ends (" + std::to_string(field.logical_maximum) +
                  ") before it starts (" + std::to_string(field.logical_minimum) + ")");
    }
    if (mixes_numbered(direction)) {
      return fail(std::string("numbered and unnumbered ") + direction_name(direction) +
                  " reports, which cannot be told apart");
    }
    if (depth_ == 0) note("a field outside any collection");
    DescribedReport& report = report_of(direction);
    const std::uint32_t field_bits = global_.report_size * global_.report_count;
    if (field_bits > kMaxReportBits - report.size_bits) {
      return fail("the report is longer than " + std::to_string(kMaxReportBits / 8) + " bytes");
    }
    field.offset_bits = report.size_bits;
    field.width_bits = global_.report_size;
    field.count = global_.report_count;
    field.flags = item.value;
    const std::int64_t physical_minimum = global_.physical.minimum;
    const std::int64_t physical_maximum = global_.physical.maximum();
    const bool has_physical = physical_minimum != 0 || physical_maximum != 0;
    field.physical_minimum = has_physical ? physical_minimum : field.logical_minimum;
    field.physical_maximum = has_physical ? physical_maximum : field.logical_maximum;
    field.unit.code = global_.unit;
    field.unit.exponent = global_.unit_exponent;
    complete_unit(field);
    for (const LocalUsage& usage : local_.usages) field.usages.push_back(usage.range);
    report.size_bits += field_bits;
    report.fields.push_back(std::move(field));
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t next_ = 0, item_offset_ = 0;
  GlobalState global_;
  std::vector<GlobalState> stack_;
  LocalState local_;
  int depth_ = 0;
  ReportDescriptor descriptor_;
  bool failed_ = false;
  DescriptorError error_;
};

}  // namespace

std::uint32_t DescriptorField::usage_of(std::uint32_t index) const {
  if (usages.empty() || index >= count) return 0;
  for (const UsageRange& range : usages) {
    const std::uint32_t length = range.last - range.first + 1;
    if (index < length) return range.first + index;
    index -= length;
  }
  return usages.back().last;
}

DescriptorResult parse_report_descriptor(std::span<const std::uint8_t> bytes) {
  return Parser(bytes).parse();
}

}  // namespace condyle::hal
