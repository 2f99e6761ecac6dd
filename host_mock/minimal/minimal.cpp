// minimal.cpp - what a host does: central differences with a lumped mass, and in each step the laws'
// impulses. Read Host::step first. history.csv has the bits of `ilaw run`.
// SPDX-License-Identifier: BSD-3-Clause
#include "minimal.hpp"

#include <ilaw/arrays.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

namespace minimal {
namespace {

using Columns = std::vector<std::pair<std::string, double>>;

ilaw_report empty_report() {
  ilaw_report report{};
  report.struct_size = sizeof report;
  return report;
}

class Host {
 public:
  explicit Host(Scene scene)
      : scene_(std::move(scene)), d_(scene_.points.d), u_(scene_.points.position.size()), impulse_(u_) {
    v_ = v_before_ = scene_.points.velocity;
    if (CoupledContacts::is_needed(scene_)) coupled_.emplace();
  }
  void start();
  void step();
  const Scene& scene() const { return scene_; }
  std::int64_t steps() const { return steps_; }
  double time() const { return static_cast<double>(steps_) * scene_.dt; }
  Columns columns() const;

 private:
  void sum_impulses(const Step& step);
  void kick(double factor);
  void locate(Contacts& contacts, double time) const;
  void add_reactions(const Step& step);
  void evaluate(Contacts& contacts, const Step& step);
  void check(const Contacts& contacts, ilaw_result code, const ilaw_report& report) const;

