% SPDX-License-Identifier: Apache-2.0
% The struct of jaw.mat holds the columns of jaw.csv: the same numbers, to the last bits of a decimal.
load jaw.mat
header = strsplit (fgetl (fopen ("jaw.csv")), ",");
table = dlmread ("jaw.csv", ",", 1, 0);
checked = 0;
function compare (values, table, header, name)
  at = find (strcmp (header, name));
  assert (numel (at), 1, sprintf ("no column %s", name));
  expected = table(:, at);
  there = ! isnan (values);
  assert (any (there), name);
  % A missing value is an empty field, which dlmread gives as 0.
  assert (all (expected(! there) == 0), name);
  assert (values(there), expected(there), -1e-14);
endfunction
compare (recording.time_s, table, header, "time_s");
names = recording.point_names;
for i = 1:numel (names)
  for axis = 1:3
    column = sprintf ("%s_%s_mm", names{i}, "xyz"(axis));
    compare (recording.position_mm(:, 3 * (i - 1) + axis), table, header, column);
    checked++;
  endfor
endfor
for axis = 1:3
  for quantity = {"velocity", "velocity_sd", "acceleration"}
    unit = "mm_s";
    if strcmp (quantity{1}, "acceleration")
      unit = "mm_s_2";
    endif
    values = recording.(sprintf ("estimate_%s_%s", quantity{1}, unit));
    compare (values(:, axis), table, header,
             sprintf ("estimate_%s_%s_%s", quantity{1}, "xyz"(axis), unit));
    checked++;
  endfor
endfor
codes = recording.estimate_velocity_provenance;
assert (all (ismember (codes(:), 0:3)));
assert (all (isnan (recording.estimate_velocity_mm_s(codes == 0))));
assert (recording.meta.provenance_codes, "0 not computed, 1 assumed, 2 derived, 3 measured");
printf ("octave: %d columns of %d samples are the same\n", checked, rows (table));
