// SPDX-License-Identifier: Apache-2.0
#include "report/html_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "report/html_text.h"

namespace condyle::host {

int digits_for(double half) {
  return half > 0 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(half))), 0, 4) : 2;
}

std::string rounded(double value, int digits) {
  if (!std::isfinite(value)) return {};
  std::string text = fmt::format("{:.{}f}", value, digits);
  if (text[0] == '-' && text.find_first_of("123456789") == std::string::npos) text.erase(0, 1);
  return text;
}

std::string provenance_mark(const char* provenance) {
  return fmt::format("<span class=\"mark {0}\" title=\"{0}\">{1}</span>", provenance,
                     static_cast<char>(std::toupper(provenance[0])));
}

HtmlTable::HtmlTable(const std::string& prefix, const char* name,
                     std::initializer_list<const char*> columns)
    : text_(fmt::format("<div class=\"scroll\" tabindex=\"0\"><table data-csv=\"{}_{}\">\n"
                        "<thead><tr>",
                        prefix, name)) {
  for (const char* const column : columns) {
    text_ += fmt::format("<th scope=\"col\">{}</th>", html_text(column));
  }
  text_ += "</tr></thead>\n<tbody>\n";
}

void HtmlTable::begin_row(const char* kind) {
  text_ += *kind == '\0' ? "<tr>" : fmt::format("<tr class=\"{}\">", kind);
}

void HtmlTable::cell(const std::string& words) {
  text_ += fmt::format("<td>{}</td>", html_text(words));
}

void HtmlTable::number_cell(const std::string& digits) {
  text_ += fmt::format("<td class=\"n v\">{}</td>", html_text(digits));
}

void HtmlTable::html_cell(const std::string& html) {
  text_ += fmt::format("<td>{}</td>", html);
}

void HtmlTable::end_row() {
  text_ += "</tr>\n";
  has_rows_ = true;
}

std::string HtmlTable::html(const char* heading) const {
  if (!has_rows_) return {};
  return fmt::format("<h3>{}</h3>\n{}</tbody></table></div>\n", heading, text_);
}

}  // namespace condyle::host
