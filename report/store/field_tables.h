// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace plumbline {

/// docs/records.md: the tables of all documents and arrays, from the field lists.
std::string fieldTables();

}  // namespace plumbline
