// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "readings/reading.h"

namespace condyle::host {
namespace {

constexpr std::string_view kSmoothness =
    "Balasubramanian, Melendez-Calderon, Roby-Brami and Burdet, J. NeuroEng. Rehabil. 12 (2015) "
    "112";
constexpr std::string_view kScatter =
    "limit: scatter in Kordass et al., Int. J. Comput. Dent. 17 (2014) 9-20";

struct Reference {
  std::string_view begins;  // the names of the readings
  std::string_view publication;
};

// The first that fits counts.
constexpr std::array kReferences = std::to_array<Reference>({
    {"sparc", kSmoothness},
    {"closing_sparc", kSmoothness},
    {"ldlj", kSmoothness},
    {"closing_ldlj", kSmoothness},
    {"hinge_axis_", "Ehrig, Taylor, Duda and Heller, J. Biomech. 40 (2007) 2150-2157"},
    {"helical_axis_", "Woltring et al., J. Biomech. 18 (1985) 379-389"},
    {"finite_axes_", "Woltring et al., J. Biomech. 18 (1985) 379-389"},
    {"instantaneous_axis_", "Ancillao et al., PLoS ONE 17 (2022) e0275218"},
    {"kinematic_centre_", "Yatabe, Zwijnenburg, Megens and Naeije, J. Dent. Res. 74 (1995) 1644"},
    {"laterality_index", "interval: Wilson, J. Am. Stat. Assoc. 22 (1927) 209-212"},
    {"condylar_inclination_", "limit: scatter with Cadiax Compact 2, n = 32 (Manchester 2013)"},
    {"condylar_translation_mm", kScatter},
    {"opening_mm", kScatter},
    {"opening_angle_deg", kScatter},
    {"laterotrusion_mm", kScatter},
    {"protrusion_mm", "limit: scatter in Hirsch et al., Eur. J. Oral Sci. 114 (2006) 465"},
});

}  // namespace

std::string_view reference_of(const ReadingDefinition& definition) {
  for (const Reference& reference : kReferences) {
    if (definition.name.starts_with(reference.begins)) return reference.publication;
  }
  return {};
}

}  // namespace condyle::host
