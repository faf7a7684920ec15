% SPDX-License-Identifier: Apache-2.0
% See check_octave. Ends with an error at the first difference.
source = argv(){1};
assert(ischar(condyle('version')));
recording = condyle('read', [source '/host_sim/recordings/chewing_60hz.csv']);
estimates = condyle('estimate', recording, '--lag=8');

% The command's file, bit for bit.
file = fopen('expected.csv');
names = strsplit(fgetl(file), ',');
columns = textscan(file, repmat('%s', 1, numel(names)), 'Delimiter', ',', 'EndOfLine', "\n");
fclose(file);
for i = 1:numel(names)
  name = names{i};
  if strcmp(name, 'events') || ~isempty(strfind(name, '_provenance'))
    continue;
  end
  wanted = str2double(columns{i});
  given = estimates.(name);
  given(isinf(given)) = NaN;
  assert(isequaln(given, wanted), ['other values of ' name]);
end

% Times and positions as arrays, also as rows.
same = condyle('estimate', recording.time_s', recording.position_m, '--lag=8');
assert(isequaln(same.velocity_m_s, estimates.velocity_m_s));

session = condyle('read', 'session.csv');
assert(size(session.position_m, 2) == 9);
axes_of_all = condyle('estimate', session, '--axis=y');
assert(numel(axes_of_all.x_velocity_m_s) == numel(session.time_s));

readings = condyle('analyse', 'session.csv', '--landmarks=session.landmarks.toml');
opening = readings(strcmp({readings.reading}, 'opening_mm') & [readings.stroke] == 0);
assert(opening(1).low < opening(1).value && opening(1).value < opening(1).high);

% Mistakes.
function expect(words, varargin)
  try
    condyle(varargin{:});
  catch problem
    assert(~isempty(regexp(problem.message, words)), ['other words: ' problem.message]);
    return;
  end
  error('no error: %s', words);
end
expect('first argument');
expect('first argument', 'estimat');
expect('path', 'read');
expect('path', 'read', 1);
expect('no_such.csv', 'read', 'no_such.csv');
expect('did you mean --lag', 'estimate', recording, '--lagg=8');
expect('not a text', 'estimate', recording, 8);
expect('one row for each sample', 'estimate', 1:10, (1:9)');
expect('1 column', 'estimate', (1:10)', zeros(10, 2));
expect('real numbers', 'estimate', (1:10)', int8(1:10)');
expect('runs backwards', 'estimate', [0:9 3 4]' / 100, zeros(12, 1));
expect('time_s', 'estimate', struct('a', 1));
disp('the MEX file holds');
