% SPDX-License-Identifier: Apache-2.0
% Reads a recording, estimates velocity, and plots it with its 95 % interval.
% Run it in the project's folder, after condyle.c is built (see there).
recording = condyle('read', 'host_sim/recordings/chewing_60hz.csv');
printf('%d samples, %s\n', numel(recording.time_s), recording.format);

estimates = condyle('estimate', recording, '--lag=8');
velocity = estimates.velocity_m_s * 1e3;
half = 1.96 * estimates.velocity_sd_m_s * 1e3;
is_measured = estimates.velocity_provenance == 3;
printf('velocity is measured at %d of %d samples\n', sum(is_measured), numel(velocity));

if exist('show_figures', 'var') && show_figures
  plot(estimates.time_s, velocity, 'b', estimates.time_s, velocity - half, 'c', ...
       estimates.time_s, velocity + half, 'c');
  xlabel('time (s)');
  ylabel('velocity (mm/s)');
end
