// SPDX-License-Identifier: Apache-2.0
#include "report/impedance_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "output/impedance_text.h"
#include "report/html_table.h"
#include "report/html_text.h"

namespace condyle::host {
namespace {

struct Shown {
  const char *name, *unit;
  const IdentifiedValue<double>& value;
  ImpedancePrior prior;
};

// Ends of a 95 % interval.
struct Ends {
  double low, high;
};

Ends interval(double value, double sd) {
  return {value - kNormalQuantile95 * sd, value + kNormalQuantile95 * sd};
}

bool is_measured(const IdentifiedValue<double>& value) {
  return value.limit == ImpedanceLimit::none && value.quantity.provenance == Provenance::measured;
}

std::string bar(const char* kind, double x_low, double x_high, double y) {
  return fmt::format(
      "<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"12\"/>", kind, x_low,
      y, std::max(x_high - x_low, 1.5));
}

// The prior above, the measured interval below, on one axis.
std::string ruler(const Shown& shown) {
  constexpr double kLeft = 92, kWidth = 420;
  const Ends prior = interval(shown.prior.mean, shown.prior.sd);
  const auto& quantity = shown.value.quantity;
  const bool measured = is_measured(shown.value);
  const Ends now = interval(quantity.value, quantity.standard_deviation);
  double low = std::min(0.0, prior.low), high = std::max(0.0, prior.high);
  if (measured) {
    low = std::min(low, now.low);
    high = std::max(high, now.high);
  }
  const auto x = [&](double value) { return kLeft + kWidth * (value - low) / (high - low); };
  std::string text = fmt::format(
      "<svg class=\"ruler\" role=\"img\" aria-label=\"{} ({})\" viewBox=\"0 0 {:.0f} 74\">",
      shown.name, shown.unit, kLeft + kWidth + 20);
  text += fmt::format(
      "<text x=\"0\" y=\"16\">A assumed</text>{}<line class=\"mean\" x1=\"{:.1f}\" x2=\"{:.1f}\" "
      "y1=\"4\" y2=\"20\"/>",
      bar("prior", x(prior.low), x(prior.high), 6), x(shown.prior.mean), x(shown.prior.mean));
  if (measured) {
    text += fmt::format(
        "<text x=\"0\" y=\"40\">M measured</text>{}<line class=\"mean\" x1=\"{:.1f}\" "
        "x2=\"{:.1f}\" y1=\"26\" y2=\"46\"/>",
        bar("known", x(now.low), x(now.high), 30), x(quantity.value), x(quantity.value));
  } else {
    text += fmt::format("<text x=\"0\" y=\"40\">W withheld</text>");
  }
  text += fmt::format("<line class=\"axis\" x1=\"{:.0f}\" x2=\"{:.0f}\" y1=\"54\" y2=\"54\"/>",
                      kLeft, kLeft + kWidth);
  const double step = std::pow(10, std::floor(std::log10((high - low) / 2)));
  const double tick = (high - low) / step > 8 ? 5 * step : step;
  for (double value = std::ceil(low / tick) * tick; value <= high; value += tick) {
    text += fmt::format("<text x=\"{:.1f}\" y=\"68\" text-anchor=\"middle\">{:.4g}</text>",
                        x(value), std::abs(value) < 1e-9 * tick ? 0.0 : value);
  }
  return text + "</svg>";
}

// "friction would be negative; ..." from ": friction would be negative; ...".
std::string reason_of(const IdentifiedValue<double>& value) {
  const std::string text = limit_text(value);
  return text.starts_with(": ") ? text.substr(2) : text;
}

}  // namespace

std::string impedance_html(const ReportSection& section, const std::string& prefix) {
  if (!section.impedance) return {};
  const ImpedanceEstimate<double>& found = *section.impedance;
  const ImpedanceParameters& parameters = section.impedance_parameters;
  std::vector<Shown> all = {{"friction", "N s/m", found.friction_Ns_m, parameters.friction_Ns_m},
                            {"mass", "kg", found.mass_kg, parameters.mass_kg},
                            {"stiffness", "N/m", found.stiffness_N_m, parameters.stiffness_N_m},
                            {"offset", "N", found.offset_N, parameters.offset_N}};
  if (parameters.coulomb_N.sd > 0) {
    all.push_back({"Coulomb friction", "N", found.coulomb_N, parameters.coulomb_N});
  }
  HtmlTable table(prefix, "friction_and_mass",
                  {"quantity", "value", "low", "high", "unit", "provenance", "assumed before",
                   "assumed low", "assumed high", "why it is withheld, and what to record"});
  std::string rulers;
  for (const Shown& shown : all) {
    const bool measured = is_measured(shown.value);
    const auto& quantity = shown.value.quantity;
    const Ends now = interval(quantity.value, quantity.standard_deviation);
    const Ends prior = interval(shown.prior.mean, shown.prior.sd);
    const int digits = digits_for(kNormalQuantile95 * quantity.standard_deviation);
    const int prior_digits = digits_for(kNormalQuantile95 * shown.prior.sd);
    const char* const provenance = measured ? "measured" : "withheld";
    table.begin_row(provenance);
    table.cell(shown.name);
    table.number_cell(measured ? rounded(quantity.value, digits) : "");
    table.number_cell(measured ? rounded(now.low, digits) : "");
    table.number_cell(measured ? rounded(now.high, digits) : "");
    table.cell(shown.unit);
    table.html_cell(provenance_mark(provenance));
    table.number_cell(rounded(shown.prior.mean, prior_digits));
    table.number_cell(rounded(prior.low, prior_digits));
    table.number_cell(rounded(prior.high, prior_digits));
    table.cell(measured ? "" : reason_of(shown.value));
    table.end_row();
    rulers += fmt::format("<figure>{}<figcaption>{} ({})</figcaption></figure>\n", ruler(shown),
                          html_text(shown.name), html_text(shown.unit));
  }
  return table.html("Friction and mass, from the drive") +
         "<p>Friction is the effective damping along the followed axis, of joint, muscle and "
         "tissue "
         "together. Hollow: what was assumed before the recording. Solid: what the drive "
         "measured. Both are 95 % intervals.</p>\n<div class=\"row rulers\">" +
         rulers + "</div>\n";
}

}  // namespace condyle::host
