-- SPDX-License-Identifier: BSD-3-Clause
-- Version 1 of a study's history. A figure's row holds for all nights from `first_night` to `last_night`: a
-- night on which nothing changed adds none. Figures without a number are NULL: not known.
CREATE TABLE nights (
  night INTEGER PRIMARY KEY,
  date TEXT NOT NULL,
  version TEXT NOT NULL,
  sessions INTEGER NOT NULL,
  failed INTEGER NOT NULL,
  alarms INTEGER NOT NULL,
  seconds REAL,
  held_out_rmse_px REAL
);
CREATE TABLE figures (
  id INTEGER PRIMARY KEY,
  session TEXT NOT NULL,
  name TEXT NOT NULL,
  unit TEXT NOT NULL,
  inputs_key TEXT NOT NULL,
  version TEXT NOT NULL,
  value REAL,
  command TEXT NOT NULL,
  first_night INTEGER NOT NULL REFERENCES nights (night),
  last_night INTEGER NOT NULL REFERENCES nights (night)
);
CREATE INDEX figures_by_name ON figures (session, name, last_night);
CREATE TABLE steps (
  name TEXT PRIMARY KEY,
  key TEXT NOT NULL,
  status TEXT NOT NULL CHECK (status IN ('done', 'failed', 'lost', 'changed')),
  message TEXT NOT NULL,
  command TEXT NOT NULL,
  seconds REAL NOT NULL,
  peak_mb REAL NOT NULL,
  night INTEGER NOT NULL REFERENCES nights (night)
);
CREATE TABLE alarms (
  id INTEGER PRIMARY KEY,
  night INTEGER NOT NULL REFERENCES nights (night),
  session TEXT NOT NULL,
  name TEXT NOT NULL,
  kind TEXT NOT NULL CHECK (kind IN ('deterministic', 'median', 'cusum')),
  first_night INTEGER NOT NULL REFERENCES nights (night),
  was REAL,
  now REAL,
  command TEXT NOT NULL
);
CREATE TABLE accepted (
  id INTEGER PRIMARY KEY,
  night INTEGER NOT NULL REFERENCES nights (night),
  session TEXT NOT NULL,
  name TEXT NOT NULL,
  note TEXT NOT NULL,
  date TEXT NOT NULL
);
