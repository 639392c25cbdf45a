-- SPDX-License-Identifier: BSD-3-Clause
-- Version 3: runs of the kind "replay". SQLite cannot change a CHECK, so the table is made anew;
-- foreign keys must be off.
CREATE TABLE runs_v3 (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  kind TEXT NOT NULL CHECK (
    kind IN ('calibration', 'trajectory', 'comparison', 'perturbation', 'replay')
  ),
  name TEXT NOT NULL,
  version TEXT NOT NULL,
  command TEXT NOT NULL,
  input TEXT NOT NULL,
  input_hash TEXT NOT NULL,
  date TEXT NOT NULL,
  verdict TEXT NOT NULL CHECK (verdict IN ('good', 'doubtful', 'bad'))
);
INSERT INTO runs_v3 (id, kind, name, version, command, input, input_hash, date, verdict)
SELECT id, kind, name, version, command, input, input_hash, date, verdict FROM runs;
DROP TABLE runs;
ALTER TABLE runs_v3 RENAME TO runs;
