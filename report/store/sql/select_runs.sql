-- SPDX-License-Identifier: BSD-3-Clause
SELECT id, name, date, verdict FROM runs WHERE kind = 'calibration' ORDER BY id;
