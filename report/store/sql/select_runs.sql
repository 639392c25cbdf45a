-- SPDX-License-Identifier: BSD-3-Clause
SELECT id, kind, name, date, verdict FROM runs ORDER BY id;
