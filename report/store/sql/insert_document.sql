-- SPDX-License-Identifier: BSD-3-Clause
INSERT INTO documents (run_id, name, json) VALUES (?, ?, ?);
