-- SPDX-License-Identifier: BSD-3-Clause
SELECT kind, name, version, command, input, input_hash, date, verdict FROM runs WHERE id = ?;
