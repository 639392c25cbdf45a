-- SPDX-License-Identifier: BSD-3-Clause
-- Version 2: runs of every kind. `stage` of metrics and parameters names the part of the run that a
-- number belongs to: "camera" and "camera_imu" of a calibration, a case of a perturbation study
-- ("imu-shift +10 ms"), a calibration of a comparison, "sequence/calibration/run" of trajectories.
-- SQLite cannot change a CHECK, so the three tables are made anew; foreign keys must be off.
CREATE TABLE runs_v2 (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  kind TEXT NOT NULL CHECK (kind IN ('calibration', 'trajectory', 'comparison', 'perturbation')),
  name TEXT NOT NULL,
  version TEXT NOT NULL,
  command TEXT NOT NULL,
  input TEXT NOT NULL,
  input_hash TEXT NOT NULL,
  date TEXT NOT NULL,
  verdict TEXT NOT NULL CHECK (verdict IN ('good', 'doubtful', 'bad'))
);
INSERT INTO runs_v2 (id, kind, name, version, command, input, input_hash, date, verdict)
SELECT id, kind, name, version, command, input, input_hash, date, verdict FROM runs;
DROP TABLE runs;
ALTER TABLE runs_v2 RENAME TO runs;
CREATE TABLE metrics_v2 (
  run_id INTEGER NOT NULL REFERENCES runs (id) ON DELETE CASCADE,
  stage TEXT NOT NULL,
  name TEXT NOT NULL,
  unit TEXT NOT NULL,
  value REAL,
  PRIMARY KEY (run_id, stage, name)
);
INSERT INTO metrics_v2 (run_id, stage, name, unit, value)
SELECT run_id, stage, name, unit, value FROM metrics;
DROP TABLE metrics;
ALTER TABLE metrics_v2 RENAME TO metrics;
CREATE TABLE parameters_v2 (
  run_id INTEGER NOT NULL REFERENCES runs (id) ON DELETE CASCADE,
  stage TEXT NOT NULL,
  position INTEGER NOT NULL,
  name TEXT NOT NULL,
  unit TEXT NOT NULL,
  value REAL,
  std REAL,
  resample_std REAL,
  PRIMARY KEY (run_id, stage, position)
);
INSERT INTO parameters_v2 (run_id, stage, position, name, unit, value, std, resample_std)
SELECT run_id, stage, position, name, unit, value, std, resample_std FROM parameters;
DROP TABLE parameters;
ALTER TABLE parameters_v2 RENAME TO parameters;
CREATE INDEX metrics_by_name ON metrics (name, stage);
CREATE INDEX parameters_by_name ON parameters (name, stage);
