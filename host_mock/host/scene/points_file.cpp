// SPDX-License-Identifier: BSD-3-Clause
#include "scene/points_file.hpp"

#include "base/csv_file.hpp"
#include "base/words.hpp"
#include "scene/json_text.hpp"

#include <cmath>

namespace ilaw::host {
namespace {

std::vector<std::string> columns_of(int dimension) {
  std::vector<std::string> columns{"mass", "area"};
  for (const char* vector : {"x", "v"})
    for (int c = 0; c < dimension; ++c) columns.push_back(vector + std::to_string(c));
  return columns;
}

}  // namespace

std::vector<PointMass> read_points_file(const std::filesystem::path& file, int dimension,
                                        const std::string& pointer) {
  CsvFile table(file);
  if (table.names() != columns_of(dimension))
    throw mistake(pointer, file.string() + " with the columns '" + joined(table.names()) + "'",
                  "a file with the columns " + joined(columns_of(dimension)));
  std::vector<PointMass> points;
  for (std::vector<double> row; table.next(row);) {
    if (table.cells() > row.size())
      throw mistake(pointer,
                    "point " + std::to_string(points.size()) + " of " + file.string() + " with " +
                        std::to_string(table.cells()) + " numbers",
                    std::to_string(row.size()));
    for (const double value : row)
      if (!std::isfinite(value) || !(row[0] > 0.0) || !(row[1] >= 0.0))
        throw mistake(pointer, "point " + std::to_string(points.size()) + " of " + file.string(),
                      "finite numbers, a mass > 0 and an area >= 0");
    const Eigen::Map<const Vector> position(&row[2], dimension), velocity(&row[2] + dimension, dimension);
    points.push_back({row[0], row[1], position, velocity, Vector()});
  }
  if (points.empty()) throw mistake(pointer, file.string() + " without rows", "at least one point");
  return points;
}

}  // namespace ilaw::host
