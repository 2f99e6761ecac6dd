// status_panel.hpp - the panel of a picture that shows which status the contacts have: a band each
// or, of many, how many have which.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <ostream>
#include <string>
#include <vector>

namespace ilaw::host {

struct StatusRow {
  std::string owner;   // "n3", or "n3.floor" of a node with several interfaces
  std::size_t column;  // of history.csv, from 1
};
using StatusRows = std::vector<StatusRow>;

// The number of rows and columns in which each status occurs.
using StatusCounts = std::map<int, int>;

// The data block of the ruptures that events.csv has of these nodes, which may lie between rows of
// the history. Returns whether there are any.
bool write_ruptures(std::ostream& script, const std::filesystem::path& folder, const StatusRows& rows);

// A band per contact.
void draw_status(std::ostream& script, const StatusRows& rows, const StatusCounts& counts);

// How many contacts have each status, one upon the other, from the data block of this name.
void draw_counts(std::ostream& script, const std::string& block, std::size_t contacts,
                 const StatusCounts& counts);

}  // namespace ilaw::host
