// SPDX-License-Identifier: Apache-2.0
// The list of readings. Distances are displacements from the reference position in the head frame:
// X anterior, Y left, Z superior (reading_geometry.h).
#include "readings/reading.h"

namespace condyle::host {

const std::vector<ReadingDefinition>& reading_definitions() {
  static const std::vector<ReadingDefinition> all = {
      {"displacement_mm", "mm",
       "greatest displacement of the lower incisor (of point 1 without "
       "landmarks) in a stroke, or in a task without strokes",
       2, false, false},
      {"rotation_deg", "deg",
       "greatest rotation from the reference position in a stroke, or in a "
       "task without strokes",
       3, true, false},
      {"opening_mm", "mm", "greatest displacement of the lower incisor", 2, false, false},
      {"opening_vertical_mm", "mm",
       "greatest displacement of the lower incisor downward, "
       "perpendicular to the reference plane",
       2, false, true},
      {"opening_angle_deg", "deg",
       "greatest rotation about the left-right axis (twist of swing and "
       "twist)",
       3, true, true},
      {"opening_deflection_mm", "mm",
       "sideways displacement of the lower incisor at the greatest "
       "opening, left positive",
       1.5, false, true},
      {"opening_deviation_mm", "mm",
       "greatest sideways distance of the lower incisor's opening "
       "path from its chord, left positive",
       1.5, false, true},
      {"protrusion_mm", "mm", "greatest displacement of the lower incisor forward", 2, false, true},
      {"laterotrusion_mm", "mm", "greatest displacement of the lower incisor to that side", 2,
       false, true},
      {"condylar_path_mm", "mm",
       "length of the outward path of the condyle, from 0.3 mm of travel "
       "to the greatest travel, by chords of 0.5 mm",
       3, true, false},
      {"condylar_translation_mm", "mm", "greatest displacement of the condyle", 3, true, false},
      {"condylar_path_difference_mm", "mm", "condylar path, left minus right", 3, true, false},
      {"condylar_inclination_3mm_deg", "deg",
       "atan2(-z, x) of the condyle where its sagittal "
       "travel first reaches 3 mm, downward positive",
       10, true, true},
      {"condylar_inclination_5mm_deg", "deg",
       "atan2(-z, x) of the condyle where its sagittal "
       "travel first reaches 5 mm, downward positive",
       10, true, true},
      {"condylar_inclination_10mm_deg", "deg",
       "atan2(-z, x) of the condyle where its sagittal "
       "travel first reaches 10 mm, downward positive",
       10, true, true},
      {"bennett_angle_3mm_deg", "deg",
       "atan2(y medial, x) of the orbiting condyle where its "
       "sagittal travel first reaches 3 mm",
       10, true, true},
      {"bennett_angle_5mm_deg", "deg",
       "atan2(y medial, x) of the orbiting condyle where its "
       "sagittal travel first reaches 5 mm",
       10, true, true},
      {"bennett_angle_10mm_deg", "deg",
       "atan2(y medial, x) of the orbiting condyle where its "
       "sagittal travel first reaches 10 mm",
       10, true, true},
      {"side_shift_mm", "mm",
       "intercept a of y medial = a + x tan b of the orbiting condyle, "
       "2 <= x <= 5 mm",
       0.5, true, true},
      {"side_shift_05mm_mm", "mm", "y medial of the orbiting condyle where x first reaches 0.5 mm",
       0.5, true, true},
      {"progressive_side_shift_deg", "deg",
       "b of y medial = a + x tan b of the orbiting condyle, "
       "2 <= x <= 5 mm",
       10, true, true},
      {"working_shift_mm", "mm",
       "outward displacement of the working condyle at the greatest "
       "laterotrusion",
       1.5, true, true},
      {"fischer_angle_5mm_deg", "deg",
       "condylar inclination at 5 mm, mediotrusion minus "
       "protrusion",
       10, true, true},
      {"opening_peak_speed_mm_s", "mm/s", "greatest 3-D speed of the lower incisor on the way out",
       15, false, false},
      {"closing_peak_speed_mm_s", "mm/s", "greatest 3-D speed of the lower incisor on the way back",
       15, false, false},
      {"sparc", "1",
       "spectral arc length of the incisor's 3-D speed on the way out, to 10 Hz, "
       "amplitude threshold 0.05 (Balasubramanian et al. 2015)",
       0.3, false, false},
      {"closing_sparc", "1", "as sparc, on the way back", 0.3, false, false},
      {"ldlj", "1",
       "log dimensionless jerk of the incisor's 3-D speed on the way out "
       "(Balasubramanian et al. 2015)",
       0.6, false, false},
      {"closing_ldlj", "1", "as ldlj, on the way back", 0.6, false, false},
      {"cycle_count", "1", "complete chewing cycles", 0, false, false},
      {"cycle_duration_s", "s", "mean time from the most closed instant to the next", 0.1, false,
       false},
      {"cycle_duration_sd_s", "s",
       "standard deviation of the cycles' durations, without that of "
       "their measurement",
       0.1, false, false},
      {"cycle_frequency_Hz", "Hz", "1 over the mean duration", 0.2, false, false},
      {"cycle_height_mm", "mm", "mean vertical range of the lower incisor in a cycle", 2, false,
       true},
      {"cycle_width_mm", "mm", "mean sideways range of the lower incisor in a cycle", 2, false,
       true},
      {"cycle_depth_mm", "mm", "mean anterior range of the lower incisor in a cycle", 2, false,
       true},
      {"opening_time_s", "s", "mean time from closed to the greatest opening", 0.1, false, false},
      {"closing_time_s", "s", "mean time from the greatest opening to closed", 0.1, false, false},
      {"hinge_axis_x_mm", "mm",
       "where the least-squares axis of this opening arc crosses the "
       "midsagittal plane, forward of the condylar axis",
       3, true, true},
      {"hinge_axis_z_mm", "mm", "the same, above the condylar axis", 3, true, true},
      {"helical_axis_x_mm", "mm",
       "where the finite helical axis from the reference to the greatest "
       "rotation crosses the midsagittal plane, forward",
       5, true, true},
      {"helical_axis_z_mm", "mm", "the same, above the condylar axis", 5, true, true},
      {"border_area_sagittal_mm2", "mm2", "convex hull of the incisor's path in the sagittal plane",
       80, false, true},
      {"border_area_frontal_mm2", "mm2", "convex hull of the incisor's path in the frontal plane",
       80, false, true},
      {"border_area_horizontal_mm2", "mm2",
       "convex hull of the incisor's path in the horizontal plane", 80, false, true},
  };
  return all;
}

}  // namespace condyle::host