  Scene scene_;
  std::size_t d_;        // dimension
  Values u_, impulse_;   // displacements, impulses of loads and springs
  Values v_, v_before_;  // half-step velocities after and before the positions' time
  std::int64_t steps_ = 0;
  std::optional<CoupledContacts> coupled_;
};

// From t_n to t_n+1.
void Host::step() {
  const double h = scene_.dt;
  const Step step{static_cast<double>(steps_ + 1) * h, h, h};
  for (std::size_t i = 0; i < u_.size(); ++i) u_[i] += h * v_[i];  // u_n+1 = u_n + h V_n+1/2
  sum_impulses(step);                                              // h f_n+1, without contact
  v_before_ = v_;
  kick(1.0);            // V_free = V_n+1/2 + M^-1 h f_n+1
  add_reactions(step);  // r = law(v_free, H, gap, state), V_n+3/2 = V_free + M^-1 r
  ++steps_;
}

// From V_0 to V_1/2 by half a kick, in which laws act, too. Otherwise bodies at rest would sink by g h^2/2.
void Host::start() {
  const Step step{0.0, 0.5 * scene_.dt, scene_.dt};
  for (Contacts& contacts : scene_.contacts) {
    locate(contacts, 0.0);
    ilaw_report report = empty_report();
    check(contacts, contacts.law.initialise(batch_of(contacts, d_, step), &report), report);
  }
  sum_impulses({0.0, 1.0, scene_.dt});  // over a unit of time: forces
  kick(step.velocity_step);
  add_reactions(step);
}

void Host::sum_impulses(const Step& step) {
  const double h = step.velocity_step;
  std::fill(impulse_.begin(), impulse_.end(), 0.0);
  for (const Force& force : scene_.forces)
    for (const std::int32_t node : force.nodes)
      for (std::size_t c = 0, n = static_cast<std::size_t>(node); c < d_; ++c)
        impulse_[d_ * n + c] += (force.is_acceleration ? scene_.points.mass[n] : 1.0) *
                                (force.at(step.time) * force.direction[c]);
  for (double& impulse : impulse_) impulse *= h;
  const double slack = 1e-9 * h;  // a shock at the end of a step belongs to it despite rounding
  for (const Shock& shock : scene_.shocks)
    if (shock.time > time() + slack && shock.time <= step.time + slack)
      for (const std::int32_t node : shock.nodes)
        for (std::size_t c = 0; c < d_; ++c)
          impulse_[d_ * static_cast<std::size_t>(node) + c] += shock.impulse[c];
  for (std::size_t i = 0; i < u_.size(); ++i) impulse_[i] += -scene_.points.stiffness[i] * u_[i] * h;
}

void Host::kick(double factor) {
  for (std::size_t i = 0; i < v_.size(); ++i) {
    v_[i] += factor * (impulse_[i] * (1.0 / scene_.points.mass[i / d_]));
    if (!std::isfinite(v_[i]))
      throw std::runtime_error("step " + std::to_string(steps_ + 1) + ": the velocity of node " +
                               std::to_string(i / d_) + " is not finite, expected a smaller /time/dt");
  }
}

// The gap is positive if it is open; the unit normal points from the obstacle into the body. A gap that is
// open by no more than the rounding of positions is closed: else a law that acts at closed gaps would let a
// node at rest fall.
void Host::locate(Contacts& contacts, double time) const {
  const Obstacle& obstacle = contacts.obstacle;
  const auto position = [&](std::int32_t node, std::size_t c) {
    const std::size_t i = d_ * static_cast<std::size_t>(node) + c;
    return scene_.points.position[i] + u_[i];
  };
  for (std::size_t k = 0; k < contacts.nodes.size(); ++k) {
    double apart[3], square = 0.0, along = 0.0, largest = 0.0;
    for (std::size_t c = 0; c < d_; ++c) {
      const double x = position(contacts.nodes[k], c);
      largest = std::max(largest, std::fabs(x));
      apart[c] = contacts.partners.empty() ? x - time * obstacle.velocity[c] - obstacle.center[c]
                                           : x - position(contacts.partners[k], c);
      square += apart[c] * apart[c];
      const double part = apart[c] * obstacle.normal[c];
      along = c == 0 ? part : along + part;
    }
    const double distance = std::sqrt(square);
    const bool is_sphere = obstacle.radius > 0.0;
    const double gap = is_sphere ? distance - obstacle.radius : along;
    const bool is_rounding = gap > 0.0 && gap <= 16.0 * std::numeric_limits<double>::epsilon() * largest;
    contacts.gap[k] = is_rounding ? 0.0 : gap;
    for (std::size_t c = 0; c < d_; ++c)
      contacts.normal[d_ * k + c] = is_sphere ? apart[c] / distance : obstacle.normal[c];
  }
}

void Host::add_reactions(const Step& step) {
  for (Contacts& contacts : scene_.contacts) locate(contacts, step.time);
  if (coupled_) return coupled_->solve(scene_, step, u_, v_before_, v_);
  for (Contacts& contacts : scene_.contacts) evaluate(contacts, step);
}

// One call of the law for all its nodes: gather H and velocities relative to the obstacle, evaluate, add H r.
void Host::evaluate(Contacts& contacts, const Step& step) {
  for (std::size_t k = 0; k < contacts.nodes.size(); ++k) {
    const auto n = static_cast<std::size_t>(contacts.nodes[k]);
    contacts.delassus[k] = 1.0 / scene_.points.mass[n];
    for (std::size_t c = 0; c < d_; ++c) {
      contacts.v_free[d_ * k + c] = v_[d_ * n + c] - contacts.obstacle.velocity[c];
      contacts.v_previous[d_ * k + c] = v_before_[d_ * n + c] - contacts.obstacle.velocity[c];
    }
  }
  ilaw_report report = empty_report();
  check(contacts, contacts.law.evaluate(batch_of(contacts, d_, step), &report), report);
  if (step.velocity_step > report.stable_velocity_step)
    throw std::runtime_error("interface '" + contacts.name + "': found the step " +
                             std::to_string(step.velocity_step) + ", expected at most " +
                             std::to_string(report.stable_velocity_step) + ", which its spring needs");
  for (std::size_t k = 0; k < contacts.nodes.size(); ++k)
    for (std::size_t c = 0; c < d_; ++c)
      v_[d_ * static_cast<std::size_t>(contacts.nodes[k]) + c] +=
          contacts.delassus[k] * contacts.impulse[d_ * k + c];
}

void Host::check(const Contacts& contacts, ilaw_result code, const ilaw_report& report) const {
  if (code == ILAW_OK) return;
  std::string text = "step " + std::to_string(steps_ + 1) + ": interface '" + contacts.name + "': ";
  if (code == ILAW_BAD_NODES && report.first_bad_node >= 0)
    text += "node " + std::to_string(contacts.nodes[static_cast<std::size_t>(report.first_bad_node)]) + ": ";
  throw std::runtime_error(text + (report.reason ? report.reason : "code " + std::to_string(code)));
}

// Gap, status, and the state variables that mean something outside their law.
void add_contact(const Contacts& contacts, std::size_t k, const std::string& prefix, Columns& columns) {
  columns.emplace_back(prefix + "gap", contacts.gap[k]);
  columns.emplace_back(prefix + "status", contacts.status[k]);
  const double* state = contacts.state.data() + k * contacts.info.state_size;
  for (std::uint32_t i = 0; i < contacts.info.state_variable_count; ++i) {
    const ilaw_state_variable& variable = *contacts.info.state_variables[i];
    const bool is_vector = variable.kind == ILAW_KIND_VECTOR || variable.kind == ILAW_KIND_TANGENTIAL;
    for (std::uint32_t c = 0; c < variable.count; ++c, ++state)
      if ((is_vector || variable.kind == ILAW_KIND_SCALAR) && !(variable.flags & ILAW_FLAG_INTERNAL))
        columns.emplace_back(prefix + variable.name + (is_vector ? std::to_string(c) : ""), *state);
  }
}

// A row of history.csv with the names of its columns.
Columns Host::columns() const {
  Columns columns{{"time", time()}};
  for (const std::int32_t node : scene_.watch) {
    const std::string name = "n" + std::to_string(node) + ".";
    const std::size_t first = d_ * static_cast<std::size_t>(node);
    Values r(d_);
    Columns own;
    std::size_t count = 0;
    for (const Contacts& contacts : scene_.contacts)
      count += static_cast<std::size_t>(std::count(contacts.nodes.begin(), contacts.nodes.end(), node));
    for (const Contacts& contacts : scene_.contacts)
      for (std::size_t k = 0; k < contacts.nodes.size(); ++k) {
        const bool is_partner = !contacts.partners.empty() && contacts.partners[k] == node;
        if (contacts.nodes[k] == node)
          add_contact(contacts, k, count == 1 ? name : name + contacts.name + ".", own);
        if (contacts.nodes[k] == node || is_partner)
          for (std::size_t c = 0; c < d_; ++c)
            r[c] += (is_partner ? -1.0 : 1.0) * contacts.impulse[d_ * k + c];
      }
    for (const auto& [quantity, values] :
         {std::pair{"u", &u_[first]}, {"v", &v_[first]}, {"r", std::as_const(r).data()}})
      for (std::size_t c = 0; c < d_; ++c)
        columns.emplace_back(name + quantity + std::to_string(c), values[c]);
    columns.insert(columns.end(), own.begin(), own.end());
  }
  return columns;
}

// As few digits as read back to the same double.
void write_row(const Columns& columns, std::ostream& out) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    char text[32] = ",";
    const char* const end = std::to_chars(text + 1, text + sizeof text, columns[i].second).ptr;
    const char* const start = i == 0 ? text + 1 : text;
    out.write(start, end - start);
  }
  out << '\n';
}

