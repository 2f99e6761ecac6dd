// SPDX-License-Identifier: BSD-3-Clause
#include "scene/values.hpp"

#include "scene/json_text.hpp"

#include <vector>

namespace ilaw::host {

using nlohmann::json;

Vector read_vector(const json& value, int dimension, const std::string& pointer) {
  if (static_cast<int>(value.size()) != dimension)
    throw mistake(pointer, std::to_string(value.size()) + " components",
                  std::to_string(dimension) + ", the dimension of the model");
  Vector vector(dimension);
  for (int i = 0; i < dimension; ++i) vector[i] = value[static_cast<std::size_t>(i)].get<double>();
  return vector;
}

Vector read_vector_or_zero(const json& object, const char* key, int dimension, const std::string& pointer) {
  if (!object.contains(key)) return Vector::Zero(dimension);
  return read_vector(object[key], dimension, pointer + "/" + key);
}

Vector read_direction(const json& value, int dimension, const std::string& pointer) {
  Vector direction = read_vector(value, dimension, pointer);
  const double largest = direction.cwiseAbs().maxCoeff();
  if (largest == 0.0) throw mistake(pointer, "a vector of length 0", "a direction");
  constexpr double square_is_normal = 1e150;  // the square of its length neither overflows nor vanishes
  if (largest < square_is_normal && largest > 1.0 / square_is_normal) return direction;
  throw mistake(pointer, value.dump(), "a direction with a length of 1e-150 to 1e150");
}

namespace {

// A number where one value is wanted.
Vector read_values(const json& value, int width, const std::string& pointer) {
  if (value.is_number() && width == 1) return Vector::Constant(1, value.get<double>());
  if (!value.is_array() || static_cast<int>(value.size()) != width)
    throw mistake(pointer, value.dump(), width == 1 ? "a number" : std::to_string(width) + " numbers");
  return read_vector(value, width, pointer);
}

Table read_sine(const json& sine, int width, const std::string& pointer) {
  const Vector mean =
      sine.contains("mean") ? read_values(sine["mean"], width, pointer + "/mean") : Vector::Zero(width);
  return Table(Sine{mean, read_values(sine["amplitude"], width, pointer + "/amplitude"),
                    sine["frequency"].get<double>(), sine.value("phase", 0.0)});
}

Table read_rows(const json& rows, int width, bool is_smooth, const std::string& pointer) {
  std::vector<double> times;
  std::vector<Vector> values;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (static_cast<int>(rows[k].size()) != width + 1)
      throw mistake(at(pointer, k), std::to_string(rows[k].size()) + " numbers",
                    std::to_string(width + 1) + " (time and values)");
    const double time = rows[k][0].get<double>();
    if (!times.empty() && time <= times.back())
      throw mistake(at(pointer, k), "time " + rows[k][0].dump(), "one after " + rows[k - 1][0].dump());
    times.push_back(time);
    Vector value(width);
    for (int i = 0; i < width; ++i) value[i] = rows[k][static_cast<std::size_t>(i) + 1].get<double>();
    values.push_back(value);
  }
  return {times, values, is_smooth};
}

}  // namespace

Table read_table(const json& table, int width, const std::string& pointer) {
  if (table.is_array()) return read_rows(table, width, false, pointer);
  require_one_of(table, "rows", "sine", "'rows' and 'sine'", pointer);
  if (table.contains("sine")) return read_sine(table["sine"], width, pointer + "/sine");
  return read_rows(table["rows"], width, table.value("smooth", false), pointer + "/rows");
}

Motion read_motion(const json& object, int dimension, const std::string& pointer) {
  if (object.contains("velocity") && object.contains("path"))
    throw mistake(pointer, "both 'velocity' and 'path'", "at most one of them");
  if (object.contains("path")) return Motion(read_table(object["path"], dimension, pointer + "/path"));
  return Motion(read_vector_or_zero(object, "velocity", dimension, pointer));
}

}  // namespace ilaw::host
