-- SPDX-License-Identifier: BSD-3-Clause
INSERT INTO runs (kind, name, version, command, input, input_hash, date, verdict)
VALUES (?, ?, ?, ?, ?, ?, ?, ?);
