-- SPDX-License-Identifier: BSD-3-Clause
-- From version 1 to 2: a run may be a study, and a finding says what it is about.
CREATE TABLE runs_2 (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  kind TEXT NOT NULL CHECK (
    kind IN ('calibration', 'trajectory', 'comparison', 'perturbation', 'replay', 'study')
  ),
  name TEXT NOT NULL,
  version TEXT NOT NULL,
  command TEXT NOT NULL,
  input TEXT NOT NULL,
  input_hash TEXT NOT NULL,
  date TEXT NOT NULL,
  verdict TEXT NOT NULL CHECK (verdict IN ('good', 'caution', 'bad'))
);
INSERT INTO runs_2 SELECT id, kind, name, version, command, input, input_hash, date, verdict FROM runs;
DROP TABLE runs;
ALTER TABLE runs_2 RENAME TO runs;
ALTER TABLE findings ADD COLUMN subject TEXT NOT NULL DEFAULT 'result';
