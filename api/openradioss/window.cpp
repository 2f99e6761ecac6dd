// Lines of a window, and the step of its nodes; see window.hpp.
// SPDX-License-Identifier: BSD-3-Clause
#include "window.hpp"

#include <ilaw/arrays.hpp>

#include <algorithm>
#include <cmath>
#include <locale>
#include <set>
#include <sstream>
#include <stdexcept>
#include <unordered_map>

namespace ilaw::openradioss {
namespace {

using shapes::vector;

[[noreturn]] void refuse(const std::string& what, const std::string& found, const std::string& expected) {
  throw std::runtime_error(what + ": found " + found + ", expected " + expected);
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

double number_of(const std::string& word, const std::string& line) {
  std::istringstream digits(word);
  digits.imbue(std::locale::classic());  // a decimal point in every country
  double value = 0.0;
  if (!(digits >> value) || !digits.eof() || !std::isfinite(value))
    refuse("'" + line + "'", "'" + word + "'", "a number");
  return value;
}

int node_of(const std::string& word, const std::string& line) {
  const double value = number_of(word, line);
  if (value < 1.0 || value > 2147483647.0 || value != std::floor(value))
    refuse("'" + line + "'", "'" + word + "'", "the number of a node");
  return static_cast<int>(value);
}

// "1 to 25 31", after the first word.
void add_nodes(const std::vector<std::string>& words, const std::string& line, std::vector<int>& nodes) {
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (words[i] != "to") {
      nodes.push_back(node_of(words[i], line));
      continue;
    }
    if (i == 1 || i + 1 == words.size()) refuse("'" + line + "'", "'to'", "a node before and after it");
    const int last = node_of(words[++i], line);
    while (nodes.back() < last) nodes.push_back(nodes.back() + 1);
  }
}

Shape shape_of(const std::vector<std::string>& words, const std::string& line) {
  Shape shape{words[0]};
  const bool has_axis = shape.kind != "sphere", has_radius = shape.kind != "plane";
  const std::size_t count = 3 + (has_axis ? 3 : 0) + (has_radius ? 1 : 0);
  if (words.size() != 1 + count)
    refuse("'" + line + "'", std::to_string(words.size() - 1) + " numbers", std::to_string(count));
  std::vector<double> numbers;
  for (std::size_t i = 1; i < words.size(); ++i) numbers.push_back(number_of(words[i], line));
  std::copy_n(numbers.begin(), 3, shape.point.begin());
  if (has_radius) shape.radius = numbers.back();
  if (has_radius && shape.radius <= 0.0) refuse("'" + line + "'", words.back(), "a radius above 0");
  if (!has_axis) return shape;
  std::copy_n(numbers.begin() + 3, 3, shape.axis.begin());
  const double length = std::sqrt(shapes::dot(shape.axis, shape.axis));
  if (length == 0.0) refuse("'" + line + "'", "a direction of length 0", "one with a length");
  for (double& component : shape.axis) component /= length;
  return shape;
}

void read_line(const std::string& line, Settings& settings) {
  const std::vector<std::string> words = words_of(line);
  if (words.empty() || words[0][0] == '/' || words[0][0] == '#') return;
  if (words[0] == "nodes") return add_nodes(words, line, settings.nodes);
  if (words[0] == "plane" || words[0] == "sphere" || words[0] == "cylinder")
    return settings.shapes.push_back(shape_of(words, line));
  if (words.size() != 2)
    refuse("'" + line + "'", std::to_string(words.size()) + " words",
           "nodes, plane, sphere, cylinder, or a name and its value");
  if (words[0] == "law")
    settings.law = words[1];
  else if (words[0] == "area")
    settings.area = number_of(words[1], line);
  else
    settings.parameters.emplace_back(words[0], words[1]);
}

Settings settings_of(const std::string& text) {
  Settings settings;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) read_line(line, settings);
  if (settings.law.empty() || settings.nodes.empty() || settings.shapes.size() != 1)
    refuse("window",
           std::string(settings.law.empty() ? "no law" : "a law") + ", " +
               std::to_string(settings.nodes.size()) + " nodes, " + std::to_string(settings.shapes.size()) +
               " shapes",
           "a law, nodes, and one plane, sphere or cylinder");
  std::set<int> once;
  for (const int node : settings.nodes)
    if (!once.insert(node).second) refuse("nodes", std::to_string(node) + " twice", "each once");
  return settings;
}

ilaw::interface law_of(const Settings& settings) {
  const auto library = ilaw::library::named(settings.law);
  const ilaw_law& law = *library.plugin().laws[0];
  ilaw::parameters parameters;
  for (const auto& [name, value] : settings.parameters) parameters.set(law, name, value);
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = 3;
  setup.delassus_form = ILAW_DELASSUS_SCALAR;
  setup.frame = ILAW_FRAME_GLOBAL;
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  parameters.give(setup);
  return {library, "", setup};
}

vector vector_at(const double* values, std::size_t row) {
  return {values[3 * row], values[3 * row + 1], values[3 * row + 2]};
}

}  // namespace

shapes::surface Shape::surface_at(const vector& x) const {
  const vector from = shapes::plus(x, point, -1.0);
  if (kind == "plane") return shapes::plane(from, axis);
  return kind == "sphere" ? shapes::sphere(from, radius) : shapes::cylinder(from, axis, radius);
}

