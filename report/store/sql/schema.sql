-- SPDX-License-Identifier: BSD-3-Clause
-- Version 2 of the store. A run is its record's document (JSON, the same that a command writes) and
-- its samples (arrays, packed little-endian). What a study asks for are rows of their own: metrics,
-- parameters, findings. `stage` names the part of the run that a number belongs to ("camera" and
-- "camera_imu" of a calibration, a case of a perturbation study, a calibration of a comparison,
-- "sequence/calibration/run" of trajectories, a session of a study); `name` is the field's path within
-- that part.
CREATE TABLE runs (
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
CREATE TABLE documents (
  run_id INTEGER PRIMARY KEY REFERENCES runs (id) ON DELETE CASCADE,
  json TEXT NOT NULL
);
CREATE TABLE arrays (
  run_id INTEGER NOT NULL REFERENCES runs (id) ON DELETE CASCADE,
  name TEXT NOT NULL,
  element TEXT NOT NULL,
  data BLOB NOT NULL,
  PRIMARY KEY (run_id, name)
);
CREATE TABLE options (
  run_id INTEGER NOT NULL REFERENCES runs (id) ON DELETE CASCADE,
  position INTEGER NOT NULL,
  name TEXT NOT NULL,
  value TEXT NOT NULL,
  PRIMARY KEY (run_id, position)
);
CREATE TABLE metrics (
  run_id INTEGER NOT NULL REFERENCES runs (id) ON DELETE CASCADE,
  stage TEXT NOT NULL,
  name TEXT NOT NULL,
  unit TEXT NOT NULL,
  value REAL
);
CREATE TABLE parameters (
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
CREATE TABLE findings (
  run_id INTEGER NOT NULL REFERENCES runs (id) ON DELETE CASCADE,
  position INTEGER NOT NULL,
  rule TEXT NOT NULL,
  level TEXT NOT NULL CHECK (level IN ('good', 'caution', 'bad')),
  evidence TEXT NOT NULL,
  advice TEXT NOT NULL,
  value REAL,
  threshold REAL,
  unit TEXT NOT NULL,
  subject TEXT NOT NULL DEFAULT 'result',
  PRIMARY KEY (run_id, position)
);
CREATE INDEX metrics_by_run ON metrics (run_id, stage, name);
CREATE INDEX metrics_by_name ON metrics (name, stage);
CREATE INDEX parameters_by_name ON parameters (name, stage);