void run(const std::string& file, const std::filesystem::path& folder) {
  Host host(read_scene(file));
  const std::int64_t steps = host.scene().steps, every = host.scene().every;
  std::filesystem::create_directories(folder);
  std::ofstream history(folder / "history.csv");
  host.start();
  for (const auto& [name, value] : host.columns()) history << (name == "time" ? "" : ",") << name;
  history << '\n';
  while (host.steps() < steps) {
    host.step();
    if (host.steps() % every == 0 || host.steps() == steps) write_row(host.columns(), history);
  }
  if (!history.flush()) throw std::runtime_error((folder / "history.csv").string() + " could not be written");
  std::printf("%s: %lld steps to time %g; %s\n", host.scene().title.c_str(), static_cast<long long>(steps),
              host.time(), (folder / "history.csv").c_str());
}

}  // namespace

// Strides: of nodes, of components. A plain step is final, so the state is written in place.
ilaw_batch batch_of(Contacts& contacts, std::size_t d, const Step& step) {
  const auto stride = static_cast<std::int64_t>(d),
             state_size = static_cast<std::int64_t>(contacts.info.state_size);
  contacts.parameter_inputs.clear();
  for (const Values& values : contacts.parameters)
    contacts.parameter_inputs.push_back(ilaw::input(values.data(), 1, 1));
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.node_count = static_cast<std::int64_t>(contacts.nodes.size());
  batch.time = step.time;
  batch.velocity_step = step.velocity_step;
  batch.position_step = step.position_step;
  batch.v_free = ilaw::input(contacts.v_free.data(), stride, 1);
  batch.v_previous = ilaw::input(contacts.v_previous.data(), stride, 1);
  batch.delassus = ilaw::input(contacts.delassus.data(), 1, 1);
  batch.gap = ilaw::input(contacts.gap.data(), 1, 1);
  batch.normal = ilaw::input(contacts.normal.data(), stride, 1);
  batch.area = ilaw::input(contacts.area.data(), 1, 1);
  batch.per_node_parameters = contacts.parameter_inputs.data();
  batch.state_in = ilaw::input(contacts.state.data(), state_size, 1);
  batch.state_out = ilaw::output(contacts.state.data(), state_size, 1);
  batch.impulse = ilaw::output(contacts.impulse.data(), stride, 1);
  batch.status = contacts.status.data();
  batch.status_stride = 1;
  return batch;
}

}  // namespace minimal

int main(int count, char** words) {
  if (count == 2 && std::string(words[1]) == "--help")
    return std::puts(
               "ilaw-minimal SCENE.json FOLDER\n\n"
               "Runs points against planes or spheres, and writes FOLDER/history.csv with the bits of `ilaw run`.\n"
               "Laws are looked for along ILAW_PATH, then in lib/ilaw beside the bin of the program.\n"
               "Exit code 1: the run failed; 2: the command or the scene was refused.\n\n"
               "Example: ilaw-minimal plugins/coulomb/sliding_block.json results") < 0;
  if (count != 3) {
    std::fprintf(stderr, "ilaw-minimal: found %d arguments, expected SCENE.json FOLDER; see --help\n",
                 count - 1);
    return 2;
  }
  try {
    minimal::run(words[1], words[2]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ilaw-minimal: %s: %s\n", words[1], error.what());
    return dynamic_cast<const std::invalid_argument*>(&error) ? 2 : 1;
  }
}