Window::Window(const std::string& lines) : settings_(settings_of(lines)), law_(law_of(settings_)) {
  const ilaw_instance_info info = law_.info();
  const ilaw_inputs read = info.inputs | info.balance_inputs;
  if ((read & ILAW_INPUT_AREA) && settings_.area < 0.0)
    refuse("law '" + settings_.law + "'", "no line 'area'", "the tributary area of each node");
  if (read & ILAW_INPUT_TANGENT)
    refuse("law '" + settings_.law + "'", "a tangent that it reads", "a law without one");
  state_size_ = info.state_size;
  state_version_ = 1.0 + info.state_version;
}

void Window::bind(const Arrays& arrays, double* memory, double last_step) {
  arrays_ = arrays;
  memory_ = memory;
  last_step_ = last_step;
  if (memory[version] != 0.0 && memory[version] != state_version_)
    refuse("restart file", "another version of the state of '" + settings_.law + "'", "that of this library");
  std::unordered_map<int, std::size_t> row_of;
  for (std::size_t row = 0; row < arrays.count; ++row) row_of[arrays.user[row]] = row;
  for (const int node : settings_.nodes) {
    const auto found = row_of.find(node);
    const std::string name = "node " + std::to_string(node);
    if (found == row_of.end()) refuse(name, "none in the model", "one");
    const std::size_t row = found->second;
    if (arrays.kinematic[row] != 0)
      refuse(name, "a kinematic condition (rigid body, rigid wall, imposed velocity, tie)",
             "none: the engine would undo the impulse of the law");
    if (!(arrays.mass[row] > 0.0)) refuse(name, "no mass", "a mass above 0");
    rows_.push_back(row);
    const vector v = vector_at(arrays.v, row);
    v_previous_.insert(v_previous_.end(), v.begin(), v.end());
  }
  const std::size_t count = rows_.size();
  for (auto* scalars : {&gap_, &inverse_mass_}) scalars->resize(count);
  for (auto* vectors : {&normal_, &v_free_, &impulse_}) vectors->resize(3 * count);
}

// Gaps and normals belong to the positions before the engine moved them.
void Window::gather(double step) {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const vector v = vector_at(arrays_.v, rows_[i]);
    const auto [gap, normal] =
        settings_.shapes[0].surface_at(shapes::plus(vector_at(arrays_.x, rows_[i]), v, -step));
    gap_[i] = gap;
    inverse_mass_[i] = 1.0 / arrays_.mass[rows_[i]];
    for (std::size_t c = 0; c < 3; ++c) {
      normal_[3 * i + c] = normal[c];
      v_free_[3 * i + c] = v[c];
    }
  }
}

void Window::evaluate(double time, double velocity_step, double position_step) {
  const auto stride = static_cast<std::int64_t>(state_size_);
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.node_count = static_cast<std::int64_t>(rows_.size());
  batch.time = time;
  batch.velocity_step = velocity_step;
  batch.position_step = position_step;
  batch.v_free = ilaw::input(v_free_.data(), 3, 1);
  batch.v_previous = ilaw::input(v_previous_.data(), 3, 1);
  batch.delassus = ilaw::input(inverse_mass_.data(), 1, 0);
  batch.gap = ilaw::input(gap_.data(), 1, 0);
  batch.normal = ilaw::input(normal_.data(), 3, 1);
  if (settings_.area >= 0.0) batch.area = ilaw::input(&settings_.area, 0, 0);
  batch.state_in = ilaw::input(memory_ + head_size, stride, 1);
  batch.state_out = ilaw::output(memory_ + head_size, stride, 1);
  batch.impulse = ilaw::output(impulse_.data(), 3, 1);
  ilaw_report report{};
  report.struct_size = sizeof report;
  if (memory_[version] == 0.0) check(law_.initialise(batch, &report), report, time, velocity_step);
  memory_[version] = state_version_;
  check(law_.evaluate(batch, &report), report, time, velocity_step);
}

void Window::check(ilaw_result code, const ilaw_report& report, double time, double velocity_step) const {
  std::ostringstream at;
  at << "time " << time;
  const std::string reason = report.reason ? report.reason : "refused";
  if (code == ILAW_BAD_NODES)
    throw std::runtime_error(
        at.str() + ": node " +
        std::to_string(settings_.nodes[static_cast<std::size_t>(report.first_bad_node)]) + ": " + reason);
  if (code != ILAW_OK) throw std::runtime_error(at.str() + ": " + reason);
  if (report.stable_velocity_step > 0.0 && velocity_step > report.stable_velocity_step)
    refuse(at.str(), "the step " + std::to_string(velocity_step),
           "at most " + std::to_string(report.stable_velocity_step) +
               ", which the spring of the law needs: /DTIX bounds it");
}

void Window::scatter(double step) {
  for (std::size_t i = 0; i < rows_.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t k = 3 * i + c, row = 3 * rows_[i] + c;
      const double change = inverse_mass_[i] * impulse_[k], v = v_free_[k] + change;
      memory_[work] += 0.5 * impulse_[k] * (v + v_previous_[k]);
      v_previous_[k] = arrays_.v[row] = v;
      arrays_.x[row] += step * change;
      arrays_.d[row] += step * change;
    }
}

void Window::apply(double time, double step) {
  gather(step);
  evaluate(time - step, 0.5 * (last_step_ + step), step);
  scatter(step);
  last_step_ = step;
}

double Window::take_work() { return std::exchange(memory_[work], 0.0); }

}  // namespace ilaw::openradioss
