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
      {"yaw_angle_deg", "deg",
       "greatest rotation about the vertical axis to that side (twist of swing and twist)", 3, true,
       true},
      {"condylar_path_mm", "mm",
       "length of the outward path of the condyle, from 0.3 mm of sagittal travel to the greatest "
       "sagittal travel, by chords of 0.5 mm",
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
      {"working_shift_angle_deg", "deg",
       "atan2(x, y outward) of the working condyle there; backward negative", 10, true, true},
      {"condylar_translation_difference_mm", "mm", "condylar translation, left minus right", 3,
       true, false},
      {"condylar_peak_speed_mm_s", "mm/s", "greatest 3-D speed of the condyle on the way out", 15,
       true, false},
      {"condylar_separation_mm", "mm",
       "mean distance of the condyle's ways out and back in the sagittal plane, at equal travel "
       "from 0.2 to 0.9 of the greatest",
       0.5, true, true},
      {"condylar_crossing_count", "1",
       "how often those ways change sides, where their distance exceeds its interval; smaller "
       "crossings are not seen",
       0, true, true},
      {"rotation_per_translation_deg_mm", "deg/mm",
       "rotation about the left-right axis over the sagittal travel of the condyle, from 0.2 to "
       "0.8 of its "
       "greatest on the way out",
       0.5, true, true},
      {"fischer_angle_5mm_deg", "deg",
       "condylar inclination at 5 mm, mediotrusion minus "
       "protrusion",
       10, true, true},
      {"opening_peak_speed_mm_s", "mm/s", "greatest 3-D speed of the lower incisor on the way out",
       15, false, false},
      {"closing_peak_speed_mm_s", "mm/s", "greatest 3-D speed of the lower incisor on the way back",
       15, false, false},
      {"sparc", "1",
       "spectral arc length of the incisor's 3-D speed on the way out, to 10 Hz, amplitude "
       "threshold 0.05, zero padding to 16 times the next power of two (Balasubramanian et al. "
       "2015); in a stroke from the first to the last time "
       "the speed is above 5 % of its peak; what is separated by a stop needs 20 %",
       0.3, false, false},
      {"closing_sparc", "1", "as sparc, on the way back", 0.3, false, false},
      {"ldlj", "1",
       "log dimensionless jerk of the incisor's 3-D speed on the way out (Balasubramanian et al. "
       "2015); of the same part as sparc",
       0.6, false, false},
      {"closing_ldlj", "1", "as ldlj, on the way back", 0.6, false, false},
      {"cycle_count", "1", "complete chewing cycles", 0, false, false},
      {"cycle_duration_s", "s", "mean time from the most closed instant to the next", 0.1, false,
       false},
      {"cycle_duration_sd_s", "s",
       "standard deviation of the cycles' durations, without that of "
       "their measurement, at least 0",
       0.1, false, false},
      {"cycle_duration_cv_percent", "%", "cycle_duration_sd_s over the mean duration", 10, false,
       false},
      {"cycle_duration_change_s", "s",
       "mean duration of the last third of the cycles minus that of the first", 0.2, false, false},
      {"closing_peak_speed_sd_mm_s", "mm/s",
       "standard deviation of the cycles' closing peak speeds, without that of their measurement, "
       "at least 0",
       15, false, false},
      {"closing_peak_speed_cv_percent", "%",
       "closing_peak_speed_sd_mm_s over the mean closing peak speed", 10, false, false},
      {"closing_peak_speed_change_mm_s", "mm/s",
       "mean closing peak speed of the last third of the cycles minus that of the first", 30, false,
       false},
      {"cycle_frequency_Hz", "Hz", "1 over the mean duration", 0.2, false, false},
      {"cycle_height_mm", "mm", "mean vertical range of the lower incisor in a cycle", 2, false,
       true},
      {"cycle_width_mm", "mm", "mean sideways range of the lower incisor in a cycle", 2, false,
       true},
      {"cycle_depth_mm", "mm", "mean anterior range of the lower incisor in a cycle", 2, false,
       true},
      {"cycle_height_sd_mm", "mm",
       "standard deviation of the cycles' heights, without that of their measurement, at least 0",
       2, false, true},
      {"cycle_height_cv_percent", "%", "cycle_height_sd_mm over the mean height", 10, false, true},
      {"cycle_height_change_mm", "mm",
       "mean height of the last third of the cycles minus that of the first", 4, false, true},
      {"cycle_width_sd_mm", "mm",
       "standard deviation of the cycles' widths, without that of their measurement, at least 0", 2,
       false, true},
      {"cycle_width_cv_percent", "%", "cycle_width_sd_mm over the mean width", 20, false, true},
      {"cycle_width_change_mm", "mm",
       "mean width of the last third of the cycles minus that of the first", 4, false, true},
      {"cycle_path_mm", "mm", "mean length of the lower incisor's path in a cycle", 5, false,
       false},
      {"opening_peak_vertical_speed_mm_s", "mm/s",
       "greatest speed of the lower incisor downward, perpendicular to the reference plane", 15,
       false, true},
      {"closing_peak_vertical_speed_mm_s", "mm/s",
       "greatest speed of the lower incisor upward, perpendicular to the reference plane", 15,
       false, true},
      {"closing_angle_deg", "deg",
       "steepness of the closing path in the frontal plane between 20 % and 80 % of its height; "
       "vertical is 90 deg",
       10, false, true},
      {"cycle_frontal_area_mm2", "mm2",
       "size of the area that the incisor's loop encloses in the frontal plane; parts that turn "
       "the other way count negative",
       20, false, true},
      {"cycle_sagittal_area_mm2", "mm2", "the same in the sagittal plane", 20, false, true},
      {"side_cycle_count", "1",
       "cycles on that side: stated with the task, or the closing path from 20 % to 80 % of its "
       "height lies on average max(1 mm, 2 sd) or more to it",
       2, false, true},
      {"midline_cycle_count", "1", "cycles to neither side", 2, false, true},
      {"reversed_loop_count", "1",
       "cycles to one side whose closing path lies nearer to the midline than the opening path", 2,
       false, true},
      {"laterality_index", "1",
       "(R - L) / (R + L), R and L the cycles on each side; Wilson's interval", 0.5, false, true},
      {"occlusal_time_s", "s",
       "mean time within 0.5 mm of the most closed position at the end of a cycle", 0.1, false,
       false},
      {"slow_close_time_s", "s",
       "mean time from when the vertical closing speed first falls below half of its peak to "
       "closed",
       0.1, false, false},
      {"opening_time_s", "s", "mean time from closed to the greatest opening", 0.1, false, false},
      {"closing_time_s", "s", "mean time from the greatest opening to closed", 0.1, false, false},
      {"hinge_axis_x_mm", "mm",
       "where the least-squares axis of the arc from 1 to 12 deg crosses the "
       "midsagittal plane, forward of the condylar axis",
       3, true, true},
      {"hinge_axis_z_mm", "mm", "the same, above the condylar axis", 3, true, true},
      {"helical_axis_x_mm", "mm",
       "where the finite helical axis from the reference to the greatest "
       "rotation crosses the midsagittal plane, forward",
       5, true, true},
      {"helical_axis_z_mm", "mm", "the same, above the condylar axis", 5, true, true},
      {"kinematic_centre_x_mm", "mm",
       "where the jaw's point whose ways out of opening and protrusion coincide best lies forward "
       "of "
       "the condylar point, mean over pairs of strokes, Student's interval (Yatabe et al. 1995)",
       3, true, true},
      {"kinematic_centre_z_mm", "mm", "the same, above the condylar point", 3, true, true},
      {"finite_axes_x_mm", "mm",
       "mean of where the finite helical axes of four steps of equal rotation, from the reference "
       "to the greatest opening angle, cross the midsagittal plane, forward",
       5, true, true},
      {"finite_axes_z_mm", "mm", "the same, above the condylar axis", 5, true, true},
      {"finite_axes_spread_mm", "mm", "root of the mean squared distance from that mean", 5, true,
       true},
      {"instantaneous_axis_x_mm", "mm",
       "mean of where the instantaneous axes of the way out cross the midsagittal plane, forward, "
       "weighted with the rate of turning, above half of its peak",
       5, true, true},
      {"instantaneous_axis_z_mm", "mm", "the same, above the condylar axis", 5, true, true},
      {"instantaneous_axis_spread_mm", "mm", "root of the mean squared distance from that mean", 5,
       true, true},
      {"border_area_sagittal_mm2", "mm2", "convex hull of the incisor's path in the sagittal plane",
       80, false, true},
      {"border_area_frontal_mm2", "mm2", "convex hull of the incisor's path in the frontal plane",
       80, false, true},
      {"border_area_horizontal_mm2", "mm2",
       "convex hull of the incisor's path in the horizontal plane", 80, false, true},
      {"border_loop_sagittal_mm2", "mm2",
       "greatest area that one excursion of the incisor's path encloses in the sagittal plane "
       "(shoelace formula), from 1 mm off the reference position to the next return; parts that "
       "turn the other way count negative",
       80, false, true},
      {"border_loop_frontal_mm2", "mm2", "the same in the frontal plane", 80, false, true},
      {"border_loop_horizontal_mm2", "mm2", "the same in the horizontal plane", 80, false, true},
      {"border_volume_mm3", "mm3", "volume of the convex hull of the incisor's path", 500, false,
       true},
  };
  return all;
}

}  // namespace condyle::host
