-- SPDX-License-Identifier: BSD-3-Clause
SELECT name, version, command, input, input_hash, date, verdict FROM runs WHERE id = ?;
