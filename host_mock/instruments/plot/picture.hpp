// picture.hpp - the picture of a history, drawn by gnuplot.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace ilaw::host {

struct Caption {
  std::string title;
  int every;                             // steps per row; 0 when it is not known
  std::vector<std::string> panels = {};  // to draw, by name and in this order; empty: all
};

// The columns of history.csv.
struct Columns {
  std::vector<std::string> names;
  std::vector<bool> all_zero;   // per column
  std::map<int, int> statuses;  // of those that occur, in how many rows and columns
};

// Draws folder/history.csv as history.png and .svg in pictures: panels over a common time
// for gap, displacement, velocity, impulse and its running sum, each state variable of the laws, as
// far as these are not zero throughout, resultants, energies, and the status as a band per node. Of
// more than six nodes their least, median and largest values are drawn, and how many have which
// status. Both folders are absolute. Says on stderr why it failed.
bool draw_picture(const std::filesystem::path& folder, const std::filesystem::path& pictures,
                  const Columns& columns, const Caption& caption);

// The panels of such a picture from top to bottom, by the names on their left.
std::vector<std::string> panel_names(const Columns& columns, int every);

}  // namespace ilaw::host
